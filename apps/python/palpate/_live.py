"""Sessions that run against the clock, on palpate's own servo thread."""

from __future__ import annotations

import contextlib
import os
import threading
import time
import weakref
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Callable

from . import _palpate
from ._errors import ArgumentTypeError, ClosedError, Error, described, refuse_attribute

if TYPE_CHECKING:
    from collections.abc import Sequence
    from types import TracebackType

    from numpy.typing import NDArray

    from ._types import BuiltinPath

_alive: weakref.WeakSet[Live] = weakref.WeakSet()


@dataclass(frozen=True)
class Hand:
    """A hand of a live session after the first, for Session.live().

    Attributes:
        device: as for live(); None: path.
        path: for the device path: an array as for touch(), followed once.
        builtin: for sim and path: "press", "slide", "scan" or "orbit".
        axes: as for live().
    """

    device: str | None = None
    path: Any = None
    builtin: BuiltinPath | None = None
    axes: str | None = None


def rest_of_hands(others: Sequence[Hand]) -> list[tuple[str | None, BuiltinPath | None, Any, str | None]]:
    """The hands after the first, as a session starts them. Raises ArgumentTypeError."""
    for hand in others:
        if not isinstance(hand, Hand):
            raise ArgumentTypeError(f"others: must be a list of Hand, but contains {described(hand)}")
    return [(hand.device, hand.builtin, hand.path, hand.axes) for hand in others]


class Live:
    """A session that runs against the clock, as Session.live() returns it, until stop() or the end of its `with`."""

    def __init__(
        self,
        session: _palpate._Session,
        on_ticks: Callable[[NDArray[Any]], object] | None,
        interval_s: float,
        is_joined: bool,
        failure_of_scene: Callable[[], str | None] | None,
    ) -> None:
        self._session = session
        self._failure_of_scene = failure_of_scene  # None: the session has no scene
        self._on_ticks = on_ticks
        self._interval_s = interval_s
        self._over = threading.Event()
        self._lock = threading.Lock()  # guards _ended
        self._ended = False  # a thread has stopped the ticks, or is about to
        self._stopped = threading.Event()  # the ticks have stopped
        self._takes_rest = True
        self._failure: BaseException | None = None
        self._failed = False
        self._diverged: str | None = None
        self._thread: threading.Thread | None = None
        _alive.add(self)
        if on_ticks is not None or is_joined:  # joined: sends its strokes to the others
            self._thread = threading.Thread(target=self._follow, name="palpate ticks", daemon=True)
            self._thread.start()

    def read_ticks(self) -> NDArray[Any]:
        """Ticks since the last call; requires that live() got no on_ticks. Raises the error that ended the session."""
        if self._on_ticks is not None:
            raise Error("on_ticks receives the ticks; read_ticks() cannot read them", status="state")
        ticks = self._session._live_read_ticks()
        self._look_at_scene()
        return ticks

    def wait(self, seconds: float | None = None) -> bool:
        """Waits until the session ends, at most `seconds`; True if it has. Raises errors of it and of on_ticks."""
        end = None if seconds is None else time.monotonic() + seconds
        while self.running and (end is None or time.monotonic() < end):
            left = self._interval_s if end is None else min(self._interval_s, max(0.0, end - time.monotonic()))
            if self._over.wait(left):
                break
            self._look_at_scene()
            if self._diverged:
                break
        self._raise()
        return not self.running

    def stop(self) -> None:
        """Stops after the tick in progress; the device has no force afterwards. Raises errors of on_ticks. May be
        called from any thread, also within on_ticks, which then receives the last ticks after it has returned.
        """
        self._end()
        self._raise()

    @property
    def running(self) -> bool:
        """False once it has ended, or was stopped."""
        try:
            return not self._over.is_set() and self._session._live_running()
        except ClosedError:  # by another thread, just now
            return False

    @property
    def late_laws(self) -> int:
        """Number of ticks for which a force law in Python was late."""
        return self._session._live_late()

    @property
    def missed(self) -> int:
        """Number of ticks missed, because their time had passed, before the last one read."""
        return self._session._live_missed()

    def set_forces(self, on: bool) -> None:
        """Switches the force on or off. When it is on again, it returns once the hand has left the surface, and ramps
        up over half a second.
        """
        self._session._live_forces(on)

    __setattr__ = refuse_attribute

    def __enter__(self) -> Live:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._end()
        if kind is None:
            self._raise()

    def __repr__(self) -> str:
        return f"<palpate.Live, {'running' if self.running else 'ended'}>"

    def _follow(self) -> None:
        try:
            while not self._over.wait(self._interval_s):
                self._pass_on()
            self._stopped.wait()
            if self._on_ticks is not None and self._takes_rest:
                while self._pass_on():  # the last ticks, and the end of a contact
                    pass
        except BaseException as failure:  # raised by wait() and stop(), on the calling thread
            self._failure, self._failed = failure, True
            self._over.set()
            with contextlib.suppress(Error):  # closed meanwhile
                self._session._live_stop()  # no force that the program no longer follows

    def _look_at_scene(self) -> None:
        if self._failure_of_scene is not None:
            self._diverged = self._failure_of_scene()

    def _pass_on(self) -> bool:
        """Whether there were ticks."""
        if self._on_ticks is None:
            self._session.apply_edits()
            return False
        ticks = self._session._live_read_ticks()
        self._look_at_scene()
        if len(ticks):
            self._on_ticks(ticks)
        return len(ticks) > 0

    def _end(self, closing: bool = False) -> None:
        """For any thread, also within on_ticks: that thread then reads the last ticks, unless it closes the session."""
        is_own = self._thread is threading.current_thread()
        with self._lock:
            first, self._ended = not self._ended, True
        if first:
            self._takes_rest = not (closing and is_own)
            self._over.set()
            try:
                self._look_at_scene()
                self._session._live_stop()
            finally:
                self._stopped.set()
        if self._thread is not None and not is_own:
            self._thread.join()
        if not is_own:
            _alive.discard(self)

    def _raise(self) -> None:
        failure, self._failure = self._failure, None
        if failure is not None:
            raise failure
        self._session._live_raise()
        if self._diverged:
            raise Error(f"the simulation {self._diverged}", status="simulation")


def end_live() -> None:
    """Ends all live sessions before the interpreter exits."""
    for live in list(_alive):
        live._end()


os.register_at_fork(after_in_child=_alive.clear)  # live sessions belong to the parent
