"""What is unknown in a mechanism, and which chains have to close."""
