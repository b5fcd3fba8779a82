"""The generator of the site: pages made of the entries of the catalogue, of the
misprints and of the studies, beside the pages that are written by hand."""
