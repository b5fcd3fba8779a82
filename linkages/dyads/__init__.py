"""All configurations of mechanisms that are built dyad by dyad.

A structure goes in; a plan of dyads comes out where there is one, and by it every
configuration at values of a driver, with what the slices leave out. In the plane a plan
may have larger groups, where dyads alone do not do.
"""
