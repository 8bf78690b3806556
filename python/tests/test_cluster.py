"""Experiments on worker processes."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import threading
import time
import warnings

import pytest

from limpid import cluster

with warnings.catch_warnings():
    warnings.simplefilter("ignore")
    from distributed import Client, LocalCluster

pytestmark = pytest.mark.filterwarnings("ignore")

RUN = {"scenes": ["off", "wall"], "rate": 1000, "devices": 40, "seconds": 0.5, "seed": 3}
FLAGS = "--scene off --scene wall --rate 1000 --devices 40 --seconds 0.5 --seed 3"


@pytest.fixture
def one_run(host_sim, tmp_path):
    """robust.csv and robust.json of a run of the command line."""
    folder = tmp_path / "one"
    # Exit status 1 says that a device violates a criterion.
    done = subprocess.run([host_sim, "robust", *FLAGS.split(), "--out", str(folder)], capture_output=True, timeout=300)
    assert done.returncode in (0, 1), done.stderr
    return (folder / "robust.csv").read_bytes(), (folder / "robust.json").read_bytes()


@pytest.fixture
def client():
    with (
        LocalCluster(n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None) as local,
        Client(local) as client,
    ):
        yield client


def test_shard_is_that_of_the_command(host_sim, tmp_path):
    subprocess.run([host_sim, "robust", *FLAGS.split(), "--shard", "2/5", "--out", str(tmp_path)], capture_output=True)
    ours, theirs = (
        text.splitlines() for text in (cluster.robust_shard("2/5", **RUN), (tmp_path / "shard-2-of-5.jsonl").read_bytes())
    )
    headings = [json.loads(lines[0]) for lines in (ours, theirs)]
    # Of the command line, ours has all options and theirs those that were given; the last line is a checksum.
    assert all(heading.pop("command").startswith("host-sim robust --scene off") for heading in headings)
    assert headings[0] == headings[1]
    assert ours[1:-1] == theirs[1:-1] and len(ours) > 10


def test_worker_that_is_killed_loses_nothing(client, one_run, tmp_path):
    out = tmp_path / "out"
    pids = client.run(os.getpid)
    assert len(set(pids.values())) == 2
    there = []

    def kill():
        # Once some shards are there, and others are not.
        while not any(out.glob("shard-*.jsonl")):
            time.sleep(0.005)
        os.kill(next(iter(pids.values())), signal.SIGKILL)
        there.append(len(list(out.glob("shard-*.jsonl"))))

    thread = threading.Thread(target=kill)
    thread.start()
    found = cluster.robust(client, out, shards=24, **RUN)
    thread.join()
    assert 1 <= there[0] < 24
    assert set(client.run(os.getpid).values()) != set(pids.values())
    assert len(list(out.glob("shard-*-of-24.jsonl"))) == 24
    assert (found.csv, found.json) == one_run
    assert (out / "robust.csv").read_bytes() == found.csv
    assert "wall" in found.table
    # A run that is started again takes what is there: one lost shard is made again.
    lost = out / "shard-7-of-24.jsonl"
    text = lost.read_bytes()
    lost.unlink()
    others = {path: path.stat().st_mtime_ns for path in out.glob("shard-*.jsonl")}
    again = cluster.robust(client, out, shards=24, **RUN)
    assert again.csv == found.csv and lost.read_bytes() == text
    assert others == {path: path.stat().st_mtime_ns for path in others}


def test_shards_that_are_lost_twice_or_of_another_run_are_refused_by_name(tmp_path):
    few = RUN | {"devices": 2, "seconds": 0.1}
    paths = []
    for part in (1, 2, 3):
        path = tmp_path / f"shard-{part}-of-3.jsonl"
        path.write_bytes(cluster.robust_shard(f"{part}/3", **few))
        paths.append(path)
    whole = cluster.merge_robust(paths)
    assert cluster.merge_robust(reversed(paths)).csv == whole.csv
    with pytest.raises(ValueError, match="shard 2/3 is missing"):
        cluster.merge_robust([paths[0], paths[2]])
    with pytest.raises(ValueError, match="shard-3-of-3.jsonl: shard 3/3 is already given by"):
        cluster.merge_robust([*paths, paths[2]])
    other = tmp_path / "other.jsonl"
    other.write_bytes(cluster.robust_shard("2/3", **(few | {"seed": 4})))
    with pytest.raises(ValueError, match="other.jsonl: settings differ"):
        cluster.merge_robust([paths[0], other, paths[2]])
    cut = paths[1].read_bytes().splitlines(keepends=True)
    paths[1].write_bytes(b"".join(cut[:-1]))
    with pytest.raises(ValueError, match=r"shard-2-of-3.jsonl: its end is missing; run host-sim robust --scene off .*--shard 2/3"):
        cluster.merge_robust(paths)


def test_wrong_options_are_refused():
    with pytest.raises(TypeError, match="scene: no such option; there are scenes, "):
        cluster.robust_shard("1/2", scene="wall")
    with pytest.raises(ValueError, match="shard='3/2': must be K/N"):
        cluster.robust_shard("3/2")
    with pytest.raises(ValueError, match="choose another one"):
        cluster.robust_shard("1/2", estimator="adaptive")
