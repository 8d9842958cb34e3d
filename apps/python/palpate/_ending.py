"""Ends live sessions, joined sessions and servers, in this order, before the interpreter exits.

Then it parks the threads that are still in a call of palpate: daemon threads, which the interpreter does not wait for.
"""

from __future__ import annotations

import atexit
import contextlib
import os
import weakref

from . import _palpate
from ._errors import Error
from ._live import end_live

joined: weakref.WeakSet[_palpate._Session] = weakref.WeakSet()
serving: weakref.WeakSet[_palpate._Server] = weakref.WeakSet()


def _forget_joined() -> None:
    joined.clear()


os.register_at_fork(after_in_child=_forget_joined)  # they belong to the parent


atexit.register(_palpate._end_gil)


@atexit.register
def _close_servers() -> None:
    for server in list(serving):
        server.close()


@atexit.register  # the last one registered is called first
def _end_sessions() -> None:
    end_live()
    for session in list(joined):
        with contextlib.suppress(Error):  # the program has ended
            session.close()
