"""Sessions shared by several programs, here or on other machines: served, listed, joined."""

from __future__ import annotations

import os
import time
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

from . import _ending, _palpate
from ._errors import ArgumentTypeError, Error, described, refuse_attribute

if TYPE_CHECKING:
    from collections.abc import Sequence
    from types import TracebackType


@dataclass(frozen=True)
class Network:
    """Network on which sessions are shared.

    Attributes:
        interface: interface of this machine, by name or address; None: programs of this machine only. With an
            interface, every program on that network can take part, and nothing is encrypted without `security`.
        peers: addresses of machines to contact directly, for networks without multicast.
        domain: domain of DDS, as ROS numbers them, 0 to 230.
        security: a folder of keys (`palpate keys`): everything is encrypted, and only holders of keys of the same
            authority can take part.
    """

    interface: str | None = None
    peers: Sequence[str] = ()
    domain: int = 0
    security: str | os.PathLike[str] | None = None

    def _told(self) -> tuple[str | None, list[str], int, str | None]:
        security = None if self.security is None else os.fspath(self.security)
        return self.interface, list(self.peers), self.domain, security


class SessionInfo(NamedTuple):
    """A served session.

    Attributes:
        name: name of the session.
        host: machine of its server.
        model: its server's description of the points.
        points: number of points.
        round_trip_ms: median of the answered pings, ms; None if none was answered.
        version: version of the network protocol.
        compatible: same version as this palpate, so that it can be joined.
        pings: number of pings.
        answered: number of answered pings.
    """

    name: str
    host: str
    model: str
    points: int
    round_trip_ms: float | None
    version: int
    compatible: bool
    pings: int
    answered: int


class OtherHand(NamedTuple):
    """Last known state of another program's hand in a joined session.

    Attributes:
        name: name of the hand.
        number: the same on all machines, while it takes part.
        position: position of what it touches with, x y z, model units.
        proxy: the proxy of that on the surface, x y z, model units.
        touching: whether it touches the surface.
        sculpts: whether it has a brush.
        age_s: s since it was heard, at most 2.
    """

    name: str
    number: int
    position: tuple[float, float, float]
    proxy: tuple[float, float, float]
    touching: bool
    sculpts: bool
    age_s: float


class OtherCamera(NamedTuple):
    """Last known camera of another program's picture in a joined session.

    Attributes:
        name: name of its hand.
        number: number of its hand, as in OtherHand.
        position: x y z, model units.
        orientation: unit quaternion w x y z of the axes to the right of the picture, down in it and in the direction of
            view.
        fov_deg: vertical field of view, degrees.
        aspect: width / height of the picture.
        age_s: s since it was heard, at most 2.
    """

    name: str
    number: int
    position: tuple[float, float, float]
    orientation: tuple[float, float, float, float]
    fov_deg: float
    aspect: float
    age_s: float


class ServerSave(NamedTuple):
    """Answer of a server that was asked to save its points.

    Attributes:
        written: whether it has written its file.
        points: number of points in the file.
        text: the file, as its server names it; or why it was not written.
    """

    written: bool
    points: int
    text: str


@dataclass(frozen=True)
class Sharing:
    """State of the exchange with the other programs of a joined session.

    Attributes:
        name: name of the session.
        host: machine of its server.
        model: its server's description of the points.
        sculptable: False: served read-only; after joining nothing is exchanged, and all counts are 0.
        connected: False if the server has been silent for too long: there is no force then.
        silent_s: time since the server was last heard, s.
        longest_silent_s: maximum of silent_s so far.
        round_trip_ms: median of the last pings, ms; None if none was answered yet.
        pings: number of pings.
        answered: number of answered pings.
        sent: states of points that this hand has made.
        received: states of points that others have made and that took effect here.
        resent: pieces of strokes that were sent again.
        resumed: number of requests for missing edits, including the first.
        delivered: the server has taken all edits of this hand.
        idle: and all edits of others are in effect here.
        same: at rest, and the points are the server's, bit by bit.
        restarts: restarts of the moving points at the server, such as of water that was stirred too fast.
        fault: reason why this hand's part has ended permanently; "": it has not.
    """

    name: str
    host: str
    model: str
    sculptable: bool
    connected: bool
    silent_s: float
    longest_silent_s: float
    round_trip_ms: float | None
    pings: int
    answered: int
    sent: int
    received: int
    resent: int
    resumed: int
    delivered: bool
    idle: bool
    same: bool
    restarts: int
    fault: str


class Server(_palpate._Server):
    """A served cloud, as for serve(), until close() or the end of its `with`. Runs on a thread of its own, independent
    of Python; any number of threads may call it.
    """

    def __init__(
        self,
        cloud: _palpate.Cloud,
        name: str,
        network: Network = Network(),
        *,
        read_only: bool = False,
        model: str | None = None,
        mm_per_unit: float | None = None,
        estimate_normals: bool = False,
        journal: str | os.PathLike[str] | None = None,
        save: str | os.PathLike[str] | None = None,
        threads: int = 0,
    ) -> None:
        super().__init__(
            cloud,
            name,
            network._told(),
            read_only=read_only,
            model=model,
            mm_per_unit=mm_per_unit,
            estimate_normals=estimate_normals,
            journal=None if journal is None else os.fspath(journal),
            save=None if save is None else os.fspath(save),
            threads=threads,
        )
        self._name = name
        _ending.serving.add(self)

    __setattr__ = refuse_attribute

    @property
    def name(self) -> str:
        """Name under which it is joined."""
        return self._name

    @property
    def serving(self) -> bool:
        """False once it has ended because of a failure, such as of its journal; wait() raises the reason."""
        return bool(self._info()["serving"])

    @property
    def points(self) -> int:
        """Number of points of the cloud."""
        return int(self._info()["points"])

    @property
    def clients(self) -> int:
        """Number of programs that have ever requested the points."""
        return int(self._info()["clients"])

    @property
    def sculptors(self) -> int:
        """Number of programs whose strokes were taken."""
        return int(self._info()["sculptors"])

    @property
    def states(self) -> int:
        """Number of states of points in the strokes that were taken."""
        return int(self._info()["states"])

    @property
    def mm_per_unit(self) -> float:
        """Millimetres per model unit, also for joined programs."""
        return float(self._info()["mm_per_unit"])

    @property
    def access(self) -> str:
        """Who can join, as a sentence."""
        return str(self._info()["access"])

    def wait(self, seconds: float | None = None) -> bool:
        """Waits until the server ends or is closed, at most `seconds`. True if it has ended. Raises Error if it failed.
        """
        end = None if seconds is None else time.monotonic() + seconds
        while True:
            try:
                info = self._info()
            except Error as error:
                if error.status == "handle":  # another thread has closed it
                    return True
                raise
            if info["fault"]:
                raise Error(str(info["fault"]), status="network")
            left = 0.1 if end is None else min(0.1, end - time.monotonic())
            if not info["serving"] or left <= 0:
                return not info["serving"]
            time.sleep(left)

    def __enter__(self) -> Server:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def __repr__(self) -> str:
        try:
            info = self._info()
        except Error as error:
            return f"<palpate.Server {self._name!r}: {error}>"
        return f"<palpate.Server {self._name!r} of {info['points']} points, joined by {info['clients']}>"


def serve(
    cloud: _palpate.Cloud,
    name: str,
    network: Network = Network(),
    *,
    read_only: bool = False,
    model: str | None = None,
    mm_per_unit: float | None = None,
    estimate_normals: bool = False,
    journal: str | os.PathLike[str] | None = None,
    save: str | os.PathLike[str] | None = None,
    threads: int = 0,
) -> Server:
    """Serves a cloud to other programs, here or on other machines, which join it by its name: Session.join(name),
    `palpate view --join`.

    Args:
        cloud: the points; normals are estimated if it has none.
        name: 1 to 200 bytes, not used by another session of the network; the call first listens for a second for one.
        network: network on which it is served.
        read_only: joined programs can feel the cloud but not sculpt it.
        model: description of the points; None: the name of the cloud's file.
        mm_per_unit: millimetres per model unit; None: as the cloud's file says, or the longest side becomes 100 mm.
        estimate_normals: even if the cloud has normals.
        journal: a file to which each stroke is written when it is taken. A server that is started with it again
            continues where the file ends, and so do the programs that have joined.
        save: a file to which all points are written when a joined program asks for it (Session.save_at_server(), or
            saving in the window), once in five seconds at most; a file that exists is kept as NAME.bak.
        threads: threads of the CPU for normals; 0: one per core.

    Raises Error, with the status "network" if the name is taken, and UsageError.
    """
    return Server(
        cloud,
        name,
        network,
        read_only=read_only,
        model=model,
        mm_per_unit=mm_per_unit,
        estimate_normals=estimate_normals,
        journal=journal,
        save=save,
        threads=threads,
    )


def discover(network: Network = Network(), seconds: float = 2) -> list[SessionInfo]:
    """Lists the sessions that are served on a network.

    Args:
        network: network to listen on.
        seconds: s to listen, 0 to 600. Pings take half a second more, and up to two if some are lost.

    Raises Error, and UsageError. Other threads run meanwhile.
    """
    if not isinstance(network, Network):
        raise ArgumentTypeError(f"network: must be a Network, not {described(network)}")
    return [SessionInfo(*seen) for seen in _palpate._discover(network._told(), seconds)]
