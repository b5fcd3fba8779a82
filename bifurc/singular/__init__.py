"""One singular point: located, looked at on a small sphere, classified, confirmed.

A problem and a place near a singular point go in; the point comes out to machine
precision, with its null space, its half-branches and its kind. How a curve came near it
is not asked here.
"""
