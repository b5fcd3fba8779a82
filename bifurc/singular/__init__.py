"""One singular point: located, looked at on a small sphere, classified, confirmed."""
