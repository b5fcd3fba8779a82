"""Misprints of the sources, each with a measured amount."""
