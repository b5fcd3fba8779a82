"""Routes from one configuration to another, along forms and over surfaces.

An atlas and two places go in; the shortest way between them comes out, leg by leg.
"""
