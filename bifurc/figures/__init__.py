"""Figures of an atlas."""
