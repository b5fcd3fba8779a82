"""Equations as data: recorded from a callable or made of sympy expressions.

A function or texts go in; a tape comes out, a list of operations of which values,
derivatives, series and bounds are computed. A problem made of a tape is what a search
takes.
"""
