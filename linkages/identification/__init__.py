"""Which linkages of the catalogue a table is a case of.

A loop goes in; families with their parameters come out, and how far the loop is from
each.
"""
