"""Scenario files as tests: found, run, judged, reported for CI systems."""
