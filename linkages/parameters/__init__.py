"""The geometry as an unknown: what becomes of a map while parameters of a family move.

In goes a family with values of its parameters, some of them free within ranges. Out come
the curves of its singular points over these, and the values at which the map changes.
"""
