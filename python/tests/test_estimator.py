"""Estimators that take rows as they come."""

from __future__ import annotations

import signal
import threading
import time
import types
import weakref

import numpy as np
import pytest

import limpid

NAMES = [info.name for info in limpid.estimators()]


def needed(name, signals):
    """The signals that the estimator needs."""
    (info,) = [info for info in limpid.estimators() if info.name == name]
    columns = {"counts": signals["counts"]}
    for need in info.needs:
        for column in ("edge_age", "edge_boundary") if need == "edge" else (need,):
            columns[column] = signals[column]
    return columns


def same(reports, replayed, rows=slice(None)):
    for name in ("velocity", "std_dev", "acceleration", "damping_ratio"):
        ours, theirs = getattr(reports, name), getattr(replayed, name)
        assert (ours is None) == (theirs is None), name
        if ours is not None:
            np.testing.assert_array_equal(ours.view(np.uint32), theirs[rows].view(np.uint32), err_msg=name)


@pytest.mark.parametrize("name", NAMES)
def test_rows_blocks_and_the_whole_have_the_same_bits(name, signals):
    columns = needed(name, signals)
    whole = limpid.replay(rate=1000, estimator=name, **columns)
    estimator = limpid.Estimator(name, rate=1000)
    # Blocks of one row, of odd numbers, and one that is longer than a section.
    ends = [0, 1, 2, 3, 100, 1000, 1777, 20_000, len(columns["counts"])]
    for start, end in zip(ends, ends[1:]):
        block = {column: values[start:end] for column, values in columns.items()}
        same(estimator.process(**block), whole, slice(start, end))
    estimator.reset()
    for row in range(2000):
        one = {column: values[row] for column, values in columns.items()}
        velocity = estimator.update(one.pop("counts"), **one)
        assert velocity == whole.velocity[row], row
        if row % 500 == 499:
            for report in ("std_dev", "acceleration", "damping_ratio"):
                ours, theirs = getattr(estimator, report), getattr(whole, report)
                assert (ours is None) == (theirs is None)
                assert ours is None or ours == theirs[row]


def test_varying_steps_have_the_bits_of_replay():
    rng = np.random.default_rng(4)
    t = np.cumsum(rng.uniform(0.6e-3, 1.4e-3, 3000))
    counts = np.floor(900 * np.sin(5 * t)).astype(np.int64)
    replayed = limpid.replay(counts, t=t, estimator="imm")
    dt = np.r_[0, np.diff(t)]
    estimator = limpid.Estimator("imm", rate=replayed.rate, varying=True)
    same(estimator.process(counts, dt=dt), replayed)
    estimator.reset()
    velocities = [estimator.update(count, dt=step) for count, step in zip(counts, dt)]
    np.testing.assert_array_equal(np.float32(velocities), replayed.velocity)


def test_absolute_encoder_is_unwrapped_with_its_edges(signals):
    columns = needed("m-over-t", signals)
    whole = limpid.replay(rate=1000, estimator="m-over-t", **columns)
    estimator = limpid.Estimator("m-over-t", rate=1000, modulus=4096)
    columns["edge_boundary"] = columns["edge_boundary"] % 4096
    columns["counts"] = columns["counts"] % 4096
    half = {column: values[:30_000] for column, values in columns.items()}
    same(estimator.process(**half), whole, slice(0, 30_000))
    for row in range(30_000, 30_500):
        one = {column: values[row] for column, values in columns.items()}
        assert estimator.update(one.pop("counts"), **one) == whole.velocity[row]


def test_both_encoders_are_unwrapped(signals):
    columns = needed("observer", signals)
    columns["coupled"] = columns["coupled"] % 2500
    columns["counts"] = columns["counts"] % 4096
    moduli = {"counts": 4096, "coupled": 2500}
    whole = limpid.Estimator("observer", rate=1000).process(**needed("observer", signals))
    estimator = limpid.Estimator("observer", rate=1000, modulus=moduli)
    half = {column: values[:30_000] for column, values in columns.items()}
    same(estimator.process(**half), whole, slice(0, 30_000))
    for row in range(30_000, 30_500):
        one = {column: values[row] for column, values in columns.items()}
        assert estimator.update(one.pop("counts"), **one) == whole.velocity[row]


def test_modulus_says_whether_coupled_wraps(signals):
    columns = {column: values[:3000] for column, values in needed("observer", signals).items()}
    whole = limpid.Estimator("observer", rate=1000).process(**columns)
    columns["counts"] = columns["counts"] % 4096
    with pytest.raises(ValueError, match="modulus=4096: does not say where coupled wraps"):
        limpid.Estimator("observer", rate=1000, modulus=4096).process(**columns)
    same(limpid.Estimator("observer", rate=1000, modulus={"counts": 4096}).process(**columns), whole)
    with pytest.raises(ValueError, match="row 1: coupled=9 with modulus=5"):
        limpid.Estimator("observer", modulus={"coupled": 5}).process([1, 2], coupled=[1, 9], current=[0, 0])


def test_integers_of_any_size_and_type_are_counts():
    estimator = limpid.Estimator("finite-difference", rate=1000)
    scale = float(np.float32(2 * np.pi * 1000 / 4096))
    estimator.update(-1)
    assert estimator.update(np.uint16(1)) == np.float32(2 * scale)
    assert estimator.update(2**32 + 4) == np.float32(3 * scale)
    assert estimator.update(2**90 + 5) == np.float32(scale)
    assert estimator.update(np.int64(5)) == 0
    assert estimator.update(True) == np.float32(-4 * scale)


def test_two_estimators_run_in_two_threads(signals):
    """Each thread has its own estimator; both give what one thread gives."""
    counts = np.tile(signals["counts"], 4)
    expected = {name: limpid.replay(counts, 1000, estimator=name).velocity for name in ("imm", "robust-exact")}
    found = {}

    def run(name):
        estimator = limpid.Estimator(name, rate=1000)
        blocks = np.array_split(counts, 50)
        found[name] = np.concatenate([estimator.process(block).velocity for block in blocks])

    threads = [threading.Thread(target=run, args=(name,)) for name in expected]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    for name, velocity in expected.items():
        np.testing.assert_array_equal(found[name], velocity)


def test_one_estimator_serves_two_threads():
    """Every row is taken once: with the same count in all rows of a thread, only changes have a velocity."""
    estimator = limpid.Estimator("finite-difference", rate=1000)
    scale = float(np.float32(2 * np.pi * 1000 / 4096))
    steps = [[], []]

    def run(thread):
        for _ in range(3000):
            steps[thread].append(estimator.update(thread) / scale)
        steps[thread].extend(estimator.process(np.full(300_000, thread)).velocity / scale)

    threads = [threading.Thread(target=run, args=(thread,)) for thread in (0, 1)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    # The counts are 0 and 1 in turn: the sum of all steps is the last count less the first one.
    total = round(sum(map(float, steps[0])) + sum(map(float, steps[1])))
    assert total in (-1, 0, 1)
    assert {round(float(step)) for step in steps[1]} <= {0, 1}
    assert {round(float(step)) for step in steps[0]} <= {0, -1}


def test_other_threads_run_meanwhile(signals):
    """The interpreter's lock is released: this thread counts while the other one estimates."""
    counts = np.tile(signals["counts"], 40)
    estimator = limpid.Estimator("robust-exact", rate=1000)
    started, ended = threading.Event(), threading.Event()
    columns = [np.ascontiguousarray(counts.astype(np.uint32)), None, None, None, None, None]

    def run():
        started.set()
        # Without the checks of process(), which are those of NumPy and release the lock themselves.
        estimator._process(*columns)
        ended.set()

    thread = threading.Thread(target=run)
    thread.start()
    started.wait()
    counted = 0
    while not ended.is_set():
        time.sleep(0.001)
        counted += 1
    thread.join()
    # With the lock held, this thread would count once or twice. The other one takes more than a second.
    assert counted > 10


def test_ctrl_c_is_looked_for(signals):
    """The handler of a signal is called while an estimator runs, not only after it."""
    counts = np.tile(signals["counts"], 60)
    calls = []
    old = signal.signal(signal.SIGALRM, lambda *_: calls.append(None))
    signal.setitimer(signal.ITIMER_REAL, 0.01, 0.01)
    try:
        limpid.replay(counts, 1000, estimator="robust-exact")
        during = len(calls)
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, old)
    assert during > 3


def test_interrupt_ends_the_run(signals):
    def interrupt(*_):
        raise KeyboardInterrupt

    old = signal.signal(signal.SIGALRM, interrupt)
    signal.setitimer(signal.ITIMER_REAL, 0.02)
    try:
        with pytest.raises(KeyboardInterrupt):
            limpid.replay(np.tile(signals["counts"], 60), 1000, estimator="robust-exact")
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, old)


def test_interrupted_rows_can_be_given_again(signals):
    def interrupt(*_):
        raise KeyboardInterrupt

    counts = np.tile(signals["counts"], 60) % 4096
    first, rest = counts[:1000], counts[1000:]
    once, again = (limpid.Estimator("robust-exact", 1000, modulus=4096) for _ in range(2))
    for estimator in (once, again):
        estimator.process(first)
    old = signal.signal(signal.SIGALRM, interrupt)
    signal.setitimer(signal.ITIMER_REAL, 0.02)
    try:
        with pytest.raises(KeyboardInterrupt):
            again.process(rest)
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, old)
    few = rest[:5000]
    np.testing.assert_array_equal(again.process(few).velocity, once.process(few).velocity)


def test_handler_of_a_signal_is_refused_the_estimator_that_it_interrupts(signals):
    counts = np.tile(signals["counts"], 60)
    estimator, other = (limpid.Estimator("robust-exact", 1000) for _ in range(2))
    found = []

    def handler(*_):
        try:
            estimator.std_dev
        except RuntimeError:
            pass
        else:
            # Before or after the run.
            return
        for use in (
            lambda: estimator.update(1),
            lambda: estimator.process([1]),
            lambda: estimator.std_dev,
            estimator.reset,
        ):
            with pytest.raises(RuntimeError, match="estimator: busy; the handler of a signal"):
                use()
        found.append(other.update(1))

    old = signal.signal(signal.SIGALRM, handler)
    signal.setitimer(signal.ITIMER_REAL, 0.02, 0.02)
    try:
        interrupted = estimator.process(counts)
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, old)
    assert set(found) == {0}
    same(interrupted, limpid.Estimator("robust-exact", 1000).process(counts))


def test_counter_of_16_bits_has_the_bits_of_replay_with_its_modulus():
    counts = (np.arange(40_000) * 3).astype(np.uint16)
    replayed = limpid.replay(counts, 1000)
    assert replayed.notes[0].startswith("counts wraps at 65536 and is unwrapped")
    streamed = limpid.Estimator("imm", rate=1000, modulus=65536).process(counts).velocity
    np.testing.assert_array_equal(streamed, replayed.velocity)


def test_parameters_are_a_mapping():
    parameters = types.MappingProxyType({"cutoff_hz": 40.0})
    assert limpid.Estimator("low-pass", parameters=parameters).parameters == dict(parameters)
    assert limpid.replay([1, 2, 3], 1000, estimator="low-pass", parameters=parameters).parameters == dict(parameters)
    moduli = types.MappingProxyType({"counts": 4096})
    assert limpid.Estimator("low-pass", modulus=moduli).update(7) == 0
    for wrong in (5, {"cutoff_hz": "x"}, ["cutoff_hz"]):
        with pytest.raises(TypeError, match="parameters: give a dict of names with numbers as values"):
            limpid.Estimator("low-pass", parameters=wrong)


def test_attribute_without_effect_is_refused():
    estimator = limpid.Estimator("pll")
    for name in ("modulus", "varying", "bandwidth_hz"):
        with pytest.raises(AttributeError, match=name):
            setattr(estimator, name, 4096)
    # Objects may still refer to it weakly.
    assert weakref.ref(estimator)() is estimator


def test_count_at_the_modulus_or_above_is_refused():
    for count in (100, 1000, -101, 2**31):
        estimator = limpid.Estimator("finite-difference", rate=1000, modulus=100)
        signed = (count + 2**31) % 2**32 - 2**31
        with pytest.raises(ValueError, match=f"row 2: counts={signed} with modulus=100: raw must be below modulus"):
            estimator.process([0, 50, count, 99])
        with pytest.raises(ValueError, match="raw must be below modulus"):
            estimator.update(count)
        # The rows can be given again. A counter may count down below zero.
        expected = limpid.replay([0, 40, 79, 78], 1000, estimator="finite-difference").velocity
        np.testing.assert_array_equal(estimator.process([0, 40, 79, -22]).velocity, expected)


@pytest.mark.parametrize(
    "options",
    [{}, {"varying": True}, {"modulus": 4096}, {"modulus": {"coupled": 65536}}, {"modulus": {"counts": 5, "coupled": 7}}],
)
def test_text_of_an_estimator_makes_the_same_one(options):
    text = repr(limpid.Estimator("imm", 2000, counts_per_rev=1024, **options))
    assert text == repr(eval(text))
    assert all(f"{name}={value!r}" in text for name, value in options.items()), text
