"""The Python reference, by Sphinx, from the docstrings of the built module. A warning is an error: an unknown name, a
docstring that is not valid reStructuredText, a public name that index.rst lacks.
"""

from __future__ import annotations

from typing import Any, get_args

import palpate
import palpate._types as words
from sphinx.ext.napoleon import Config, GoogleDocstring
from sphinx.util import logging

project = author = "palpate"
release = palpate.__version__
extensions = ["sphinx.ext.autodoc"]
html_theme = "alabaster"
html_theme_options = {"description": "The Python module"}
html_copy_source = False
default_role = "code"
python_use_unqualified_type_names = True
nitpicky = True
autodoc_member_order = "bysource"
autodoc_default_options = {
    "members": True,
    "inherited-members": "object,dict,tuple,pybind11_object,BaseException,AttributeError",
}

# Names of other projects, and what the docstrings of the compiled part return, in words.
nitpick_ignore_regex = [
    ("py:class", r"(numpy|collections\.abc|os)\..*|NDArray|(structured )?array|list of (str|Contact)")
]


def read_sections(app: Any, what: str, name: str, thing: object, options: Any, lines: list[str]) -> None:
    """Reads Args and Attributes. Skips properties, whose text before a colon does not name a type."""
    if what in ("class", "exception", "function", "method"):
        sections = GoogleDocstring(list(lines), Config(napoleon_use_ivar=True), app, what, name, thing, options)
        lines[:] = sections.lines()


def skip_field(app: Any, what: str, name: str, thing: object, skip: bool, options: Any) -> bool | None:
    """Leaves out the docstrings that Python gives the fields of a named tuple; those of the class describe them."""
    return True if (getattr(thing, "__doc__", None) or "").startswith("Alias for field number") else None


def full_name(name: str) -> str:
    """Name with its module, of a public name or a list of words."""
    return f"palpate._types.{name}" if name in words.__all__ else f"palpate.{name}"


def public_name(app: Any, env: Any, node: Any, text: Any) -> Any:
    """Resolves names of private modules, such as palpate._session.Session, to the public ones."""
    name = node["reftarget"].rpartition(".")[2].lstrip("_")
    if name not in palpate.__all__ and name not in words.__all__:
        return None
    target = full_name(name)
    return env.get_domain("py").resolve_xref(env, node["refdoc"], app.builder, "obj", target, node, text)


def list_words(app: Any, what: str, name: str, thing: Any, options: Any, lines: list[str]) -> None:
    """Describes the name of a list of words by these words."""
    if what == "data" and name.rpartition(".")[2] in words.__all__:
        lines[:] = ["One of " + ", ".join(f"``{word}``" for word in get_args(thing)) + "."]


def require_all_names(app: Any, env: Any) -> None:
    """Warns of public names that the reference lacks."""
    described = env.get_domain("py").objects
    for name in [*palpate.__all__, *words.__all__]:
        if full_name(name) not in described:
            logging.getLogger(__name__).warning("palpate.%s is missing in index.rst", name)


def setup(app: Any) -> None:
    app.connect("autodoc-process-docstring", read_sections)
    app.connect("autodoc-process-docstring", list_words)
    app.connect("autodoc-skip-member", skip_field)
    app.connect("missing-reference", public_name)
    app.connect("env-check-consistency", require_all_names)
