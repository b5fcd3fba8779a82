"""Links as bodies: the rods that they are made of, and how near they come."""
