"""Roads that nobody has seen: networks and traffic drawn at random, trips there by both drivers, and what came of them."""
