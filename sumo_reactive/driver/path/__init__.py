"""The nominal plan P: lanes to drive, the smooth curve C and its time constraints (F&L 1991, §1.3)."""
