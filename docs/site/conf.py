"""Configuration of Sphinx for the site; `tools/docs/site.py` makes the folder of pages."""

from __future__ import annotations

import os
import re
import tomllib
from datetime import date
from pathlib import Path
from typing import Any

from sphinx.util.inspect import TypeAliasForwardRef

from tools.docs.html.for_everybody import for_everybody

_HERE = Path(os.environ["HAND_SANDBOX_SITE"])
_SETTINGS = tomllib.loads((_HERE / "settings.toml").read_text(encoding="utf-8"))
_ARRAY = re.compile(
    r"~?numpy\.ndarray\[tuple\[~?(?:typing\.)?Any, \.\.\.\], ~?numpy\.dtype\[~?numpy\.(\w+)\]\]"
)
_PROJECT = tomllib.loads((_HERE.parents[1] / "pyproject.toml").read_text(encoding="utf-8"))[
    "project"
]


def _known(name: str) -> str:
    """A setting; empty if its owner has not filled it in."""
    value = str(_SETTINGS[name])
    return "" if value.startswith("<") else value


project = _SETTINGS["title"]
author = _known("authors")
release = version = str(_PROJECT["version"])
copyright = f"{date.today().year} {author}".strip()

extensions = [
    "myst_parser",
    "sphinx.ext.autodoc",
    "sphinx.ext.napoleon",
    "sphinx_copybutton",
    "sphinx_design",
]
templates_path = ["templates"]
html_static_path = ["static"]
html_favicon = "static/favicon.svg"
html_css_files = ["site.css"]
exclude_patterns = ["examples/**/*.md"]
myst_heading_anchors = 4
myst_enable_extensions = ["colon_fence"]
# Blocks without a language are text, and not Python.
highlight_language = "text"
# Docstrings of this project write code in single backticks.
default_role = "code"
# A value such as a whole skeleton would be a page of numbers.
autodoc_default_options = {"members": True, "show-inheritance": True, "no-value": True}
autodoc_member_order = "bysource"
autodoc_typehints = "signature"
# A default by its name in the source, where it has one, and not by its value.
autodoc_preserve_defaults = True
autodoc_type_aliases = {"Array": "Array", "ArrayLike": "ArrayLike"}
napoleon_google_docstring = True
napoleon_numpy_docstring = False
napoleon_use_ivar = True
# Or names of attributes lose the underscore at their end.
strip_signature_backslash = True

html_theme = "furo"
html_title = project
html_copy_source = False
html_show_sourcelink = False
# Those of Furo, with the versions below the pages.
html_sidebars = {
    "**": [
        "sidebar/brand.html",
        "sidebar/search.html",
        "sidebar/scroll-start.html",
        "sidebar/navigation.html",
        "versions.html",
        "sidebar/scroll-end.html",
    ]
}
# Where the site of the newest state is, seen from this one, and the released ones in folders of it.
html_context = {
    "newest": os.environ.get("HAND_SANDBOX_NEWEST", ""),
    "released": os.environ.get("HAND_SANDBOX_VERSIONS", "").split(),
}
html_theme_options = {"source_repository": _known("repository")} if _known("repository") else {}


def _plain(text: str) -> str:
    """Arrays as the sources name them, in the place of NumPy's long types, and `...` for a default
    that is made anew each time, since `<factory>` cannot be read as Python."""
    text = text.replace("<factory>", "...")
    return _ARRAY.sub(lambda m: "Array" if m[1] == "float64" else f"NDArray[{m[1]}]", text)


def _plain_signature(
    app: Any,
    kind: str,
    name: str,
    thing: Any,
    options: Any,
    signature: str | None,
    gives: str | None,
) -> tuple[str | None, str | None]:
    return signature and _plain(signature), gives and _plain(gives)


def _plain_docstring(
    app: Any, kind: str, name: str, thing: Any, options: Any, lines: list[str]
) -> None:
    lines[:] = map(_plain, lines)


def _for_everybody(app: Any, page: str, template: str, context: dict[str, Any], tree: Any) -> None:
    """Headings of the menu get the level that Sphinx leaves out; see also `for_everybody`."""
    menu = context.get("furo_navigation_tree", "")
    context["furo_navigation_tree"] = menu.replace(
        'role="heading"', 'role="heading" aria-level="2"'
    )
    if "body" in context:
        context["body"] = for_everybody(context["body"])


def setup(app: Any) -> None:
    """Called by Sphinx."""
    # Sphinx shows an alias that is a part of another type, such as tuple[Array, Array], by this.
    setattr(TypeAliasForwardRef, "__repr__", lambda alias: alias.name)  # noqa: B010
    app.connect("autodoc-process-signature", _plain_signature)
    # After what makes fields of the sections.
    app.connect("autodoc-process-docstring", _plain_docstring, priority=900)
    app.connect("html-page-context", _for_everybody, priority=900)
