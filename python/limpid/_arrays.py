"""Arguments as arrays, with errors that name the argument and the remedy."""

from __future__ import annotations

from collections.abc import Iterable
from os import PathLike
from typing import Any

import numpy as np
from numpy.typing import NDArray

IntLike = Any
FloatLike = Any


def one_dimensional(values: Any, name: str) -> NDArray[Any]:
    """``values`` as an array of one dimension."""
    if np.ma.is_masked(values):
        raise ValueError(
            f"{name}: has masked rows; fill them with array.filled(value), or remove them from all columns and pass t"
        )
    try:
        array = np.asarray(values)
    except ValueError as error:
        raise ValueError(f"{name}: not an array of numbers: {error}") from None
    if array.ndim == 0 and not isinstance(values, np.ndarray):
        file = "; limpid.read_log reads a file" if isinstance(values, (str, PathLike)) else ""
        raise ValueError(f"{name}: has the type {type(values).__name__}; pass an array or a list{file}")
    if array.ndim != 1:
        raise ValueError(
            f"{name}: has the shape {array.shape}; pass one dimension, for example array.ravel() or one column"
        )
    return array


def as_number(value: Any, name: str, unit: str) -> float:
    """A positive and finite number."""
    try:
        # A text is no number, although float() reads it.
        number = None if isinstance(value, (str, bytes)) else float(value)
    except (TypeError, ValueError):
        number = None
    except OverflowError:
        number = float("inf")
    if number is None:
        raise TypeError(f"{name}: has the type {type(value).__name__}; pass a number ({unit})")
    if not (number > 0 and np.isfinite(number)):
        raise ValueError(f"{name}={value}: must be positive and finite ({unit})")
    return number


def _is_integer(value: Any) -> bool:
    # A bool is an int of Python.
    return isinstance(value, (int, np.integer)) and not isinstance(value, bool)


def _integers(array: NDArray[Any], name: str) -> str:
    """What to pass in the place of an array of another type."""
    wrong = np.zeros(len(array), dtype=bool)
    if array.dtype.kind == "f":
        wrong = ~np.isfinite(array)
    elif array.dtype.kind == "O":
        wrong = np.array([not _is_integer(value) for value in array])
    if wrong.any():
        row = int(np.argmax(wrong))
        return (
            f", and row {row} is {array[row]}; pass integers: fill such rows, or remove them from all columns and "
            "pass t"
        )
    example = f", for example numpy.rint({name}).astype(numpy.int64)" if array.dtype.kind == "f" else ""
    return f"; pass integers{example}"


def as_counts(values: IntLike, name: str) -> NDArray[np.uint32]:
    """Integers of any type modulo 2^32."""
    if isinstance(values, (list, tuple)) and all(map(_is_integer, values)):
        # Of integers beyond 63 bits NumPy would make floats, which do not have all of their digits.
        values = np.array(values, dtype=object)
    array = one_dimensional(values, name)
    if array.size == 0:
        raise ValueError(f"{name}: is empty; pass at least one row")
    if array.dtype.kind == "O" and all(map(_is_integer, array)):
        array = np.array([int(value) & 0xFFFFFFFF for value in array], dtype=np.uint32)
    if array.dtype.kind not in "iu":
        raise ValueError(f"{name}: has the type {array.dtype}{_integers(array, name)}")
    return np.require(array.astype(np.uint32, copy=False), requirements=["C", "A"])


def as_floats(values: FloatLike, name: str, unit: str, *, nan: bool = False) -> NDArray[np.float64]:
    """Finite numbers; with ``nan``, also NaN."""
    array = one_dimensional(values, name)
    if array.dtype.kind not in "iuf":
        dates = array.dtype.kind in "mM" and name == "t"
        example = f", for example ({name} - {name}[0]) / numpy.timedelta64(1, 's')" if dates else ""
        raise ValueError(f"{name}: has the type {array.dtype}; pass real numbers ({unit}){example}")
    array = np.require(array, dtype=np.float64, requirements=["C", "A"])
    wrong = np.isinf(array) if nan else ~np.isfinite(array)
    if wrong.any():
        row = int(np.argmax(wrong))
        raise ValueError(
            f"{name}: row {row} is {array[row]}; remove the row, or fill it with a finite number ({unit})"
        )
    return array


def as_names(values: Any, name: str, example: str) -> list[str]:
    """A name or several as a list."""
    if isinstance(values, str):
        return [values]
    names = list(values) if isinstance(values, Iterable) else [values]
    for value in names:
        if not isinstance(value, str):
            raise TypeError(f"{name}: has the type {type(value).__name__}; pass {example}")
    return names


def same_rows(columns: dict[str, NDArray[Any] | None]) -> None:
    """Checks that all columns have the rows of the first one."""
    names = [name for name, column in columns.items() if column is not None]
    first = columns[names[0]]
    assert first is not None
    for name in names[1:]:
        column = columns[name]
        if column is not None and len(column) != len(first):
            raise ValueError(
                f"{name}: has {len(column)} rows where {names[0]} has {len(first)}; pass columns of equal length"
            )


def rows(
    counts: IntLike,
    coupled: IntLike | None,
    current: FloatLike | None,
    edge_age: FloatLike | None,
    edge_boundary: IntLike | None,
) -> dict[str, Any]:
    """The columns that an estimator reads."""
    if (edge_age is None) != (edge_boundary is None):
        raise ValueError("edge_age and edge_boundary: pass both or neither")
    columns: dict[str, Any] = {
        "counts": as_counts(counts, "counts"),
        "coupled": None if coupled is None else as_counts(coupled, "coupled"),
        "current": None if current is None else as_floats(current, "current", "A"),
        "edge_age": None if edge_age is None else as_floats(edge_age, "edge_age", "s", nan=True),
        "edge_boundary": None if edge_boundary is None else as_counts(edge_boundary, "edge_boundary"),
    }
    age = columns["edge_age"]
    if age is not None and (age < 0).any():
        row = int(np.argmax(age < 0))
        raise ValueError(f"edge_age: row {row} is {age[row]}; the age of an edge is not negative (s)")
    same_rows(columns)
    return columns
