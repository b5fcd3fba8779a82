"""What an atlas says in the variables of joints and in places of bodies.

A mechanism and points of its atlas go in; joint variables, poses of bodies and facts
come out: joints that stand still, bodies that move as one, redundant constraints.
"""
