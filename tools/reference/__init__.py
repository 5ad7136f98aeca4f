"""What the pages of reference are made from, a kind of source a file."""
