"""The command `bifurc`: its commands, tables and texts."""
