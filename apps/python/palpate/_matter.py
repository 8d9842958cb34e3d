"""Scenes of matter that move by themselves: water, sand, soft bodies."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from . import _palpate
from ._errors import UsageError, refuse_attribute

if TYPE_CHECKING:
    from types import TracebackType


class Parameter(NamedTuple):
    """A number of a scene that can be changed while it moves."""

    value: float
    low: float
    high: float
    unit: str
    label: str


class PortEnergy(NamedTuple):
    """Energy that a hand has put into a scene since it began, less what it got back, J. Passive: the least is never
    below 0.
    """

    now_J: float
    least_J: float


def _by_name(told: list[tuple[str, float, float, float, str, str]]) -> dict[str, Parameter]:
    return {each[0]: Parameter(*each[1:]) for each in told}


class Matter(_palpate._Matter):
    """A scene of matter that no hand touches.

    Args:
        scene: "water", "sand", "jelly" or another one that is built in, "FILE in water", "FILE in sand" or "soft FILE"
            with a closed cloud or mesh, or a JSON file.
        gpu: as of Session; None: a GPU where there is one, and the CPU for soft bodies.
        threads: of the CPU; 0: one per core.

    Positions are in mm. The same scene gives the same bytes on the same machine. Raises Error, and UsageError for an
    unknown scene. Threads may share it and wait for one another.
    """

    def __init__(self, scene: str, gpu: int | str | None = None, threads: int = 0) -> None:
        super().__init__(scene, None if gpu is None else str(gpu), threads)
        self._scene = scene

    __setattr__ = refuse_attribute

    def __enter__(self) -> Matter:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def __repr__(self) -> str:
        return f"<palpate.Matter {self._scene!r}>"

    def simulate(self, seconds: float) -> None:
        """So much further, to the next millisecond; as step()."""
        if not 0 <= seconds < 1e9:
            raise UsageError(f"seconds: {seconds} is not a number from 0 to 1e9")
        self.step(round(seconds * 1000))

    @property
    def parameters(self) -> dict[str, Parameter]:
        """Those that set() changes, by name."""
        return _by_name(self._parameters())
