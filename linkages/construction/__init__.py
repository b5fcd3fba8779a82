"""What families are made of: numbers of any kind, links, triangles, constructions.

Angles and lengths go in, as floats, with 50 digits or exact; links, loops and equations
of tables come out, over numbers of the same kind.
"""
