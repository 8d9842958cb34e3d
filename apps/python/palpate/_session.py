"""Sessions, over the C interface; what runs at the pace of a hand runs there."""

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

_joined: weakref.WeakSet[Session] = weakref.WeakSet()


@dataclass(frozen=True)
class Hand:
    """A hand of a live session after the first: its device, and the path that it follows if there is no device
    (Session.live()).
    """

    device: str | None = None
    path: Any = None
    builtin: str | None = None


class Session(_palpate._Session):
    """A cloud, or a scene of matter, that is felt, seen and sculpted.

    Args:
        cloud: the points; normals are estimated where it has none. Or the name of a scene of matter that moves by
            itself, as of Matter, in mm: a hand holds a ball in water and sand, and presses on what is soft. Or the
            folder of a recorded depth camera (TUM, Redwood), in metres. Or a Join: a session that another program
            serves, whose points are felt as those of a cloud; a hand's edits go to all programs that have joined, and
            theirs come here between two ticks. At rest all have the same points, bit by bit; none come to keep the
            surface whole (keeps_density). If its server is silent for seconds the force fades, until the server is
            heard again.
        gpu: number or part of the name of a GPU; "cpu": none, in double precision; None: a GPU where there is one.
        mm_per_unit: millimetres in the hand per model unit, by which all lengths in mm are measured; None: as the file
            says, or the longest side becomes 100 mm, which remarks tell. 1 for a scan in mm that is felt at its own
            size.
        surface: what the points define: "average", "sphere" (true to curvature) or "sharp" (keeps edges).
        radius_mm: support radius, as a hand feels it; None: by the spacing of the points.
        friction: coefficient of a proxy that slides; 0 is none.
        stiffness_N_per_mm, damping_N_s_per_mm, max_force_N: of the force.
        rate_Hz: ticks per second.
        estimate_normals: also where the cloud has some.
        threads: of the CPU; 0: one per core.
        undo_memory_MiB: for strokes that can be taken back.
        hands: that touch at the same time, 1 to 8; the first one sculpts, the others feel.
        tool: of the first hand: "point", or many points that share the stiffness: "pad" (a fingertip), "ball",
            "spatula".
        tool_points, tool_size_mm: of a pad, ball or spatula: 1 to 64; diameter or length.
        tool_axis: where the face of a pad or spatula looks, in the model's axes.
        moving: the points move, frame by frame, as add_frame() says; the cloud stands still until the first one.
        keeps_points: of those: a point has its row in all frames.
        most_points: of those: points of a frame; 0: as many as the cloud has.
        speed, loop, fuse: of a recorded depth camera: its seconds in one of the session's; whether it begins again;
            whether its frames become one map.
        law: a compiled force law of the first hand in place of spring and damper: "libmine.so:law", or a numba cfunc.
            With allow_python a function of Python's, which is called with a LawInput in each tick of contact.
        allow_python: takes such a function. It costs a tick some 30 us while no other thread holds Python's lock, and
            5 ms and more beside one busy thread. By path the tick waits for it. Live, the tick waits 0.3 ms; if the
            force comes later, the last one is held for 10 ms and fades until 50 ms. Its exceptions are raised by
            touch(), wait() and stop().

    Raises Error, and UsageError for an argument that is out of its bounds. Threads may share it and wait for one
    another.
    """

    def __init__(
        self,
        cloud: _palpate.Cloud | str | Join,
        gpu: int | str | None = None,
        mm_per_unit: float | None = None,
        *,
        surface: str = "average",
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
        tool: str = "point",
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
        """Ends the session, and what is live of it; its clouds, meshes and arrays stay."""
        if self._live is not None:
            self._live._end(closing=True)
        super().close()

    def push(self, path: Any, radius_mm: float | None = None, **brush: Any) -> NDArray[Any]:
        """Follows the path and pushes the points before it, as stroke() does; radius_mm: 6 unless radius is given."""
        return self.stroke(path, "push", **_with_radius(radius_mm, brush))

    def carve(self, path: Any, radius_mm: float | None = None, **brush: Any) -> NDArray[Any]:
        """Follows the path and takes points away, as stroke() does; radius_mm: 6 unless radius is given."""
        return self.stroke(path, "carve", **_with_radius(radius_mm, brush))

    def live(
        self,
        device: str | None = None,
        rate: float = 0,
        on_ticks: Callable[[NDArray[Any]], object] | None = None,
        *,
        path: Any = None,
        builtin: str | None = None,
        law: Any = None,
        allow_python: bool = False,
        others: Sequence[Hand] = (),
        interval_s: float = 1 / 30,
    ) -> Live:
        """Begins ticks against the wall clock, on a servo thread that Python has no part in.

        Args:
            device: openhaptics[:NAME], dhd[:NUMBER], hid[:WHICH], sim, replay:FILE or path; None: path.
            rate: ticks per second; 0: the session's.
            on_ticks: is called with blocks of ticks (tick_dtype), on a thread of its own, each `interval_s`; with
                several hands their shape is (ticks, hands).
            path: of a device that is none: an array as of touch(), followed once.
            builtin: of sim and path: "press", "slide", "scan" or "orbit".
            law, allow_python: in place of the session's, as there.
            others: the hands after the first.

        A scene of matter begins from the start. Where it diverges wait() and stop() raise Error, and so they do where a
        session that was joined goes on without this hand.
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
        """That the cloud had."""
        return int(self._info()["points"])

    @property
    def mm_per_unit(self) -> float:
        """Millimetres per model unit."""
        return float(self._info()["mm_per_unit"])

    @property
    def spacing_mm(self) -> float:
        """Mean distance of neighbouring points."""
        return float(self._info()["spacing_mm"])

    @property
    def radius_mm(self) -> float:
        """Support radius."""
        return float(self._info()["radius_mm"])

    @property
    def rate_Hz(self) -> float:
        """Ticks per second."""
        return float(self._info()["rate_Hz"])

    @property
    def undoable(self) -> int:
        """Strokes that can be taken back."""
        return int(self._info()["undoable"])

    @property
    def redoable(self) -> int:
        """Strokes that can be done again."""
        return int(self._info()["redoable"])

    @property
    def machine(self) -> str:
        """What answers, in words."""
        return str(self._info()["machine"])

    @property
    def backend(self) -> str:
        """ "vulkan" or "cpu"."""
        return str(self._info()["backend"])

    @property
    def sharing(self) -> Sharing | None:
        """State of the exchange with the others, in counts, s and ms; None unless the session was joined."""
        told = _if_any(self._sharing)
        return None if told is None else Sharing(**told)

    @property
    def others(self) -> list[OtherHand]:
        """Hands of the other programs in a joined session that were heard within two seconds, in model units; none
        unless it was joined.
        """
        return [OtherHand(*hand) for hand in _if_any(self._others) or ()]

    @property
    def cameras(self) -> list[OtherCamera]:
        """Viewpoints of the other programs in a joined session that were heard within two seconds, in model units; none
        unless it was joined.
        """
        return [OtherCamera(*camera) for camera in _if_any(self._cameras) or ()]

    @property
    def parameters(self) -> dict[str, Parameter]:
        """Of a scene of matter: those that set() changes, by name; none for what does not move by itself."""
        return _by_name(_if_any(self._parameters) or [])

    @property
    def port_energies(self) -> list[PortEnergy]:
        """Of a scene of matter: what each hand has put into it; none for what does not move by itself."""
        motion = _if_any(self._motion)
        return [] if motion is None else [PortEnergy(*energy) for energy in motion["energies_J"]]

    @property
    def held(self) -> bool | None:
        """Whether a scene of matter stands still, by hold(); None for what does not move by itself."""
        motion = _if_any(self._motion)
        return None if motion is None else bool(motion["held"])

    @property
    def failure(self) -> str | None:
        """Why a scene of matter goes on no more until reset(), as "has diverged"; None while it does, and for what does
        not move by itself.
        """
        motion = _if_any(self._motion)
        return None if motion is None else str(motion["failure"]) or None

    @property
    def left_out_s(self) -> float | None:
        """Time by which a live scene of matter has stayed behind the clock, and which it leaves out; None for what does
        not move by itself.
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
        """What a notebook shows."""
        return _png(self.render((640, 400)))


def _if_any(ask: Callable[[], Any]) -> Any:
    """What it says; None where the session has nothing of the kind."""
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


os.register_at_fork(after_in_child=_forget_joined)  # they stay with the parent


@atexit.register
def _end_all() -> None:
    end_live()
    for session in list(_joined):
        session.close()
