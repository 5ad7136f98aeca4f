"""Scenes for judges, built from the few values a test cares about."""

import math

from sumo_reactive.driver.nouns.record import Scene, StepRecord
from sumo_reactive.driver.nouns.traffic import Body, RoadUser

NAN = math.nan


def record(time=0.0, x=0.0, y=0.0, heading=0.0, speed=0.0, **others) -> StepRecord:
    values = {
        "acceleration": 0.0,
        "steering_angle": 0.0,
        "lane_id": "road_0",
        "s": 0.0,
        "d": 0.0,
        "command_acceleration": 0.0,
        "command_steering_rate": 0.0,
        "desired_speed": 10.0,
        "stop_s": NAN,
        "u": 0.0,
        "u1": 0.0,
        "u2": 0.0,
        "u3": 0.0,
        "leader": "",
        "gap": NAN,
        "behaviour": "normal driving",
        "instruction": "follow C",
        "pilot": 0,
        "emergency": False,
        "light": "",
        "control_us": 100.0,
        "decisions": (),
        "hazard": "",
    }
    return StepRecord(time=time, x=x, y=y, heading=heading, speed=speed, **(values | others))


def user(name="other", x=0.0, y=0.0, heading=0.0, speed=0.0, lane="elsewhere_0", position=0.0, route=(), size=(5.0, 1.8)):
    return RoadUser(name, x, y, heading, speed, lane, position, Body(*size, 9.0, 50.0), route)


def drive(judge, ego, others, steps, dt=0.1, world=None):
    """Show `judge` what functions `ego(t)` (a record) and `others(t)` (users) give, in a world."""
    for k in range(steps):
        t = k * dt
        judge.see(Scene(ego(t), tuple(others(t)), world=world))
