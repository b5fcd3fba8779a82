"""One branch: traced, monitored, certified.

A problem and one of its solutions go in; a branch comes out, polynomial pieces that are
evaluated and never solved again, with its singular values, events and certificate. What
other branches there are is not known here.
"""
