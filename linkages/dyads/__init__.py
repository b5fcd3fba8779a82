"""All configurations of mechanisms that are built dyad by dyad."""
