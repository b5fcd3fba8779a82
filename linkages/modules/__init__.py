"""Modules of a mechanism: all configurations at given values of some unknowns.

A structure goes in; its closures come out as a family of polynomial equations in which
the geometry is a parameter. A generic member has a number of complex solutions that
monodromy finds and a trace test counts, and paths lead from these to all isolated
configurations of the given mechanism.
"""
