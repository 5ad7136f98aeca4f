"""World model W (F&L 1991, §2): lanes, junctions, conflict regions, right of way, the labelled oriented graph."""
