"""Mechanisms in files of this project and in FOLD files."""
