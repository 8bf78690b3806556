"""Estimators over recordings, and the reader of logs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from os import PathLike
from typing import Any, SupportsIndex

import numpy as np
from numpy.typing import NDArray

from . import _arrays, _limpid
from ._recording import Recording


@dataclass(frozen=True, eq=False)
class Replay:
    """What an estimator reports at each row of a recording.

    At the first row the estimator starts: the velocity is 0 and its standard deviation 0.
    """

    #: Name of the estimator.
    estimator: str
    #: Rate of the rows, Hz.
    rate: float
    #: Velocity, rad/s.
    velocity: NDArray[np.float32]
    #: Standard deviation of the velocity, rad/s; None if the estimator reports none.
    std_dev: NDArray[np.float32] | None
    #: Acceleration, rad/s^2; None if the estimator reports none.
    acceleration: NDArray[np.float32] | None
    #: Learned damping of the coupler over the assumed one; None if the estimator does not learn it.
    damping_ratio: NDArray[np.float32] | None
    #: Values of the parameters by name.
    parameters: dict[str, float]
    #: What was converted, and whether the parameters were tuned for another encoder or rate.
    notes: list[str]
    _times: NDArray[np.float64] | None = field(repr=False)

    @property
    def t(self) -> NDArray[np.float64]:
        """Time of each row, s."""
        return np.arange(len(self.velocity)) / self.rate if self._times is None else self._times


def replay(
    counts: _arrays.IntLike | Recording,
    rate: float | None = None,
    *,
    t: _arrays.FloatLike | None = None,
    counts_per_rev: SupportsIndex | None = None,
    estimator: str = "imm",
    current: _arrays.FloatLike | None = None,
    coupled: _arrays.IntLike | None = None,
    edge_age: _arrays.FloatLike | None = None,
    edge_boundary: _arrays.IntLike | None = None,
    parameters: Mapping[str, float] | None = None,
    presets: str | PathLike[str] | None = None,
    device: str | PathLike[str] | dict[str, Any] | None = None,
    resample: float | None = None,
) -> Replay:
    """Runs an estimator over counts, as ``cargo sim replay`` does, and returns its velocity.

    Parameters
    ----------
    counts
        A :class:`Recording`, or its counts: integers of any type, taken modulo 2^32.
    rate, t
        Rate of the rows, Hz, or the time of each row, s.
    counts_per_rev
        Counts per revolution of the encoder [default: those in the device file, otherwise those of the
        recording, otherwise 4096].
    estimator
        Name of the estimator, see :func:`estimators`.
    current, coupled, edge_age, edge_boundary
        Signals that some estimators need, as of :class:`Recording`.
    parameters
        Values of parameters by name; they replace the tuned ones, which are scaled to the encoder and the
        rate.
    presets
        Path of a file of tuned parameters, as :func:`tune` writes it.
    device
        Path of a device file (TOML), or a dict with its sections; estimators with a model of the motor
        need it.
    resample
        Replace the rows by rows at this rate, Hz: for estimators that need a constant period.

    Raises
    ------
    ValueError
        An argument is wrong; the message names it and the remedy.
    """
    if isinstance(counts, Recording):
        given = (rate, t, current, coupled, edge_age, edge_boundary)
        if any(argument is not None for argument in given):
            raise ValueError("rate, t, current, coupled, edge_age, edge_boundary: the recording has its own; leave them out")
        recording = counts
        recording._check()
    else:
        recording = Recording(
            counts,
            rate,
            t=t,
            current=current,
            coupled=coupled,
            edge_age=edge_age,
            edge_boundary=edge_boundary,
        )
    # Times are made when they are read.
    reports, times, rate, values, notes = _limpid.replay(
        recording,
        estimator,
        counts_per_rev,
        parameters,
        presets,
        device,
        resample,
    )
    velocity, std_dev, acceleration, damping_ratio = reports
    return Replay(
        estimator=estimator,
        rate=rate,
        velocity=velocity,
        std_dev=std_dev,
        acceleration=acceleration,
        damping_ratio=damping_ratio,
        parameters=values,
        notes=notes,
        _times=_copied(recording._t) if times is None else np.asarray(times),
    )


def _copied(times: NDArray[np.float64] | None) -> NDArray[np.float64] | None:
    """Times that stay when those of the recording are changed."""
    return None if times is None else times.copy()


Columns = Mapping[str, str | int] | Sequence[str] | str
"""The type of ``columns``."""

Modulus = SupportsIndex | Mapping[str, SupportsIndex] | None
"""The type of ``modulus``."""



def read_log(
    path: str | PathLike[str],
    *,
    columns: Columns = (),
    modulus: Modulus = None,
    row_rate: float | None = None,
    drop_stale: bool = False,
    resample: float | None = None,
    counts_per_rev: SupportsIndex | None = None,
    device: str | PathLike[str] | dict[str, Any] | None = None,
) -> Recording:
    """Reads a log as the commands of this project read it.

    Its own columns are ``t`` (s) and ``counts_large``; optional are ``counts_small``, ``current`` (A),
    ``edge_tick``, ``edge_bound`` and ``true_omega`` (rad/s). Logs of moteus, ODrive, VESC Tool, SimpleFOC
    and PlotJuggler are read by their own names.

    Parameters
    ----------
    columns
        Other names of columns, with their units: ``{"t": "time_ms:ms", "counts_large": "angle:deg"}``.
    modulus
        Counts at which an absolute encoder wraps; ``{"counts_small": 4096}`` for the other encoder.
    row_rate
        Rate of the rows, Hz, for a log without a column of time.
    drop_stale
        Leave out rows in which the position stays in a fast motion, as where a bus lost a message.
    resample
        Replace the rows by rows at this rate, Hz.
    counts_per_rev
        Counts per revolution [default: those in the device file, otherwise those that the log states,
        otherwise 4096, with a note].
    device
        Path of a device file (TOML), or a dict with its sections.

    Raises
    ------
    ValueError
        The log cannot be read; the message names its line and its column.
    OSError
        The file cannot be opened.
    """
    names, moduli = column_options(columns, modulus)
    fields = _limpid.read_log(path, names, moduli, row_rate, drop_stale, resample, counts_per_rev, device)
    return Recording(**fields)


def column_options(columns: Columns, modulus: Modulus) -> tuple[list[str], list[str]]:
    """The options ``--column`` and ``--modulus`` of the commands."""
    if isinstance(columns, Mapping):
        columns = [f"{ours}={theirs}" for ours, theirs in columns.items()]
    else:
        columns = _arrays.as_names(columns, "columns", "a dict, for example {'t': 'time_ms:ms'}")
    if isinstance(modulus, Mapping):
        moduli = [f"{column}={number}" for column, number in modulus.items()]
    else:
        moduli = [] if modulus is None else [str(modulus)]
    return columns, moduli
