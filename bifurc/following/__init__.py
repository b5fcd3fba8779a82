"""A singular point followed while parameters move.

In goes a `ParametrisedProblem` and a singular point of one of its members. The equations
of the point itself (F = 0, F_u V = 0, V an orthonormal basis of the null space) are
traced like any others. Out comes the curve of the point in the unknowns and parameters,
with the places at which a parameter turns back: there two such points are born, or meet
and vanish.
"""
