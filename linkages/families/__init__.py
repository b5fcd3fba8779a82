"""The families of the catalogue, a module and a table each.

The parameters of a family go in; a loop comes out. The table says what its linkages are,
the module how they are built, their closed forms and named forms, with their sources.
"""
