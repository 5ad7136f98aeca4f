"""Bundles: a record with all that it was made from in one file, and what drives it again and compares."""
