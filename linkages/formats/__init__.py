"""Mechanisms in the files of other programs: MJCF, SDF and CUIK worlds."""
