"""The site: Sphinx with the pydata theme, numpydoc for the API, myst-nb for pages that run, sphinx-gallery for examples.

``python -m sphinx -W --keep-going docs docs/_build/html`` builds it: warnings are errors, and references to what is
not there are warnings.
"""

import os
import sys
import warnings
from importlib.resources import files
from pathlib import Path

HERE = Path(__file__).parent
sys.path.insert(0, str(HERE / "_extensions"))
os.environ.setdefault("PYDEVD_DISABLE_FILE_VALIDATION", "1")  # kernels warn of it otherwise

import kickdrift  # noqa: E402
from kickdrift.engine import announcing  # noqa: E402

announcing._print = lambda sentence: None  # what the builder's machine compiles is no part of an example
warnings.simplefilter("error", kickdrift.UnsolvedWarning)  # the examples of the gallery show worlds that are solved

project = "kickdrift"
author = "The kickdrift maintainers"
copyright = "the kickdrift maintainers"  # noqa: A001 - Sphinx's name
version = release = kickdrift.__version__

extensions = [
    "sphinx.ext.autodoc",
    "sphinx.ext.autosummary",
    "numpydoc",
    "myst_nb",
    "sphinx_gallery.gen_gallery",
    "catalogue_pages",
    "docstrings",
    "figures",
    "mathml",
]
exclude_patterns = ["_build", "gallery", "examples/**/*.ipynb", "**/sg_execution_times.rst", "sg_execution_times.rst"]
nitpicky = True
default_role = "name"  # a link where it is the name of an object with a page
templates_path = ["_templates"]

autosummary_generate = True
autodoc_typehints = "none"
autodoc_member_order = "groupwise"
python_maximum_signature_line_length = 100  # one argument per line beyond; kickdrift.css puts them into columns
numpydoc_show_class_members = False
numpydoc_xref_param_type = False

myst_enable_extensions = ["dollarmath", "amsmath", "colon_fence", "deflist", "attrs_inline"]
myst_heading_anchors = 3
smartquotes = False  # they would turn the primes of y' = f(t, y) and x'' into quotation marks
nb_execution_mode = "cache"
nb_execution_cache_path = str(HERE / "_build" / "notebooks")
nb_execution_timeout = 300
nb_execution_raise_on_error = True
nb_merge_streams = True
nb_render_markdown_format = "gfm"  # with tables
nb_output_stderr = "remove"

sphinx_gallery_conf = {
    "examples_dirs": "gallery",
    "gallery_dirs": "examples",
    "filename_pattern": os.environ.get("KICKDRIFT_GALLERY", r"\.py$"),  # a part of a path builds that example alone
    "ignore_pattern": r"__init__\.py",
    "image_scrapers": ("figures.scrape",),
    "capture_repr": (),  # of the last line, which is often a call of pyplot
    "within_subsection_order": "FileNameSortKey",
    "subsection_order": ["gallery/" + name for name in (
        "orbits", "oscillations", "fields", "heat", "chaos", "rigid", "contacts", "machines", "cloth", "methods",
    )],
    "download_all_examples": False,
    "show_memory": False,
    "show_signature": False,
    "min_reported_time": 1e9,
    "plot_gallery": "True",
    "abort_on_example_error": True,
    "doc_module": ("kickdrift",),
    "backreferences_dir": "backreferences",
    "reset_modules": ("matplotlib",),
}  # fmt: skip
suppress_warnings = ["config.cache"]  # functions in the gallery's configuration

html_math_renderer = "mathml"
html_theme = "pydata_sphinx_theme"
html_title = "kickdrift"
# The font of formulas, for machines without one: without, brackets do not grow, and indices are too large.
html_static_path = ["_static", str(files("ziamath") / "fonts" / "STIXTwoMath-Regular.ttf")]
html_css_files = ["kickdrift.css"]
html_show_sourcelink = False
html_theme_options = {
    "navbar_align": "left",
    "show_toc_level": 2,
    "navigation_with_keys": False,
    "secondary_sidebar_items": ["page-toc"],
    "footer_start": ["copyright"],
    "footer_end": [],
    "header_links_before_dropdown": 9,
}
html_sidebars = {"index": [], "tutorial": [], "elsewhere": []}  # without pages below them
html_context = {"default_mode": "auto"}  # light or dark, as the reader's system is
