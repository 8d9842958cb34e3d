"""Sessions, over the C interface, in which all servo ticks run."""

from __future__ import annotations

import atexit
import os
import struct
import weakref
import zlib
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Callable

from . import _palpate
from ._errors import ArgumentTypeError, Error, described, refuse_attribute
from ._live import Live, end_live
from ._matter import Parameter, PortEnergy, _by_name
from ._sharing import Join, OtherCamera, OtherHand, Sharing

if TYPE_CHECKING:
    from collections.abc import Sequence
    from types import TracebackType

    from numpy.typing import NDArray

    from ._types import BuiltinPath, SurfaceKind, ToolKind

_joined: weakref.WeakSet[Session] = weakref.WeakSet()


@dataclass(frozen=True)
class Hand:
    """A hand of a live session after the first, for Session.live().

    Attributes:
        device: as for live(); None: path.
        path: for the device path: an array as for touch(), followed once.
        builtin: for sim and path: "press", "slide", "scan" or "orbit".
    """

    device: str | None = None
    path: Any = None
    builtin: BuiltinPath | None = None


class Session(_palpate._Session):
    """A cloud, or a scene of matter, that is felt, seen and sculpted.

    Args:
        cloud: the points; normals are estimated if it has none. Or the name of a scene of moving matter, as for Matter,
            in mm: a hand holds a ball in water and sand, and presses on a soft body. Or the folder of a recorded depth
            camera (TUM, Redwood), in metres. Or a Join: a session that another program serves, whose points are felt
            like those of a cloud; a hand's edits are sent to all programs that have joined, and their edits take effect
            here between two ticks. At rest all programs have the same points, bit by bit; points are neither inserted
            nor removed (keeps_density). If its server is silent for seconds the force fades, until the server is heard
            again.
        gpu: number or part of the name of a GPU; "cpu": none, double precision; None: a GPU if there is one.
        mm_per_unit: millimetres in the hand per model unit, the scale of all lengths in mm; None: as the file says, or
            else the longest side becomes 100 mm, which is reported in remarks. 1 for a scan in mm that is felt at its
            own size.
        surface: surface that the points define: "average", "sphere" (true to curvature) or "sharp" (keeps edges).
        radius_mm: support radius, mm in the hand; None: from the spacing of the points.
        friction: coefficient of sliding friction of the proxy; 0: none.
        stiffness_N_per_mm: of the spring from the hand to the proxy, N/mm.
        damping_N_s_per_mm: of the damper on its change, N s/mm.
        max_force_N: limit of the magnitude, N.
        rate_Hz: ticks per second.
        estimate_normals: even if the cloud has normals.
        threads: threads of the CPU; 0: one per core.
        undo_memory_MiB: memory of strokes that can be undone, MiB; beyond it the oldest are discarded.
        hands: number of simultaneous hands, 1 to 8; the first one sculpts, the others feel.
        tool: tool of the first hand: "point", or many points that share the stiffness: "pad" (a fingertip), "ball",
            "spatula".
        tool_points: number of points of a pad, ball or spatula, 1 to 64.
        tool_size_mm: diameter of a pad or ball, length of a spatula, mm.
        tool_axis: direction of the face of a pad or spatula, in the model's axes.
        moving: the points move, frame by frame (add_frame()); they are at rest until the first frame.
        keeps_points: for moving points: each point has the same row in all frames.
        most_points: for moving points: maximum number of points of a frame; 0: that of the cloud.
        speed: for a recorded depth camera: seconds of the recording per second of the session.
        loop: for a recorded depth camera: restarts after the last frame.
        fuse: for a recorded depth camera: its frames are fused into one map.
        law: a compiled force law of the first hand instead of spring and damper: "libmine.so:law", or a numba cfunc.
            With allow_python a Python function, which is called with a LawInput in each tick of contact.
        allow_python: accepts a Python function. It costs a tick some 30 us while no other thread holds Python's lock,
            and 5 ms and more with one busy thread. By path the tick waits for it. Live, the tick waits 0.3 ms; if the
            force is later, the last one is held for 10 ms and fades until 50 ms. Its exceptions are raised by touch(),
            wait() and stop().

    Raises Error, and UsageError for an argument that is out of bounds. Threads may share a session and wait for one
    another.
    """

    def __init__(
        self,
        cloud: _palpate.Cloud | str | Join,
        gpu: int | str | None = None,
        mm_per_unit: float | None = None,
        *,
        surface: SurfaceKind = "average",
        radius_mm: float | None = None,
        friction: float = 0,
        stiffness_N_per_mm: float = 0.8,
        damping_N_s_per_mm: float = 0.002,
        max_force_N: float = 3.3,
        rate_Hz: float = 1000,
        estimate_normals: bool = False,
        threads: int = 0,
        undo_memory_MiB: float = 1024,
        hands: int = 1,
        tool: ToolKind = "point",
        tool_points: int = 16,
        tool_size_mm: float = 10,
        tool_axis: Sequence[float] = (0, 0, -1),
        moving: bool = False,
        keeps_points: bool = False,
        most_points: int = 0,
        speed: float = 1,
        loop: bool = False,
        fuse: bool = False,
        law: Any = None,
        allow_python: bool = False,
    ) -> None:
        join = cloud if isinstance(cloud, Join) else None
        super().__init__(
            None if isinstance(cloud, Join) else cloud,
            None if gpu is None else str(gpu),
            mm_per_unit,
            surface=surface,
            radius_mm=radius_mm,
            friction=friction,
            stiffness_N_per_mm=stiffness_N_per_mm,
            damping_N_s_per_mm=damping_N_s_per_mm,
            max_force_N=max_force_N,
            rate_Hz=rate_Hz,
            estimate_normals=estimate_normals,
            threads=threads,
            undo_memory_MiB=undo_memory_MiB,
            hands=hands,
            tool=tool,
            tool_points=tool_points,
            tool_size_mm=tool_size_mm,
            tool_axis=tool_axis,
            moving=moving,
            keeps_points=keeps_points,
            most_points=most_points,
            speed=speed,
            loop=loop,
            fuse=fuse,
            join=None if join is None else join._told(),
            law=law,
            allow_python=allow_python,
        )
        self._live: Live | None = None
        self._is_scene = isinstance(cloud, str) and not os.path.isdir(cloud)
        self._is_joined = join is not None
        if join is not None:
            _joined.add(self)

    __setattr__ = refuse_attribute

    def __enter__(self) -> Session:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def close(self) -> None:
        """Closes the session, and ends its live session; its clouds, meshes and arrays remain valid."""
        if self._live is not None:
            self._live._end(closing=True)
        super().close()

    def push(self, path: Any, radius_mm: float | None = None, **brush: Any) -> NDArray[Any]:
        """Follows the path with the brush push, as stroke() does; radius_mm: 6 unless radius is given."""
        return self.stroke(path, "push", **_with_radius(radius_mm, brush))

    def carve(self, path: Any, radius_mm: float | None = None, **brush: Any) -> NDArray[Any]:
        """Follows the path with the brush carve, as stroke() does; radius_mm: 6 unless radius is given."""
        return self.stroke(path, "carve", **_with_radius(radius_mm, brush))

    def live(
        self,
        device: str | None = None,
        rate: float = 0,
        on_ticks: Callable[[NDArray[Any]], object] | None = None,
        *,
        path: Any = None,
        builtin: BuiltinPath | None = None,
        law: Any = None,
        allow_python: bool = False,
        others: Sequence[Hand] = (),
        interval_s: float = 1 / 30,
    ) -> Live:
        """Starts ticks against the wall clock, on a servo thread that runs no Python code.

        Args:
            device: openhaptics[:NAME], dhd[:NUMBER], haply[:SERIAL], hid[:WHICH], sim, replay:FILE or path; None: path.
            rate: ticks per second; 0: the session's.
            on_ticks: called with blocks of ticks (tick_dtype), on a thread of its own; with several hands their shape
                is (ticks, hands).
            path: for the device path: an array as for touch(), followed once.
            builtin: for sim and path: "press", "slide", "scan" or "orbit".
            law: instead of the session's, with the same meaning.
            allow_python: instead of the session's, with the same meaning.
            others: the hands after the first.
            interval_s: time between two calls of on_ticks, s.

        A scene of matter restarts. wait() and stop() raise Error if it diverges, and if this hand's part in a joined
        session has ended permanently.
        """
        if on_ticks is not None and not callable(on_ticks):
            raise ArgumentTypeError(f"on_ticks: is a function, not {described(on_ticks)}")
        for hand in others:
            if not isinstance(hand, Hand):
                raise ArgumentTypeError(f"others: is a list of Hand, and has {described(hand)}")
        rest = [(hand.device, hand.builtin, hand.path) for hand in others]
        self._live_start(device, rate, builtin, path, law, allow_python, rest)
        self._live = Live(self, on_ticks, interval_s)
        return self._live

    @property
    def points(self) -> int:
        """Number of points of the cloud as opened."""
        return int(self._info()["points"])

    @property
    def mm_per_unit(self) -> float:
        """Millimetres in the hand per model unit."""
        return float(self._info()["mm_per_unit"])

    @property
    def spacing_mm(self) -> float:
        """Mean distance of neighbouring points, mm in the hand."""
        return float(self._info()["spacing_mm"])

    @property
    def radius_mm(self) -> float:
        """Support radius, mm in the hand."""
        return float(self._info()["radius_mm"])

    @property
    def rate_Hz(self) -> float:
        """Ticks per second."""
        return float(self._info()["rate_Hz"])

    @property
    def undoable(self) -> int:
        """Number of strokes that can be undone."""
        return int(self._info()["undoable"])

    @property
    def redoable(self) -> int:
        """Number of strokes that can be redone."""
        return int(self._info()["redoable"])

    @property
    def machine(self) -> str:
        """Name of the machine that answers."""
        return str(self._info()["machine"])

    @property
    def backend(self) -> str:
        """ "vulkan" or "cpu"."""
        return str(self._info()["backend"])

    @property
    def sharing(self) -> Sharing | None:
        """State of the exchange with the other programs; None unless the session was joined."""
        told = _if_any(self._sharing)
        return None if told is None else Sharing(**told)

    @property
    def others(self) -> list[OtherHand]:
        """Hands of the other programs in a joined session that were heard within two seconds, in model units; empty
        unless it was joined.
        """
        return [OtherHand(*hand) for hand in _if_any(self._others) or ()]

    @property
    def cameras(self) -> list[OtherCamera]:
        """Cameras of the other programs in a joined session that were heard within two seconds, in model units; empty
        unless it was joined.
        """
        return [OtherCamera(*camera) for camera in _if_any(self._cameras) or ()]

    @property
    def parameters(self) -> dict[str, Parameter]:
        """Parameters of a scene of matter, by name, which set() changes; empty for other sessions."""
        return _by_name(_if_any(self._parameters) or [])

    @property
    def port_energies(self) -> list[PortEnergy]:
        """Energy that each hand has put into a scene of matter; empty for other sessions."""
        motion = _if_any(self._motion)
        return [] if motion is None else [PortEnergy(*energy) for energy in motion["energies_J"]]

    @property
    def held(self) -> bool | None:
        """True while a scene of matter is paused by hold(); None for other sessions."""
        motion = _if_any(self._motion)
        return None if motion is None else bool(motion["held"])

    @property
    def failure(self) -> str | None:
        """Reason why a scene of matter has failed, such as "has diverged", until reset(); None if it has not, and for
        other sessions.
        """
        motion = _if_any(self._motion)
        return None if motion is None else str(motion["failure"]) or None

    @property
    def left_out_s(self) -> float | None:
        """Time by which a live scene of matter fell behind the clock, and which it skipped, s; None for other
        sessions.
        """
        motion = _if_any(self._motion)
        return None if motion is None else float(motion["left_out_s"])

    def __repr__(self) -> str:
        try:
            info = self._info()
        except Error as error:
            return f"<palpate.Session: {error}>"
        return f"<palpate.Session of {info['points']} points on {info['machine']}, {info['undoable']} strokes>"

    def _repr_png_(self) -> bytes:
        """Picture for a notebook."""
        return _png(self.render((640, 400)))


def _if_any(ask: Callable[[], Any]) -> Any:
    """Result of `ask`; None if the session does not support it."""
    try:
        return ask()
    except Error as error:
        if error.status == "state":
            return None
        raise


def _with_radius(radius_mm: float | None, brush: dict[str, Any]) -> dict[str, Any]:
    if radius_mm is None and "radius" in brush:
        return brush
    return {"radius_mm": 6 if radius_mm is None else radius_mm, **brush}


def _png(rgba: NDArray[Any]) -> bytes:
    height, width, _ = rgba.shape
    rows = b"".join(b"\0" + rgba[y].tobytes() for y in range(height))

    def chunk(name: bytes, data: bytes) -> bytes:
        return struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))

    head = struct.pack(">IIBBBBB", width, height, 8, 6, 0, 0, 0)
    return (
        b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", zlib.compress(rows, 6)) + chunk(b"IEND", b"")
    )


def _forget_joined() -> None:
    _joined.clear()


os.register_at_fork(after_in_child=_forget_joined)  # they belong to the parent


@atexit.register
def _end_all() -> None:
    end_live()
    for session in list(_joined):
        session.close()
