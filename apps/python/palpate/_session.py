"""Sessions, over the C interface, in which all servo ticks run."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, Any, Callable

from . import _ending, _palpate
from ._errors import ArgumentTypeError, Error, described, if_any, refuse_attribute
from ._live import Hand, Live, rest_of_hands
from ._matter import Parameter, PortEnergy, _by_name
from ._placed import Pose, placed_clouds
from ._png import png_of
from ._sharing import Network, OtherCamera, OtherHand, ServerSave, Sharing

if TYPE_CHECKING:
    from collections.abc import Sequence
    from types import TracebackType

    from numpy.typing import NDArray
    from typing_extensions import Unpack

    from ._types import BuiltinPath, SessionOptions


class Session(_palpate._Session):
    """A cloud that is felt, seen and sculpted. Session.of_clouds() opens several clouds as one, Session.of_scene() a
    scene of matter, Session.of_frames() a cloud whose frames the program provides, Session.of_stream() a recorded depth
    camera, and Session.join() a session that another program serves.

    Args:
        cloud: the points; normals are estimated if it has none.
        gpu: number or part of the name of a GPU; "cpu": none, double precision; None: a GPU if there is one.
        mm_per_unit: millimetres in the hand per model unit, the scale of all lengths in mm; None: as the file says, or
            else the longest side becomes 100 mm, which is reported in messages. 1 for a scan in mm that is felt at its
            own size.
        options: the keywords below, which all constructors have.
        backend: "vulkan" (a GPU), "cpu" (double precision), or "auto": "vulkan" if a GPU is named or there is one other
            than a software driver, else "cpu" (default "auto"). With "auto", budget_us and no named GPU, a cloud at
            rest is answered by the one of both that takes less time for a tick with an edit, which is measured for up
            to two seconds, reported in messages, and remembered in the user's cache folder.
        surface: surface that the points define: "average", "sphere" (true to curvature) or "sharp" (keeps edges)
            (default "average").
        radius_mm: support radius, mm in the hand; None: from the spacing of the points (default None).
        friction: coefficient of sliding friction of the proxy; 0: none (default 0).
        stiffness_N_per_mm: of the spring from the hand to the proxy, N/mm (default 0.8).
        damping_N_s_per_mm: of the damper on its change, N s/mm (default 0.002).
        max_force_N: limit of the magnitude, N (default 3.3).
        rate_Hz: ticks per second (default 1000).
        budget_us: time limit of an answer of touch_pose(), us, after which the last answer bridges it; 0: no limit
            (default 0).
        estimate_normals: even if the cloud has normals (default False).
        threads: threads of the CPU; 0: one per core (default 0).
        undo_memory_MiB: memory of strokes that can be undone, MiB; beyond it the oldest are discarded (default 1024).
        hands: number of simultaneous hands, 1 to 8; the first one sculpts, the others feel (default 1).
        tool: tool of the first hand: "point", or many points that share the stiffness: "pad" (a fingertip), "ball",
            "spatula" (default "point").
        tool_points: number of points of a pad, ball or spatula, 1 to 64 (default 16).
        tool_size_mm: diameter of a pad or ball, length of a spatula, mm (default 10).
        tool_axis: direction of the face of a pad or spatula, in the model's axes (default (0, 0, -1)).
        law: a compiled force law of the first hand instead of spring and damper: "libmine.so:law", or a numba cfunc.
            With allow_python_law a Python function, which is called with a LawInput in each tick of contact (default
            None).
        allow_python_law: accepts a Python function (default False). It costs a tick some 30 us while no other thread
            holds Python's lock, and 5 ms and more with one busy thread. By path the tick waits for it. Live, the tick
            waits 0.3 ms; if the force is later, the last one is held for 10 ms and fades until 50 ms. Its exceptions
            are raised by touch(), wait() and stop().

        on_message: called with the level ("note" or "warning": points, frames or strokes are lost) and the text of each
            message, at the end of the call during which it came, on its thread (default None). Messages are also kept
            in messages; nothing is printed.

    Raises Error, and UsageError for an argument that is out of bounds. Threads may share a session and wait for one
    another.
    """

    def __init__(
        self,
        cloud: _palpate.Cloud,
        gpu: int | str | None = None,
        mm_per_unit: float | None = None,
        **options: Unpack[SessionOptions],
    ) -> None:
        self._open(_palpate._Source(cloud=cloud), gpu, mm_per_unit, options)

    @classmethod
    def of_clouds(
        cls,
        clouds: Sequence[_palpate.Cloud],
        gpu: int | str | None = None,
        mm_per_unit: float | None = None,
        *,
        poses: Sequence[Pose | None] | None = None,
        **options: Unpack[SessionOptions],
    ) -> Session:
        """Opens several clouds at rest, which hands feel and sculpt as one. rows(), nearest() and raycast() say which
        cloud and row a point comes from. Their positions, normals and colours are taken; normals of a cloud without any
        are estimated from its own points.

        Args:
            clouds: at least one; the same cloud may be placed several times.
            gpu, mm_per_unit, options: as for Session(); mm_per_unit None: the longest side of all becomes 100 mm.
            poses: pose of each cloud in the session; None: as it is.
        """
        return cls.__new__(cls)._open(_palpate._Source(clouds=placed_clouds(clouds, poses)), gpu, mm_per_unit, options)

    @classmethod
    def of_scene(
        cls,
        scene: str,
        gpu: int | str | None = None,
        mm_per_unit: float | None = None,
        **options: Unpack[SessionOptions],
    ) -> Session:
        """Opens a scene of moving matter, in mm: a hand holds a ball in water and sand, and presses on a soft body.

        Args:
            scene: its name, as for Matter().
            gpu, mm_per_unit, options: as for Session().
        """
        return cls.__new__(cls)._open(_palpate._Source(scene=scene), gpu, mm_per_unit, options)

    @classmethod
    def of_frames(
        cls,
        cloud: _palpate.Cloud,
        gpu: int | str | None = None,
        mm_per_unit: float | None = None,
        *,
        stable_rows: bool = False,
        max_points: int = 0,
        **options: Unpack[SessionOptions],
    ) -> Session:
        """Opens a cloud whose points move, frame by frame (add_frame()). They are at rest until the first frame.

        Args:
            cloud: the points until then.
            stable_rows: each point has the same row in all frames.
            max_points: maximum number of points of a frame; 0: that of the cloud.
            gpu, mm_per_unit, options: as for Session().
        """
        source = _palpate._Source(cloud=cloud, moving=True, stable_rows=stable_rows, max_points=max_points)
        return cls.__new__(cls)._open(source, gpu, mm_per_unit, options)

    @classmethod
    def of_stream(
        cls,
        folder: str | os.PathLike[str],
        gpu: int | str | None = None,
        mm_per_unit: float | None = None,
        *,
        speed: float = 1,
        loop: bool = False,
        fuse: bool = False,
        **options: Unpack[SessionOptions],
    ) -> Session:
        """Opens a recorded depth camera, whose points are in metres.

        Args:
            folder: in the layout of TUM, ScanNet, Redwood, Replica or 7-Scenes.
            speed: seconds of the recording per second of the session.
            loop: restarts after the last frame.
            fuse: its frames are fused into one map.
            gpu, mm_per_unit, options: as for Session().
        """
        source = _palpate._Source(folder=os.fspath(folder), speed=speed, loop=loop, fuse=fuse)
        return cls.__new__(cls)._open(source, gpu, mm_per_unit, options)

    @classmethod
    def join(
        cls,
        name: str,
        network: Network = Network(),
        gpu: int | str | None = None,
        *,
        hand_name: str | None = None,
        read_only: bool = False,
        timeout_s: float = 10,
        partial: bool = False,
        **options: Unpack[SessionOptions],
    ) -> Session:
        """Joins a session that another program serves (serve(), `palpate serve`). Its points are felt like those of a
        cloud; a hand's edits are sent to all programs that have joined, and their edits take effect here between two
        ticks. At rest all programs have the same points, bit by bit; points are neither inserted nor removed
        (resample). If its server is silent for seconds the force fades, until the server is heard again.

        Args:
            name: name of the served session.
            network: network of the session.
            hand_name: name of this hand for the others; None: name of the machine.
            read_only: this hand feels the others' edits, and cannot have a brush.
            timeout_s: timeout, s, for finding the session, for each further piece of it, and, by path and in cloud(),
                for all edits to reach all programs.
            partial: streams only the points around the hands, ahead of them; they can be sculpted, and cloud() has the
                known ones, with their numbers among all (`number`). Moving points are always streamed this way, and
                can be felt live.
            gpu, options: as for Session().
        """
        joining = (name, network._told(), hand_name, read_only, timeout_s, partial)
        return cls.__new__(cls)._open(_palpate._Source(join=joining), gpu, None, options)

    def _open(
        self, source: _palpate._Source, gpu: int | str | None, mm_per_unit: float | None, options: SessionOptions
    ) -> Session:
        super().__init__(source, None if gpu is None else str(gpu), mm_per_unit, **options)
        self._live: Live | None = None
        self._is_scene = source.is_scene
        self._is_joined = source.is_joined
        if self._is_joined:
            _ending.joined.add(self)
        return self

    __setattr__ = refuse_attribute

    def __enter__(self) -> Session:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        try:
            self.close()
        except Error:
            if error is None:  # else that has more to say
                raise

    def close(self) -> None:
        """Closes the session, and ends its live session; its clouds, meshes and arrays remain valid. Raises Error with
        the status "network" if the server of a joined session has not confirmed all its strokes; it is closed then.
        """
        if self._live is not None and self._is_here():
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
        allow_python_law: bool = False,
        others: Sequence[Hand] = (),
        interval_s: float = 1 / 30,
        axes: str | None = None,
    ) -> Live:
        """Starts ticks against the wall clock, on a servo thread that runs no Python code.

        Args:
            device: openhaptics[:NAME], dhd[:NUMBER], haply[:SERIAL], hid[:WHICH], sim, replay:FILE or path; None: path.
            rate: ticks per second; 0: the session's.
            on_ticks: called with blocks of ticks (live_tick_dtype), on a thread of its own; with several hands their
                shape is (ticks, hands). An exception in it ends the live session, without force.
            path: for the device path: an array as for touch(), followed once.
            builtin: for sim and path: "press", "slide", "scan" or "orbit".
            law: instead of the session's, with the same meaning.
            allow_python_law: instead of the session's, with the same meaning.
            others: the hands after the first.
            interval_s: time between two calls of on_ticks, s.
            axes: of a hand-held device, those that point right, up and towards the user, as in "x,z,-y"; None: as its
                user agreed to after the guided test, else the device's own.

        A contact is never stiffer than what the user of a hand-held device agreed to after its guided test. A scene of
        matter restarts. wait() and stop() raise Error if it diverges, and if this hand's part in a joined session has
        ended permanently.
        """
        if on_ticks is not None and not callable(on_ticks):
            raise ArgumentTypeError(f"on_ticks: must be a function, not {described(on_ticks)}")
        self._live_start(device, rate, builtin, path, law, allow_python_law, rest_of_hands(others), axes)
        failure = (lambda: self.failure) if self._is_scene else None
        self._live = Live(self, on_ticks, interval_s, self._is_joined, failure)
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
    def undo_count(self) -> int:
        """Number of strokes that can be undone."""
        return int(self._info()["undo_count"])

    @property
    def redo_count(self) -> int:
        """Number of strokes that can be redone."""
        return int(self._info()["redo_count"])

    @property
    def blocked_moves(self) -> int:
        """Moves for which points had no room, before a side that stays; in each edit one for each such point."""
        return int(self._info()["blocked_moves"])

    @property
    def blocked_edits(self) -> int:
        """Edits in which nearly all points under the brush had no room: while it increases, the part is too thin."""
        return int(self._info()["blocked_edits"])

    @property
    def bridged_ticks(self) -> int:
        """Ticks whose own answer would have been late, so that the points kept around the hand answered them."""
        return int(self._info()["bridged_ticks"])

    @property
    def thinned_ticks(self) -> int:
        """Of these ticks, those answered from only a share of the points, because they are too many."""
        return int(self._info()["thinned_ticks"])

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
        told = if_any(self._sharing)
        return None if told is None else Sharing(**told)

    def save_at_server(self, seconds: float = 30) -> ServerSave:
        """For a joined session: asks the server to write all its points to its file (serve(save=), `palpate serve
        --save`), once it has taken the edits made here, and waits at most `seconds` for its answer. A server writes
        once in five seconds at most.
        """
        return ServerSave(*self._save_at_server(seconds))

    @property
    def other_hands(self) -> list[OtherHand]:
        """Hands of the other programs in a joined session that were heard within two seconds, in model units; empty
        unless it was joined.
        """
        return [OtherHand(*hand) for hand in if_any(self._other_hands) or ()]

    @property
    def cameras(self) -> list[OtherCamera]:
        """Cameras of the other programs in a joined session that were heard within two seconds, in model units; empty
        unless it was joined.
        """
        return [OtherCamera(*camera) for camera in if_any(self._cameras) or ()]

    @property
    def parameters(self) -> dict[str, Parameter]:
        """Parameters of a scene of matter, by name, which set() changes; empty for other sessions."""
        return _by_name(if_any(self._parameters) or [])

    @property
    def port_energies(self) -> list[PortEnergy]:
        """Energy that each hand has put into a scene of matter; empty for other sessions."""
        motion = if_any(self._motion)
        return [] if motion is None else [PortEnergy(*energy) for energy in motion["energies_J"]]

    @property
    def paused(self) -> bool | None:
        """True while a scene of matter is paused by pause(); None for other sessions."""
        motion = if_any(self._motion)
        return None if motion is None else bool(motion["paused"])

    @property
    def failure(self) -> str | None:
        """Reason why a scene of matter has failed, such as "has diverged", until reset(); None if it has not, and for
        other sessions.
        """
        motion = if_any(self._motion)
        return None if motion is None else str(motion["failure"]) or None

    @property
    def dropped_s(self) -> float | None:
        """Time by which a live scene of matter fell behind the clock, and which it skipped, s; None for other
        sessions.
        """
        motion = if_any(self._motion)
        return None if motion is None else float(motion["dropped_s"])

    def __repr__(self) -> str:
        try:
            info = self._info()
        except Error as error:
            return f"<palpate.Session: {error}>"
        return f"<palpate.Session of {info['points']} points on {info['machine']}, {info['undo_count']} strokes>"

    def _repr_png_(self) -> bytes | None:
        """Picture for a notebook; None where nothing can be drawn, as without a GPU."""
        try:
            return png_of(self.render((640, 400)))
        except Error:
            return None


def _with_radius(radius_mm: float | None, brush: dict[str, Any]) -> dict[str, Any]:
    if radius_mm is None and "radius" in brush:
        return brush
    return {"radius_mm": 6 if radius_mm is None else radius_mm, **brush}
