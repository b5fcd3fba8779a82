"""Tables and sentences of the command line."""
