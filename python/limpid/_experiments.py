"""Experiments: simulated and coarse recordings, scores, a recommendation, tuned parameters."""

from __future__ import annotations

import json
from collections.abc import Iterable, Sequence, Sized
from dataclasses import dataclass
from os import PathLike
from pathlib import Path
from typing import Any, SupportsIndex

import numpy as np

from . import _arrays, _limpid
from ._recording import Recording
from ._replay import Columns, Modulus, Replay, column_options


def simulate(
    scenario: str | None = None,
    *,
    scene: str | None = None,
    rate: float = 10_000.0,
    seconds: float | None = None,
    seed: SupportsIndex = 1,
    hand: str | None = None,
    every: SupportsIndex | None = None,
    counts_per_rev: SupportsIndex | None = None,
    device: str | PathLike[str] | dict[str, Any] | None = None,
) -> Recording:
    """Simulates the dual-stage device and returns what its encoders saw, with the true velocity.

    Parameters
    ----------
    scenario
        Motion in open loop, see :func:`scenarios`. It has every signal that an estimator can need.
    scene
        Scene in closed loop instead: ``excite``, ``wall``, ``free-air``, ... [default: excite].
    rate
        Control rate, Hz, from 100 to 100000; of a scene from 600, of ``excite`` from 1000 on.
    seconds
        Duration, s [default: 16; scenarios: 10, heating 60].
    seed
        Seed of all random numbers.
    hand
        Load on the handle in a scene: ``still``, ``clamp``, ``nobody`` or ``moving`` [default: still].
    every
        Keep only every N-th tick of a scene, 1 to 1000 [default: 1].
    counts_per_rev
        Counts per revolution of the large encoder [default: those of the device].
    device
        Path of a device file (TOML), or a dict with its sections.
    """
    if scenario is not None and scene is not None:
        raise ValueError("scenario and scene: pass one of them")
    if scenario is not None and not (hand is None and every is None):
        raise ValueError("hand and every: are of a scene; leave them out, or pass a scene in place of the scenario")
    hand = "still" if hand is None else hand
    every = 1 if every is None else every
    fields = _limpid.simulate(scenario, scene, rate, seconds, seed, hand, every, counts_per_rev, device)
    if every == 1:
        # The rate is known: the times say it less exactly.
        fields["rate"] = rate
        del fields["t"]
    return Recording(**fields)


def coarsen(
    path: str | PathLike[str],
    counts_per_rev: SupportsIndex,
    *,
    rate: float = 1000.0,
    fine_counts_per_rev: SupportsIndex | None = None,
    phase: float = 0.37,
    seconds: float | None = None,
    columns: Columns = (),
    modulus: Modulus = None,
    row_rate: float | None = None,
    drop_stale: bool = False,
    device: str | PathLike[str] | dict[str, Any] | None = None,
) -> Recording:
    """What an encoder of ``counts_per_rev`` would have seen of the recording of a finer one.

    Parameters
    ----------
    path
        A log as :func:`read_log` reads it, which may be compressed by gzip. The names ``time_s`` (s),
        ``fine_count``, ``motor_torque_nm`` (N.m) and ``true_omega_rad_s`` (rad/s) are known too.
    counts_per_rev
        Counts per revolution of the coarse encoder, at most half of those of the fine one.
    rate
        Rate of the rows, Hz, at most that of the fine recording.
    fine_counts_per_rev
        Counts per revolution of the fine encoder [default: those in the recordings.toml beside the file].
    phase
        Position of the boundaries of the coarse encoder, coarse counts.
    seconds
        Part of the recording that is used, s from its start [default: all].
    columns, modulus, row_rate, drop_stale
        As in :func:`read_log`.
    device
        Path of a device file or a dict; its torque constant turns torque into current.
    """
    fields = _limpid.coarsen(
        path,
        *column_options(columns, modulus),
        row_rate,
        drop_stale,
        counts_per_rev,
        fine_counts_per_rev,
        rate,
        phase,
        seconds,
        device,
    )
    fields["rate"] = rate
    del fields["t"]
    return Recording(**fields)


def decode(
    path: str | PathLike[str],
    *,
    rate: float = 1000.0,
    lines: Sequence[str | int] | None = None,
    hall: Sequence[str | int] | None = None,
    columns: Columns = (),
    row_rate: float | None = None,
    counts_per_rev: SupportsIndex | None = None,
) -> Recording:
    """The counts and the times of the edges in a capture of an encoder's lines.

    Parameters
    ----------
    path
        A file of a logic analyser: a table (CSV) where a row has the levels 0 or 1 of the lines from its time
        on, or a value change dump (VCD). It may be compressed by gzip.
    rate
        Rate of the rows of the recording, Hz, from 5 to 100000.
    lines
        Names or numbers, from 1, of the columns of the lines A and B [default: the only two columns that are
        no time]. In the other order counts have the other sign.
    hall
        The columns of three Hall lines instead, a third of a period apart.
    columns
        Column and unit of the time: ``{"t": "Time (us)"}``, ``{"t": "1:ns"}`` [default: the column whose
        name begins with time].
    row_rate
        Rate of the capture's rows, Hz, where it has no time.
    counts_per_rev
        Counts per revolution of the encoder: four times its lines, or six times the pole pairs of Hall
        sensors.
    """
    if lines is not None and hall is not None:
        raise ValueError("lines and hall: pass one of them")
    for name, given, number in (("lines", lines, 2), ("hall", hall, 3)):
        if given is not None and (isinstance(given, str) or not isinstance(given, Sized) or len(given) != number):
            raise ValueError(f"{name}={given!r}: give the names of {number} columns")
    named = lines if hall is None else hall
    names = None if named is None else [str(name) for name in named]
    fields = _limpid.decode(path, rate, names, column_options(columns, None)[0], row_rate, counts_per_rev)
    fields["rate"] = rate
    del fields["t"]
    return Recording(**fields)


def scores(
    velocity: _arrays.FloatLike | Replay,
    true_velocity: _arrays.FloatLike | Recording,
    rate: float | None = None,
    *,
    device: str | PathLike[str] | dict[str, Any] | None = None,
) -> dict[str, float]:
    """Scores of a velocity against the true one, by name; :func:`score_fields` has their units and definitions.

    It has the scores of a velocity alone: not those relative to finite difference (``rms_pct``), nor those of a
    standard deviation (``within_2_sigma``) or of a learned damping.
    The first 0.1 s is not scored, because every estimator begins at rest.

    Parameters
    ----------
    velocity
        A :class:`Replay`, or velocities, rad/s.
    true_velocity
        A :class:`Recording` with its true velocity, or velocities, rad/s.
    rate
        Rate of the rows, Hz [default: that of the replay or of the recording].
    device
        Device whose haptic interval the distances are from.
    """
    if isinstance(velocity, Replay):
        rate = velocity.rate if rate is None else rate
        velocity = velocity.velocity
    if isinstance(true_velocity, Recording):
        rate = true_velocity.rate if rate is None else rate
        if true_velocity.true_velocity is None:
            raise ValueError(f"{true_velocity.name}: has no true velocity; pass it as an array")
        true_velocity = true_velocity.true_velocity
    if rate is None:
        raise ValueError("rate: missing; pass the rate of the rows (Hz)")
    rate = _arrays.as_number(rate, "rate", "Hz")
    estimate = _arrays.as_floats(velocity, "velocity", "rad/s")
    truth = _arrays.as_floats(true_velocity, "true_velocity", "rad/s")
    _arrays.same_rows({"velocity": estimate, "true_velocity": truth})
    return _limpid.scores(estimate.astype(np.float32), truth, rate, device)


def score_fields() -> dict[str, tuple[str, str]]:
    """Unit and definition of each score of this project; :func:`scores` returns those of a velocity alone."""
    return {name: (unit, about) for name, unit, about in _limpid.score_fields()}


@dataclass(frozen=True)
class Ranked:
    """One estimator on the recordings; ``recommended`` is ``best``, ``cheap`` or None."""

    estimator: str
    recommended: str | None
    #: Geometric mean over the recordings of the RMS error in % of finite difference.
    rms_pct: float
    #: RMS over the recordings of the RMS error, rad/s.
    rms_rad_s: float
    #: Largest 99th percentile of the error's magnitude, rad/s.
    p99_rad_s: float
    #: Mean delay, ms.
    delay_ms: float | None
    #: RMS of the standard deviation that the estimator reports, rad/s.
    sd_rad_s: float | None
    #: Instructions per update on a Cortex-M4: mean and largest; None if they were not measured.
    instructions_mean: float | None
    instructions_most: float | None
    reads: list[str]
    parameters: dict[str, float]
    #: Lines of Rust to paste.
    rust: str
    #: The scores on each recording.
    logs: list[dict[str, Any]]


@dataclass(frozen=True)
class Recommendation:
    """The estimators on recordings of a device, the smallest error first."""

    ranked: list[Ranked]
    #: The recommendation as text, with the lines of Rust.
    text: str
    #: What the scores are against, and what was left out.
    notes: list[str]

    @property
    def best(self) -> Ranked:
        """The most accurate estimator; of equal ones the cheapest."""
        return next(row for row in self.ranked if row.recommended == "best")

    @property
    def cheap(self) -> Ranked | None:
        """The most accurate estimator within the budget of instructions, if it is not the best one."""
        return next((row for row in self.ranked if row.recommended == "cheap"), None)


def _logs(logs: Recording | Iterable[Recording]) -> list[Recording]:
    recordings: list[Any] = list(logs) if isinstance(logs, Iterable) else [logs]
    if not recordings or not all(isinstance(log, Recording) for log in recordings):
        raise ValueError("logs: pass a limpid.Recording or several, for example limpid.read_log('motor.csv')")
    for row, recording in enumerate(recordings):
        if any(recording is other for other in recordings[:row]):
            raise ValueError(f"logs: {recording.name} is given twice; pass each recording once")
        recording._check()
    return recordings


def recommend(
    logs: Recording | Iterable[Recording],
    *,
    instructions: float = 100.0,
    counts_per_rev: SupportsIndex | None = None,
    presets: str | PathLike[str] | None = None,
    device: str | PathLike[str] | dict[str, Any] | None = None,
) -> Recommendation:
    """Ranks the estimators on recordings of one device, as ``cargo sim recommend`` does.

    Without a true velocity the scores are against a reference that is smoothed from the counts in both
    directions of time.

    Parameters
    ----------
    logs
        A :class:`Recording` or several.
    instructions
        Largest number of instructions per update on a Cortex-M4 for the second, cheap estimator.
    counts_per_rev
        Counts per revolution [default: those in the device file, otherwise those of the recordings, otherwise
        4096].
    presets
        Path of a file of tuned parameters.
    device
        Path of a device file or a dict; without it, estimators with constants of the device are left out.
    """
    recordings = _logs(logs)
    ranked, text, notes = _limpid.recommend(recordings, instructions, counts_per_rev, presets, device)
    rows = []
    for row in json.loads(ranked):
        cost = row.pop("cost") or {}
        for name in ("instructions_mean", "instructions_most"):
            row[name] = cost.get(name)
        rows.append(Ranked(**row))
    return Recommendation(rows, text, notes)


@dataclass(frozen=True)
class TuningRow:
    """RMS errors of one estimator, rad/s, each in the tuned and in the held-out seconds."""

    estimator: str
    before: tuple[float, float]
    found: tuple[float, float]
    #: Whether the parameters are kept as they were: the found ones are not better in the held-out seconds.
    kept: bool


@dataclass(frozen=True)
class Tuning:
    """Tuned parameters."""

    #: Values of the parameters of each estimator, for ``parameters=`` of :func:`replay`.
    parameters: dict[str, dict[str, float]]
    #: The errors on recordings; empty after tuning on scenarios.
    rows: list[TuningRow]
    notes: list[str]
    #: The text of a presets file, for ``presets=`` and for ``cargo sim --presets``.
    presets: str

    def save(self, path: str | PathLike[str]) -> None:
        """Writes the presets file."""
        Path(path).write_text(self.presets, encoding="utf-8")


def tune(
    logs: Recording | Iterable[Recording] | None = None,
    *,
    rate: float | None = None,
    estimators: str | Sequence[str] = (),
    scenarios: str | Sequence[str] = (),
    seeds: SupportsIndex | None = None,
    seconds: float | None = None,
    perturbed: bool | None = None,
    friction: bool = True,
    counts_per_rev: SupportsIndex | None = None,
    presets: str | PathLike[str] | None = None,
    device: str | PathLike[str] | dict[str, Any] | None = None,
) -> Tuning:
    """Searches the parameters of estimators on recordings, or on simulated motion, as ``cargo sim tune`` does.

    On recordings, every second of them in turn is tuned on and held out; found parameters are kept if their
    RMS error in the held-out seconds is smaller. On simulated motion they are compared on a further seed.

    Parameters
    ----------
    logs
        A :class:`Recording` or several, each of at least 4 s; None to tune on scenarios at ``rate``.
    rate
        Control rate of the scenarios, Hz.
    estimators
        Name or names [default: all that have parameters].
    scenarios, seeds, seconds, perturbed, friction
        The simulated motion: name or names of scenarios, number of seeds, duration of each run (s), whether the
        constants of the device are wrong too, and whether the motor has friction.
    counts_per_rev
        Counts per revolution [default: those in the device file, otherwise those of the recordings, otherwise
        4096].
    presets
        Path of a presets file from which the search on recordings begins.
    device
        Path of a device file (TOML), or a dict with its sections.
    """
    names = _arrays.as_names(estimators, "estimators", "a name or names of limpid.estimators()")
    motions = _arrays.as_names(scenarios, "scenarios", "a name or names of limpid.scenarios()")
    if (logs is None) == (rate is None):
        raise ValueError("logs and rate: pass recordings, or the rate at which scenarios are simulated (Hz)")
    rows: list[Any] = []
    if logs is None:
        assert rate is not None
        if presets is not None:
            raise ValueError("presets: the search on scenarios begins with the shipped ones; leave it out")
        text, notes = _limpid.tune_scenarios(
            rate, names, motions, seeds, seconds, perturbed, friction, counts_per_rev, device
        )
    else:
        if motions or not friction or not (seeds is None and seconds is None and perturbed is None):
            raise ValueError("scenarios, seeds, seconds, perturbed, friction: are of simulated motion; leave them out")
        recordings = _logs(logs)
        text, rows, notes = _limpid.tune_logs(recordings, names, counts_per_rev, presets, device)
    values = {name: dict(values) for name, values in _limpid.values_of_presets(text)}
    tuned = [TuningRow(name, tuple(before), tuple(found), kept) for name, before, found, kept in rows]
    return Tuning(values, tuned, notes, text)
