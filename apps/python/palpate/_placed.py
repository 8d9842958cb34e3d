"""Clouds that are placed in one session."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import TYPE_CHECKING

from . import _palpate
from ._errors import ArgumentTypeError, UsageError, described

if TYPE_CHECKING:
    from collections.abc import Sequence


@dataclass(frozen=True)
class Pose:
    """Pose of a cloud in a session, for Session.of_clouds(): rotated by orientation, then moved by position.

    Attributes:
        position: model units of the session.
        orientation: unit quaternion w x y z.
    """

    position: Sequence[float] = (0, 0, 0)
    orientation: Sequence[float] = (1, 0, 0, 0)


def placed_clouds(
    clouds: Sequence[_palpate.Cloud], poses: Sequence[Pose | None] | None
) -> list[tuple[_palpate.Cloud, Sequence[float], Sequence[float]]]:
    """Each cloud with its position and orientation. Raises UsageError."""
    if not isinstance(clouds, Iterable):
        raise ArgumentTypeError(f"clouds: must be a list of Cloud, not {described(clouds)}")
    clouds = list(clouds)
    placed = list(poses) if poses is not None else [None] * len(clouds)
    if len(placed) != len(clouds):
        raise UsageError(f"poses: {len(placed)} are given for {len(clouds)} clouds")
    if not clouds:
        raise UsageError("clouds: is empty; give at least one")
    given = []
    for cloud, pose in zip(clouds, placed):
        if not isinstance(cloud, _palpate.Cloud):
            raise ArgumentTypeError(f"clouds: must be a list of Cloud, but contains {described(cloud)}")
        if not isinstance(pose, (Pose, type(None))):
            raise ArgumentTypeError(f"poses: must be a list of Pose, but contains {described(pose)}")
        there = pose or Pose()
        given.append((cloud, there.position, there.orientation))
    return given
