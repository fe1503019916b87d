# SPDX-License-Identifier: MIT
"""Settings of Sphinx for the site; make_site.py hands over the version."""
import os

project = "tactor"
author = "The tactor authors"
copyright = "2026, the tactor authors"  # pylint: disable=redefined-builtin
version = release = os.environ["TACTOR_VERSION"]
extensions = ["myst_parser"]
html_theme = "furo"
html_title = f"tactor {version}"
html_copy_source = False
html_show_sphinx = False
html_extra_path = ["reference"]
# Sphinx highlights code by guess, and warns where its guess fails.
highlight_language = "none"
