"""Recordings in memory."""

from __future__ import annotations

from collections.abc import Sequence
from typing import SupportsIndex

import numpy as np
from numpy.typing import NDArray

from . import _arrays, _limpid


class Recording:
    """Samples of an encoder with what was recorded beside them.

    Rows come at a constant ``rate`` (Hz), or at the times ``t`` (s); give one of both. With ``t`` the
    attribute ``rate`` is one over the mean of the usual steps.

    Parameters
    ----------
    counts
        Counts of the encoder: integers of any type, taken modulo 2^32, so that counters may wrap and be
        negative.
    rate, t
        Rate of the rows, 10 to 1e7 Hz, or the time of each row, s.
    current
        Current of the motor from each row to the next, A.
    coupled
        Counts of the encoder of the small motor behind the coupler.
    edge_age, edge_boundary
        Age of the latest edge of the encoder at each row, s (NaN before the first edge), and the boundary
        that it crossed: boundary ``e`` lies between the counts ``e - 1`` and ``e``.
    true_velocity
        Velocity that scores are against, rad/s.
    current_small
        Current of the small motor, A. No estimator reads it.
    counts_per_rev
        Counts per revolution of the encoder: four times the lines of a quadrature encoder.
    name
        Name in messages.
    notes
        What the reader of a log said: conversions, missing rows.
    """

    def __init__(
        self,
        counts: _arrays.IntLike,
        rate: float | None = None,
        *,
        t: _arrays.FloatLike | None = None,
        current: _arrays.FloatLike | None = None,
        coupled: _arrays.IntLike | None = None,
        edge_age: _arrays.FloatLike | None = None,
        edge_boundary: _arrays.IntLike | None = None,
        true_velocity: _arrays.FloatLike | None = None,
        current_small: _arrays.FloatLike | None = None,
        counts_per_rev: SupportsIndex | None = None,
        name: str = "recording",
        notes: Sequence[str] = (),
    ) -> None:
        self.counts: NDArray[np.uint32] = counts
        self.coupled: NDArray[np.uint32] | None = coupled
        self.current: NDArray[np.float64] | None = current
        self.edge_age: NDArray[np.float64] | None = edge_age
        self.edge_boundary: NDArray[np.uint32] | None = edge_boundary
        self.true_velocity: NDArray[np.float64] | None = true_velocity
        self.current_small: NDArray[np.float64] | None = current_small
        self._t: NDArray[np.float64] | None = t
        self.name = name
        self.notes = _arrays.as_names(notes, "notes", "lines of text")
        self.counts_per_rev = None if counts_per_rev is None else _limpid.checked_counts_per_rev(counts_per_rev)
        self._check_columns()
        if (rate is None) == (self._t is None):
            raise ValueError("rate and t: pass one of them: the rate of the rows (Hz), or the time of each row (s)")
        if self._t is not None:
            rate = _limpid.clock(self._t, name)
        assert rate is not None
        self.rate = rate
        self._check_numbers()
        self._rate_of_t = None if self._t is None else self.rate

    def _check(self) -> None:
        """Checks the attributes, some of which a user may have replaced."""
        self._check_columns()
        self._check_numbers()
        if self._rate_of_t is not None and self.rate != self._rate_of_t:
            raise ValueError(
                f"rate={self.rate}: the rows have times, which are {self._rate_of_t} Hz; leave the rate as it is, or "
                "make a Recording with this rate in the place of t"
            )

    def _check_columns(self) -> None:
        if not isinstance(self.name, str):
            raise TypeError(f"name: has the type {type(self.name).__name__}; pass a str")
        columns = _arrays.rows(self.counts, self.coupled, self.current, self.edge_age, self.edge_boundary)
        for name, column, unit in (
            ("true_velocity", self.true_velocity, "rad/s"),
            ("current_small", self.current_small, "A"),
            ("t", self._t, "s"),
        ):
            columns[name] = None if column is None else _arrays.as_floats(column, name, unit)
        _arrays.same_rows(columns)
        self._t = columns.pop("t")
        vars(self).update(columns)

    def _check_numbers(self) -> None:
        self.rate = _arrays.as_number(self.rate, "rate", "Hz")
        if self.counts_per_rev is not None:
            self.counts_per_rev = _limpid.checked_counts_per_rev(self.counts_per_rev)

    @property
    def t(self) -> NDArray[np.float64]:
        """Time of each row, s."""
        return np.arange(len(self.counts)) / self.rate if self._t is None else self._t

    def __len__(self) -> int:
        return len(self.counts)

    def __repr__(self) -> str:
        optional = ("current", "coupled", "edge_age", "true_velocity")
        there = ", ".join(name for name in optional if getattr(self, name) is not None)
        return f"<limpid.Recording {self.name}: {len(self)} rows at {self.rate} Hz{'; ' if there else ''}{there}>"
