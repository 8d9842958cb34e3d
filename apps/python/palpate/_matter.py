"""Scenes of moving matter: water, sand, soft bodies."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from . import _palpate
from ._errors import UsageError, refuse_attribute

if TYPE_CHECKING:
    from types import TracebackType

    from ._types import Backend


class Parameter(NamedTuple):
    """A parameter of a scene, which can be changed while the scene moves.

    Attributes:
        value: present value, in `unit`.
        low: minimum of the value.
        high: maximum of the value.
        unit: "": dimensionless.
        label: for display.
    """

    value: float
    low: float
    high: float
    unit: str
    label: str


class PortEnergy(NamedTuple):
    """Energy that a hand has put into a scene since it began, less what it got back. The hand is passive if the minimum
    is never below 0.

    Attributes:
        now_J: present energy, J.
        min_J: its minimum so far, J.
    """

    now_J: float
    min_J: float


def _by_name(told: list[tuple[str, float, float, float, str, str]]) -> dict[str, Parameter]:
    return {each[0]: Parameter(*each[1:]) for each in told}


class Matter(_palpate._Matter):
    """A scene of matter without hands.

    Args:
        scene: "water", "sand", "jelly" or another built-in scene, "FILE in water", "FILE in sand" or "soft FILE" with a
            closed cloud or mesh, or a JSON file.
        gpu: as for Session; None: a GPU if there is one, and the CPU for soft bodies.
        threads: threads of the CPU; 0: one per core.
        backend: "vulkan" (a GPU), "cpu" or "auto", as for Session; "auto": the CPU for soft bodies.

    Positions are in mm. The same scene gives the same bytes on the same machine. Raises Error, and UsageError for an
    unknown scene. Threads may share it and wait for one another.
    """

    def __init__(
        self, scene: str, gpu: int | str | None = None, threads: int = 0, *, backend: Backend = "auto"
    ) -> None:
        super().__init__(scene, None if gpu is None else str(gpu), threads, backend)
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
        """Advances the scene by so many seconds, rounded to milliseconds, as step() does. Raises UsageError unless they
        are from 0 to 1e9.
        """
        if not 0 <= seconds < 1e9:
            raise UsageError(f"seconds: {seconds} is not a number from 0 to 1e9")
        self.step(round(seconds * 1000))

    @property
    def parameters(self) -> dict[str, Parameter]:
        """Parameters, by name, which set() changes."""
        return _by_name(self._parameters())
