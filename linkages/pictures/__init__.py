"""Pictures of a linkage.

An atlas and a configuration go in; a flat picture comes out, as strokes and names, and of
these figures of matplotlib, moving pictures and drawings for CAD programs.
"""
