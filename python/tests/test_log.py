"""Logs, read as the commands read them."""

from __future__ import annotations

import csv
import os
import subprocess
import sys

import numpy as np
import pytest

import limpid


def column(path, name):
    with path.open() as file:
        return [row[name] for row in csv.DictReader(file)]


def test_columns_are_those_of_the_file(data):
    path = data / "back-and-forth.csv"
    log = limpid.read_log(path, device=data / "hall-90.toml")
    np.testing.assert_array_equal(log.t, np.array(column(path, "t"), dtype=float))
    np.testing.assert_array_equal(log.counts.view(np.int32), np.array(column(path, "counts_large"), dtype=int))
    np.testing.assert_array_equal(log.true_velocity, np.array(column(path, "true_omega"), dtype=float))
    edges = np.array([float(text) if text else np.nan for text in column(path, "edge_tick")])
    # A clock of 84 MHz, in a time of a few seconds.
    np.testing.assert_allclose(log.edge_age, np.maximum(log.t - edges / 84e6, 0), atol=1e-12)
    assert log.edge_boundary.view(np.int32)[0] == int(column(path, "edge_bound")[0])
    assert (log.counts_per_rev, log.rate, log.name) == (90, 1000.0, "back-and-forth.csv")
    assert log.current is None and log.coupled is None
    assert len(log) == 1501
    assert "1501 rows at 1000.0 Hz" in repr(log)


def motion(t):
    """Counts and current of the logs: tests/data/logs/README.md."""
    counts = np.floor(4096 * (0.8 + 0.6 * t + 0.4 * np.sin(2 * np.pi * 1.5 * t)))
    return counts, 0.3 * np.cos(0.05 * 1000 * t)


@pytest.mark.parametrize(
    ("name", "options", "says"),
    [
        ("own.csv", {}, None),
        (
            "semicolons-decimal-commas.csv",
            {},
            "counts_large from 'angle_deg' (deg with 4096 counts/rev); others are named with columns=",
        ),
        ("odrive.csv", {"counts_per_rev": 4096}, "read as a log of ODrive"),
        ("vesc-tool.csv", {}, "read as a log of VESC Tool"),
        ("moteus-tview.csv", {}, "read as a log of moteus"),
        ("moteus-python.csv", {}, "read as a log of moteus"),
        ("simplefoc-monitor.txt", {"row_rate": 1000}, "read as a log of SimpleFOC"),
        ("absolute-deg.csv", {"columns": {"counts_large": "angle:deg"}}, "counts_large from 'angle' (deg with 4096"),
        ("no-header.csv", {"columns": {"t": "1:ms", "counts_large": "2:rev"}}, "counts_large from column 2"),
        ("no-header.csv", {"columns": "t=1:ms,counts_large=2:rev"}, "counts_large from column 2"),
        ("no-time.csv", {"row_rate": 1000, "columns": ["counts_large=encoder"]}, None),
    ],
)
def test_logs_have_the_motion_that_they_were_made_from(name, options, says, data):
    log = limpid.read_log(data / "logs" / name, **options)
    t = np.arange(240) / 1000
    counts, current = motion(t)
    np.testing.assert_allclose(log.t - log.t[0], t, atol=1e-6)
    # Logs in turns and degrees round the count, by the digits that they have; whole turns may be left out.
    off = log.counts.view(np.int32) - counts
    assert off.std() <= 0.5 and off[0] % 4096 in (0, 1, 4095)
    if log.current is not None:
        np.testing.assert_allclose(log.current, current, atol=2e-3)
    assert says is None or any(says in note for note in log.notes)
    assert log.counts_per_rev == 4096


def test_absolute_encoder_is_unwrapped(data):
    path = data / "logs" / "absolute-4096.csv"
    log = limpid.read_log(path)
    raw = np.array(column(path, "counts_large"), dtype=int)
    assert np.abs(np.diff(raw)).max() > 3000
    np.testing.assert_array_equal(log.counts % 4096, raw)
    assert np.abs(np.diff(log.counts.view(np.int32))).max() < 100
    by_hand = limpid.read_log(data / "logs" / "absolute-3600.csv", modulus=3600)
    assert np.abs(np.diff(by_hand.counts.view(np.int32))).max() < 100


def test_rows_are_resampled(data):
    path = data / "logs" / "uneven.csv"
    log = limpid.read_log(path, resample=500)
    assert log.rate == 500
    assert np.diff(log.t) == pytest.approx(0.002)
    with pytest.raises(ValueError, match="needs a constant period: add resample="):
        limpid.replay(limpid.read_log(path), estimator="foaw-end-fit")
    assert len(limpid.replay(log, estimator="foaw-end-fit").velocity) == len(log)


def test_stale_readings_are_named_and_left_out(data):
    path = data / "logs" / "stale-readings.csv"
    log = limpid.read_log(path)
    assert any("stays in 5 rows" in note and "add drop_stale=True to leave" in note for note in log.notes)
    log = limpid.read_log(path, drop_stale=True)
    kept = np.setdiff1d(np.arange(240), [21, 45, 46, 70, 90]) / 1000
    np.testing.assert_allclose(log.t, kept, atol=1e-9)
    np.testing.assert_array_equal(log.counts, motion(kept)[0])


@pytest.mark.parametrize(
    ("name", "said"),
    [
        ("unknown-names.csv", ["found: stamp; shaft; speed", "columns='t=stamp:s,"]),
        ("no-header.csv", ["no names but 2 columns", "columns=t=1:ms,counts_large=2:rad"]),
        ("not-a-number.csv", ["line 7: column counts_large: 'n/a' is not a number"]),
        ("time-goes-back.csv", ["line 4: column t: 0.0005 s is before the 0.001 s"]),
        ("seconds-in-ms.csv", ["column t: rows 1 s apart", "columns=t=NAME:ms"]),
        ("simplefoc-monitor.txt", ["SimpleFOC", "row_rate=HZ"]),
        ("broken.jsonl", ["line 2: no JSON object; remove the line"]),
    ],
)
def test_logs_are_refused_with_line_and_remedy(name, said, data):
    with pytest.raises(ValueError) as error:
        limpid.read_log(data / "logs" / name)
    text = str(error.value)
    for part in said:
        assert part in text
    assert "--" not in text


def test_wrong_options_are_refused(data):
    own = data / "logs" / "own.csv"
    for options, said in (
        ({"columns": {"time": "t"}}, "columns=time=t: 'time' is no column of a recording"),
        ({"modulus": 1}, "modulus=1: '1' is no number of counts from 2 to 2^31"),
        ({"row_rate": 0.0}, "row_rate=0: the rate of the rows must be positive"),
        ({"resample": 1e9}, "resample=1000000000"),
    ):
        with pytest.raises(ValueError) as error:
            limpid.read_log(own, **options)
        assert said in str(error.value)


def test_device_without_counts_leaves_those_that_the_log_states(tmp_path):
    path = tmp_path / "stated.csv"
    path.write_text("# counts_per_rev = 90\nt,counts_large\n" + "".join(f"{k / 1000},{k // 2}\n" for k in range(5000)))
    inertia = {"large": {"inertia_kg_m2": 2e-5}}
    counts = {"large": {"counts_per_rev": 4096}}
    log = limpid.read_log(path)
    assert log.counts_per_rev == limpid.read_log(path, device=inertia).counts_per_rev == 90
    fast = limpid.replay(log, estimator="finite-difference").velocity.max()
    replayed = limpid.replay(log, estimator="finite-difference", device=inertia)
    assert replayed.velocity.max() == fast == pytest.approx(2 * np.pi / 90 * 1000)
    assert replayed.notes == []

    # A device that states them, and the argument, are used, with a note.
    for options, source in (({"device": counts}, "device"), ({"counts_per_rev": 4096}, "counts_per_rev")):
        said = f"stated.csv: 4096 counts/rev of {source} are used; the recording states 90"
        replayed = limpid.replay(log, estimator="finite-difference", **options)
        assert replayed.velocity.max() == pytest.approx(fast * 90 / 4096)
        assert replayed.notes == [said]
        assert said in limpid.recommend(log, **options).notes
        assert said in limpid.tune(log, estimators="low-pass", **options).notes
        # A recording has the name of its file, and the message of a reader its path.
        assert limpid.read_log(path, **options).notes[0] == f"{tmp_path}/{said}"
        assert limpid.read_log(path, **options).counts_per_rev == 4096
    for found in (limpid.recommend(log, device=inertia), limpid.tune(log, estimators="low-pass", device=inertia)):
        assert not any("counts/rev" in note for note in found.notes)


def test_counts_that_nothing_states_are_assumed_with_a_note(tmp_path):
    path = tmp_path / "plain.csv"
    path.write_text("t,counts_large\n" + "".join(f"{k / 1000},{k}\n" for k in range(50)))
    said = "4096 counts/rev assumed: give counts_per_rev or device"
    assert limpid.read_log(path).notes == [said]
    assert limpid.read_log(path, device={"large": {"inertia_kg_m2": 2e-5}}).notes == [said]
    assert limpid.read_log(path, counts_per_rev=4096).notes == []
    assert limpid.read_log(path, device={"large": {"counts_per_rev": 4096}}).notes == []


def test_logs_of_different_encoders_are_refused():
    logs = [limpid.Recording(np.arange(5000), 1000, counts_per_rev=counts, name=str(counts)) for counts in (90, None)]
    inertia = {"large": {"inertia_kg_m2": 2e-5}}
    for device in (None, inertia):
        with pytest.raises(ValueError, match="logs: 90 and None state different counts per revolution, 90 and none"):
            limpid.recommend(logs, device=device)
    limpid.recommend(logs, counts_per_rev=90)


@pytest.mark.parametrize(
    "call",
    [
        "limpid.read_log('endless.csv')",
        "limpid.coarsen('endless.csv', 256, rate=500)",
        "limpid.decode('endless.csv', rate=1000, counts_per_rev=4096)",
        "limpid.simulate(scene='wall', rate=1e5, seconds=200)",
        "limpid.simulate('track', rate=1e5, seconds=200)",
    ],
)
def test_interrupt_ends_a_call_whose_work_goes_on(call, tmp_path):
    """A pipe that nobody writes has no end; of a simulation the thread is still there after the call."""
    os.mkfifo(tmp_path / "endless.csv")
    program = f"""
import os, signal, limpid
threads = lambda: len(os.listdir("/proc/self/task"))
before = threads()
signal.signal(signal.SIGALRM, signal.default_int_handler)
signal.setitimer(signal.ITIMER_REAL, 0.1)
try:
    {call}
except KeyboardInterrupt:
    print("interrupted", threads() - before)
"""
    done = subprocess.run(
        [sys.executable, "-c", program], cwd=tmp_path, capture_output=True, text=True, timeout=60
    )
    assert (done.stdout, done.stderr, done.returncode) == ("interrupted 1\n", "", 0)
