"""A driver of somebody's, which stays where it is: what a module of the user's is like."""

STILL = """
from sumo_reactive.lab.drivers.protocol import LaneCommand

class Still:
    reason = "waits for <nobody>"
    def start(self, mission): pass
    def step(self, view): return LaneCommand(-1.0, is_checked=True)
    def end(self, result): pass
"""
"""The contents of `still.py`, in which the driver is `still:Still`."""
