"""Curves of systems with a thousand to a million unknowns: sparse, bordered, traced.

A large problem and a solution go in; a branch of points comes out, with its folds and
crossings. Matrices are sparse, or are never formed where a user brings a solver.
"""
