"""Trials in processes of their own: what is asked, what comes back, who runs it."""
