"""The closure equations of a loop."""
