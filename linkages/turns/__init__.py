"""Whole turns after which a mechanism is closed again, and what is one up to them."""
