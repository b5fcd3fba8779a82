"""The families of the catalogue, one file each.

The parameters of a family go in; a loop comes out. Beside the constructor stand its
conditions, closed forms and named forms, with their sources.
"""
