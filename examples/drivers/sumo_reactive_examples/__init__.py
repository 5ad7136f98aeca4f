"""Drivers to begin one's own from, each in one file: on lanes, by steering, by places, from a record, as a program."""
