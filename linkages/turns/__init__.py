"""Whole turns after which a mechanism is closed again, and what is one up to them.

A structure goes in; a lattice of turns comes out. Forms and assemblies that differ by
turns of the lattice are listed once.
"""
