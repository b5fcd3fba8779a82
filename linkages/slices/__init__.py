"""Complete slices: every configuration at one joint angle, and what that proves."""
