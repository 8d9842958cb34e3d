"""Every public name has a docstring, and those of numbers give units and shapes."""

from __future__ import annotations

import inspect
import re

import palpate as pp
import pytest
from palpate import _types


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
                    yield f"{name}.{member}", value.__func__ if isinstance(value, classmethod) else value


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


def keywords_of(thing: object) -> list[str]:
    """Its keywords; for **brush and **options those of a brush and of all sessions. The compiled part gives them in the
    first line of its docstrings.
    """
    usage = re.match(r"\w+(\(.*\))", text_of(thing).partition("\n")[0])
    if usage:
        names = re.findall(r"[(,] ?(\*{0,2}[a-z]\w*)", usage[1])
    else:
        try:
            parameters = inspect.signature(thing).parameters.values()
        except ValueError:
            return []  # a compiled class that calls return
        names = [f"{'**' * (each.kind is each.VAR_KEYWORD)}{each.name}" for each in parameters]
    open_ones = {"**brush": pp._palpate._brush_settings(), "**options": list(_types.SessionOptions.__annotations__)}
    return [each for name in names if name not in ("self", "cls") for each in open_ones.get(name, [name])]


def prose_of(name: str, thing: object) -> str:
    """The docstring without its usage line, and those that it refers to, as in "as for stroke()"."""
    text = re.sub(r"^\w+\(.*", "", text_of(thing))
    owner = name.rpartition(".")[0]
    for referred in re.findall(r"(?:as for|as|As) (\w+)\(\)", text):
        known = NAMES.get(f"{owner}.{referred}") or NAMES.get(referred)
        text += text_of(known) if known is not thing else ""
    return text


@pytest.mark.parametrize("name", [
    name for name, thing in NAMES.items()
    if callable(thing) and not (inspect.isclass(thing) and issubclass(thing, (pp.Error, pp.Live)))])
def test_every_keyword_is_described(name):
    text = prose_of(name, NAMES[name])
    assert [each for each in keywords_of(NAMES[name]) if not re.search(rf"\b{each}\b", text)] == []


def test_a_keyword_without_a_description_is_found():
    def press(depth_mm: float, rate_Hz: float) -> None:
        """Presses. depth_mm: how far."""

    assert keywords_of(press) == ["depth_mm", "rate_Hz"]
    assert "rate_Hz" not in prose_of("press", press)
    assert set(keywords_of(pp.Session.stroke)) > {"path", "kind", "radius_mm", "strength"}
    assert set(keywords_of(NAMES["Session.of_frames"])) > {"cloud", "max_points", "friction", "backend"}
    assert "strength" in prose_of("Session.push", pp.Session.push)


def test_what_can_be_called_has_a_signature_with_its_defaults():
    for thing in NAMES.values():
        if callable(thing) and not inspect.isclass(thing):
            inspect.signature(thing)
    nearest = inspect.signature(pp.Session.nearest).parameters
    assert list(nearest) == ["self", "positions", "max_distance", "surface"]
    assert nearest["max_distance"].default == float("inf") and nearest["surface"].default is True
    assert inspect.signature(pp.Session.stroke).parameters["brush"].kind is inspect.Parameter.VAR_KEYWORD
