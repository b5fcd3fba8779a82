"""The usual ways to follow a curve, for comparison: each as good as its textbook makes
it, on the same problems.

All of them are given the problem's compiled residual and Jacobian, the arclength to
follow, and a smooth interpolant between their points; what is measured is the method.
"""
