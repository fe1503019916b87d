# SPDX-License-Identifier: MIT
"""Sphinx, for the reference of the Python package: python3 -m sphinx src/python/reference FOLDER, where tactor can be imported."""
import tactor

project = "tactor"
author = "The tactor authors"
project_copyright = "2026, The tactor authors"
version = release = tactor.__version__
extensions = ["sphinx.ext.autodoc", "sphinx.ext.napoleon"]
html_theme = "classic"
html_copy_source = False
add_module_names = False
autodoc_typehints = "none"  # sections say them with their units
autoclass_content = "both"
autodoc_member_order = "bysource"
autodoc_default_options = {"members": True}
napoleon_google_docstring = False
napoleon_use_rtype = False
napoleon_use_ivar = True
default_role = "code"  # as the docstrings have it


def setup(app):
    # The docstrings of named tuples describe their fields.
    app.connect("autodoc-skip-member", lambda app, what, name, member, skip, options: True if type(member).__name__ == "_tuplegetter" else None)
