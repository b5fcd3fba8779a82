"""Closed forms of motion: written down, proved, compared with traced curves."""
