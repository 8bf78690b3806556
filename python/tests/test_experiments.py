"""Simulated and coarse recordings, scores, recommendations and tuned parameters."""

from __future__ import annotations

import csv
import gzip
import json
import signal
import subprocess
import sys
import time

import numpy as np
import pytest

import limpid


def run(*command):
    return subprocess.run(command, check=True, capture_output=True, text=True, timeout=300)


@pytest.mark.parametrize(
    ("options", "flags"),
    [
        ({"scenario": "track", "rate": 1000, "seconds": 2, "seed": 7}, "--scenario track --seed 7"),
        ({"scene": "wall", "rate": 1000, "seconds": 2, "hand": "moving", "every": 5}, "--scene wall --hand moving --every 5"),
        ({"scene": "excite", "rate": 1000, "seconds": 2, "hand": "still"}, "--hand still"),
        ({"scene": "excite", "rate": 1000, "seconds": 2, "hand": "clamp"}, "--hand clamp"),
        ({"scene": "excite", "rate": 1000, "seconds": 2, "hand": "nobody"}, "--hand nobody"),
    ],
)
def test_simulated_recording_is_that_of_the_command(options, flags, host_sim, tmp_path):
    path = tmp_path / "simulated.csv"
    run(host_sim, "simulate", *flags.split(), "--rate", "1000", "--seconds", "2", "--out", str(path))
    simulated, read = limpid.simulate(**options), limpid.read_log(path)
    np.testing.assert_array_equal(simulated.counts, read.counts)
    assert simulated.rate == read.rate
    np.testing.assert_allclose(simulated.t, read.t, atol=1e-12)
    # The file has as many digits as tell two numbers apart.
    np.testing.assert_array_equal(simulated.true_velocity, read.true_velocity)
    np.testing.assert_array_equal(simulated.current, read.current)
    np.testing.assert_array_equal(simulated.coupled, read.coupled)


def test_hands_differ():
    hands = ("still", "clamp", "nobody", "moving")
    recordings = [limpid.simulate(scene="excite", rate=1000, seconds=2, hand=hand) for hand in hands]
    assert len({recording.coupled.tobytes() for recording in recordings}) == len(hands)


def test_counts_are_the_integral_of_the_true_velocity():
    simulated = limpid.simulate("track", rate=10_000, seconds=3)
    velocity = simulated.true_velocity
    turned = np.r_[0, np.cumsum((velocity[1:] + velocity[:-1]) / 2)] / 10_000
    counted = (simulated.counts - simulated.counts[0]).view(np.int32) * 2 * np.pi / 4096
    # The first count may be anywhere in its cell.
    assert np.abs(counted - turned).max() < 1.1 * 2 * np.pi / 4096


def test_seeds_and_encoders_differ():
    one = limpid.simulate("track", rate=1000, seconds=1)
    np.testing.assert_array_equal(limpid.simulate("track", rate=1000, seconds=1).counts, one.counts)
    assert (limpid.simulate("track", rate=1000, seconds=1, seed=2).counts != one.counts).any()
    fine = limpid.simulate("track", rate=1000, seconds=1, counts_per_rev=40_960)
    assert fine.counts_per_rev == 40_960
    np.testing.assert_array_equal(fine.true_velocity, one.true_velocity)


def test_every_estimator_runs_on_a_scenario():
    simulated = limpid.simulate("free-air", rate=1000, seconds=2)
    for info in limpid.estimators():
        replayed = limpid.replay(simulated, estimator=info.name)
        assert limpid.scores(replayed, simulated)["rms_rad_s"] < 5


def test_coarse_recording_is_that_of_the_command_and_of_the_formula(data, host_sim, tmp_path):
    fine, path = data / "real" / "epfl-paddle-hand.csv.gz", tmp_path / "coarse.csv"
    run(host_sim, "coarsen", str(fine), "--counts-per-rev", "1024", "--rate", "500", "--out", str(path))
    coarse, read = limpid.coarsen(fine, 1024, rate=500), limpid.read_log(path)
    np.testing.assert_array_equal(coarse.counts, read.counts)
    np.testing.assert_array_equal(coarse.true_velocity, read.true_velocity)
    assert coarse.counts_per_rev == read.counts_per_rev == 1024
    with gzip.open(fine, "rt") as file:
        rows = list(csv.DictReader(file))
    t = np.array([row["time_s"] for row in rows], dtype=float)
    count = np.array([row["fine_count"] for row in rows], dtype=float)
    position = np.interp(coarse.t, t - t[0], count) * 1024 / 30_000 + 0.37
    # A position that rounds to a boundary may fall on either side of it.
    assert (np.floor(position).astype(np.int64).astype(np.uint32) == coarse.counts).mean() > 0.999


def test_columns_and_modulus_of_a_fine_recording_are_those_of_a_log(tmp_path):
    t = np.arange(4000) * 0.5e-3
    count = np.floor(40_000 * np.sin(2 * t)).astype(int)
    own, other = tmp_path / "own.csv", tmp_path / "other.csv"
    rows = zip(t, count)
    own.write_text("t,counts_large\n" + "".join(f"{s},{n}\n" for s, n in rows))
    rows = zip(t, count % 16_384)
    other.write_text("ms,enc\n" + "".join(f"{1e3 * s},{n}\n" for s, n in rows))
    expected = limpid.coarsen(own, 1024, fine_counts_per_rev=100_000)
    columns = {"t": "ms:ms", "counts_large": "enc"}
    read = limpid.coarsen(other, 1024, fine_counts_per_rev=100_000, columns=columns, modulus=16_384)
    np.testing.assert_array_equal(read.counts, expected.counts)
    with pytest.raises(ValueError, match="no column counts_large"):
        limpid.coarsen(other, 1024, fine_counts_per_rev=100_000)


def test_decoded_capture_is_that_of_the_command(data, host_sim, tmp_path):
    capture, path = data / "encoder-lines.csv", tmp_path / "motor.csv"
    for named, options in (
        ({}, []),
        ({"lines": (3, "Channel 0")}, ["--lines", "3", "Channel 0"]),
        ({"columns": {"t": "Time [s]"}, "rate": 500}, ["--column", "t=Time [s]", "--rate", "500"]),
    ):
        run(host_sim, "decode", str(capture), "--out", str(path), *options)
        decoded, read = limpid.decode(capture, counts_per_rev=4096, **named), limpid.read_log(path)
        np.testing.assert_array_equal(decoded.counts, read.counts)
        np.testing.assert_array_equal(decoded.edge_boundary, read.edge_boundary)
        np.testing.assert_allclose(decoded.edge_age, read.edge_age, atol=1e-8)
        assert decoded.rate == read.rate == named.get("rate", 1000)
        assert decoded.counts_per_rev == 4096
        assert "line A from column" in decoded.notes[0]
    assert limpid.decode(capture).counts_per_rev is None
    velocity = limpid.replay(decoded, estimator="imm-edge").velocity
    assert np.abs(velocity[-100:]).max() > 1


def test_hall_lines_are_decoded(tmp_path):
    # Half a turn of one pole pair: U rises, W falls, V rises.
    path = tmp_path / "hall.csv"
    path.write_text("t,u,v,w\n0,0,0,1\n0.01,1,0,1\n0.02,1,0,0\n0.03,1,1,0\n0.04,1,1,0\n")
    decoded = limpid.decode(path, hall=("u", "v", "w"), counts_per_rev=24)
    assert list(decoded.counts[[5, 15, 25, 35]]) == [0, 1, 2, 3]
    for arguments, said in (
        ({"lines": "ab"}, "lines='ab': give the names of 2 columns"),
        ({"hall": ("u", "v")}, "hall=('u', 'v'): give the names of 3 columns"),
        ({"lines": "ab", "hall": "abc"}, "lines and hall: pass one of them"),
        ({"rate": 4}, "rate=4: must be from 5 to 100000 Hz"),
        ({"counts_per_rev": 1}, "counts_per_rev"),
        ({"lines": ("u", "x")}, "hall.csv: line 1: no column 'x'"),
        ({}, "with lines=['A', 'B'], or three Hall lines with hall=['U', 'V', 'W']"),
    ):
        with pytest.raises(ValueError) as error:
            limpid.decode(path, **arguments)
        assert said in str(error.value)


def test_scores_are_those_of_numpy():
    rng = np.random.default_rng(6)
    truth = 5 * np.sin(np.arange(3000) / 200)
    velocity = (truth + rng.normal(0, 0.4, 3000)).astype(np.float32)
    scores = limpid.scores(velocity, truth, 1000)
    error = np.abs(velocity[100:].astype(float) - truth[100:])
    assert scores["rms_rad_s"] == pytest.approx(np.sqrt(np.mean(error**2)), rel=1e-9)
    assert scores["max_rad_s"] == pytest.approx(error.max(), rel=1e-9)
    # The haptic interval of the default device: docs/theory/scores.md.
    outside = np.maximum(0, error - 0.05 * np.abs(truth[100:]) - 0.01 * 0.07 / (2 * 0.96e-3))
    assert scores["distance_rad_s"] == pytest.approx(outside.mean(), rel=1e-9)
    assert scores["outside"] == pytest.approx((outside > 0).mean(), rel=1e-9)
    fields = limpid.score_fields()
    assert set(scores) <= set(fields) and fields["rms_rad_s"][0] == "rad/s"


def test_recommendation_is_that_of_the_command(data, host_sim):
    path = data / "back-and-forth.csv"
    printed = run(host_sim, "recommend", str(path), "--counts-per-rev", "90", "--json", "-")
    expected = json.loads(printed.stdout)
    found = limpid.recommend(limpid.read_log(path, counts_per_rev=90))
    assert [row.estimator for row in found.ranked] == [row["estimator"] for row in expected]
    for ours, theirs in zip(found.ranked, expected):
        assert ours.rms_rad_s == theirs["rms_rad_s"] and ours.rust == theirs["rust"]
        assert ours.recommended == theirs["recommended"]
        cost = theirs["cost"] or {}
        assert ours.instructions_most == cost.get("instructions_most")
    assert found.best.estimator in found.text
    assert found.cheap is None or found.cheap.instructions_most <= 100
    assert any("left out" in note and "device=FILE.toml" in note for note in found.notes)
    assert not any("--" in note for note in found.notes)


def test_ranking_follows_the_errors():
    """The scores of the ranking are those of replay and scores."""
    log = limpid.simulate("track", rate=1000, seconds=4)
    found = limpid.recommend(log)
    assert [row.rms_pct for row in found.ranked] == sorted(row.rms_pct for row in found.ranked)
    for row in found.ranked[:3]:
        replayed = limpid.replay(log, estimator=row.estimator)
        assert limpid.scores(replayed, log)["rms_rad_s"] == pytest.approx(row.rms_rad_s, rel=1e-9)


def test_tuned_parameters_are_better_and_can_be_used(host_sim, tmp_path):
    log = limpid.simulate("creep", rate=1000, seconds=8)
    tuned = limpid.tune(log, estimators=["pll", "low-pass"])
    (tmp_path / "log.csv").write_text(
        "t,counts_large,true_omega\n"
        + "".join(
            f"{t!r},{count},{omega!r}\n"
            for t, count, omega in zip(log.t.tolist(), log.counts.tolist(), log.true_velocity.tolist())
        )
    )
    command = [host_sim, "tune", "log.csv", "--estimator", "pll", "--estimator", "low-pass", "--out", "p.toml"]
    subprocess.run(command, check=True, capture_output=True, cwd=tmp_path, timeout=300)
    written = [line for line in (tmp_path / "p.toml").read_text().splitlines() if line and line[0] != "#"]
    assert [line for line in tuned.presets.splitlines() if line] == written
    before = limpid.scores(limpid.replay(log, estimator="pll"), log)["rms_rad_s"]
    after = limpid.replay(log, estimator="pll", parameters=tuned.parameters["pll"])
    assert limpid.scores(after, log)["rms_rad_s"] < 0.8 * before
    (row,) = [row for row in tuned.rows if row.estimator == "pll"]
    assert row.found[1] < row.before[1] and not row.kept
    tuned.save(tmp_path / "mine.toml")
    by_file = limpid.replay(log, estimator="pll", presets=tmp_path / "mine.toml")
    assert by_file.parameters == tuned.parameters["pll"]
    np.testing.assert_array_equal(by_file.velocity, after.velocity)


def test_tuning_on_scenarios_has_the_values_of_the_command(host_sim, tmp_path):
    tuned = limpid.tune(rate=1000, estimators="pll", scenarios=["step"], seeds=1, seconds=1)
    flags = "--estimator pll --rate 1000 --scenario step --seeds 1 --seconds 1 --out p.toml"
    subprocess.run([host_sim, "tune", *flags.split()], check=True, capture_output=True, cwd=tmp_path, timeout=300)
    replayed = limpid.replay([1, 2, 3], 1000, estimator="pll", presets=tmp_path / "p.toml")
    assert replayed.parameters == tuned.parameters["pll"]


def test_tuning_without_friction_is_that_of_the_command(host_sim, tmp_path):
    options = {"rate": 1000, "estimators": "pll", "scenarios": ["step"], "seeds": 1, "seconds": 1}
    tuned = limpid.tune(**options, friction=False)
    flags = "--estimator pll --rate 1000 --scenario step --seeds 1 --seconds 1 --frictionless --out p.toml"
    subprocess.run([host_sim, "tune", *flags.split()], check=True, capture_output=True, cwd=tmp_path, timeout=300)
    written = [line for line in (tmp_path / "p.toml").read_text().splitlines() if line and line[0] != "#"]
    assert [line for line in tuned.presets.splitlines() if line] == written
    assert 'plant = "frictionless"' in written
    with_friction = limpid.tune(**options).presets
    assert 'plant = "friction"' in with_friction and "frictionless" not in with_friction


@pytest.mark.parametrize("on_recordings", [True, False], ids=["recordings", "scenarios"])
def test_tuning_of_one_estimator_can_be_interrupted(on_recordings):
    def interrupt(*_):
        raise KeyboardInterrupt

    log = limpid.simulate("track", rate=10_000, seconds=5)
    scenarios = {"rate": 10_000, "scenarios": "track", "seeds": 1, "seconds": 5}
    options = {"estimators": "adaptive", **({"logs": log} if on_recordings else scenarios)}
    whole = time.process_time()
    limpid.tune(**options)
    whole = time.process_time() - whole
    old = signal.signal(signal.SIGALRM, interrupt)
    begun = time.process_time()
    try:
        # The alarm may come before the run begins.
        with pytest.raises(KeyboardInterrupt):
            signal.setitimer(signal.ITIMER_REAL, 0.01)
            limpid.tune(**options)
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, old)
    assert time.process_time() - begun < 0.2 * whole


@pytest.mark.parametrize(
    ("call", "said"),
    [
        (lambda: limpid.simulate("trak"), "'trak'; did you mean track?"),
        (lambda: limpid.simulate("track", scene="wall"), "scenario and scene: pass one of them"),
        (lambda: limpid.simulate(scene="nowhere"), "nowhere"),
        (lambda: limpid.simulate("track", rate=1), "rate 1 Hz: must be from 100 to 100000 Hz"),
        (lambda: limpid.simulate(every=0), "every=0: must be from 1 to 1000"),
        (lambda: limpid.simulate("track", every=5), "hand and every: are of a scene; leave them out"),
        (lambda: limpid.simulate("track", hand="still"), "hand and every: are of a scene; leave them out"),
        (lambda: limpid.simulate(hand="both"), "hand='both': must be still, clamp, nobody or moving"),
        (lambda: limpid.recommend([]), "logs: pass a limpid.Recording or several"),
        (lambda: limpid.recommend([1, 2]), "logs: pass a limpid.Recording or several"),
        (lambda: limpid.recommend(limpid.Recording(range(50), 1000)), "recording: 50 rows; scores need at least"),
        (lambda: limpid.recommend(limpid.Recording(range(50), 1000), instructions=0), "instructions=0: must be"),
        (lambda: limpid.tune(), "logs and rate: pass recordings, or the rate"),
        (lambda: limpid.tune(rate=1000, estimators="imm"), "none of them has parameters to tune"),
        (lambda: limpid.tune(rate=1000, seeds=0), "seeds=0: must be from 1 to 1000"),
        (lambda: limpid.tune(limpid.Recording(range(50), 1000)), "0.05 s are too short; tuning needs 4 s"),
        (lambda: limpid.tune(limpid.Recording(range(50), 1000), seeds=3), "are of simulated motion"),
        (lambda: limpid.scores([1.0] * 50, [1.0] * 50, 1000), "the first 0.1 s are not scored"),
        (lambda: limpid.scores([1.0] * 500, [1.0] * 50, 1000), "true_velocity: has 50 rows where velocity has 500"),
        (lambda: limpid.scores([1.0] * 500, [1.0] * 500), "rate: missing"),
    ],
)
def test_wrong_arguments_are_refused(call, said):
    with pytest.raises(ValueError) as error:
        call()
    assert said in str(error.value)
    assert "--" not in str(error.value)


@pytest.mark.parametrize(
    ("velocity", "said"),
    [
        (np.ones(300, dtype=complex), "velocity: has the type complex128; pass real numbers (rad/s)"),
        (["1.5"] * 300, "velocity: has the type <U3; pass real numbers (rad/s)"),
        (["a"] * 300, "velocity: has the type <U1; pass real numbers (rad/s)"),
        (np.r_[np.ones(299), np.nan], "velocity: row 299 is nan"),
    ],
)
def test_velocity_that_is_no_real_number_is_not_scored(velocity, said):
    with pytest.raises(ValueError) as error:
        limpid.scores(velocity, np.ones(300), 1000)
    assert said in str(error.value)


def test_recording_of_one_row_is_refused():
    for call in (limpid.recommend, limpid.tune):
        with pytest.raises(ValueError, match=r"recording: has one row; pass a recording of several seconds"):
            call(limpid.Recording([5], 1000))


def test_name_of_one_scenario_is_a_list_of_one():
    options = {"rate": 1000, "estimators": "low-pass", "seeds": 1, "seconds": 1}
    assert limpid.tune(scenarios="track", **options) == limpid.tune(scenarios=["track"], **options)


def test_recordings_of_two_encoders_are_refused():
    logs = [limpid.Recording(range(5000), 1000, counts_per_rev=counts) for counts in (90, 4096)]
    for call in (limpid.recommend, limpid.tune):
        with pytest.raises(ValueError, match="pass recordings of one encoder, or counts_per_rev"):
            call(logs)


def test_coarsening_is_refused_with_the_reason(data):
    fine = data / "real" / "epfl-paddle-hand.csv.gz"
    with pytest.raises(ValueError, match="ask for at most 15000 counts/rev"):
        limpid.coarsen(fine, 20_000)
    with pytest.raises(ValueError, match="rate=4: must be from 5 to 100000 Hz"):
        limpid.coarsen(fine, 1024, rate=4)
    with pytest.raises(ValueError, match="give fine_counts_per_rev=, or list the file"):
        limpid.coarsen(data / "back-and-forth.csv", 16)
    for none in (0, -3, 15, 4_000_001):
        with pytest.raises(ValueError, match=f"fine_counts_per_rev={none}: must be from 16 to 4000000"):
            limpid.coarsen(fine, 1024, fine_counts_per_rev=none)
    with pytest.raises(FileNotFoundError):
        limpid.coarsen(data / "nothing.csv", 16)


def test_forked_process_has_its_own_threads(tmp_path):
    """A pool of multiprocessing forks after the parent has tuned: the threads of the parent are not there."""
    program = """
import multiprocessing, limpid
log = limpid.simulate("track", rate=1000, seconds=5)
def experiments(_):
    return limpid.tune(log, estimators=["pll", "low-pass"]).presets, limpid.recommend(log).text
once = experiments(0)
with multiprocessing.get_context("fork").Pool(1) as pool:
    # Without threads of its own the process would wait for ever.
    assert pool.map_async(experiments, [0]).get(timeout=120) == [once]
"""
    # Not in the folder of the sources, which has a package of this name.
    subprocess.run([sys.executable, "-W", "ignore", "-c", program], check=True, cwd=tmp_path)
