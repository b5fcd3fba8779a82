"""One surface of solutions: covered by charts, measured, walked over."""
