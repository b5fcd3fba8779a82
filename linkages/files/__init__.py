"""Mechanisms in files of this project and in FOLD files.

The content of a TOML or FOLD file goes in, joints, points and bars, arcs, tables or
panels; a mechanism comes out, or an error that names the key and what is allowed.
"""
