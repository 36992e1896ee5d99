"""The documentation: ``sphinx-build -W --keep-going -b html notebooks OUT`` (extra ``docs``).

The notebooks are shown as they are stored, with their outputs, so nothing is executed. The environment
variable ``LRP_DOCS`` is the address at which the result is published.
"""

import sys
from importlib.metadata import version as installed
from pathlib import Path

from lrp_jupyter.codes import DOCUMENTATION

sys.path.insert(0, str(Path(__file__).parent))  # for documentation.py

project = "lrp-jupyter"
author = copyright = "The lrp-jupyter developers"  # noqa: A001
version = release = installed("lrp-jupyter")
html_title = "lrp-jupyter"
html_theme = "furo"
smartquotes = False  # what is quoted is often typed
html_baseurl = f"{DOCUMENTATION}/" if DOCUMENTATION else ""
html_copy_source = False
extensions = ["myst_nb", "sphinx.ext.autodoc", "sphinx.ext.napoleon", "documentation"]
exclude_patterns = ["**/.*", "hosts"]
myst_enable_extensions = ["colon_fence"]
myst_heading_anchors = 4
myst_heading_slug_func = "documentation.anchor"
nb_execution_mode = "off"
nb_merge_streams = True
napoleon_google_docstring = False
napoleon_use_rtype = False
autodoc_member_order = "bysource"
autodoc_typehints = "none"  # the docstrings name the types, with their units
autodoc_class_signature = "separated"
