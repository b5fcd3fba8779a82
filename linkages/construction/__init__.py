"""What families are made of: numbers of any kind, links, triangles, constructions."""
