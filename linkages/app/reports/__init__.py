"""What commands work out besides the map.

A linkage or its atlas goes in; clearances, tolerances, verifications, confirmed digits
and printed parts come out, as records that texts show.
"""
