"""Sheets of rigid panels of any size, by name.

Numbers of a sheet go in; a folded state of it comes out as the content of a FOLD file, with
its folds in closed form.
"""
