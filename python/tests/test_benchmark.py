"""The benchmark beside SciPy and filterpy, and what it is based on."""

from __future__ import annotations

import importlib.util
import time
from pathlib import Path

import numpy as np
import pytest

import limpid

pytestmark = pytest.mark.filterwarnings("ignore")


@pytest.fixture
def compare():
    path = Path(__file__).parents[1] / "benchmarks" / "compare.py"
    spec = importlib.util.spec_from_file_location("compare", path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_kalman_filter_is_that_of_filterpy(compare, data):
    """Another program with the same model, in float64, on a recorded motion."""
    log = limpid.coarsen(data / "real" / "tue-m2-q1e-spring.csv.gz", 4096, rate=1000, seconds=6)
    jerk = 200.0
    ours = limpid.replay(log, estimator="kalman-triple-steady", parameters={"jerk": jerk}).velocity
    theirs = compare.filterpy(log.counts.view(np.int32).astype(np.int64), jerk)
    # The steady gain is that of the end of the run; velocities are up to 10 rad/s in f32.
    assert np.abs(ours[1000:] - theirs[1000:]).max() < 2e-3
    assert np.abs(theirs).max() > 1


def test_a_sample_costs_no_loop_of_python(compare):
    """Ratios within one run, with wide bounds: measured are 2 and 900."""
    counts = np.floor(4096 * np.sin(np.arange(1_000_000) / 1000)).astype(np.int64)

    def seconds(run, number):
        part = counts[:number]

        def once():
            begun = time.process_time()
            run(part, 60.0)
            return time.process_time() - begun

        return min(once() for _ in range(3)) / number

    ours = seconds(compare.ours("pll", "bandwidth_hz"), len(counts))
    assert ours < 40 * seconds(compare.butterworth, len(counts))
    assert ours < seconds(compare.filterpy, 2000) / 30


def test_benchmark_runs(compare, capsys, monkeypatch):
    first = list(compare.recordings())
    assert len(first) == 8 and {role for _, role, _ in first} == {"chooses", "judges"}
    few = [
        (name, role, limpid.Recording(log.counts[:600], log.rate, true_velocity=log.true_velocity[:600]))
        for name, role, log in first[:2]
    ]
    monkeypatch.setattr(compare, "recordings", lambda: few)
    monkeypatch.setattr(compare, "GRID", 2)
    compare.main(["--samples", "5000"])
    printed = capsys.readouterr().out
    for name, *_ in compare.FILTERS:
        assert printed.count(name) == 2
    assert "| tue-q1c-free-motion | chooses |" in printed
