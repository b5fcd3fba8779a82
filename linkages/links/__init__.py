"""Links as bodies: the rods that they are made of, and how near they come.

A form goes in; the least distances of bodies along it come out, each with an error bound,
and the lines that are drawn of bodies and joints.
"""
