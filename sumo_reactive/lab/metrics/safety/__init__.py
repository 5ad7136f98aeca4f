"""Surrogate safety measures over every encounter of the ego, a family a file; `pairs` says who meets whom."""
