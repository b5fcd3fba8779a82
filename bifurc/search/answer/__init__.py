"""The answer of a search: an atlas of its findings.

What was found goes in, in any order; out comes an atlas in an order of its own, with what
meets at each singular point, what is claimed of it and what is in doubt.
"""
