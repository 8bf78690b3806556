"""The compiled part of the package; its functions are called by the modules beside it.

The documentation of the class is that of the compiled part.
"""

from collections.abc import Mapping
from os import PathLike
from typing import Any, SupportsIndex

import numpy as np
from numpy.typing import NDArray

from ._recording import Recording

_Path = str | PathLike[str]
_Device = str | PathLike[str] | dict[str, Any]
_Reports = tuple[
    NDArray[np.float32],
    NDArray[np.float32] | None,
    NDArray[np.float32] | None,
    NDArray[np.float32] | None,
]

__version__: str

def estimators() -> list[dict[str, Any]]: ...
def parameters(
    estimator: str, rate: float, counts_per_rev: SupportsIndex | None, presets: _Path | None, device: _Device | None
) -> dict[str, float]: ...
def scenarios() -> list[tuple[str, str]]: ...
def device(device: _Device | None) -> str: ...
def checked_counts_per_rev(counts_per_rev: SupportsIndex) -> int: ...
def clock(t: NDArray[np.float64], name: str) -> float: ...
def read_log(
    path: _Path,
    columns: list[str],
    modulus: list[str],
    row_rate: float | None,
    drop_stale: bool,
    resample: float | None,
    counts_per_rev: SupportsIndex | None,
    device: _Device | None,
) -> dict[str, Any]: ...
def replay(
    recording: Recording,
    estimator: str,
    counts_per_rev: SupportsIndex | None,
    parameters: Mapping[str, float] | None,
    presets: _Path | None,
    device: _Device | None,
    resample: float | None,
) -> tuple[_Reports, NDArray[np.float64] | None, float, dict[str, float], list[str]]: ...

class Estimator:
    def __new__(
        cls,
        estimator: str = "imm",
        rate: float = 1000.0,
        *,
        counts_per_rev: SupportsIndex | None = None,
        parameters: Mapping[str, float] | None = None,
        presets: _Path | None = None,
        device: _Device | None = None,
        modulus: SupportsIndex | Mapping[str, SupportsIndex] | None = None,
        varying: bool = False,
    ) -> Estimator: ...
    @property
    def name(self) -> str: ...
    @property
    def rate(self) -> float: ...
    @property
    def counts_per_rev(self) -> int: ...
    @property
    def parameters(self) -> dict[str, float]: ...
    @property
    def notes(self) -> list[str]: ...
    @property
    def std_dev(self) -> float | None: ...
    @property
    def acceleration(self) -> float | None: ...
    @property
    def damping_ratio(self) -> float | None: ...
    def reset(self) -> None: ...
    def update(
        self,
        count: SupportsIndex,
        *,
        current: float | None = None,
        coupled: SupportsIndex | None = None,
        edge_age: float | None = None,
        edge_boundary: SupportsIndex | None = None,
        dt: float | None = None,
    ) -> float: ...
    def _process(
        self,
        counts: NDArray[np.uint32],
        current: NDArray[np.float64] | None,
        coupled: NDArray[np.uint32] | None,
        edge_age: NDArray[np.float64] | None,
        edge_boundary: NDArray[np.uint32] | None,
        dt: NDArray[np.float64] | None,
    ) -> _Reports: ...

def simulate(
    scenario: str | None,
    scene: str | None,
    rate: float,
    seconds: float | None,
    seed: SupportsIndex,
    hand: str,
    every: SupportsIndex,
    counts_per_rev: SupportsIndex | None,
    device: _Device | None,
) -> dict[str, Any]: ...
def coarsen(
    path: _Path,
    columns: list[str],
    modulus: list[str],
    row_rate: float | None,
    drop_stale: bool,
    counts_per_rev: SupportsIndex,
    fine_counts_per_rev: SupportsIndex | None,
    rate: float,
    phase: float,
    seconds: float | None,
    device: _Device | None,
) -> dict[str, Any]: ...
def decode(
    path: _Path,
    rate: float,
    lines: list[str] | None,
    columns: list[str],
    row_rate: float | None,
    counts_per_rev: SupportsIndex | None,
) -> dict[str, Any]: ...
def scores(
    velocity: NDArray[np.float32], true_velocity: NDArray[np.float64], rate: float, device: _Device | None
) -> dict[str, float]: ...
def score_fields() -> list[tuple[str, str, str]]: ...
def recommend(
    logs: list[Recording],
    instructions: float,
    counts_per_rev: SupportsIndex | None,
    presets: _Path | None,
    device: _Device | None,
) -> tuple[str, str, list[str]]: ...
def tune_logs(
    logs: list[Recording],
    estimators: list[str],
    counts_per_rev: SupportsIndex | None,
    presets: _Path | None,
    device: _Device | None,
) -> tuple[str, list[tuple[str, tuple[float, float], tuple[float, float], bool]], list[str]]: ...
def tune_scenarios(
    rate: float,
    estimators: list[str],
    scenarios: list[str],
    seeds: SupportsIndex | None,
    seconds: float | None,
    perturbed: bool | None,
    friction: bool,
    counts_per_rev: SupportsIndex | None,
    device: _Device | None,
) -> tuple[str, list[str]]: ...
def values_of_presets(text: str) -> list[tuple[str, dict[str, float]]]: ...
def command(arguments: list[str]) -> int: ...
