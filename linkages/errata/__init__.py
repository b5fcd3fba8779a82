"""Misprints of the sources, each with a measured amount.

What is printed and what is right go in as formulas; by how much the printed one misses
comes out.
"""
