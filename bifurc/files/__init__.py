"""An atlas as a dataset, as a file, as a graph file."""
