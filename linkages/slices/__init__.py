"""Complete slices: every configuration at one joint angle, and what that proves.

A loop of four to six turns and the angles of one joint go in; all configurations come
out. An audit holds the forms of a search against them.
"""
