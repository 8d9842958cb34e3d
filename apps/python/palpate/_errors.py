"""Exceptions of palpate."""

from __future__ import annotations

import inspect
from collections.abc import Iterable
from typing import Any, Callable


class Error(RuntimeError):
    """A failed operation; the message says where it failed, why, and what to do.

    Attributes:
        status: the kind of failure, one word: "file", "gpu", "device", "state", "memory", "network", "unsupported",
            "failed", …
        file: the file that it is about, or None.
        line: the line of that file, from 1, or None if unknown.
    """

    def __init__(self, text: str, *, status: str = "failed", file: str | None = None, line: int | None = None) -> None:
        super().__init__(text)
        self.status = status
        self.file = file
        self.line = line

    def __str__(self) -> str:
        return BaseException.__str__(self)  # without the quotes that KeyError adds


class ClosedError(Error, AttributeError):
    """A closed session, scene, server or network was used; hasattr() on it is False."""


class UsageError(Error, ValueError):
    """An argument that is out of bounds or conflicts with another one."""

    def __init__(self, text: str, *, status: str = "argument", **about: Any) -> None:
        super().__init__(text, status=status, **about)


class ArgumentTypeError(UsageError, TypeError):
    """An argument of a wrong type, or with an unknown name."""


class UnknownNameError(UsageError, KeyError):
    """An unknown name, such as of an attribute that a cloud does not have."""


class UnknownAttributeError(UsageError, AttributeError):
    """An unknown attribute of an object of palpate, or an assignment that would have no effect."""


def if_any(ask: Callable[[], Any]) -> Any:
    """Result of `ask`; None if the session does not support it."""
    try:
        return ask()
    except Error as error:
        if error.status == "state":
            return None
        raise


def described(value: object) -> str:
    """The value as a message names it: "the text 'a'", "1.5", "a list"."""
    if isinstance(value, str):
        return f"the text {value[:60]!r}"
    if value is None or hasattr(value, "__float__") and not hasattr(value, "__len__"):
        return str(value)
    told = repr(value) if isinstance(value, (tuple, list)) else ""
    if told and len(told) < 40:
        return told
    name = type(value).__name__
    return f"{'an' if name[0] in 'aeiouAEIOU' else 'a'} {name}"


def nearest(word: str, names: Iterable[str]) -> str:
    """Suggests the most similar name, as the end of a sentence; empty if no name is similar."""
    from difflib import get_close_matches  # takes longer to import than all of palpate

    close = get_close_matches(word, list(names), 1)
    return f"; did you mean {close[0]}?" if close else ""


def _settings(kind: type) -> dict[str, str]:
    """Keywords of the constructors, each with the constructor's name; empty if they have no signature."""
    makers = {kind.__name__: kind.__init__}  # type: ignore[misc]
    for owner in kind.__mro__:
        for name, each in vars(owner).items():
            if isinstance(each, classmethod) and not name.startswith("_"):
                makers[f"{kind.__name__}.{name}"] = each.__func__
    found: dict[str, str] = {}
    for maker, function in makers.items():
        try:
            parameters = inspect.signature(function).parameters.values()
        except ValueError:
            continue
        names = [each.name for each in parameters if each.kind not in (each.VAR_KEYWORD, each.VAR_POSITIONAL)]
        if any(takes_session_options(each) for each in parameters):
            names += session_options()
        for name in names:
            if name not in ("self", "cls"):
                found.setdefault(name, maker)
    return found


def takes_session_options(parameter: inspect.Parameter) -> bool:
    """Whether it is **options, the keywords that all constructors of a Session have."""
    return parameter.kind is parameter.VAR_KEYWORD and "SessionOptions" in str(parameter.annotation)


def session_options() -> dict[str, str]:
    """The names of those keywords, with their types as in an annotation."""
    from ._types import SessionOptions

    hints = SessionOptions.__annotations__
    return {name: getattr(hint, "__forward_arg__", str(hint)) for name, hint in hints.items()}


def missing_attribute(self: object, name: str) -> Any:
    """__getattr__ of palpate's classes: points to a constructor argument that cannot be read, or to a similar name."""
    kind = type(self)
    if name.startswith("_") or hasattr(kind, name):
        return object.__getattribute__(self, name)  # raises the original exception again
    settings = _settings(kind)
    if name in settings:
        maker = settings[name]
        raise UnknownAttributeError(
            f"{name}: cannot be read; is set when the {kind.__name__} is created: {maker}({name}=…)"
        )
    meant = nearest(name, [each for each in [*dir(kind), *settings] if not each.startswith("_")])
    raise UnknownAttributeError(f"{name}: a {kind.__name__} has no such attribute{meant}")


def refuse_attribute(self: object, name: str, value: object) -> None:
    """__setattr__ of palpate's classes: only private attributes can be set."""
    if name.startswith("_"):
        return object.__setattr__(self, name, value)
    kind, settings = type(self).__name__, _settings(type(self))
    if name in settings:
        raise UnknownAttributeError(
            f"{name}: is set when the {kind} is created: {settings[name]}(…, {name}={value!r})"
        )
    if hasattr(type(self), name):
        raise UnknownAttributeError(f"{name}: cannot be set on a {kind}, only read")
    raise UnknownAttributeError(f"{name}: cannot be set on a {kind}{nearest(name, settings)}")
