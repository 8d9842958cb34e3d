"""Cost of importing palpate, and how its modules import one another."""

from __future__ import annotations

import ast
import graphlib
import resource
import subprocess
import sys
from pathlib import Path

import palpate as pp
import pytest


def processor_seconds(program: str) -> float:
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run([sys.executable, "-c", program], check=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def test_an_import_takes_less_than_that_of_numpy_which_it_leaves_for_later():
    # A busy machine makes all three take longer. So they run in turn, and the least of each is compared.
    programs = ("pass", "import palpate", "import numpy")
    bare, own, numpy = (min(times) for times in zip(*([processor_seconds(p) for p in programs] for _ in range(5))))
    assert own - bare < numpy - bare
    subprocess.run([sys.executable, "-c", "import palpate, sys; assert 'numpy' not in sys.modules"], check=True)


def imported_modules(program: str) -> set[str]:
    """Modules of the package that one of its modules imports, also for type checkers or within a function."""
    found: set[str] = set()
    for node in ast.walk(ast.parse(program)):
        if isinstance(node, ast.ImportFrom) and node.level == 1:
            found |= {node.module} if node.module else {each.name for each in node.names}
    return found


def test_the_modules_of_the_package_import_one_another_without_a_circle():
    modules = {file.stem: imported_modules(file.read_text()) for file in Path(pp.__file__).parent.glob("*.py*")}
    assert {"_live", "_sharing"} <= modules["_session"] and modules["_live"] >= {"_errors", "_types"}
    order = list(graphlib.TopologicalSorter(modules).static_order())  # raises CycleError with the circle
    assert order[-1] == "__init__" and set(order) == set(modules)


def test_a_circle_that_only_type_checkers_follow_is_found():
    modules = {"_a": imported_modules("from ._b import B"),
               "_b": imported_modules("if TYPE_CHECKING:\n    from . import _a")}
    with pytest.raises(graphlib.CycleError):
        graphlib.TopologicalSorter(modules).prepare()
