"""Mechanisms of many equal or similar units, by name.

Numbers go in; a `Mechanism` in a configuration of its closed form comes out.
"""
