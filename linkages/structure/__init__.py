"""What is unknown in a mechanism, and which chains have to close.

A mechanism goes in; its unknowns come out, with their limits and periods, and the chains,
rods and points whose closing are its equations. Whether it is one loop of turns is seen
here, too.
"""
