"""Commands of the project in shards on the workers of a Dask cluster.

A shard is a task. Its worker runs the command with ``--shard K/N`` as a process and returns the shard's file. A
worker that is lost loses its tasks, and the scheduler gives them to other workers. Shards of an earlier run are kept
if they are of the same command with the same settings. The merge of the program refuses a shard that is missing or
incomplete, by its name. The outputs are those of the command without shards, byte for byte.

It needs the package ``distributed``: ``pip install limpid[cluster]``.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from distributed import Client

__all__ = ["Merged", "run"]


@dataclass(frozen=True)
class Merged:
    """What the command without shards prints; its files are there."""

    #: Standard output: the tables.
    text: str
    #: Lines of standard error.
    notes: list[str]
    #: What violates a criterion (exit status 1 of the command); None if nothing does.
    complaint: str | None


def _process(program: str | None, arguments: Sequence[str], folder: str) -> subprocess.CompletedProcess[str]:
    """Runs a program, by default the command line that is in this package, in ``folder`` if it is there."""
    words = [sys.executable, "-m", "limpid"] if program is None else [program]
    # The tasks share the cores of a worker, not the threads of one process. A module in the working folder is not
    # the package.
    variables = os.environ | {"RAYON_NUM_THREADS": "1", "PYTHONSAFEPATH": "1"}
    cwd = folder if os.path.isdir(folder) else None
    return subprocess.run([*words, *arguments], cwd=cwd, env=variables, capture_output=True, text=True)


def _failure(line: str) -> str:
    return line.removeprefix("error: ")


def _written(
    program: str | None, command: Sequence[str], part: str, folder: str, temporary: str | None
) -> bytes | ValueError:
    """The file of a shard; an error, which is not raised, if the program refuses the command: again it would."""
    with tempfile.TemporaryDirectory(dir=temporary) as out:
        try:
            done = _process(program, [*command, "--shard", part, "--out", out], folder)
        except OSError as error:
            return ValueError(f"program: {error}")
        lines = done.stderr.splitlines() or [""]
        if done.returncode == 2:
            return ValueError(_failure(lines[-1]))
        if done.returncode != 0:
            raise RuntimeError(f"shard {part}: ended with status {done.returncode}: {lines[-1]}")
        files = list(Path(out).iterdir())
        if len(files) != 1:
            return ValueError(
                f"command={list(command)}: wrote no shard; pass the words of a command that has --shard, for example "
                "['robust', '--devices', '100']"
            )
        return files[0].read_bytes()


def _shard(program: str | None, command: Sequence[str], part: str, folder: str) -> bytes | ValueError:
    """The file of a shard that a worker runs."""
    from distributed import get_worker

    # The folder of the worker is removed with it.
    return _written(program, command, part, folder, get_worker().local_directory)


#: The last part of the largest number of parts: it has one job at most, and its file the settings of the run.
_EMPTY = "1000000/1000000"


def _heading(shard: bytes) -> dict[str, Any]:
    """What the first line of a shard states on its run: the same for all shards of a run."""
    heading: dict[str, Any] = json.loads(shard.split(b"\n", 1)[0])
    del heading["part"]
    return heading


def _check(there: Sequence[Path], program: str | None, command: Sequence[str]) -> None:
    """Refuses shards that are there and are of another run than ``command``."""
    if not there:
        return
    empty = _written(program, command, _EMPTY, os.getcwd(), None)
    if isinstance(empty, ValueError):
        raise empty
    own = _heading(empty)
    for file in there:
        try:
            other = _heading(file.read_bytes())
        except (ValueError, TypeError, KeyError):
            # The merge would refuse it, after all other shards are run.
            what = "not a shard"
        else:
            if other == own:
                continue
            what = f"shard of another run: {_difference(other, own)}"
        raise ValueError(f"{file}: {what}; pass another out, or remove the folder {file.parent}")


def _difference(other: dict[str, Any], own: dict[str, Any]) -> str:
    for name in ("command", "version"):
        if other.get(name) != own[name]:
            return f"its {name} is {other.get(name)}, not {own[name]}"
    return "its settings differ, because a file that the command reads has changed"


def run(
    client: Client,
    command: Sequence[str],
    out: str | PathLike[str],
    *,
    shards: int = 16,
    program: str | PathLike[str] | None = None,
    retries: int = 3,
) -> Merged:
    """Runs a command in shards and merges them, for example ``["zwidth", "--lines", "1024"]``.

    Each shard is written into the folder ``OUT.shards`` as soon as it has ended, under the name that the command
    line gives it. A run that is started again takes the shards that are there and runs the others; if one of them
    is of another command or of other settings, nothing is run.

    Parameters
    ----------
    client
        Client of the cluster; its workers need this package, of the same version.
    command
        The words after ``cargo sim`` of a command that has ``--shard``, without its options for outputs. Files that
        it names are read by the workers: relative paths begin at the working folder of the client.
    out
        The option ``--out`` of the command; of ``stress`` its option ``--json``.
    shards
        Number of parts: several for each thread of a worker.
    program
        Another program, where the workers find it: ``target/release/stress`` for the words after ``cargo stress``.
        [default: the command line that is in this package]
    retries
        How often a shard is run again after an error. A shard whose worker is lost is run again anyway.

    Raises
    ------
    ValueError
        The program refuses the command or a shard; the message is the line that it prints. A shard that is there is
        of another run; the message names its file.
    """
    from distributed import as_completed

    if isinstance(command, str):
        raise ValueError(f"command={command!r}: pass a list of words, for example {command.split()}")
    if shards < 1:
        raise ValueError(f"shards={shards}: must be at least 1")
    name = None if program is None else os.fspath(program)
    if name is not None and os.path.dirname(name):
        name = os.path.abspath(name)
    folder = Path(f"{os.fspath(out)}.shards")
    folder.mkdir(parents=True, exist_ok=True)
    files = {part: folder / f"shard-{part}-of-{shards}.jsonl" for part in range(1, shards + 1)}
    there = [file for file in files.values() if file.exists()]
    _check(there, name, command)
    parts = {}
    for part, file in files.items():
        if file not in there:
            future = client.submit(
                _shard, name, list(command), f"{part}/{shards}", os.getcwd(), retries=retries, pure=False
            )
            parts[future] = part
    try:
        for future in as_completed(parts):  # type: ignore[no-untyped-call]
            result = future.result()
            if isinstance(result, ValueError):
                raise result
            file = files[parts[future]]
            # A file is there as a whole or not at all.
            partial = file.with_suffix(".partial")
            partial.write_bytes(result)
            partial.replace(file)
            future.release()
    except BaseException:
        client.cancel(list(parts))  # type: ignore[no-untyped-call]
        raise
    return _merge(name, list(files.values()), os.fspath(out))


def _merge(program: str | None, files: Sequence[Path], out: str) -> Merged:
    is_stress = program is not None and Path(program).stem == "stress"
    words, option = (["--merge"], "--json") if is_stress else (["merge"], "--out")
    done = _process(program, [*words, *map(str, files), option, out], os.getcwd())
    lines = done.stderr.splitlines()
    complaint = _failure(lines.pop()) if done.returncode and lines else None
    if done.returncode == 2:
        raise ValueError(complaint)
    if done.returncode not in (0, 1):
        raise RuntimeError(f"merge: ended with status {done.returncode}: {complaint}")
    return Merged(done.stdout, lines, complaint)
