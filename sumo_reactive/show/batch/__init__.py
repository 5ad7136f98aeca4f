"""The page of a batch: tables, distributions, pairs, worst trials."""
