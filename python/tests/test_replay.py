"""Velocities of replay against known truths and independent computations."""

from __future__ import annotations

import csv
import subprocess

import numpy as np
import pytest

import limpid

SCALE = np.float32(2 * np.pi * 1000 / 4096)
INTEGERS = ["i1", "i2", "i4", "i8", "u1", "u2", "u4", "u8", ">i2", ">i4", ">u8"]


def test_finite_difference_is_that_of_numpy(signals):
    counts = signals["counts"]
    replayed = limpid.replay(counts, 1000, counts_per_rev=4096, estimator="finite-difference")
    expected = np.r_[0, np.diff(counts)].astype(np.float32) * SCALE
    assert replayed.velocity.dtype == np.float32
    np.testing.assert_array_equal(replayed.velocity, expected)


def test_arrays_that_are_not_aligned_are_copied():
    counts = np.arange(100, dtype="<u4")
    current = np.linspace(0, 1, 100)
    odd = [np.frombuffer(b"x" + array.tobytes(), dtype=array.dtype, offset=1) for array in (counts, current)]
    assert not any(array.flags.aligned for array in odd)
    expected = limpid.replay(counts, 1000, current=current, estimator="imm-motor").velocity
    np.testing.assert_array_equal(limpid.replay(odd[0], 1000, current=odd[1], estimator="imm-motor").velocity, expected)
    streamed = limpid.Estimator("imm-motor", rate=1000).process(odd[0], current=odd[1]).velocity
    np.testing.assert_array_equal(streamed, expected)


def test_objects_that_are_integers_are_counts():
    counts = np.array([np.int64(1), 5, np.uint8(9), -3, 2**40], dtype=object)
    expected = limpid.replay([1, 5, 9, -3, 2**40], 1000).velocity
    np.testing.assert_array_equal(limpid.replay(counts, 1000).velocity, expected)


def test_array_without_masked_rows_is_an_array():
    counts = np.ma.array(np.arange(100))
    np.testing.assert_array_equal(limpid.replay(counts, 1000).velocity, limpid.replay(np.arange(100), 1000).velocity)


def test_note_on_an_unknown_modulus_has_a_remedy_that_works(tmp_path):
    turning = np.arange(3000)
    wrapped = turning % 360
    expected = limpid.replay(turning, 1000).velocity
    replayed = limpid.replay(wrapped, 1000)
    (note,) = replayed.notes
    remedy = "counts=numpy.unwrap(counts.astype(int), period=N), N about 360, if it has other counts per revolution"
    assert note.endswith(f"or as large.counts_per_rev in the file of device=, or {remedy}")
    assert (replayed.velocity != expected).any()
    recording = limpid.Recording(wrapped, 1000)
    assert remedy in limpid.recommend(recording).notes[0]
    unwrapped = np.unwrap(recording.counts.astype(int), period=360)
    np.testing.assert_array_equal(limpid.replay(unwrapped, 1000).velocity, expected)
    # Of the other encoder.
    coupled = limpid.replay(turning, 1000, coupled=(50 * turning) % 16384).notes[0]
    assert "or coupled=numpy.unwrap(coupled.astype(int), period=16384) if" in coupled

    path = tmp_path / "wrapped.csv"
    rows = "".join(f"{k / 1000},{count},{50 * k % 16384}\n" for k, count in enumerate(wrapped))
    path.write_text("t,counts_large,counts_small\n" + rows)
    large, small = limpid.read_log(path, counts_per_rev=4096).notes
    assert "or modulus={'counts_large': N}, N about 360, if" in large
    assert "or modulus={'counts_small': 16384} if" in small
    modulus = {"counts_large": 360, "counts_small": 16384}
    log = limpid.read_log(path, modulus=modulus, counts_per_rev=4096)
    assert log.notes == []
    np.testing.assert_array_equal(limpid.replay(log).velocity, expected)


def test_low_pass_is_the_recurrence_in_float64(signals):
    cutoff = 40.0
    replayed = limpid.replay(
        signals["counts"],
        1000,
        counts_per_rev=4096,
        estimator="low-pass",
        parameters={"cutoff_hz": cutoff},
    )
    alpha = 1 - np.exp(-2 * np.pi * cutoff / 1000)
    velocity = 0.0
    expected = [velocity]
    for step in np.diff(signals["counts"]) * 2 * np.pi * 1000 / 4096:
        velocity += alpha * (step - velocity)
        expected.append(velocity)
    # A rounding of an f32 of up to 24 rad/s in each tick, over a memory of 1 / alpha ticks.
    np.testing.assert_allclose(replayed.velocity, expected, atol=24 * 2**-24 * 2 / alpha, rtol=0)
    assert replayed.parameters == {"cutoff_hz": cutoff}


@pytest.mark.parametrize("estimator", [e.name for e in limpid.estimators() if not e.needs])
def test_constant_speed_is_found(estimator):
    # 13.7 counts per row: near a whole number imm-pair may keep a ripple (docs/theory/imm.md).
    speed = 21.0
    counts = np.floor(4096 / (2 * np.pi) * speed * np.arange(4000) / 1000).astype(np.int64)
    replayed = limpid.replay(counts, 1000, estimator=estimator)
    # Over 500 ticks the displacement is wrong by less than a count at each end.
    tolerance = 2 * 2 * np.pi * 1000 / 4096 / 500
    if estimator == "super-twisting-explicit":
        # It has a limit cycle: the mean is that of whole cycles only.
        tolerance *= 10
    assert abs(replayed.velocity[-500:].mean() - speed) < tolerance
    if replayed.std_dev is not None:
        assert (replayed.std_dev[-500:] > 0).all()
    mirrored = limpid.replay(-counts, 1000, estimator=estimator)
    assert abs(mirrored.velocity[-500:].mean() + speed) < tolerance


@pytest.mark.parametrize("dtype", INTEGERS)
def test_every_integer_type_counts_modulo_its_width(dtype):
    """A counter of any width that does not wrap within its type gives the same velocities."""
    steps = np.random.default_rng(1).integers(-1, 2, 120)
    counts = np.cumsum(steps) + 60
    assert 0 <= counts.min() and counts.max() < 127
    expected = limpid.replay(counts, 1000, estimator="finite-difference").velocity
    replayed = limpid.replay(counts.astype(dtype), 1000, estimator="finite-difference").velocity
    np.testing.assert_array_equal(replayed, expected)


def test_counts_wrap_at_2_to_the_32():
    steps = np.random.default_rng(2).integers(-9, 10, 1000)
    position = np.cumsum(steps)
    expected = limpid.replay(position, 1000).velocity
    for start in (2**32 - 5, -(2**31) + 3, 2**63 - 2**14, -7):
        wide = position + start if abs(start) < 2**62 else position.astype(object) + start
        np.testing.assert_array_equal(limpid.replay(wide, 1000).velocity, expected)
        narrow = (position.astype(object) + start) % 2**32
        narrow = narrow.astype(np.uint32)
        np.testing.assert_array_equal(limpid.replay(narrow, 1000).velocity, expected)
        np.testing.assert_array_equal(limpid.replay(narrow.view(np.int32), 1000).velocity, expected)


def test_lists_of_integers_of_any_size_are_counts():
    for values in ([2**63, 2**63 + 1, 7], (0, 2**64 + 5), [-(2**63) - 1, np.uint64(2**63), -1], [1, -2]):
        expected = [int(value) % 2**32 for value in values]
        assert limpid.Recording(values, 1000).counts.tolist() == expected
    for values in ([1, 2.5], [True, False], ["1", "2"]):
        with pytest.raises(ValueError, match="counts: has the type"):
            limpid.Recording(values, 1000)


def test_arrays_need_not_be_contiguous(signals):
    counts, current = signals["counts"], signals["current"]
    table = np.stack([counts, counts], axis=1)
    strided = table[:, 0]
    assert not strided.flags.c_contiguous
    small = counts.astype(np.uint32)
    wide = np.stack([small, small], axis=1)[:, 1]
    assert not wide.flags.c_contiguous
    np.testing.assert_array_equal(limpid.replay(wide, 1000).velocity, limpid.replay(counts, 1000).velocity)
    for name, more in (("imm", {}), ("imm-motor", {"current": current})):
        expected = limpid.replay(counts, 1000, estimator=name, **more).velocity
        if more:
            more = {"current": np.repeat(current, 3)[::3]}
        np.testing.assert_array_equal(limpid.replay(strided, 1000, estimator=name, **more).velocity, expected)
        backwards = counts[::-1].copy()[::-1]
        np.testing.assert_array_equal(limpid.replay(backwards, 1000, estimator=name, **more).velocity, expected)
    assert limpid.replay(counts.tolist()[:100], 1000).velocity.shape == (100,)


def test_arrays_are_not_changed(signals):
    counts = signals["counts"].astype(np.uint32) % 4096
    before = counts.copy()
    replayed = limpid.replay(counts, 1000)
    assert any("wraps at 4096 and is unwrapped" in note for note in replayed.notes)
    np.testing.assert_array_equal(counts, before)


def test_absolute_encoder_is_unwrapped(signals):
    expected = limpid.replay(signals["counts"], 1000)
    replayed = limpid.replay(signals["counts"] % 4096, 1000)
    np.testing.assert_array_equal(replayed.velocity, expected.velocity)
    assert expected.notes == []


def test_rows_at_uneven_times_have_their_true_steps():
    """The speed of a shaft at 20 rad/s, read at uneven times."""
    rng = np.random.default_rng(3)
    t = np.cumsum(rng.choice([0.7e-3, 1e-3, 1.6e-3], 4000, p=[0.2, 0.7, 0.1]))
    counts = np.floor(4096 / (2 * np.pi) * 20 * t).astype(np.int64)
    replayed = limpid.replay(counts, t=t, estimator="finite-difference")
    steps = np.diff(t) * replayed.rate
    expected = np.diff(counts) / steps * 2 * np.pi * replayed.rate / 4096
    np.testing.assert_allclose(replayed.velocity[1:], expected, rtol=3e-7)
    assert "t is uneven" in replayed.notes[0]
    even = limpid.replay(counts, t=t, estimator="foaw-end-fit", resample=1000)
    assert np.diff(even.t) == pytest.approx(1e-3)
    assert abs(even.velocity[-500:].mean() - 20) < 0.1


def test_times_of_a_replay_stay_when_its_recording_changes():
    recording = limpid.Recording(np.arange(3000), 1000)
    replayed = limpid.replay(recording)
    recording.counts = np.arange(10)
    recording.rate = 50
    np.testing.assert_array_equal(replayed.t, np.arange(3000) / 1000)
    recording = limpid.Recording(np.arange(3000), t=np.arange(3000) / 1000)
    replayed = limpid.replay(recording)
    recording.t[:] = 0
    np.testing.assert_array_equal(replayed.t, np.arange(3000) / 1000)


def test_note_on_parameters_from_far_away_names_calls():
    said = "tune them with limpid.tune(log) or limpid.tune(rate=1000.5), with device=FILE.toml, and give its file as presets="
    (note,) = limpid.replay(np.arange(100), 1000.5, estimator="pll", counts_per_rev=16).notes
    assert said in note
    assert limpid.Estimator("pll", 1000.5, counts_per_rev=16).notes == [note]


def test_presets_are_scaled_to_the_encoder_as_stated(signals):
    fine = limpid.parameters("pll", 1000, counts_per_rev=4096)
    coarse = limpid.parameters("pll", 1000, counts_per_rev=256)
    # docs/theory/presets.md: three poles go with the square root of the counts.
    assert coarse["bandwidth_hz"] == pytest.approx(fine["bandwidth_hz"] / 4)
    replayed = limpid.replay(signals["counts"], 1000, counts_per_rev=256, estimator="pll")
    assert replayed.parameters == coarse
    assert "far from there: pll" in replayed.notes[0]
    assert "--" not in replayed.notes[0] and "presets=" in replayed.notes[0]


def test_first_row_is_at_rest_and_types_are_those_of_the_stub(signals):
    replayed = limpid.replay(signals["counts"], 1000, estimator="imm")
    assert replayed.velocity[0] == 0
    for column in (replayed.velocity, replayed.std_dev, replayed.acceleration):
        assert column is not None and column.dtype == np.float32 and len(column) == len(signals["counts"])
    assert replayed.damping_ratio is None
    learner = limpid.replay(estimator="adaptive", rate=1000, counts=signals["counts"], current=signals["current"],
                            coupled=signals["coupled"])
    assert learner.damping_ratio is not None and learner.damping_ratio[0] == 1


def test_acceleration_is_that_of_the_motion():
    """A velocity that swings: its derivative is known at every row."""
    t = np.arange(8000) / 1000
    angle = 3 * np.sin(6 * t)
    counts = np.floor(40_000 / (2 * np.pi) * angle).astype(np.int64)
    replayed = limpid.replay(counts, 1000, counts_per_rev=40_000, estimator="imm")
    assert replayed.acceleration is not None
    truth = -3 * 36 * np.sin(6 * t)
    # The model of the bank lets accelerations decay, so that its amplitude is too small, not its phase.
    correlation = np.corrcoef(replayed.acceleration[500:], truth[500:])[0, 1]
    assert correlation > 0.9
    amplitude = replayed.acceleration[500:].std() / truth[500:].std()
    assert 0.2 < amplitude < 1.5


@pytest.mark.parametrize(
    ("log", "device", "options"),
    [("back-and-forth.csv", "hall-90.toml", []), ("logs/uneven.csv", None, []), ("logs/own.csv", None, [])],
)
def test_velocities_have_the_bits_of_the_command(log, device, options, data, host_sim, tmp_path):
    out = tmp_path / "velocity.csv"
    command = [host_sim, "replay", str(data / log), "--out", str(out)]
    if device is not None:
        command += ["--device", str(data / device)]
    subprocess.run(command, check=True, capture_output=True, timeout=60)
    with out.open() as file:
        rows = list(csv.DictReader(file))
    device = None if device is None else data / device
    recording = limpid.read_log(data / log, device=device)
    names = [name for name in rows[0] if name != "t"]
    assert len(names) > 3
    for name in names:
        replayed = limpid.replay(recording, estimator=name, device=device)
        expected = np.array([row[name] for row in rows], dtype=np.float32)
        np.testing.assert_array_equal(replayed.velocity.view(np.uint32), expected.view(np.uint32), err_msg=name)
    np.testing.assert_array_equal(replayed.t, np.array([row["t"] for row in rows], dtype=float))
