"""An atlas seen along one of its unknowns, the parameter."""
