"""Sheets of rigid panels of any size, by name.

Numbers of a sheet go in; the content of a FOLD file comes out: of a mesh folded by its
closed form, or of a flat pattern that repeats.
"""
