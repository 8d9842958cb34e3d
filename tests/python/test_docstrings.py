"""Every public name has a docstring, and those of numbers give units and shapes."""

from __future__ import annotations

import inspect
import re

import palpate as pp
import pytest


def public_names():
    """Every public name of the module, and palpate's own members of its classes and their bases."""
    for name in pp.__all__:
        thing = getattr(pp, name)
        yield name, thing
        if not inspect.isclass(thing):
            continue
        for owner in thing.__mro__:
            if not owner.__module__.startswith("palpate"):
                continue
            for member, value in vars(owner).items():
                if not member.startswith("_"):
                    yield f"{name}.{member}", value


NAMES = dict(public_names())


def text_of(thing: object) -> str:
    return (inspect.getdoc(thing) or "").strip()


@pytest.mark.parametrize("name", [name for name in NAMES if not name.endswith("tick_dtype")])
def test_every_public_name_has_a_docstring(name):
    thing = NAMES[name]
    if not (callable(thing) or isinstance(thing, (property, staticmethod, classmethod))):
        return  # a value of a class; the docstring of the class describes it
    text = text_of(thing)
    assert len(text) > 10, name
    assert text != text_of(type(thing)), f"{name} has the docstring of its type"


@pytest.mark.parametrize("name, unit", [
    ("Cloud.xyz", r"\(N, 3\)"), ("Cloud.normals", r"\(N, 3\).*unit"), ("Cloud.colors", r"\(N, 4\).*0 to 255"),
    ("Cloud.origin", "model units"), ("Cloud.bounds", "file coordinates"), ("Cloud.attribute", r"\(N,\)"),
    ("Mesh.vertices", r"\(N, 3\).*model units"), ("Mesh.triangles", r"\(M, 3\).*uint32"),
    ("LawInput.t_s", "Seconds"), ("LawInput.hip", "three floats, model units"), ("LawInput.force_N", "N"),
    ("LawInput.penetration_mm", "mm")])
def test_units_and_shapes_are_said(name, unit):
    assert re.search(unit, text_of(NAMES[name])), text_of(NAMES[name])
