"""Messages for calls with wrong arguments, instead of those of Python and pybind11."""

from __future__ import annotations

import ast
import functools
import inspect
import math
import re
import types
from typing import Any, Callable, NamedTuple

from . import _palpate, _types
from ._errors import (
    ArgumentTypeError,
    Error,
    described,
    missing_attribute,
    nearest,
    session_options,
    takes_session_options,
)

_PYBIND = ("incompatible function arguments", "incompatible constructor arguments", "Unable to cast")


class _Parameter(NamedTuple):
    name: str
    by_place: bool
    required: bool
    type: str  # as in an annotation; "" if unknown


def _of_brush(known: set[str]) -> list[_Parameter]:
    return [_Parameter(name, False, False, "") for name in _palpate._brush_settings() if name not in known]


def _of_python(function: Callable[..., Any]) -> list[_Parameter]:
    found: list[_Parameter] = []
    for each in inspect.signature(function).parameters.values():
        if takes_session_options(each):
            found += [_Parameter(name, False, False, kind) for name, kind in session_options().items()]
        elif each.kind is each.VAR_KEYWORD:
            found += _of_brush({before.name for before in found})
        elif each.name not in ("self", "cls"):
            required = each.default is each.empty
            kind = each.annotation if isinstance(each.annotation, str) else ""
            found.append(_Parameter(each.name, each.kind is not each.KEYWORD_ONLY, required, kind))
    return found


def _of_pybind(signature: str) -> list[_Parameter]:
    """Parameters of a signature such as "(self: Session, steps: int = 1, **kwargs) -> int"."""
    inner = re.match(r"[^(]*\((.*?)\)(?: -> .*)?$", signature)
    parts, depth = [""], 0
    for c in inner.group(1) if inner else "":
        depth += (c in "([{") - (c in ")]}")
        if c == "," and depth == 0:
            parts.append("")
        else:
            parts[-1] += c
    found: list[_Parameter] = []
    for part in parts:
        declared, _, default = part.strip().partition(" = ")
        name, _, kind = declared.partition(": ")
        if name.startswith("**"):
            found += _of_brush({before.name for before in found})
        elif name and name != "self":
            found.append(_Parameter(name, True, not default, kind))
    return found


def _is_number(value: object) -> bool:
    return hasattr(value, "__float__") or hasattr(value, "__index__")


def _is_whole(value: object) -> bool:
    return hasattr(value, "__index__")


_KINDS: dict[str, tuple[str, Callable[[Any], bool]]] = {
    "float": ("a number", _is_number),
    "int": ("a whole number", _is_whole),
    "str": ("a text", lambda value: isinstance(value, str)),
    "bool": ("True or False", lambda value: type(value).__name__ in ("bool", "bool_")),
    "None": ("None", lambda value: value is None),
    "Cloud": ("a Cloud", lambda value: isinstance(value, _palpate.Cloud)),
    "Tuple[int, int]": ("two whole numbers", lambda value: _is_row(value, 2, lambda n: _is_whole(n) and n >= 0)),
    "List[float[3]]": ("three numbers", lambda value: _is_row(value, 3, _is_number)),
    "List[float[4]]": ("four numbers", lambda value: _is_row(value, 4, _is_number)),
    "List[int[3]]": (
        "three whole numbers from 0 to 255",
        lambda value: _is_row(value, 3, lambda n: _is_whole(n) and 0 <= n <= 255),
    ),
}


_KINDS.update({name: _KINDS["str"] for name in _types.__all__ if name != "SessionOptions"})
_KINDS["Sequence[float]"] = _KINDS["List[float[3]]"]  # of a keyword: an axis


def _is_row(value: Any, count: int, fits: Callable[[Any], bool]) -> bool:
    return not isinstance(value, str) and hasattr(value, "__len__") and len(value) == count and all(map(fits, value))


def _wrong_type(parameter: _Parameter, value: object) -> str | None:
    """Describes the wrong type of an argument; None if it fits, or if that is unknown."""
    kind = re.sub(r"^Optional\[(.*)\]$", r"\1 | None", re.sub(r"[\w.]+\.", "", parameter.type))
    kinds = [_KINDS.get(each) for each in kind.split(" | ")]
    known = [each for each in kinds if each is not None]
    if len(known) < len(kinds) or any(fits(value) for _, fits in known):
        return None
    return f"{parameter.name} must be {' or '.join(words for words, _ in known)}, not {described(value)}"


def _misfit(parameters: list[_Parameter], args: tuple[Any, ...], settings: dict[str, Any]) -> str | None:
    """Describes what is wrong with a call; None if nothing is known to be wrong."""
    names = [each.name for each in parameters]
    takes = f"it takes {', '.join(names)}" if names else "it takes no arguments"
    for name in settings:
        if name not in names:
            return f"there is no argument '{name}'{nearest(name, names) or ';'} {takes}".replace("? it", "? It")
    places = [each for each in parameters if each.by_place]
    if len(args) > len(places):
        by_name = " by position, the others by name" if len(places) < len(names) else ""
        return f"takes {len(places)} arguments{by_name}, and {len(args)} are given; {takes}"
    given = {each.name: value for each, value in zip(places, args)}
    for name in settings:
        if name in given:
            return f"{name} is given twice"
    given.update(settings)
    for each in parameters:
        if each.required and each.name not in given:
            return f"{each.name} is missing; {takes}"
    for each in parameters:
        if each.name in given:
            wrong = _wrong_type(each, given[each.name])
            if wrong:
                return wrong
    for each in parameters:
        value = given.get(each.name)
        if each.type == "int" and value is not None and value < 0:
            return f"{each.name} must be a whole number of 0 or more, not {value}"
        if each.type == "int" and value is not None and value >= 1 << 32:
            return f"{each.name} is too large"
    return None


def _open_arguments(function: Callable[..., Any], is_bound: bool) -> list[_Parameter]:
    """Parameters of a function with **brush or **options, including those; empty for other functions."""
    if not is_bound:
        kinds = {each.kind for each in inspect.signature(function).parameters.values()}
        return _of_python(function) if inspect.Parameter.VAR_KEYWORD in kinds else []
    usage = (function.__doc__ or "").partition("\n")[0]
    return _of_pybind(usage) if "**brush" in usage else []


def _signature_of(function: Callable[..., Any], is_method: bool) -> inspect.Signature | None:
    """As the first line of its docstring has it; None without one. Functions of pybind11 have none of their own."""
    usage = " ".join((function.__doc__ or "").partition("\n\n")[0].split())
    found = re.fullmatch(r"\w+\((.*)\)(?: -> .*)?", usage)
    if found is None:
        return None
    try:
        definition = ast.parse(f"def f({found[1]}): ...").body[0]
    except SyntaxError:
        return None
    assert isinstance(definition, ast.FunctionDef)
    given = definition.args
    kind = inspect.Parameter
    named = [(each.arg, kind.POSITIONAL_OR_KEYWORD) for each in given.args]
    defaults: list[Any] = [kind.empty] * (len(named) - len(given.defaults))
    defaults += [math.inf if ast.unparse(each) == "inf" else ast.literal_eval(each) for each in given.defaults]
    parameters = [kind("self", kind.POSITIONAL_ONLY)] if is_method else []
    parameters += [kind(arg, how, default=default) for (arg, how), default in zip(named, defaults)]
    if given.kwarg is not None:
        parameters.append(kind(given.kwarg.arg, kind.VAR_KEYWORD))
    return inspect.Signature(parameters)


def _in_words(name: str, function: Callable[..., Any], is_method: bool, is_bound: bool) -> Callable[..., Any]:
    known_first = _open_arguments(function, is_bound)

    def known(text: str) -> list[_Parameter]:
        if not is_bound:
            return _of_python(function)
        signatures = re.findall(r"^ +1\. (.*)$", text, re.M)
        return _of_pybind(signatures[0]) if signatures else []

    def called(args: tuple[Any, ...]) -> str:
        if name == "__init__":
            return type(args[0]).__name__
        return f"{args[0].__name__}.{name}" if is_method and isinstance(args[0], type) else name

    def told(text: str, args: tuple[Any, ...], settings: dict[str, Any]) -> str | None:
        by_pybind = any(words in text for words in _PYBIND)
        if is_bound and not by_pybind:  # raised by a function of the user that it called
            return None
        given = args[is_method:]
        wrong = _misfit(known(text), given, settings)
        if wrong is None and by_pybind:
            kinds = [described(each) for each in given]
            kinds += [f"{key}={described(each)}" for key, each in settings.items() if each is not None]
            wrong = f"its arguments do not fit: {', '.join(kinds)}"
        if wrong is None or called(args).startswith("_"):  # a private name is not the one that the user called
            return wrong
        return f"{called(args)}(): {wrong}"

    @functools.wraps(function)
    def call(*args: Any, **settings: Any) -> Any:
        wrong = None
        try:
            if known_first:  # the function itself accepts any name
                wrong = _misfit(known_first, args[is_method:], settings)
            if wrong is None:
                return function(*args, **settings)
            wrong = f"{called(args)}(): {wrong}"
        except (TypeError, RuntimeError) as error:
            if not isinstance(error, Error):
                wrong = told(str(error), args, settings)
            if wrong is None:
                raise
        raise ArgumentTypeError(wrong)

    if is_bound and not name.startswith("_") and (signature := _signature_of(function, is_method)):
        call.__signature__ = signature  # type: ignore[attr-defined]
    return call


def say_of_bound(owner: Any) -> None:
    """Wraps all functions and methods of a pybind11 module or class."""
    for name, each in list(vars(owner).items()):
        is_method = str(type(each)) == "<class 'instancemethod'>"
        if is_method or isinstance(each, types.BuiltinFunctionType):
            setattr(owner, name, _in_words(name, each, is_method, True))
        elif isinstance(each, type) and each.__module__ == _palpate.__name__:
            each.__getattr__ = missing_attribute  # type: ignore[attr-defined]
            say_of_bound(each)


def say_of_python(thing: Any) -> Any:
    """Wraps a function, or the methods of a class in place; returns the function or class."""
    if isinstance(thing, types.FunctionType):
        return _in_words(thing.__name__, thing, False, False)
    for name, each in list(vars(thing).items()):
        if isinstance(each, types.FunctionType) and (name == "__init__" or not name.startswith("_")):
            setattr(thing, name, _in_words(name, each, True, False))
        elif isinstance(each, classmethod) and not name.startswith("_"):
            setattr(thing, name, classmethod(_in_words(name, each.__func__, True, False)))
    return thing


say_of_bound(_palpate)
