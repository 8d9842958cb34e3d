"""The words of the type hints are those that the library accepts."""

from __future__ import annotations

import ast
import inspect
import json
import os
import re
import subprocess
import tempfile
from pathlib import Path
from typing import Any, Callable, get_args

import numpy as np
import palpate as pp
import pytest
from palpate import _palpate, _types

SAYS = re.compile(r"(?:choose one of|one of|there is|there are|choose) ([\w, :-]+)")


def words_in_error(call: Callable[[], Any]) -> set[str]:
    """The valid words, as the error about an invalid one lists them."""
    with pytest.raises(pp.Error) as caught:
        call()
    said = SAYS.findall(str(caught.value))
    assert said, str(caught.value)
    return {word.strip().removeprefix("builtin:") for word in said[-1].split(",")}


def test_each_hint_lists_exactly_the_words_that_the_library_accepts(ball: pp.Cloud) -> None:
    wrong: Any = "wrong"
    path = np.zeros((2, 3))
    with pp.Session(ball, gpu="cpu") as session:
        assert words_in_error(lambda: pp.Session(ball, gpu="cpu", surface=wrong)) == set(get_args(_types.SurfaceKind))
        assert words_in_error(lambda: session.touch(path, surface=wrong)) == set(get_args(_types.SurfaceKind))
        assert words_in_error(lambda: pp.Session(ball, gpu="cpu", tool=wrong)) == set(get_args(_types.ToolKind))
        assert words_in_error(lambda: pp.Session(ball, backend=wrong)) == set(get_args(_types.Backend))
        assert words_in_error(lambda: session.stroke(path, wrong)) == set(get_args(_types.BrushKind))
        assert words_in_error(lambda: session.mask(wrong)) == set(get_args(_types.MaskKind))
        assert words_in_error(lambda: session.set_brush(wrong)) == set(get_args(_types.BrushKind))
        assert words_in_error(lambda: session.mesh(surface=wrong)) == set(get_args(_types.MeshSurface))
        assert words_in_error(lambda: session.render(color_map=wrong)) == set(get_args(_types.ColorMap))
        assert words_in_error(lambda: session.render(material=wrong)) == set(get_args(_types.Material))
        assert words_in_error(lambda: session.render(cavity=wrong)) == set(get_args(_types.Switch))
        assert words_in_error(lambda: session.render(projection=wrong)) == set(get_args(_types.Projection))
        assert words_in_error(lambda: session.render(splats=wrong)) == set(get_args(_types.Splats))
        assert words_in_error(lambda: session.render(backs=wrong)) == set(get_args(_types.Backs))
        assert words_in_error(lambda: session.render(side=wrong)) == set(get_args(_types.Side))
        assert words_in_error(lambda: session.live(builtin=wrong)) == set(get_args(_types.BuiltinPath)) - {"stir"}


def table() -> dict[str, Any]:
    """Default of each setting by its path, from the program."""
    program = os.environ.get("PALPATE_PROGRAM")
    if not program:
        pytest.skip("skipped: the program is not built")
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "reference.json"
        subprocess.run([program, "reference", "--quiet", "--json", str(file)], check=True, capture_output=True)
        return {setting["key"]: setting["default"] for setting in json.loads(file.read_text())["settings"]}


KEYWORDS = {
    "surface": "surface.kind",
    "radius_mm": "surface.radius_mm",
    "friction": "surface.friction",
    "stiffness_N_per_mm": "force.stiffness_N_per_mm",
    "damping_N_s_per_mm": "force.damping_N_s_per_mm",
    "max_force_N": "force.max_N",
    "rate_Hz": "rate_Hz",
    "undo_memory_MiB": "undo.memory_MiB",
    "tool": "tool.kind",
    "tool_points": "tool.points",
    "tool_size_mm": "tool.size_mm",
    "tool_axis": "tool.axis",
}
OF_STREAMS = {
    "speed": "stream.speed",
    "loop": "stream.loop",
    "fuse": "stream.fuse",
}


def test_the_keywords_of_a_session_have_the_defaults_of_the_settings() -> None:
    defaults = table()
    described = dict(re.findall(r"^ {4}(\w+): ((?:.*\n)+?)(?= {0,4}\w|\n|\Z)", inspect.getdoc(pp.Session) or "", re.M))
    for keyword, path in KEYWORDS.items():
        said = re.search(r"\(default\s+(.+?)\)(?:\.|\s|$)", described[keyword])
        assert said, keyword
        usual, given = defaults[path], ast.literal_eval(said[1])
        assert (list(given) if isinstance(given, tuple) else given) == usual, keyword
    parameters = inspect.signature(pp.Session.of_stream).parameters
    for keyword, path in OF_STREAMS.items():
        assert parameters[keyword].default == defaults[path], keyword


def test_the_options_of_sessions_are_those_of_the_extension_each_described() -> None:
    with pytest.raises(TypeError) as refused:
        _palpate._Session(unknown=0)
    taken = set(str(refused.value).split("it takes ")[1].split(", "))
    options = set(_types.SessionOptions.__annotations__)
    assert taken == options | {"source", "gpu", "mm_per_unit"}
    said = set(re.findall(r"^ {4}(\w+): ", inspect.getdoc(pp.Session) or "", re.M))
    assert said == options | {"cloud", "gpu", "mm_per_unit", "options"}


def test_each_setting_of_a_brush_is_a_keyword_in_the_stub() -> None:
    brush = {path.removeprefix("brush.") for path in table() if path.startswith("brush.")} - {"kind"}
    assert brush <= set(_palpate._brush_settings())
    stub = (Path(pp.__file__).parent / "_palpate.pyi").read_text()
    declared = stub.split("class _BrushOptions(")[1].split("class ")[0]
    assert set(re.findall(r"^ +(\w+): ", declared, re.M)) == set(_palpate._brush_settings())
