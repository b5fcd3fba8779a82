"""The moving linkage beside its map: a page of HTML, and a widget for notebooks.

An atlas goes in; one document of plain values comes out, which the script of the page
draws. Its script is built from ``viewer``.
"""
