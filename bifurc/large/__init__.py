"""Curves of systems with a thousand to a million unknowns: sparse, bordered, traced."""
