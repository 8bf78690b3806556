"""Velocity estimation from quadrature encoders.

The estimators, log readers and experiments of the Limpid project, in SI units (rad/s, s, A) and NumPy
arrays. Every algorithm is the compiled one of the project: nothing is written a second time here.

>>> import limpid
>>> replay = limpid.replay([0, 3, 7, 10, 14, 17], 1000, counts_per_rev=4096, estimator="pll")
>>> bool(replay.velocity[-1] > 0)
True
"""

from ._estimator import Estimator, Reports
from ._experiments import (
    Ranked,
    Recommendation,
    Tuning,
    TuningRow,
    coarsen,
    decode,
    recommend,
    score_fields,
    scores,
    simulate,
    tune,
)
from ._limpid import __version__
from ._lists import EstimatorInfo, ParameterInfo, device, estimators, parameters, scenarios
from ._recording import Recording
from ._replay import Replay, read_log, replay

__all__ = [
    "Estimator",
    "EstimatorInfo",
    "ParameterInfo",
    "Ranked",
    "Recommendation",
    "Recording",
    "Replay",
    "Reports",
    "Tuning",
    "TuningRow",
    "__version__",
    "coarsen",
    "decode",
    "device",
    "estimators",
    "parameters",
    "read_log",
    "recommend",
    "replay",
    "scenarios",
    "score_fields",
    "scores",
    "simulate",
    "tune",
]
