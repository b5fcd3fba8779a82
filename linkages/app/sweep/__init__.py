"""The command `bifurc sweep`: many members of a family, resumable.

A linkage and ranges of its parameters go in; one table of summaries comes out. A journal
holds every member that is done.
"""
