"""What palpate could not do."""

from __future__ import annotations


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


class UsageError(Error, ValueError):
    """An argument that is out of its bounds or does not go with another one."""
