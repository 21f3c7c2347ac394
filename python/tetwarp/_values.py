"""Checks of arguments that are no arrays: numbers, words, names of files, functions; every error names
the argument, what it is and what it should be."""

from __future__ import annotations

import operator
import os
import sys
import warnings
from collections.abc import Sequence
from itertools import chain
from typing import Any

import numpy as np

_MOST_AXES = 64  # of an array of NumPy
_NUMBERS = {int, float, bool, complex}


def shown(value: Any) -> str:
    """What was given, on one line, for messages."""
    text = " ".join(repr(value).split())
    return text if len(text) <= 200 else f"{text[:200]}..."


def _is_list(kind: type) -> bool:
    return issubclass(kind, Sequence) and not issubclass(kind, (str, bytes, range))


def is_masked(value: Any) -> bool:
    """Whether elements of an array, or of one in a list, are masked: NumPy would drop the mask."""
    if isinstance(value, np.ndarray):
        return np.ma.is_masked(value)
    items = value if _is_list(type(value)) else ()
    for _ in range(_MOST_AXES):  # whole levels of lists at a time, which is quick for many numbers
        kinds = set(map(type, items))
        if kinds <= _NUMBERS:
            return False
        if any(issubclass(kind, np.ma.MaskedArray) for kind in kinds) and any(
                isinstance(item, np.ma.MaskedArray) and np.ma.is_masked(item) for item in items):
            return True
        lists = {kind for kind in kinds if _is_list(kind)}
        inner = items if kinds == lists else [item for item in items if type(item) in lists]
        items = list(chain.from_iterable(inner))
    return False  # NumPy refuses it


def _is_unicode(text: str) -> bool:
    try:
        text.encode()
    except UnicodeEncodeError:  # of a name that the system has in another encoding
        return False
    return True


def _is_text(value: Any) -> bool:
    """Whether the library takes it as a text: one of Unicode, without a zero, which would end it."""
    return isinstance(value, str) and "\0" not in value and _is_unicode(value)


def word_of(value: Any, name: str) -> str:
    """A word; which ones there are is checked by the library."""
    if not _is_text(value):
        raise ValueError(f"{name}: expected a word, got {shown(value)}")
    return value


def path_of(value: Any, name: str = "path") -> str:
    """The name of a file."""
    path = os.fsdecode(value) if isinstance(value, (bytes, os.PathLike)) else value
    if not _is_text(path) or not path:
        raise ValueError(f"{name}: expected the name of a file in UTF-8, got {shown(value)}")
    return path


def check_callback(value: Any, name: str) -> None:
    """Raises ValueError for what is neither a function nor None."""
    if value is not None and not callable(value):
        raise ValueError(f"{name}: expected a function, got {shown(value)}")


def check_kind(value: Any, kind: type, name: str) -> None:
    """Raises ValueError for what is not of a class of this package."""
    if not isinstance(value, kind):
        raise ValueError(f"{name}: expected a {kind.__name__}, got {type(value).__name__}")


def list_of(values: Any, name: str, what: str) -> list[Any]:
    """The items of a list or of anything that gives them."""
    try:
        return list(values)
    except TypeError:
        raise ValueError(f"{name}: expected {what}, got {shown(values)}") from None


def number_of(value: Any, name: str) -> float:
    """A number: no text, and no complex one, whose imaginary part would be lost."""
    if type(value) is float:
        return value
    try:
        if not isinstance(value, (int, float)):
            if isinstance(value, (str, bytes, bytearray)) or is_masked(value) or np.ndim(value):
                raise TypeError
            value = value.item() if isinstance(value, (np.ndarray, np.generic)) else value
        return float(value)
    except (TypeError, ValueError, OverflowError):
        raise ValueError(f"{name}: expected a number, got {shown(value)}") from None


def exact_of(value: Any, name: str) -> float:
    """A number to which samples are compared: a whole one that float64 would round is refused."""
    number = number_of(value, name)
    if isinstance(value, np.ndarray):
        value = value.item()
    if isinstance(value, (int, np.integer)) and int(number) != value:
        raise ValueError(f"{name}: expected a number that float64 holds, got {value}")
    return number


def integer_of(value: Any, name: str, most: int = 2**31 - 1) -> int:
    """A whole number up to `most`, and not below its negative; one with a fraction is refused, not
    cut.
    """
    try:
        if type(value) is not int and is_masked(value):
            raise TypeError
        number = operator.index(value)
    except TypeError:
        raise ValueError(f"{name}: expected a whole number, got {shown(value)}") from None
    if not -most <= number <= most:
        raise ValueError(f"{name}: expected a whole number up to {most}, got {number}")
    return number


def warn(text: str) -> None:
    """Gives a RuntimeWarning at the line that called the package."""
    level, frame = 1, sys._getframe()
    while frame.f_back and frame.f_globals.get("__name__", "").startswith(f"{__package__}."):
        level, frame = level + 1, frame.f_back
    warnings.warn(text, RuntimeWarning, stacklevel=level)


def flag_of(value: Any, name: str) -> bool:
    """True or False, also of NumPy; of anything else, such as a text, Python would make one."""
    if not isinstance(value, (bool, np.bool_)):
        raise ValueError(f"{name}: expected True or False, got {shown(value)}")
    return bool(value)
