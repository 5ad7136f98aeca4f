"""Perception: relate what is observed to C and to the regions on it."""
