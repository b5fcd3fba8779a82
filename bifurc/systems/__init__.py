"""Systems of equations in files: read, solved, and reported on."""
