"""Mechanisms in the files of other programs: MJCF, SDF and CUIK worlds.

A file goes in; an assembly of bodies and joints in body frames comes out, which is closed
and becomes a mechanism. Writers take the same way back.
"""
