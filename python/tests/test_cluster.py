"""Commands in shards on worker processes."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import threading
import time
import warnings
from pathlib import Path

import pytest

from limpid import cluster

with warnings.catch_warnings():
    warnings.simplefilter("ignore")
    from distributed import Client, LocalCluster

pytestmark = pytest.mark.filterwarnings("ignore")

# A handle so heavy that a hand that moves it feels more than the limit.
HEAVY = "[hand]\nstiffness_nm_per_rad = 200\ndamping_nms_per_rad = 1\n[small]\ninertia_kg_m2 = 1e-2\n"

TINY = "robust --scene off --rate 1000 --devices 2 --seconds 0.05".split()


@pytest.fixture
def client():
    with (
        LocalCluster(n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None) as local,
        Client(local) as client,
    ):
        yield client


@pytest.fixture
def folders(tmp_path, monkeypatch):
    """A folder for a run of the command line, and one for shards, which is the working folder."""
    one, many = tmp_path / "one", tmp_path / "many"
    one.mkdir()
    many.mkdir()
    monkeypatch.chdir(many)
    return one, many


def single_run(folder, program, *words, status=0):
    done = subprocess.run([program, *words], cwd=folder, capture_output=True, text=True, timeout=300)
    assert done.returncode == status, done.stderr
    return done


def files(folder):
    return {path.relative_to(folder): path.read_bytes() for path in Path(folder).rglob("*") if path.is_file()}


@pytest.mark.parametrize(
    ("command", "shards", "file", "status"),
    [
        ("robust --scene off --rate 1000 --devices 80 --seconds 0.5 --device heavy.toml", 12, "robust.csv", 1),
        ("zwidth --rate 1000 --lines 256 --lines 512 --lines 1024 --estimator pll --estimator low-pass", 6, "zwidth.csv", 0),
    ],
    ids=["robust", "zwidth"],
)
def test_worker_that_is_killed_loses_nothing(command, shards, file, status, client, host_sim, folders):
    one, many = folders
    for folder in folders:
        (folder / "heavy.toml").write_text(HEAVY)
    command = command.split()
    whole = single_run(one, host_sim, *command, "--out", "page", status=status)
    parts = many / "page.shards"
    pids = client.run(os.getpid)
    assert len(set(pids.values())) == 2
    there = []

    def kill():
        # Once some shards are there, and others are not.
        while not any(parts.glob("shard-*.jsonl")):
            time.sleep(0.005)
        os.kill(next(iter(pids.values())), signal.SIGKILL)
        there.append(len(list(parts.glob("shard-*.jsonl"))))

    thread = threading.Thread(target=kill)
    thread.start()
    found = cluster.run(client, command, "page", shards=shards)
    thread.join()
    assert 1 <= there[0] < shards
    assert set(client.run(os.getpid).values()) != set(pids.values())
    assert found.text == whole.stdout
    assert [f"error: {found.complaint}"] * status == whole.stderr.splitlines()
    assert Path(file) in files("page") and files("page") == files(one / "page")

    # The shard is that of the command line, and a run that is started again takes what is there.
    single_run(one, host_sim, *command, "--shard", f"2/{shards}", "--out", "parts")
    lost = parts / f"shard-2-of-{shards}.jsonl"
    assert files(one / "parts") == {Path(lost.name): lost.read_bytes()}
    lost.unlink()
    others = {path: path.stat().st_mtime_ns for path in parts.iterdir()}
    assert len(others) == shards - 1
    assert cluster.run(client, command, "page", shards=shards).text == found.text
    assert files(one / "parts") == {Path(lost.name): lost.read_bytes()}
    assert others == {path: path.stat().st_mtime_ns for path in others}


def test_recordings_are_tuned_on_in_shards(client, host_sim, folders):
    one, many = folders
    for folder in folders:
        single_run(folder, host_sim, *"simulate --scenario track --rate 1000 --seconds 6 --out log.csv".split())
    command = "tune log.csv --estimator pll --estimator low-pass --estimator kalman-triple-steady".split()
    whole = single_run(one, host_sim, *command, "--out", "presets.toml")
    found = cluster.run(client, command, "presets.toml", shards=2)
    assert found.text == whole.stdout and found.notes == whole.stderr.splitlines()
    assert (many / "presets.toml").read_bytes() == (one / "presets.toml").read_bytes()


def test_stress_runs_in_shards(client, stress, folders):
    one, many = folders
    command = "--ticks 3000 --estimator kalman-triple-s --rate 1000".split()
    whole = single_run(one, stress, *command, "--json", "findings.json")
    found = cluster.run(client, command, "findings.json", shards=3, program=stress)
    assert found.text == whole.stdout and "kalman-triple-steady" in found.text
    assert (many / "findings.json").read_bytes() == (one / "findings.json").read_bytes()


def test_shard_whose_process_is_killed_is_run_again(client, host_sim, folders):
    one, many = folders
    program = many / "killed-once"
    program.write_text(f'#!/bin/sh\nmkdir "{one}/${{2#--}}" 2> /dev/null && kill -9 $$\nexec {host_sim} "$@"\n')
    program.chmod(0o755)
    whole = single_run(one, host_sim, *TINY, "--out", "page")
    found = cluster.run(client, TINY, "page", shards=2, program="./killed-once")
    assert (one / "scene").is_dir() and found.text == whole.stdout
    program.write_text("#!/bin/sh\nkill -9 $$\n")
    with pytest.raises(RuntimeError, match="shard [12]/2: ended with status -9"):
        cluster.run(client, TINY, "other", shards=2, program="./killed-once", retries=1)


def test_wrong_command_is_refused_in_one_line(client, folders):
    for command, said in [
        (["zwidth", "--linse", "256"], "unexpected argument '--linse' found; tip: .*'--lines'; see host-sim zwidth --help"),
        (["compare"], "unexpected argument '--shard' found; see host-sim compare --help"),
        (["robust", "--estimator", "adaptive"], "choose another one"),
        (["robust", "--out", "page"], "'--out <DIR>' cannot be used multiple times"),
        (["tune", "log.csv"], "log.csv: cannot read"),
        ("robust --devices 2", r"command='robust --devices 2': pass a list of words, for example \['robust', '--devices', '2'\]"),
    ]:
        with pytest.raises(ValueError, match=said) as error:
            cluster.run(client, command, "out", shards=2)
        assert len(str(error.value).splitlines()) == 1
    with pytest.raises(ValueError, match="program: .*nowhere/stress"):
        cluster.run(client, TINY, "out", program="nowhere/stress")
    with pytest.raises(ValueError, match="shards=0: must be at least 1"):
        cluster.run(client, TINY, "out", shards=0)
    assert not files(folders[1])


def test_shards_of_another_run_are_refused_by_name_before_anything_is_run(client, folders):
    (folders[1] / "device.toml").write_text("[large]\ncounts_per_rev = 4096\n")
    command = [*TINY, "--device", "device.toml"]
    first = cluster.run(client, command, "page", shards=2)
    before = files(".")
    others = [
        (["robust", *command[1:], "--seed", "4"], r"--seed 4"),
        ("zwidth --lines 64 --estimator pll --rate 10000".split(), "host-sim zwidth"),
    ]
    for complete in (True, False):
        if not complete:
            Path("page.shards/shard-1-of-2.jsonl").unlink()
            del before[Path("page.shards/shard-1-of-2.jsonl")]
        for other, said in others:
            with pytest.raises(ValueError) as error:
                cluster.run(client, other, "page", shards=2)
            text = str(error.value)
            name = "page.shards/shard-1-of-2.jsonl" if complete else "page.shards/shard-2-of-2.jsonl"
            assert text.startswith(f"{name}: shard of another run: its command is host-sim robust --scene off")
            assert said in text and text.endswith("; pass another out, or remove the folder page.shards")
            assert files(".") == before
    # A file that the command reads has changed.
    (folders[1] / "device.toml").write_text("[large]\ncounts_per_rev = 2048\n")
    with pytest.raises(ValueError, match="shard of another run: its settings differ, because a file"):
        cluster.run(client, command, "page", shards=2)
    (folders[1] / "device.toml").write_text("[large]\ncounts_per_rev = 4096\n")
    assert cluster.run(client, command, "page", shards=2) == first
    Path("page.shards/shard-2-of-2.jsonl").write_text("{}\n")
    with pytest.raises(ValueError, match="page.shards/shard-2-of-2.jsonl: not a shard; pass another out"):
        cluster.run(client, command, "page", shards=2)


def test_program_that_writes_no_shard_is_refused(client, folders):
    for command, program in [(["robust", "--help"], None), (["--version"], None), (TINY, "/bin/true")]:
        with pytest.raises(ValueError, match="wrote no shard; pass the words of a command that has --shard"):
            cluster.run(client, command, "out", shards=2, program=program)
    assert not files(folders[1])


@pytest.mark.skipif(sys.version_info < (3, 11), reason="Python 3.10 has no PYTHONSAFEPATH")
def test_module_in_the_working_folder_is_not_the_package(client, folders):
    Path("limpid.py").write_text("raise SystemExit('another module')\n")
    assert "off" in cluster.run(client, TINY, "page", shards=1).text


def test_processes_have_one_thread_and_no_module_of_the_working_folder(monkeypatch, tmp_path):
    """Whatever the environment of the worker says."""
    monkeypatch.setenv("RAYON_NUM_THREADS", "7")
    monkeypatch.setenv("PYTHONSAFEPATH", "")
    monkeypatch.setenv("LIMPID_TEST", "kept")
    done = cluster._process("env", [], str(tmp_path))
    variables = dict(line.split("=", 1) for line in done.stdout.splitlines() if "=" in line)
    assert (variables["RAYON_NUM_THREADS"], variables["PYTHONSAFEPATH"]) == ("1", "1")
    assert variables["LIMPID_TEST"] == "kept"


def test_package_is_the_command_line(host_sim, tmp_path):
    for words, status in [(["scenarios"], 0), (["merge", "none.jsonl"], 2), (["--version"], 0)]:
        ours, theirs = (
            subprocess.run([*program, *words], cwd=tmp_path, capture_output=True)
            for program in ([sys.executable, "-m", "limpid"], [host_sim])
        )
        assert ours.returncode == status
        assert (ours.returncode, ours.stdout, ours.stderr) == (theirs.returncode, theirs.stdout, theirs.stderr)


def test_interrupt_ends_a_command(tmp_path):
    words = ["robust", "--devices", "1000000", "--out", "page"]
    process = subprocess.Popen([sys.executable, "-m", "limpid", *words], cwd=tmp_path, stderr=subprocess.PIPE)
    time.sleep(2)
    process.send_signal(signal.SIGINT)
    try:
        process.communicate(timeout=30)
    finally:
        process.kill()
    assert process.returncode in (-signal.SIGINT, 130)
    assert not files(tmp_path)
