"""Session logs: what a hand did and felt, and what it did to the points."""

from __future__ import annotations

import json
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from . import _palpate
from ._errors import refuse_attribute

if TYPE_CHECKING:
    import os


class Log(_palpate._Log):
    """A session log. Views of it cannot be written to, and keep it."""

    __setattr__ = refuse_attribute

    def __repr__(self) -> str:
        end = "to its end" if self.ended else "not to its end"
        return f"<palpate.Log of {len(self.ticks)} ticks and {len(self.edits)} edits, {end}>"

    @property
    def header(self) -> dict[str, Any]:
        """How to run the session again."""
        return dict(json.loads(self._header()))

    @property
    def missing(self) -> list[str]:
        """What is missing of it and where, in sentences; empty where it is whole."""
        return self._missing().splitlines()


@dataclass(frozen=True)
class Replay:
    """What came of a recorded session that was run again.

    Attributes:
        identical: all ticks and all points in the end are the same, within the tolerance; to the last bit if that is 0.
        ticks: of the log.
        compared: of them; less than all where the session cannot be run again exactly, for the reason in `because`.
        force_ticks: whose forces differ, by `largest_force_N` at most.
        edit_ticks: between which the points were edited differently.
        points: that are not the same in the end; None where that was not compared.
        first_difference_s: None where there is none.
        recorded_edits_agree: whether the log's edits give the points that it ended with; None where it did not end.
        machine, recorded_on: that ran it again, and that ran it first.
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
    because: str
    machine: str
    recorded_on: str


def read_log(file: str | os.PathLike[str]) -> Log:
    """A session log; of one that is damaged or cut off all that is whole. Raises Error with the file."""
    return Log(file)


def replay(
    file: str | os.PathLike[str],
    cloud: _palpate.Cloud | None = None,
    *,
    model: str | os.PathLike[str] | None = None,
    gpu: int | str | None = None,
    threads: int = 0,
    tolerance: float = 0,
) -> Replay:
    """Runs a recorded session again, in virtual time, and holds it against its log.

    Args:
        file: what Session.record() or the program wrote.
        cloud: the points that the session had; None: of the file `model`, or the one that the log names.
        gpu: which one, where the session was on a GPU.
        threads: of the CPU; 0: one per core.
        tolerance: N for forces and mm for points; 0: the same bits.

    Raises Error where the log, or the model that it had, cannot be read.
    """
    return Replay(**_palpate._replay(file, cloud, model, None if gpu is None else str(gpu), threads, tolerance))
