"""All configurations of planar mechanisms that are built dyad by dyad."""
