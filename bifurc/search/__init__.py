"""All of it: every branch and every singular point of a problem.

A problem, settings and a seed of random starts go in; an atlas comes out, and how sure it
is. Branches and points are found by the rooms of these names; here it is decided where to
look next, and what is new.
"""
