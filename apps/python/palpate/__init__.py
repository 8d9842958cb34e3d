"""palpate: feel, see and sculpt point clouds.

    import numpy as np, palpate as pp
    cloud = pp.read("scan.laz")                      # or pp.Cloud(xyz, normals=n, colors=c)
    with pp.Session(cloud, gpu="cpu") as s:
        t = s.touch(path, surface="sharp")           # a structured array, one row for each tick
        s.push(path, radius_mm=4); s.undo()
        picture = s.render((1280, 720))              # uint8, H x W x 4
        s.mesh(resolution=256).save("m.ply")

Positions are in model units (the coordinates of the cloud's file), lengths in the hand in mm, forces in N, times in s.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from . import _notebook  # for clouds, meshes and matter
from . import _palpate
from . import _words
from ._errors import ArgumentTypeError, ClosedError, Error, UnknownAttributeError, UnknownNameError, UsageError, nearest
from ._live import Hand, Live
from ._logs import Recording, Replay, read_recording, replay
from ._matter import Matter, Parameter, PortEnergy
from ._palpate import Cloud, Contact, ContactEvent, Frame, LawInput, Mesh, can_share, can_simulate
from ._palpate import formats_read, formats_written, gpus, read, write
from ._placed import Pose
from ._session import Session
from ._sharing import Network, OtherCamera, OtherHand, SessionInfo, Server, ServerSave, Sharing, serve, discover

__all__ = [
    "ArgumentTypeError",
    "ClosedError",
    "Cloud",
    "Contact",
    "ContactEvent",
    "Error",
    "Frame",
    "Hand",
    "LawInput",
    "Live",
    "Recording",
    "Matter",
    "Mesh",
    "Network",
    "OtherCamera",
    "OtherHand",
    "Parameter",
    "PortEnergy",
    "Pose",
    "Replay",
    "SessionInfo",
    "Server",
    "ServerSave",
    "Session",
    "Sharing",
    "UnknownAttributeError",
    "UnknownNameError",
    "UsageError",
    "can_share",
    "can_simulate",
    "formats_read",
    "formats_written",
    "gpus",
    "live_tick_dtype",
    "read",
    "read_recording",
    "replay",
    "serve",
    "discover",
    "tick_dtype",
    "tool_tick_dtype",
    "write",
]

__version__: str = _palpate.version()

if TYPE_CHECKING:
    import numpy

    tick_dtype: numpy.dtype[Any]  # of the rows that touch() returns
    live_tick_dtype: numpy.dtype[Any]  # the same of a live session
    tool_tick_dtype: numpy.dtype[Any]  # the same with a tool of many points


for _name in __all__:
    _thing = globals().get(_name)
    _is_error = isinstance(_thing, type) and issubclass(_thing, BaseException)
    if getattr(_thing, "__module__", _palpate.__name__) != _palpate.__name__ and not _is_error:
        globals()[_name] = _words.say_of_python(_thing)


def __dir__() -> list[str]:
    return [*__all__, "__version__"]


def __getattr__(name: str) -> Any:
    if name == "tick_dtype":  # on first use: it imports NumPy, which takes longer than the whole package
        return _palpate._tick_dtype()
    if name == "live_tick_dtype":
        return _palpate._live_tick_dtype()
    if name == "tool_tick_dtype":
        return _palpate._tool_tick_dtype()
    raise AttributeError(f"module 'palpate' has no attribute '{name}'{nearest(name, __all__)}")
