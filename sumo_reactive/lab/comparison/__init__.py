"""Paired comparisons of two drivers on the same trips, and what they mean for all others."""
