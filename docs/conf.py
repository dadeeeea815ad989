"""How the documentation is built: `sphinx-build -W docs out/site` in the folder of the project."""

import sys
from pathlib import Path

HERE = Path(__file__).parent
sys.path[:0] = [str(HERE / "_ext"), str(HERE.parent)]  # the reference of this checkout

from origami_nlp import __version__  # noqa: E402

project = "origami_nlp"
author = "The origami_nlp developers"
copyright = author
version = release = __version__

extensions = [
    "myst_nb",
    "sphinx.ext.autodoc",
    "sphinx.ext.napoleon",
    "sphinx_copybutton",
    "sphinx_design",
    "gallery",
    "notebooks",
    "offline",
    "reference",
    "terminal",
    "turning",
]
exclude_patterns = ["_ext", "figures/*.md"]
root_doc = "index"

# ---------------------------------------------------------------- pages and notebooks
nb_execution_mode = "off"  # the stored outputs, which the tests compare with fresh ones
nb_merge_streams = True
myst_enable_extensions = ["colon_fence", "dollarmath", "deflist", "html_image"]
myst_fence_as_directive = ["math"]  # as GitHub draws them
smartquotes = False  # two hyphens begin an option
myst_heading_anchors = 4
myst_links_external_new_tab = False
copybutton_exclude = ".linenos, .gp, .go"

# ---------------------------------------------------------------- docstrings
autodoc_typehints = "none"  # the docstrings say what, with shapes and units
autodoc_member_order = "bysource"
autodoc_class_signature = "separated"
napoleon_google_docstring = False
napoleon_use_rtype = False
napoleon_use_ivar = True
default_role = "code"  # `x` in a docstring is code, as it is in Markdown

# ---------------------------------------------------------------- the site
html_math_renderer = "mathml"
html_theme = "pydata_sphinx_theme"
html_title = "origami_nlp"
html_static_path = ["_static"]
html_css_files = ["site.css"]
html_show_sourcelink = False
html_sidebars = {
    page: [] for page in ("index", "getting_started", "which_verb", "gallery", "concepts")
}
html_theme_options = {
    "logo": {"text": "origami_nlp"},
    "navbar_persistent": ["search-button"],  # the field would take a line of its own
    "show_prev_next": True,
    "navigation_with_keys": False,
    "show_toc_level": 2,
    "header_links_before_dropdown": 7,
    "secondary_sidebar_items": ["page-toc"],
    "footer_start": ["copyright"],
    "footer_end": [],
}
