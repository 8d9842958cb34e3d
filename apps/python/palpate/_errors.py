"""What palpate could not do."""

from __future__ import annotations

import inspect
from typing import Any


class Error(RuntimeError):
    """What could not be done, in words that say where, what and what to do.

    Attributes:
        status: the kind of failure, one word: "file", "gpu", "device", "state", "memory", "network", "unsupported",
            "failed", …
        file: the file that it is about, or None.
        line: the line of that file, from 1, or None where none is known.
    """

    def __init__(self, text: str, *, status: str = "failed", file: str | None = None, line: int | None = None) -> None:
        super().__init__(text)
        self.status = status
        self.file = file
        self.line = line

    def __str__(self) -> str:
        return BaseException.__str__(self)  # the words alone, where KeyError would put them in quotes


class ClosedError(Error, AttributeError):
    """A closed session, scene, server or network was used; hasattr() on it is False."""


class UsageError(Error, ValueError):
    """An argument that is out of its bounds or does not go with another one."""

    def __init__(self, text: str, *, status: str = "argument", **about: Any) -> None:
        super().__init__(text, status=status, **about)


class ArgumentTypeError(UsageError, TypeError):
    """An argument of a type that the call does not take, or under a name that it does not know."""


class UnknownNameError(UsageError, KeyError):
    """A name that stands for nothing here, as of an attribute that a cloud does not have."""


class UnknownAttributeError(UsageError, AttributeError):
    """An attribute that was assigned to an object of palpate and would have no effect."""


def refuse_attribute(self: object, name: str, value: object) -> None:
    """__setattr__ of what has no attributes to set but its own."""
    if name.startswith("_"):
        return object.__setattr__(self, name, value)
    kind = type(self).__name__
    if name in inspect.signature(type(self).__init__).parameters:
        raise UnknownAttributeError(f"{name}: is given as the {kind} is made: {kind}(…, {name}={value!r})")
    raise UnknownAttributeError(f"{name}: cannot be set on a {kind}")
