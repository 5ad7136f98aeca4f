"""Everything that knows SUMO: network files, sessions, the ego's hand-over, units."""
