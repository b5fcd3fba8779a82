"""Solve and decompose: bordered systems, correctors, roots, pieces by collocation."""
