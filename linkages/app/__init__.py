"""The command `bifurc`: from the words of a command line to an exit code.

Words go in; linkages, settings and places to write come out, for the commands to work
with. ``cli`` alone turns errors into one line and an exit code.
"""
