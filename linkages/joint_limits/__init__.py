"""What limits of joints cut off, keep out and leave.

A closure with limits goes in; solutions within them come out, the parts of motions that
they leave, and the ranges of joints along forms.
"""
