"""Judges: each looks at one moment a step and gives its figures at the end."""
