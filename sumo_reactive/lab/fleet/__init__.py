"""Several egos in one simulation."""
