"""Session logs, which record what a hand did and felt and how it changed the points."""

from __future__ import annotations

import json
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from . import _palpate
from ._errors import refuse_attribute

if TYPE_CHECKING:
    import os


class Recording(_palpate._Log):
    """A session log, immutable. Its views are read-only and keep it alive."""

    __setattr__ = refuse_attribute

    def __repr__(self) -> str:
        end = "to its end" if self.ended else "not to its end"
        return f"<palpate.Recording of {len(self.ticks)} ticks and {len(self.edits)} edits, {end}>"

    @property
    def header(self) -> dict[str, Any]:
        """How to replay the session."""
        return dict(json.loads(self._header()))

    @property
    def missing(self) -> list[str]:
        """Missing parts of the log, as sentences; empty if it is complete."""
        return self._missing().splitlines()


@dataclass(frozen=True)
class Replay:
    """Result of a replay.

    Attributes:
        identical: all ticks, and all points at the end, are the same within the tolerance; to the last bit if it is 0.
        ticks: ticks of the log.
        compared: ticks compared; fewer than all if the session cannot be replayed exactly, for the reason in `reason`.
        force_ticks: ticks whose forces differ.
        largest_force_N: maximum difference of a force, N.
        edit_ticks: ticks between which the edits differ.
        points: points that differ at the end; None if they were not compared.
        first_difference_s: time of the first difference, s; None without one.
        recorded_edits_agree: whether the log's edits give the points at its end; None if the log has no end.
        reason: reason why not all ticks, or not the points at the end, were compared; "" if all were.
        machine: machine of the replay.
        recorded_on: machine of the recording.
    """

    identical: bool
    ticks: int
    compared: int
    force_ticks: int
    largest_force_N: float
    edit_ticks: int
    points: int | None
    first_difference_s: float | None
    recorded_edits_agree: bool | None
    reason: str
    machine: str
    recorded_on: str


def read_recording(file: str | os.PathLike[str]) -> Recording:
    """Reads a session log; of a damaged or cut-off log all complete parts. Raises Error with the file."""
    return Recording(file)


def replay(
    file: str | os.PathLike[str],
    cloud: _palpate.Cloud | None = None,
    *,
    model: str | os.PathLike[str] | None = None,
    gpu: int | str | None = None,
    threads: int = 0,
    tolerance: float = 0,
) -> Replay:
    """Replays a recorded session in virtual time and compares it with the log.

    Args:
        file: a log written by Session.record() or the program.
        cloud: the points of the session; None: those of the file `model`, or of the file that the log names.
        gpu: GPU to use, if the session was on one; None: the best available.
        threads: threads of the CPU; 0: one per core.
        tolerance: maximum difference, N for forces and mm for points; 0: identical to the last bit.

    Raises Error if the log, or its model, cannot be read.
    """
    return Replay(**_palpate._replay(file, cloud, model, None if gpu is None else str(gpu), threads, tolerance))
