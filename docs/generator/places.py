"""Where the site is made: what is written by hand stands in docs/, everything else in
build/docs, and the site in out/site."""

from __future__ import annotations

from pathlib import Path

ROOT = Path(__file__).parents[2]
DOCS = ROOT / "docs"
BUILD = ROOT / "build" / "docs"
SOURCE = BUILD / "source"  # all pages, as Sphinx reads them
RECORDS = BUILD / "records"  # what was found of each linkage
SCRIPTS = BUILD / "scripts"  # the studies, as sphinx-gallery reads them
NO_PICTURE = BUILD / "no_picture.png"  # in the gallery, of a study that is not run
EXTRA = BUILD / "extra"  # files that Sphinx copies to the site as they are
PICTURES = EXTRA / "pictures"
VIEWER = EXTRA / "viewer"
SITE = ROOT / "out" / "site"
