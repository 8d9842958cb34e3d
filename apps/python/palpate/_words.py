"""Arguments that do not fit, in palpate's words in place of pybind11's; read before anything takes what it binds."""

from __future__ import annotations

import functools
import types
from typing import Any, Callable

from . import _palpate
from ._errors import ArgumentTypeError, Error

_PYBIND = ("incompatible function arguments", "incompatible constructor arguments", "Unable to cast")


def _in_words(name: str, function: Callable[..., Any], is_method: bool) -> Callable[..., Any]:
    usage = (function.__doc__ or "").partition("\n")[0]

    @functools.wraps(function)
    def call(*args: Any, **settings: Any) -> Any:
        try:
            return function(*args, **settings)
        except (TypeError, RuntimeError) as error:
            if isinstance(error, Error) or not any(words in str(error) for words in _PYBIND):
                raise
            given = [type(each).__name__ for each in args[is_method:]]
            given += [f"{key}={type(each).__name__}" for key, each in settings.items() if each is not None]
            called = type(args[0]).__name__ if name == "__init__" else name
            known = f" of {usage}" if usage.startswith(called) else ""
            told = f"{called}(): arguments{known} do not fit what it takes; given: {', '.join(given) or 'none'}"
        raise ArgumentTypeError(told)

    return call


def _say(owner: Any) -> None:
    for name, each in list(vars(owner).items()):
        is_method = str(type(each)) == "<class 'instancemethod'>"
        if is_method or isinstance(each, types.BuiltinFunctionType):
            setattr(owner, name, _in_words(name, each, is_method))
        elif isinstance(each, type) and each.__module__ == _palpate.__name__:
            _say(each)


_say(_palpate)
