"""All of it: every branch and every singular point of a problem."""
