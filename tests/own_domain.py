"""Which domain of DDS a test has to itself: as own_domain.hpp has it."""

from __future__ import annotations

import fcntl
import functools
import os
import time

FIRST, COUNT = 20, 80


@functools.lru_cache(maxsize=1)
def own_domain() -> int:
    """One that no other test of this machine is on until this program ends; the same in each call."""
    for _ in range(600):
        for i in range(COUNT):
            domain = FIRST + (os.getpid() + i) % COUNT
            file = f"/tmp/palpate-tests-domain-{domain}"
            try:  # a file of another user can be locked, but not written
                lock = os.open(file, os.O_RDONLY | os.O_CLOEXEC)
            except OSError:
                try:
                    lock = os.open(file, os.O_RDWR | os.O_CREAT | os.O_CLOEXEC, 0o666)
                except OSError:
                    continue
            try:
                fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except OSError:
                os.close(lock)
                continue
            return domain
        time.sleep(0.1)
    raise RuntimeError("all domains of /tmp/palpate-tests-domain-* are in use by other tests")
