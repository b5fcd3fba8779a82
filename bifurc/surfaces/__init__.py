"""One surface of solutions: covered by charts, measured, walked over.

A problem and a solution about which solutions form a surface go in; charts that cover
the surface come out, and shortest ways over them.
"""
