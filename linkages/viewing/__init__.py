"""The moving linkage beside its map: a page of HTML, and a widget for notebooks."""
