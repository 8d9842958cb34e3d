"""Sessions that several programs have, here or on other machines: served, listed, joined."""

from __future__ import annotations

import atexit
import os
import time
import weakref
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

from . import _palpate
from ._errors import Error, refuse_attribute

if TYPE_CHECKING:
    from collections.abc import Sequence
    from types import TracebackType

_serving: weakref.WeakSet[Server] = weakref.WeakSet()


@dataclass(frozen=True)
class Network:
    """Which network sessions are on.

    Attributes:
        interface: of this machine, by name or address; None: programs of this machine alone. With it, every program on
            that network can take part, and without `security` nothing is encrypted.
        peers: addresses of machines to look for, where the network carries no multicast.
        domain: of DDS, as ROS numbers them, 0 to 230.
        security: a folder of keys (`palpate keys`): all is encrypted, for holders of keys of the same authority alone.
    """

    interface: str | None = None
    peers: Sequence[str] = ()
    domain: int = 0
    security: str | os.PathLike[str] | None = None

    def _told(self) -> tuple[str | None, list[str], int, str | None]:
        security = None if self.security is None else os.fspath(self.security)
        return self.interface, list(self.peers), self.domain, security


@dataclass(frozen=True)
class Join:
    """A session that another program serves (serve(), `palpate serve`), in place of a Session's cloud.

    Attributes:
        name: that it is served under.
        network: that it is on.
        hand: what the others see this hand called; None: as the machine.
        read_only: this hand feels what the others do, and takes no brush.
        patience_s: s, for the session to be found, for each next piece of it, and, by path and in cloud(), for all
            edits to have reached all programs.
        near: only the points around the hands come here, ahead of them; they can be sculpted, but no stroke can be
            taken back. Moving points always come so, and are felt live.
    """

    name: str
    network: Network = Network()
    hand: str | None = None
    read_only: bool = False
    patience_s: float = 10
    near: bool = False

    def _told(self) -> tuple[str, tuple[str | None, list[str], int, str | None], str | None, bool, float, bool]:
        return self.name, self.network._told(), self.hand, self.read_only, self.patience_s, self.near


class SeenSession(NamedTuple):
    """A session that somebody serves.

    Attributes:
        name, host, model: of it, of the machine that serves it, and what its points are in that one's words.
        points: how many there are.
        round_trip_ms: the median of its answers to pings; None where none came.
        version: of what is said on the network.
        fits: it is this palpate's version, so that it can be joined.
        pings, answered: how many there were.
    """

    name: str
    host: str
    model: str
    points: int
    round_trip_ms: float | None
    version: int
    fits: bool
    pings: int
    answered: int


class OtherHand(NamedTuple):
    """Another program's hand in a session that was joined, as it was heard last.

    Attributes:
        name: what it is called.
        number: the same on all machines, for as long as it takes part.
        position: of what it touches with, x y z, model units.
        proxy: where the surface holds that, x y z, model units.
        touching, sculpts: whether it does.
        age_s: s since it was heard, 2 at most.
    """

    name: str
    number: int
    position: tuple[float, float, float]
    proxy: tuple[float, float, float]
    touching: bool
    sculpts: bool
    age_s: float


class OtherCamera(NamedTuple):
    """From where another program's picture is seen in a session that was joined, as it was heard last.

    Attributes:
        name, number: of its hand, as of OtherHand.
        position: x y z, model units.
        orientation: a unit quaternion, x y z w, of the axes to the right of the picture, down in it and where it looks.
        fov_deg: vertical.
        aspect: width / height of the picture.
        age_s: s since it was heard, 2 at most.
    """

    name: str
    number: int
    position: tuple[float, float, float]
    orientation: tuple[float, float, float, float]
    fov_deg: float
    aspect: float
    age_s: float


@dataclass(frozen=True)
class Sharing:
    """How it goes with the others of a session that was joined.

    Attributes:
        name, host, model: of the session, of its server, and what its points are in that one's words.
        sculptable: False: it is served to be felt alone; once it is joined nothing is exchanged, and all counts are 0.
        heard: False: the server has been silent for so long that there is no force, until it is heard again.
        silent_s, longest_silent_s: s, since the server was heard last, and at most so far.
        round_trip_ms: the median of the last pings; None: none was answered yet.
        pings, answered: how many there were.
        sent, received: states of points, that this hand has made, and of others that took effect here.
        resent, resumed: pieces of strokes that went again, and times that what was missing was asked for.
        delivered: all that this hand has done has been taken by the server.
        at_rest: and all that others have done is in effect here.
        same: at rest, and the points are the server's, bit by bit.
        restarts: times that what moves has begun anew where it is served, as water does that was stirred too fast.
        fault: why this hand's part has ended for good; "": it goes on.
    """

    name: str
    host: str
    model: str
    sculptable: bool
    heard: bool
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
    at_rest: bool
    same: bool
    restarts: int
    fault: str


class Server(_palpate._Server):
    """A cloud that others join, until close(), or for as long as a `with` lasts (serve()). Runs on a thread of its own,
    independent of Python; any number of threads may call it.
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
            threads=threads,
        )
        self._name = name
        _serving.add(self)

    __setattr__ = refuse_attribute

    @property
    def name(self) -> str:
        """That it is joined by."""
        return self._name

    @property
    def serving(self) -> bool:
        """False once it has ended by itself, as where its journal cannot be written; wait() says why."""
        return bool(self._info()["serving"])

    @property
    def points(self) -> int:
        """That the cloud has."""
        return int(self._info()["points"])

    @property
    def clients(self) -> int:
        """Programs that have ever asked for the points."""
        return int(self._info()["clients"])

    @property
    def sculptors(self) -> int:
        """Programs of whom strokes were taken."""
        return int(self._info()["sculptors"])

    @property
    def states(self) -> int:
        """Of points, that the strokes that were taken have made."""
        return int(self._info()["states"])

    @property
    def mm_per_unit(self) -> float:
        """Millimetres per model unit, as those who join have them."""
        return float(self._info()["mm_per_unit"])

    @property
    def openness(self) -> str:
        """Who can join, in a sentence."""
        return str(self._info()["openness"])

    def wait(self, seconds: float | None = None) -> bool:
        """Waits so long (s), or until it ends or is closed. Returns whether it has ended; raises Error if it failed."""
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
    threads: int = 0,
) -> Server:
    """A cloud for other programs, here or on other machines, which join it by its name: Session(Join(name)),
    `palpate view --join`.

    Args:
        cloud: the points; normals are estimated where it has none.
        name: 1 to 200 bytes; no other session of the network has it. That is listened for first, for a second.
        network: that it is served on.
        read_only: whoever joins feels it, and does not sculpt it.
        model: what the points are, in words; None: the name of the cloud's file.
        mm_per_unit: millimetres per model unit; None: as the cloud's file says, or the longest side becomes 100 mm.
        estimate_normals: also where the cloud has some.
        journal: a file that each stroke is written to as it is taken: a server that is started with it again continues
            where this one ends, and so do the programs that have joined.
        threads: of the CPU, for normals; 0: one per core.

    Raises Error, with the status "network" where the name is taken, and UsageError.
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
        threads=threads,
    )


def sessions(network: Network = Network(), seconds: float = 2) -> list[SeenSession]:
    """The sessions that are served on a network.

    Args:
        network: that is listened on.
        seconds: s to listen, 0 to 600. Pings take half a second more, and up to two where some are lost.

    Raises Error, and UsageError. Other threads run meanwhile.
    """
    return [SeenSession(*seen) for seen in _palpate._survey(network._told(), seconds)]


@atexit.register
def _close_all() -> None:
    for server in list(_serving):
        server.close()
