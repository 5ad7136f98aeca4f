"""Explanations, pictures and pages, made from recorded runs only."""
