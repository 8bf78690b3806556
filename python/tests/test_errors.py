"""Wrong arguments are refused with a line that names the argument and the remedy."""

from __future__ import annotations

import importlib.metadata
from pathlib import Path

import numpy as np
import pytest

import limpid

COUNTS = np.arange(100)
CURRENT = np.zeros(100)


def replay(**arguments):
    return limpid.replay(**{"counts": COUNTS, "rate": 1000, **arguments})


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        ({"counts": COUNTS / 2}, ["counts: has the type float64; pass integers", "numpy.rint(counts)"]),
        ({"counts": COUNTS > 5}, ["counts: has the type bool"]),
        ({"counts": np.full(100, np.nan)}, ["counts: has the type float64"]),
        ({"counts": COUNTS.reshape(10, 10)}, ["counts: has the shape (10, 10); pass one dimension"]),
        ({"counts": np.array(5)}, ["counts: has the shape ()"]),
        ({"counts": [[1, 2], [3]]}, ["counts: not an array of numbers"]),
        ({"counts": []}, ["counts: is empty"]),
        ({"counts": np.array([True, False], dtype=object)}, ["counts: has the type object"]),
        ({"counts": np.ma.array(COUNTS, mask=COUNTS == 7)}, ["counts: has masked rows; fill them", "pass t"]),
        ({"current": np.ma.masked_invalid(np.r_[CURRENT[:99], np.nan])}, ["current: has masked rows"]),
        ({"counts": ["a", "b"]}, ["counts: has the type"]),
        ({"counts": "motor.csv"}, ["counts: has the type str; pass an array or a list; limpid.read_log reads a file"]),
        ({"counts": Path("motor.csv")}, ["counts: has the type PosixPath; pass an array", "limpid.read_log"]),
        ({"counts": (k for k in range(100))}, ["counts: has the type generator; pass an array or a list"]),
        ({"counts": {1, 2}}, ["counts: has the type set; pass an array or a list"]),
        ({"counts": [1, None, 3]}, ["counts: has the type object, and row 1 is None; pass integers: fill such rows"]),
        ({"counts": [1.0, 2.0, np.nan]}, ["float64, and row 2 is nan; pass integers: fill such rows", "pass t"]),
        ({"current": CURRENT[:50]}, ["current: has 50 rows where counts has 100; pass columns of equal length"]),
        ({"current": np.r_[CURRENT[:99], np.nan]}, ["current: row 99 is nan; remove the row, or fill it", "(A)"]),
        ({"current": np.r_[np.inf, CURRENT[:99]]}, ["current: row 0 is inf"]),
        ({"current": ["x"] * 100}, ["current: has the type", "(A)"]),
        ({"coupled": COUNTS / 2}, ["coupled: has the type float64"]),
        ({"edge_age": CURRENT}, ["edge_age and edge_boundary: pass both or neither"]),
        ({"edge_age": CURRENT - 1, "edge_boundary": COUNTS}, ["edge_age: row 0 is -1.0", "not negative (s)"]),
        ({"rate": None}, ["rate and t: pass one of them"]),
        ({"t": COUNTS / 1000}, ["rate and t: pass one of them"]),
        ({"rate": 0}, ["rate=0: must be positive and finite (Hz)"]),
        ({"rate": float("nan")}, ["rate=nan: must be positive and finite (Hz)"]),
        ({"rate": 10**400}, ["0: must be positive and finite (Hz)"]),
        ({"rate": None, "t": COUNTS[::-1] / 1000}, ["row 1: column t: 0.098 s is before the 0.099 s above it"]),
        ({"rate": None, "t": COUNTS.astype(float)}, ["1 Hz", "that it is not in ms, us or ns, and multiply it"]),
        ({"rate": None, "t": COUNTS * 1e-9}, ["if it is in minutes, hours or days, multiply it"]),
        ({"rate": None, "t": 0.001}, ["t: has the type float; pass an array or a list"]),
        (
            {"rate": None, "t": COUNTS.astype("timedelta64[ms]")},
            ["t: has the type timedelta64[ms]; pass real numbers (s), for example (t - t[0]) / numpy.timedelta64(1, 's')"],
        ),
        ({"rate": None, "t": np.r_[np.nan, COUNTS[:99]]}, ["t: row 0 is nan", "(s)"]),
        ({"estimator": "imn"}, ["'imn'; did you mean imm?"]),
        ({"estimator": "IMM"}, ["'IMM'; did you mean imm?"]),
        ({"estimator": "imm-motor"}, ["imm-motor needs the current of the large motor: pass current"]),
        ({"estimator": "observer", "current": CURRENT}, ["the counts of the small encoder: pass coupled"]),
        ({"estimator": "m-over-t"}, ["pass edge_age and edge_boundary"]),
        ({"estimator": "pll", "parameters": {"cutoff": 1}}, ["pll has no parameter 'cutoff'; there are bandwidth_hz"]),
        ({"estimator": "pll", "parameters": {"bandwidth_hz": -1}}, ["pll.bandwidth_hz = -1", "Hz"]),
        ({"estimator": "pll", "parameters": {"bandwidth_hz": np.nan}}, ["pll.bandwidth_hz = NaN"]),
        ({"estimator": "pll", "parameters": {"bandwidth_hz": 900}}, ["pll at 1000 Hz"]),
        ({"estimator": "imm", "parameters": {"x": 1}}, ["imm has no parameter 'x': it has none at all"]),
        ({"counts_per_rev": 3}, ["counts_per_rev=3: must be from 16 to 4000000"]),
        ({"device": {"large": {"inertia": 1}}}, ["device: ", "inertia"]),
        ({"resample": -5}, ["resample=-5"]),
        ({"rate": 4}, ["recording: rate=4: must be from 5 to 10000000 Hz"]),
        ({"rate": 1e30}, ["must be from 5 to 10000000 Hz"]),
        ({"rate": 50}, ["50 rows/s; imm needs 100 to 100000: add resample=100"]),
    ],
)
def test_replay_refuses(arguments, said):
    with pytest.raises(ValueError) as error:
        replay(**arguments)
    text = str(error.value)
    for part in said:
        assert part in text
    assert "--" not in text and "\n" not in text


def test_estimator_that_needs_a_constant_period_is_refused_on_uneven_rows():
    t = np.cumsum(np.random.default_rng(5).uniform(0.5e-3, 1.5e-3, 100))
    with pytest.raises(ValueError, match="foaw-end-fit needs a constant period: add resample=") as error:
        replay(rate=None, t=t, estimator="foaw-end-fit")
    assert "or name one of finite-difference" in str(error.value)


@pytest.mark.parametrize(
    ("attribute", "value", "said"),
    [
        ("current", CURRENT[:50], "current: has 50 rows where counts has 100"),
        ("current", np.r_[CURRENT[:99], np.nan], "current: row 99 is nan"),
        ("current", ["x"] * 100, "current: has the type"),
        ("counts", COUNTS[:50], "has 100 rows where counts has 50"),
        ("true_velocity", CURRENT[:50], "true_velocity: has 50 rows"),
        ("edge_age", CURRENT, "edge_age and edge_boundary: pass both or neither"),
        ("rate", -1.0, "rate=-1.0: must be positive"),
    ],
)
def test_attribute_that_is_replaced_is_checked_again(attribute, value, said):
    recording = limpid.Recording(COUNTS, 1000, current=CURRENT, true_velocity=CURRENT)
    setattr(recording, attribute, value)
    for call in (lambda log: limpid.replay(log, estimator="imm-motor"), limpid.recommend, limpid.tune):
        with pytest.raises(ValueError) as error:
            call(recording)
        assert said in str(error.value)
    # In place, too.
    recording = limpid.Recording(COUNTS, 1000, current=CURRENT.copy())
    recording.current[7] = np.inf
    with pytest.raises(ValueError, match="current: row 7 is inf"):
        limpid.replay(recording)


def test_rate_of_rows_with_times_is_not_replaced():
    recording = limpid.Recording(COUNTS, t=COUNTS / 1000)
    limpid.replay(recording)
    recording.rate = 500
    with pytest.raises(ValueError, match=r"rate=500.0: the rows have times, which are 1000.0 Hz; leave the rate"):
        limpid.replay(recording)


def test_attributes_are_replaced_by_other_types():
    recording = limpid.Recording(COUNTS, 1000)
    recording.counts = 2 * COUNTS
    expected = limpid.replay(2 * COUNTS, 1000).velocity
    np.testing.assert_array_equal(limpid.replay(recording).velocity, expected)


def test_recording_has_its_own_columns():
    recording = limpid.Recording(COUNTS, 1000)
    with pytest.raises(ValueError, match="the recording has its own"):
        limpid.replay(recording, 1000)


@pytest.mark.parametrize(
    ("arguments", "kind", "said"),
    [
        ({"count": 1.5}, TypeError, "count: must be an integer; round a float"),
        ({"count": "x"}, TypeError, "count: must be an integer"),
        ({"count": COUNTS}, TypeError, "count: must be an integer; round a float with round(), and pass several rows to process()"),
        ({"count": 1, "dt": 0.001}, ValueError, "make it with varying=True"),
        ({"count": 1, "current": float("nan")}, ValueError, "current=NaN: must be finite (A)"),
        ({"count": 1, "edge_age": 0.0}, ValueError, "edge_age and edge_boundary: give both or neither"),
        ({"count": 1, "edge_age": -1.0, "edge_boundary": 2}, ValueError, "edge_age=-1: must be finite"),
    ],
)
def test_update_refuses(arguments, kind, said):
    estimator = limpid.Estimator("pll", rate=1000)
    with pytest.raises(kind) as error:
        estimator.update(**arguments)
    assert said in str(error.value)


def test_estimator_refuses():
    for arguments, said in (
        ({"rate": 0.0}, "rate=0: must be positive"),
        ({"estimator": "nobody"}, "no estimator 'nobody'"),
        ({"modulus": 1}, "modulus=1: must be from 2 to 2147483648, for example 4096"),
        ({"modulus": {"coupled": 1}}, "modulus=1: must be from 2 to 2147483648, for example 4096"),
        ({"modulus": {"small": 4096}}, "modulus: has the key 'small'; pass counts or coupled"),
        ({"modulus": {1: 4096}}, "modulus: has the key '1'; pass counts or coupled"),
        ({"estimator": "foaw-end-fit", "varying": True}, "foaw-end-fit needs a constant period"),
    ):
        with pytest.raises(ValueError) as error:
            limpid.Estimator(**arguments)
        assert said in str(error.value)
    with pytest.raises(ValueError, match="dt: missing"):
        limpid.Estimator("imm", varying=True).update(1)
    with pytest.raises(ValueError, match="imm-motor needs the current"):
        limpid.Estimator("imm-motor").update(1)
    with pytest.raises(ValueError, match="current: has 1 rows where counts has 2"):
        limpid.Estimator("imm").process([1, 2], current=[0.0])


def test_refused_rows_leave_the_estimator_as_it_was():
    estimator = limpid.Estimator("finite-difference", rate=1000, modulus=100)
    estimator.update(99)
    with pytest.raises(ValueError):
        estimator.update(1, current=float("inf"))
    # From 99 to 1 at a modulus of 100: two counts.
    assert estimator.update(1) == pytest.approx(2 * 2 * np.pi * 1000 / 4096)


def test_missing_files_are_os_errors(tmp_path):
    for name, read in (
        ("nothing.csv", limpid.read_log),
        ("nothing.csv", lambda path: limpid.coarsen(path, 1024)),
        ("nothing.csv", limpid.decode),
        ("nothing.toml", limpid.device),
        ("nothing.toml", lambda path: replay(presets=path)),
        ("nothing.toml", lambda path: limpid.Estimator(presets=path)),
        ("nothing.toml", lambda path: limpid.parameters("imm", 1000, presets=path)),
        ("nothing.toml", lambda path: limpid.recommend(limpid.Recording(COUNTS, 1000), presets=path)),
        ("nothing.toml", lambda path: limpid.tune(limpid.Recording(COUNTS, 1000), presets=path)),
    ):
        with pytest.raises(FileNotFoundError) as error:
            read(tmp_path / name)
        assert error.value.filename == str(tmp_path / name)
        assert str(error.value) == f"[Errno 2] No such file or directory: '{tmp_path / name}'"
        with pytest.raises(IsADirectoryError) as error:
            read(tmp_path)
        assert error.value.filename == str(tmp_path)
    with pytest.raises(TypeError, match="give the path of a device file, or a dict"):
        limpid.device(5)
    with pytest.raises(TypeError, match="give the path of a presets file"):
        replay(presets=5)


@pytest.mark.parametrize(
    ("sections", "error", "names"),
    [
        ({"large": {"inertia_kg_m2": [1]}}, TypeError, r"large\.inertia_kg_m2: give a number"),
        ({"large": {"inertia_kg_m2": None}}, TypeError, r"large\.inertia_kg_m2: give a number"),
        ({"large": {1: 2}}, TypeError, r"large\.1: a key must be a str"),
        ({"large": {"inertia_kg_m2": "heavy"}}, ValueError, "inertia_kg_m2"),
        ({"large": {"inertia_kg_m2": float("nan")}}, ValueError, "inertia"),
        ({"large": {"inertia": 1}}, ValueError, "inertia"),
        ({"large": 1}, ValueError, "large"),
        ({"large": {"inertia_kg_m2": {"x": 1}}}, ValueError, r"large\.inertia_kg_m2: is a section in a section"),
    ],
)
def test_device_that_is_wrong_is_named(sections, error, names):
    with pytest.raises(error, match=names):
        limpid.device(sections)


def test_device_that_has_itself_is_refused():
    sections: dict = {}
    sections["large"] = sections
    for call in (limpid.device, lambda device: limpid.replay([1, 2], 1000, device=device)):
        with pytest.raises(ValueError, match=r"device: large\.large: is a section in a section; give a number"):
            call(sections)


def test_device_takes_numbers_of_numpy():
    device = limpid.device({"large": {"counts_per_rev": np.int32(90), "inertia_kg_m2": np.float64(2e-5)}})
    assert device["large"]["counts_per_rev"] == 90
    assert device["large"]["inertia_kg_m2"] == 2e-5


@pytest.mark.parametrize(
    ("call", "argument"),
    [
        (lambda value: replay(counts_per_rev=value), "counts_per_rev"),
        (lambda value: limpid.Recording(COUNTS, 1000, counts_per_rev=value), "counts_per_rev"),
        (lambda value: limpid.Estimator(counts_per_rev=value), "counts_per_rev"),
        (lambda value: limpid.Estimator(modulus=value), "modulus"),
        (lambda value: limpid.simulate("track", seed=value), "seed"),
        (lambda value: limpid.simulate(every=value), "every"),
        (lambda value: limpid.tune(rate=1000, seeds=value), "seeds"),
    ],
)
def test_integers_are_checked(call, argument):
    for value in (-1, 2**64, 2**200):
        with pytest.raises(ValueError, match=rf"^{argument}={value}: must be from \d+ to \d+"):
            call(value)
    for value in (4096.5, "4096"):
        with pytest.raises(TypeError) as error:
            call(value)
        assert str(error.value) == f"{argument}: has the type {type(value).__name__}; pass an integer"


def test_counts_per_rev_that_is_replaced_is_checked_again():
    recording = limpid.Recording(COUNTS, 1000, counts_per_rev=np.int16(90))
    recording.counts_per_rev = -1
    with pytest.raises(ValueError, match="counts_per_rev=-1: must be from 16 to 4000000"):
        limpid.replay(recording)


def test_wrong_types_are_type_errors_that_name_the_argument():
    for call in (lambda: replay(rate="1000"), lambda: limpid.Recording(COUNTS, "1000")):
        with pytest.raises(TypeError, match=r"rate: has the type str; pass a number \(Hz\)"):
            call()
    with pytest.raises(TypeError, match="rate: has the type list"):
        replay(rate=[1000, 2000])


def test_every_type_error_names_the_argument():
    log = limpid.Recording(COUNTS, 1000)
    for call, said in (
        (lambda: replay(parameters=5), "parameters: give a dict of names with numbers as values"),
        (lambda: replay(parameters={1: 5}), "parameters: give a dict of names with numbers as values"),
        (lambda: limpid.tune(log, estimators=None), "estimators: has the type NoneType; pass a name or names"),
        (lambda: limpid.tune(log, estimators=limpid.estimators()), "estimators: has the type EstimatorInfo; pass a name"),
        (lambda: limpid.tune(rate=1000, scenarios=5), "scenarios: has the type int; pass a name or names"),
        (lambda: limpid.read_log("log.csv", columns=None), "columns: has the type NoneType; pass a dict"),
        (lambda: limpid.read_log("log.csv", columns=[("t", "time")]), "columns: has the type tuple; pass a dict"),
        (lambda: limpid.Recording(COUNTS, t=COUNTS / 1000, name=5), "name: has the type int; pass a str"),
        (lambda: limpid.Recording(COUNTS, 1000, name=5), "name: has the type int; pass a str"),
        (lambda: limpid.Recording(COUNTS, 1000, notes=5), "notes: has the type int; pass lines of text"),
    ):
        with pytest.raises(TypeError) as error:
            call()
        assert str(error.value).startswith(said)


def test_notes_on_recordings_name_their_attributes():
    t = np.arange(6000) / 1000
    counts = np.floor(4096 * np.sin(2 * t)).astype(int)
    velocity = 2 * np.pi * 2 * np.cos(2 * t)
    for true, said in (
        (-velocity, "true_velocity is -1.000 times the velocity of counts, reverse the sign"),
        (0 * velocity, "true_velocity is 0, and counts moves: leave it out for scores against a reference"),
        (velocity * 30 / np.pi, "as in rpm: convert it to rad/s, or read the log with columns=true_omega=NAME:rpm"),
    ):
        log = limpid.Recording(counts, 1000, true_velocity=true, counts_per_rev=4096, name="log")
        assert any(said in note for note in limpid.recommend(log).notes)
    counts[3000] += 500
    notes = limpid.recommend(limpid.Recording(counts, 1000, counts_per_rev=4096, name="log")).notes
    assert notes[0].startswith("log: counts is bad at t = 3 s: delete these rows")
    assert notes[1].startswith("log: no true_velocity; scores are against a reference")


def test_logs_are_recordings_and_each_is_given_once():
    for logs in (None, 5, "motor.csv", COUNTS, [], [5]):
        for call in (limpid.recommend, limpid.tune) if logs is not None else (limpid.recommend,):
            with pytest.raises(ValueError, match=r"logs: pass a limpid.Recording or several"):
                call(logs)
    log = limpid.Recording(COUNTS, 1000, name="hand")
    for call in (limpid.recommend, limpid.tune):
        with pytest.raises(ValueError, match="logs: hand is given twice; pass each recording once"):
            call([log, log])


def test_lines_are_named():
    for lines in (5, "AB", ["A"]):
        with pytest.raises(ValueError, match="give the names of 2 columns"):
            limpid.decode("lines.csv", lines=lines)


def test_rows_of_a_recording_are_replaced_by_the_reader_of_logs():
    """The remedy is an argument that exists: recommend and tune have no resample."""
    rng = np.random.default_rng(5)
    counts = (300 * np.sin(np.arange(6000) / 300)).astype(int)
    uneven = limpid.Recording(counts, t=np.cumsum(rng.uniform(0.5e-3, 1.5e-3, 6000)))
    with pytest.raises(ValueError, match=r"needs a constant period: add resample=\d+ of limpid\.read_log, or name"):
        limpid.tune(uneven, estimators="foaw-end-fit")
    with pytest.raises(ValueError, match=r"; give resample= of limpid\.read_log, or run each rate on its own"):
        limpid.recommend([limpid.Recording(counts, rate) for rate in (1000, 500)])


def test_version_is_that_of_the_package():
    assert limpid.__version__ == importlib.metadata.version("limpid")
