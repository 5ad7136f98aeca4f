"""One trial and what is made of it: scenario, verdicts, metrics, records."""
