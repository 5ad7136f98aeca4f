"""One file per behaviour of the paper (F&L 1991, §2); overtaking joins them with the event-driven pilot."""
