"""A driver that is a program, in plain Python: nothing of sumo_reactive is imported. It keeps a time headway to the leader
and stops for red; SUMO moves it along its lanes and checks what it wishes.

    sumo-reactive run my.sumocfg --driver "exec:python pass_on.py"
"""

import json
import sys

HEADWAY_S, STANDSTILL_M, BRAKING_M_S2 = 1.5, 2.0, 2.5


def main() -> None:
    limits = {}
    for line in sys.stdin:
        message = json.loads(line)
        if "start" in message:
            limits = message["start"]
            answer({"ready": True})
        elif "step" in message:
            answer(step(message["step"], limits))


def step(view: dict, limits: dict) -> dict:
    """Return the acceleration that leads to the safe speed within a second, and why."""
    speed, around = view["ego"]["speed"], view["own"]
    if around is None:
        return {"lane": [0.0, None, True], "reason": "is on no lane"}
    _, _, limit, leader, _ = around
    wished, reason = min(limit, limits["max_speed"]), "drives freely"
    if leader is not None:
        name, gap, its_speed = leader
        safe = (gap - STANDSTILL_M) / HEADWAY_S + 0.5 * (its_speed - speed)
        if safe < wished:
            wished, reason = safe, f"keeps behind {name}"
    if view["light"] is not None:
        name, distance, letter = view["light"]
        stop = (2.0 * BRAKING_M_S2 * max(0.0, distance - 1.0)) ** 0.5
        if letter in "rRyYu" and stop < wished:
            wished, reason = stop, f"stops for {name}"
    gain = min(max(wished - speed, -limits["emergency_deceleration"]), limits["max_acceleration"])
    return {"lane": [gain, None, True], "reason": reason}


def answer(message: dict) -> None:
    """Write a line, at once."""
    print(json.dumps(message), flush=True)


if __name__ == "__main__":
    main()
