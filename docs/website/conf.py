"""How Sphinx makes the site of the pages in docs/: `make docs`. Nothing is fetched, now or by a reader.

The pages are plain Markdown that reads well without Sphinx. What a site needs beyond that is in the modules
beside this one: `tree` makes the tree of pages from lists of links, `repository` makes pages of the files
that they link to, `command_line` describes the commands and `docstrings` the functions, `mathml` prints
formulas, `gallery` and `moving_picture` draw motions, and `live` makes pages on which they can be played.
"""

import os
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[2]))
sys.path.insert(0, str(Path(__file__).parents[1]))

import kanegen

BUILD = Path(__file__).parents[2] / "build"

project = "kanegen"
release = kanegen.__version__
html_title = "kanegen"
language = "en"
smartquotes = False

extensions = [
    "myst_nb",  # Markdown, and notebooks in Markdown
    "sphinx.ext.autodoc",
    "sphinx.ext.viewcode",
    "sphinx_copybutton",
    "website.command_line",
    "website.docstrings",
    "website.live",
    "website.mathml",
    "website.repository",
    "website.tree",
]
root_doc = "index"
exclude_patterns = ["website/**"]

# Markdown. A footnote is [^1]; rotations as [^1R_7] have the same form and are none.
myst_heading_anchors = 4
myst_enable_extensions = ["deflist"]
myst_disable_syntax = ["footnote_ref"]
myst_update_mathjax = False

# Notebooks run once; the results are kept until their code changes.
nb_execution_mode = "cache"
nb_execution_cache_path = str(BUILD / "notebooks")
nb_execution_timeout = 300
nb_execution_raise_on_error = True
nb_merge_streams = True

# Kernels have a configuration of their own, not that of the reader's IPython. They would warn that they are
# reached by TCP, which here stays on this machine.
os.environ["IPYTHONDIR"] = str(BUILD / "ipython")
kernel = BUILD / "ipython" / "profile_default" / "ipython_kernel_config.py"
kernel.parent.mkdir(parents=True, exist_ok=True)
kernel.write_text('c.IPKernelApp.log_level = "ERROR"\n', encoding="utf-8")

# Functions and classes. Types of properties are links only where they are public.
default_role = "code"
toc_object_entries_show_parents = "hide"
autodoc_member_order = "bysource"
autodoc_typehints = "none"
autodoc_preserve_defaults = True
nitpick_ignore_regex = [("py:.*", r"(kanegen|collections|numpy|sympy|pathlib|typing|builtins)\..*")]

html_theme = "furo"
html_static_path = ["static"]
html_css_files = ["site.css"]
html_math_renderer = "mathml"
html_show_copyright = False
html_show_sphinx = False
html_copy_source = False
html_theme_options = {
    "top_of_page_buttons": [],
    "light_css_variables": {"color-brand-primary": "#1d4ed8", "color-brand-content": "#1d4ed8"},
    "dark_css_variables": {"color-brand-primary": "#7aa2f7", "color-brand-content": "#7aa2f7"},
}
pygments_style = "friendly"
pygments_dark_style = "github-dark"
copybutton_prompt_text = "$ "
highlight_language = "none"
