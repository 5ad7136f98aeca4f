"""Who drives an ego: this project's driver, SUMO's own, or one of the user's, all judged alike."""
