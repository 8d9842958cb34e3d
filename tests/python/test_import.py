"""Cost of importing palpate."""

from __future__ import annotations

import resource
import subprocess
import sys


def processor_seconds(program: str) -> float:
    """Processor seconds; the minimum of several runs, since the load of the machine only adds to them."""

    def once() -> float:
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        subprocess.run([sys.executable, "-c", program], check=True)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime

    return min(once() for _ in range(5))


def test_an_import_takes_a_tenth_of_a_second_at_most_and_leaves_numpy_for_later():
    assert processor_seconds("import palpate") - processor_seconds("pass") < 0.1
    subprocess.run([sys.executable, "-c", "import palpate, sys; assert 'numpy' not in sys.modules"], check=True)
