"""The words of the type hints are those that the library accepts."""

from __future__ import annotations

import re
from typing import Any, Callable, get_args

import numpy as np
import palpate as pp
import pytest
from palpate import _types

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
        assert words_in_error(lambda: session.stroke(path, wrong)) == set(get_args(_types.BrushKind))
        assert words_in_error(lambda: session.set_brush(wrong)) == set(get_args(_types.BrushKind))
        assert words_in_error(lambda: session.mesh(surface=wrong)) == set(get_args(_types.MeshSurface))
        assert words_in_error(lambda: session.render(color=wrong)) == set(get_args(_types.ColorBy))
        assert words_in_error(lambda: session.live(builtin=wrong)) == set(get_args(_types.BuiltinPath)) - {"stir"}
