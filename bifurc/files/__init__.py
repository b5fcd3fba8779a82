"""An atlas as a dataset, as a file, as a graph file.

An atlas goes in and a file comes out, whole or not at all; and back, checked. One table
of columns for each thing that is written says how.
"""
