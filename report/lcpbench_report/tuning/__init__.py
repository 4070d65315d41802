"""Tuning with a stated budget, the same for every solver: what may be set, what is tried, what is chosen."""
