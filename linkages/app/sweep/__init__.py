"""The command `bifurc sweep`: many members of a family, resumable."""
