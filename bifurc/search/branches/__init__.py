"""What becomes of a traced branch before it is recorded.

A branch goes in; out it comes with a start and a direction of its own, the singular points
along it and a certificate. Where doubles lose it beside a point, it is cut, joined, or put
together from the germs there.
"""
