"""Settings of Sphinx; build.py puts this file beside the pages, in output/site-source."""

from importlib import metadata

from docutils import nodes

project = "fx_membrane"
author = "The developers of fx_membrane"
release = metadata.version("fx_membrane")

extensions = ["myst_nb", "sphinx.ext.autodoc", "sphinx.ext.napoleon", "sphinx.ext.viewcode"]
exclude_patterns = ["jupyter_execute"]
html_theme = "furo"
html_show_copyright = False  # the licence is in README
html_title = f"fx_membrane {release}"
html_static_path = ["style.css"]
html_css_files = ["style.css"]

myst_enable_extensions = ["colon_fence"]
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

GALLERY = "gallery/index"


def card(app, name):
    """Title of a page with its last picture above it, if it has one, as a link."""
    *_, picture = (None, *app.env.get_doctree(name).findall(nodes.image))
    link = nodes.reference("", "", internal=True, refuri=app.builder.get_relative_uri(GALLERY, name))
    title = app.env.titles[name].astext()
    if picture is not None:
        shown = picture.deepcopy()
        shown["alt"] = title
        link += shown
    link += nodes.inline("", title)
    return nodes.list_item("", nodes.paragraph("", "", link))


def fill_gallery(app, doctree, name):
    """Show the pages of the gallery by their pictures: those that have one first."""
    if name == GALLERY:
        cards = [card(app, page) for page in app.env.toctree_includes[GALLERY]]
        cards.sort(key=lambda entry: not any(entry.findall(nodes.image)))
        next(doctree.findall(nodes.section)).append(nodes.bullet_list("", *cards, classes=["gallery"]))


def setup(app):
    """Fill the gallery once the pages are known."""
    app.connect("doctree-resolved", fill_gallery)
