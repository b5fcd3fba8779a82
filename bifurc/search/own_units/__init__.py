"""Units of a search's own.

A function of a user goes in; out come its equations, counted by the sizes of its
solutions and by its gradients. An atlas found in these units goes in, and comes out in
those of the user.
"""
