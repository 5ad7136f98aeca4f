"""What all pages share: one self-contained document, its style, colours and words."""
