"""Equations with parameters over the complex numbers: all isolated solutions.

Of polynomials with given monomials a generic member is solved from mixed cells. Of
another family of square systems one solution of a generic member goes in; monodromy finds
the others, and a trace test says whether any is missing. Paths lead from them to all
isolated solutions of every other member.
"""
