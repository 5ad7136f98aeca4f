// A driver that is a program, in C++17 without a library: it drives at 90 % of the limit and keeps its distance, as far as
// SUMO's own checks let it. Build with "g++ -O2 -std=c++17 -o pass_on pass_on.cpp" and run
//
//     sumo-reactive run my.sumocfg --driver exec:./pass_on

#include <algorithm>
#include <cstdlib>
#include <iostream>
#include <string>

// Returns the number behind a key of a JSON text, or `otherwise` where there is none.
static double number(const std::string& text, const std::string& key, double otherwise) {
    const auto at = text.find('"' + key + "\":");
    return at == std::string::npos ? otherwise : std::strtod(text.c_str() + at + key.size() + 3, nullptr);
}

// The ego's lane is [number, how far it leads on, limit, leader, follower], a leader ["id", gap, speed] or null.
struct Lane {
    double limit = 10.0, gap = 1e3, leader_speed = 0.0;
    bool has_leader = false;
};

static Lane lane_of(const std::string& text) {
    Lane lane;
    auto at = text.find("\"own\":[");
    if (at == std::string::npos) return lane;
    for (int comma = 0; comma < 2; ++comma) at = text.find(',', at) + 1;
    char* end = nullptr;
    lane.limit = std::strtod(text.c_str() + at, &end);
    if (std::string(end, 3) == ",[\"") {
        const auto quote = text.find("\",", end - text.c_str());
        lane.gap = std::strtod(text.c_str() + quote + 2, &end);
        lane.leader_speed = std::strtod(end + 1, nullptr);
        lane.has_leader = true;
    }
    return lane;
}

int main() {
    double most = 2.0;
    for (std::string line; std::getline(std::cin, line);) {
        if (line.find("{\"start\"") == 0) {
            most = number(line, "max_acceleration", most);
            std::cout << "{\"ready\": true}" << std::endl;
        } else if (line.find("{\"step\"") == 0) {
            const double speed = number(line, "speed", 0.0);
            const Lane lane = lane_of(line);
            double wished = 0.9 * lane.limit;
            if (lane.has_leader) wished = std::min(wished, (lane.gap - 2.0) / 1.5 + 0.5 * (lane.leader_speed - speed));
            const double gain = std::clamp(wished - speed, -4.0, most);
            std::cout << "{\"lane\": [" << gain << ", null, true], \"reason\": \""
                      << (lane.has_leader ? "keeps its distance" : "drives freely") << "\"}" << std::endl;
        }
    }
}
