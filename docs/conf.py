"""Settings of the site; `make docs` builds it from what docs/generator gathers."""

from __future__ import annotations

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1]))

import bifurc
from docs.generator.places import DOCS, EXTRA, NO_PICTURE, SCRIPTS
from docs.generator.sources import STUDIES
from docs.generator.study_scripts import RUN
from docs.generator.written_pictures import WrittenPictures

project = "bifurc"
author = "the authors of bifurc"
version = release = bifurc.__version__
html_title = "bifurc"

extensions = [
    "myst_parser",
    "sphinx.ext.autodoc",
    "sphinx.ext.autosummary",
    "sphinx_click",
    "sphinx_design",
    "sphinx_gallery.gen_gallery",
    "docs.generator.directives",
    "docs.generator.docstrings",
    "docs.generator.mathml",
    "docs.generator.public_names",
    "docs.generator.words",
]
source_suffix = {".md": "markdown", ".rst": "restructuredtext"}
root_doc = "index"
templates_path = [str(DOCS / "templates")]
highlight_language = "none"
smartquotes = False  # two hyphens are an option of a command

# --- Markdown ---
myst_enable_extensions = ["colon_fence", "dollarmath"]
myst_heading_anchors = 3  # as code hosts make them
myst_fence_as_directive = ["mermaid"]

# --- references ---
nitpicky = True
default_role = "py:obj"
# names of other packages, whose pages are not fetched, and names in docstrings that
# are not public: they are shown as code
nitpick_ignore_regex = [("py:.*", r".*")]

# --- what docstrings become ---
autosummary_generate = True
autosummary_ignore_module_all = False
autodoc_default_options = {"members": True, "show-inheritance": True}
autodoc_member_order = "bysource"
autodoc_typehints = "signature"
autodoc_typehints_format = "short"
autodoc_preserve_defaults = True
python_use_unqualified_type_names = True
python_maximum_signature_line_length = 78

# --- studies ---

sphinx_gallery_conf = {
    "examples_dirs": [str(SCRIPTS)],
    "gallery_dirs": [STUDIES],
    "filename_pattern": "|".join(rf"/{name}\.py" for name in sorted(RUN)),
    "ignore_pattern": r"/out/",
    "default_thumb_file": str(NO_PICTURE),
    "within_subsection_order": "docs.generator.study_scripts.study_order",
    "image_scrapers": (WrittenPictures(),),
    "reset_modules": (),
    "abort_on_example_error": True,
    "download_all_examples": False,
    "show_memory": False,
    "show_signature": False,
    "min_reported_time": 1e9,
    "write_computation_times": False,
    "plot_gallery": "True",
}

# --- the look ---
html_theme = "pydata_sphinx_theme"
html_static_path = ["static"]
html_extra_path = [str(EXTRA)]
html_css_files = ["site.css"]
html_js_files = ["site.js"]
html_math_renderer = "mathml"
html_show_sourcelink = False
html_copy_source = False
# pages of wide tables
WIDE = ("figures", "performance", "stability", "negative_controls", "page_sizes")
html_theme_options = {
    "logo": {"text": "bifurc"},
    "navbar_align": "left",
    "header_links_before_dropdown": 7,
    "show_toc_level": 2,
    "show_nav_level": 1,
    "navigation_depth": 3,
    "collapse_navigation": False,
    # the list of sections at the right, where wide tables need no room
    "secondary_sidebar_items": {
        "*": ["page-toc"],
        **{page: [] for page in WIDE},
        "reference/**": ["page-toc"],
        "tutorials/*": ["page-toc"],
    },
    "footer_start": ["copyright"],
    "footer_end": [],
}
html_context = {"default_mode": "auto"}
html_sidebars: dict[str, list[str]] = {"index": [], "catalogue": [], "changes": []}
