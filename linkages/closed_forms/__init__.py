"""Closed forms of motion: written down, proved, compared with traced curves.

The formulas of a family go in; whether they close its loop comes out, exactly over random
members, and by how much a traced form differs from them.
"""
