"""The paper's controller, whole: no SUMO, no files (F&L 1991, figure 1)."""
