"""Figures of an atlas.

An atlas goes in; figures of matplotlib come out: maps, singular values, graphs,
surfaces, bifurcation diagrams.
"""
