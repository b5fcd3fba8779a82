"""The closure equations, as a problem for `bifurc`.

A loop or a mechanism goes in; a problem comes out: residuals, exact derivatives, Taylor
series, bounds, and sources of solutions to start from, each with what it proves.
"""
