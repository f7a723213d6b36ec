"""Settings of Sphinx; build.py puts this file beside the pages, in output/site-source."""

from importlib import metadata

project = "fx_membrane"
author = "The developers of fx_membrane"
release = metadata.version("fx_membrane")

extensions = ["myst_nb", "sphinx.ext.autodoc", "sphinx.ext.napoleon", "sphinx.ext.viewcode"]
exclude_patterns = ["jupyter_execute"]
html_theme = "furo"
html_title = f"fx_membrane {release}"
html_static_path = ["style.css"]
html_css_files = ["style.css"]

myst_enable_extensions = ["colon_fence", "dollarmath"]
myst_heading_anchors = 3
nb_execution_mode = "cache"
nb_execution_timeout = 600
nb_execution_raise_on_error = True
nb_execution_in_temp = True
nb_merge_streams = True

autodoc_default_options = {"members": True}
autodoc_member_order = "bysource"
autodoc_typehints = "none"  # docstrings give shapes and units
napoleon_google_docstring = True
napoleon_use_ivar = True
napoleon_attr_annotations = False  # numpy.bool_ would be taken for a link
