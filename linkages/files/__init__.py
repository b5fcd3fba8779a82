"""Mechanisms in files of this project, and crease patterns in FOLD, CP and SVG files.

The content of a file goes in, joints, points and bars, arcs, tables or
panels; a mechanism comes out, or an error that names the key and what is allowed.
"""
