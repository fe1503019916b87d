# SPDX-License-Identifier: MIT
"""Settings of Sphinx for the site; make_site.py hands over the version and the folder of Doxygen's XML."""
import os
import pathlib
import runpy

project = "tactor"
author = "The tactor authors"
copyright = "2026, the tactor authors"  # pylint: disable=redefined-builtin
version = release = os.environ["TACTOR_VERSION"]
extensions = ["myst_parser", "breathe"]
breathe_projects = {"tactor": os.environ["TACTOR_XML"]}
breathe_default_project = "tactor"
package = pathlib.Path(__file__).parent / "python-reference/conf.py"
if package.exists():  # the Python package describes itself
    of_package = runpy.run_path(str(package))
    extensions += of_package["extensions"]
    globals().update({name: value for name, value in of_package.items() if name == "setup" or name.startswith(("add_", "auto", "default_role", "napoleon"))})
# Links to headings, as a forge has them.
myst_heading_anchors = 2
html_theme = "furo"
html_title = f"tactor {version}"
html_copy_source = False
html_show_sphinx = False
# Sphinx highlights code by guess, and warns where its guess fails.
highlight_language = "none"
