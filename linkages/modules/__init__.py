"""Mechanisms of any joints: all assemblies of what nothing moves, and slices of what moves.

A structure goes in; its closures come out as a family of polynomial equations in which
the geometry is a parameter. Paths lead from the solutions of a generic member to all
isolated configurations of the given mechanism, without drivers or with one at a value.
"""
