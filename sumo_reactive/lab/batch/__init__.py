"""Batches: an experiment file becomes trials, run by workers, kept in a store."""
