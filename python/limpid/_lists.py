"""What the names of arguments can be."""

from __future__ import annotations

import json
from dataclasses import dataclass
from os import PathLike
from typing import Any, SupportsIndex

from . import _limpid


@dataclass(frozen=True)
class ParameterInfo:
    """A parameter of an estimator."""

    name: str
    unit: str
    meaning: str
    lowest: float
    highest: float
    whole: bool


@dataclass(frozen=True)
class EstimatorInfo:
    """An estimator of the catalogue.

    ``needs`` has the signals that it reads besides the counts: ``current``, ``coupled``, ``edge``.
    ``varying_period`` tells whether it takes rows at uneven times.
    """

    name: str
    summary: str
    needs: tuple[str, ...]
    varying_period: bool
    parameters: tuple[ParameterInfo, ...]


def estimators() -> list[EstimatorInfo]:
    """All estimators with their parameters, units and ranges.

    >>> [e.name for e in limpid.estimators() if e.name.startswith("pll")]
    ['pll']
    """
    rows = _limpid.estimators()
    for row in rows:
        row["needs"] = tuple(row["needs"])
        row["parameters"] = tuple(ParameterInfo(**fields) for fields in row["parameters"])
    return [EstimatorInfo(**row) for row in rows]


def parameters(
    estimator: str,
    rate: float,
    *,
    counts_per_rev: SupportsIndex | None = None,
    presets: str | PathLike[str] | None = None,
    device: str | PathLike[str] | dict[str, Any] | None = None,
) -> dict[str, float]:
    """Values of the parameters of ``estimator`` at ``rate`` (Hz): the tuned ones, scaled to the encoder.

    These are the values that :func:`replay` and :class:`Estimator` use unless others are given.
    """
    return _limpid.parameters(estimator, rate, counts_per_rev, presets, device)


def scenarios() -> dict[str, str]:
    """Names and descriptions of the scenarios of :func:`simulate`."""
    return dict(_limpid.scenarios())


def device(device: str | PathLike[str] | dict[str, Any] | None = None) -> dict[str, Any]:
    """All constants of a device, with the defaults of those that are not given.

    ``device`` is the path of a device file (TOML), or a dict with its sections.
    """
    constants: dict[str, Any] = json.loads(_limpid.device(device))
    return constants
