"""The highway code, one rule a file: what it asks of the ego now (F&L 1991, §2)."""
