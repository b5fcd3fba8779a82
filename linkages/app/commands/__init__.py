"""The commands of `bifurc`, one a file.

Options go in; tables, JSON and files come out. What a command needs is imported when it
runs.
"""
