"""The page of a run: map, timeline, decisions."""
