"""An atlas seen along one of its unknowns, the parameter.

An atlas and a parameter go in; folds, stable stretches, Hopf points and events along its
forms come out.
"""
