"""Paths of the repository, and a motion that many tests run on."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
import pytest

DATA = Path(__file__).parents[2] / "tests" / "data"


@pytest.fixture
def data() -> Path:
    return DATA


def program(variable: str, name: str) -> str:
    """A program of the project, which test.sh builds."""
    path = os.environ.get(variable)
    if path is None:
        pytest.fail(f"{variable} is not set: run python/test.sh, or set it to target/release/{name}")
    return path


@pytest.fixture
def host_sim() -> str:
    return program("HOST_SIM", "host-sim")


@pytest.fixture
def stress() -> str:
    return program("STRESS", "stress")


@pytest.fixture
def signals() -> dict[str, np.ndarray]:
    """Every signal that an estimator can need, at 1 kHz: a shaft that goes back and forth."""
    rows = 70_000
    t = np.arange(rows) / 1000
    position = 4096 / (2 * np.pi) * (3 * np.sin(4 * t) + 0.5 * np.sin(31 * t))
    # The latest edge: somewhere in the tick of the latest change of the count.
    counts = np.floor(position).astype(np.int64)
    changed = np.r_[False, counts[1:] != counts[:-1]]
    latest = np.maximum.accumulate(np.where(changed, np.arange(rows), -1))
    before = counts[np.maximum(latest - 1, 0)]
    now = counts[np.maximum(latest, 0)]
    age = np.where(latest < 0, np.nan, (np.arange(rows) - latest + 0.4) / 1000)
    return {
        "counts": counts,
        "coupled": np.floor(position * 2500 / 4096).astype(np.int64),
        "current": 0.2 * np.cos(4 * t),
        "edge_age": age,
        "edge_boundary": np.where(now > before, now, now + 1),
    }
