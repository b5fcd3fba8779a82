"""One surface of solutions, or a component of more dimensions: covered by charts,
measured, walked over, taken for a product.

A problem and solutions about which others form a surface go in; charts that cover the
surface come out, shortest ways over them, the factors of products, and which of the
solutions are joined.
"""
