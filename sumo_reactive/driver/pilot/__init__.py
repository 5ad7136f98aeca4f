"""The pilot: a symbolic layer that knows the highway code and completes the nominal plan (F&L 1991, §2)."""
