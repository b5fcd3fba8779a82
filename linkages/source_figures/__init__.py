"""The figures of the sources, drawn from the geometry.

``data`` holds what each figure shows, one table a source; a module draws each kind. The
name of a figure goes in; a figure of matplotlib comes out.
"""
