"""All configurations of mechanisms that are built dyad by dyad.

A structure goes in; a plan of dyads comes out where there is one, and by it every
configuration at values of a driver, with what the slices leave out. The plan of what
stands, without a driver, may have larger groups.
"""
