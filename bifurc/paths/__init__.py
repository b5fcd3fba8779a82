"""Equations with parameters over the complex numbers: all isolated solutions.

A family of square systems and one solution of a generic member go in; monodromy finds
the other solutions of it, a trace test says whether any is missing, and paths lead
from them to all isolated solutions of every other member.
"""
