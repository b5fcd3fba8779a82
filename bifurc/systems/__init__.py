"""Systems of equations in files: read, solved, and reported on.

A TOML file goes in; an atlas comes out, and its summary and JSON document.
"""
