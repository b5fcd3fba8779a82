"""Equations as data: recorded from a callable or made of sympy expressions."""
