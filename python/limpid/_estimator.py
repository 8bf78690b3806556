"""Estimators that take rows as they come."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from . import _arrays
from ._limpid import Estimator as _Estimator


class Reports(NamedTuple):
    """What an estimator reports at each row; None for what it does not report."""

    #: Velocity, rad/s.
    velocity: NDArray[np.float32]
    #: Standard deviation of the velocity, rad/s.
    std_dev: NDArray[np.float32] | None
    #: Acceleration, rad/s^2.
    acceleration: NDArray[np.float32] | None
    #: Learned damping of the coupler over the assumed one.
    damping_ratio: NDArray[np.float32] | None


class Estimator(_Estimator):
    """An estimator that takes rows as they come: :meth:`update` one row, :meth:`process` several.

    Rows give the same bits one by one, in blocks of any size, and in :func:`replay`, which finds the modulus of counts
    that wrap at a revolution or at 16 bits; here it is an argument. Methods may be called
    from several threads: a call waits for the one before. :meth:`process` releases the interpreter's lock. A handler of
    a signal that interrupts :meth:`process` cannot use the same estimator: a RuntimeError says so.

    Parameters
    ----------
    estimator
        Name of the estimator, see :func:`estimators`.
    rate
        Rate of the rows, Hz.
    counts_per_rev
        Counts per revolution of the encoder [default: that of the device, otherwise 4096].
    parameters, presets, device
        As of :func:`replay`.
    modulus
        Counts at which an absolute encoder wraps, for example 4096; without it, counts wrap at 2^32. With ``coupled``,
        of each that wraps: ``{"counts": 4096, "coupled": 65536}``.
    varying
        Whether rows come at uneven times; then each row has ``dt``, the time since the row before.

    >>> estimator = Estimator("finite-difference", rate=1000, counts_per_rev=4096)
    >>> estimator.update(7), round(estimator.update(8), 4)
    (0.0, 1.534)
    """

    # A value that is set under another name, as modulus, would have no effect: it is an AttributeError.
    __slots__ = ("__weakref__",)

    def process(
        self,
        counts: _arrays.IntLike,
        *,
        current: _arrays.FloatLike | None = None,
        coupled: _arrays.IntLike | None = None,
        edge_age: _arrays.FloatLike | None = None,
        edge_boundary: _arrays.IntLike | None = None,
        dt: _arrays.FloatLike | None = None,
    ) -> Reports:
        """Takes several rows and returns what is reported at each of them.

        The arguments are arrays of what :meth:`update` takes. A call that Ctrl-C ends has taken no row.
        """
        columns = _arrays.rows(counts, coupled, current, edge_age, edge_boundary)
        columns["dt"] = None if dt is None else _arrays.as_floats(dt, "dt", "s")
        _arrays.same_rows(columns)
        return Reports(*self._process(**columns))
