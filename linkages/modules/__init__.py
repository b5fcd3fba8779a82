"""Mechanisms of any joints that nothing moves: all of their assemblies.

A structure goes in; its closures come out as a family of polynomial equations in which
the geometry is a parameter. Paths lead from the solutions of a generic member to all
isolated configurations of the given mechanism.
"""
