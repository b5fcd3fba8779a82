"""What is given of a mechanism: bodies, and joints of every kind between them.

Joints go in, each with its place in one closed configuration; a mechanism comes out,
checked. What is unknown in it, and what it does, is asked further on.
"""
