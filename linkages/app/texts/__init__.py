"""Tables and sentences of the command line.

Atlases and reports go in; text comes out, angles in degrees and joints from 1.
"""
