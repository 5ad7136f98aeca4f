"""Results of trials that never ran."""

from sumo_reactive.lab.result import TrialResult


def result(**others):
    """Return a clean arrival after 30 s, but for `others`."""
    values = {
        "scenario": "a.toml",
        "ego": "cab",
        "chosen": "as named",
        "seed": 42,
        "step_length_s": 0.1,
        "profile": "default",
        "arrived": True,
        "ended": "arrived",
        "begin_s": 0.0,
        "departure_s": 5.0,
        "end_s": 35.0,
        "time_loss_s": 3.0,
        "distance_m": 200.0,
        "length_m": 4.7,
        "width_m": 1.8,
        "figures": {},
    }
    return TrialResult(**(values | others))
