"""Sphinx: the guides, as they stand in the tree, with search. `build` gives the staged tree as source."""

project = "Pellucid"
author = "The Pellucid developers"
copyright = "The Pellucid developers, Apache-2.0"
extensions = ["myst_parser"]
myst_heading_anchors = 5
myst_enable_extensions = ["colon_fence"]
source_suffix = {".md": "markdown"}
html_theme = "furo"
html_title = "Pellucid"
html_copy_source = False
html_show_sphinx = False
html_extra_path = ["extra"]  # the interfaces, made by Doxygen and pdoc
suppress_warnings = ["myst.header"]  # the command line's pages begin as they like
