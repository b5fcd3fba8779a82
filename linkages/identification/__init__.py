"""Which linkages of the catalogue a table is a case of."""
