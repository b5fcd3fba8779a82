"""Networks of Bennett loops whose joints are locked and released.

A plan of loops and its parameters go in; mechanisms with locks come out, all
configurations by the closed form, and routes from locks to locks.
"""
