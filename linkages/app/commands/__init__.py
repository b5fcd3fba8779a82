"""The commands of `bifurc`, one a file. What they need is imported when they run."""
