"""Angles, polylines, curves, footprints, distance fields: geometry that knows no traffic."""
