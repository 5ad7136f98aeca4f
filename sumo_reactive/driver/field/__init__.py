"""The executor: descends the potential U over the command space at every control period (F&L 1991, §3)."""
