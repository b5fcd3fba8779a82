"""Linear algebra and polynomials of one variable, for whatever is solved.

Matrices, functions of one variable and points go in; solutions, null spaces, roots and
polynomial pieces come out. Nothing here knows what a curve or a singular point is.
"""
