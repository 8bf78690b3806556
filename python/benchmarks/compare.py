"""Time and accuracy beside scipy.signal.lfilter and filterpy's Kalman filter.

Time: processor time of one core for 1e7 samples (filterpy: 2e4 samples, a loop of Python), the least of
several runs.

Accuracy: RMS error, rad/s, on the recordings of tests/data/real that a fine encoder made, seen by an encoder of
4096 counts per revolution at 1 kHz (first 10 s; the first 0.1 s is not scored). Every filter with a parameter is
tuned by the same rule: of 16 values on a logarithmic grid, the one with the least geometric mean of the RMS in % of
finite difference on the recordings of the role "chooses". All recordings are listed; the mean is that of the role
"judges". imm has no parameter. The fine recordings are smoothed in both directions of time to get the truth.

    target/python/bin/python python/benchmarks/compare.py
"""

from __future__ import annotations

import argparse
import time
import tomllib
from pathlib import Path

import numpy as np
from filterpy.kalman import KalmanFilter
from scipy import signal

import limpid

DATA = Path(__file__).parents[2] / "tests" / "data" / "real"
COUNTS_PER_REV = 4096
RATE = 1000.0
COUNT = 2 * np.pi / COUNTS_PER_REV
SAMPLES = 10_000_000
GRID = 16


def butterworth(counts, cutoff):
    """A second-order low-pass over the finite difference."""
    difference = np.diff(counts, prepend=counts[:1]) * (COUNT * RATE)
    return signal.lfilter(*signal.butter(2, cutoff, fs=RATE), difference)


def filterpy(counts, jerk):
    """A Kalman filter on a triple integrator of white jerk, of this spectral density, rad/s^3/sqrt(Hz)."""
    t = 1 / RATE
    kalman = KalmanFilter(dim_x=3, dim_z=1)
    kalman.F = np.array([[1, t, t * t / 2], [0, 1, t], [0, 0, 1]])
    kalman.H = np.array([[1.0, 0, 0]])
    kalman.R *= COUNT**2 / 12
    powers = np.array([[t**5 / 20, t**4 / 8, t**3 / 6], [t**4 / 8, t**3 / 3, t**2 / 2], [t**3 / 6, t**2 / 2, t]])
    kalman.Q = jerk**2 * powers
    kalman.P = np.diag([COUNT**2, 1.0, 100.0])
    position = (counts - counts[0]) * COUNT
    velocity = np.empty(len(position))
    for row, angle in enumerate(position):
        kalman.predict()
        kalman.update(angle)
        velocity[row] = kalman.x[1, 0]
    return velocity


def ours(name, parameter=None):
    """An estimator of this package, with one of its parameters."""

    def run(counts, value=None):
        parameters = {} if parameter is None else {parameter: value}
        return limpid.replay(
            counts, RATE, counts_per_rev=COUNTS_PER_REV, estimator=name, parameters=parameters
        ).velocity

    return run


#: Name, filter, bounds of the grid of its parameter, samples for the time, unit of the parameter.
FILTERS = [
    ("limpid finite-difference", ours("finite-difference"), None, SAMPLES, ""),
    ("limpid low-pass", ours("low-pass", "cutoff_hz"), (2, 400), SAMPLES, "Hz"),
    ("limpid pll", ours("pll", "bandwidth_hz"), (2, 400), SAMPLES, "Hz"),
    ("limpid kalman-triple-steady", ours("kalman-triple-steady", "jerk"), (10, 1e6), SAMPLES, "rad/s^3/sqrt(Hz)"),
    ("limpid imm", ours("imm"), None, SAMPLES, ""),
    ("scipy lfilter, Butterworth 2", butterworth, (2, 400), SAMPLES, "Hz"),
    ("filterpy KalmanFilter", filterpy, (10, 1e6), 20_000, "rad/s^3/sqrt(Hz)"),
]


def recordings():
    """Name, role and coarse recording of each fine recording."""
    for entry in tomllib.loads((DATA / "recordings.toml").read_text())["recording"]:
        if entry["kind"] == "fine":
            coarse = limpid.coarsen(DATA / entry["file"], COUNTS_PER_REV, rate=RATE, seconds=10)
            yield entry["file"].removesuffix(".csv.gz"), entry.get("role", "judges"), coarse


def rms(velocity, recording):
    return limpid.scores(velocity, recording)["rms_rad_s"]


def run_filter(run, value, counts):
    signed = counts.view(np.int32).astype(np.int64)
    return run(signed) if value is None else run(signed, value)


def mean_pct(errors, of_difference):
    return 100 * np.exp(np.mean(np.log(np.array(errors) / of_difference)))


def tuned(run, bounds, chosen):
    """The value with the least mean error on the recordings that choose."""
    if bounds is None:
        return None
    of_difference = [rms(run_filter(ours("finite-difference"), None, log.counts), log) for log in chosen]
    grid = np.geomspace(*bounds, GRID)
    cost = [
        mean_pct([rms(run_filter(run, value, log.counts), log) for log in chosen], of_difference) for value in grid
    ]
    return float(f"{grid[int(np.argmin(cost))]:.3g}")


def cpu_seconds(run, value, counts, runs):
    def once():
        begun = time.process_time()
        run(counts) if value is None else run(counts, value)
        return time.process_time() - begun

    return min(once() for _ in range(runs))


def main(line=None):
    arguments = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    arguments.add_argument("--samples", type=int, default=SAMPLES, help="samples for the time [default: 1e7]")
    samples = arguments.parse_args(line).samples
    logs = list(recordings())
    chosen = [log for _, role, log in logs if role == "chooses"]
    values = {name: tuned(run, bounds, chosen) for name, run, bounds, _, _ in FILTERS}

    t = np.arange(samples) / RATE
    motion = np.floor((10 * np.sin(t) + 3 * np.sin(7 * t)) / COUNT).astype(np.int64)
    lfilter = None
    print(f"Time: processor time for {samples:.0e} samples\n")
    print("| filter | s | ns per sample | over lfilter |\n|---|---|---|---|")
    rows = []
    for name, run, _, most, _ in FILTERS:
        number = min(samples, most)
        seconds = cpu_seconds(run, values[name], motion[:number], 4 if number == samples else 1)
        rows.append((name, seconds * samples / number, 1e9 * seconds / number))
        if name.startswith("scipy"):
            lfilter = seconds / number
    for name, seconds, each in rows:
        print(f"| {name} | {seconds:.3g} | {each:.3g} | {each / (1e9 * lfilter):.2g} |")

    names = [name for name, *_ in FILTERS]
    print("\nAccuracy: RMS error, rad/s\n")
    print(f"| recording | role | {' | '.join(names)} |\n|---|---|{'---|' * len(names)}")
    errors = {}
    for log_name, role, log in logs:
        row = [rms(run_filter(run, values[name], log.counts), log) for name, run, *_ in FILTERS]
        errors[log_name] = row
        print(f"| {log_name} | {role} | {' | '.join(f'{error:.3g}' for error in row)} |")
    judging = np.array([errors[name] for name, role, _ in logs if role == "judges"])
    mean = [mean_pct(judging[:, column], judging[:, 0]) for column in range(len(names))]
    print(f"| mean of the judging ones, % of finite difference | | {' | '.join(f'{pct:.3g}' for pct in mean)} |")
    shown = [f"{values[name]:.3g} {unit}" if values[name] else "-" for name, *_, unit in FILTERS]
    print(f"| parameter | | {' | '.join(shown)} |")


if __name__ == "__main__":
    main()
