"""Experiments on the workers of a Dask cluster.

An experiment is divided into shards. Each shard is a task: a worker that is lost loses its tasks, and the
scheduler gives them to other workers. The result of each shard is a file with its settings; the merge of the
Rust code refuses a file that is missing, given twice, incomplete or of other settings, by its name. The merged
rows are those of one run, byte for byte.

It needs the package ``distributed``: ``pip install limpid[cluster]``.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

from . import _limpid

if TYPE_CHECKING:
    from distributed import Client

__all__ = ["Robust", "merge_robust", "robust", "robust_shard"]


@dataclass(frozen=True)
class Robust:
    """The closed loop on many devices."""

    #: The table of the command line.
    table: str
    #: What violates a criterion; None if no run does.
    complaint: str | None
    #: ``robust.csv`` and ``robust.json`` as ``cargo sim robust`` writes them.
    csv: bytes
    json: bytes


def robust_shard(shard: str, **options: Any) -> bytes:
    """Runs one shard, ``K/N``, and returns the content of its file; the options are those of :func:`robust`.

    The content is that of the file which ``cargo sim robust --shard K/N`` writes.
    """
    defaults: dict[str, Any] = {
        "scenes": [],
        "estimator": "kalman-triple-steady",
        "rate": 10_000.0,
        "devices": 1000,
        "seed": 1,
        "seconds": 2.0,
        "device": None,
    }
    unknown = set(options) - set(defaults)
    if unknown:
        raise TypeError(f"{', '.join(sorted(unknown))}: no such option; there are {', '.join(defaults)}")
    return _limpid.robust_shard(shard, **(defaults | options))


def merge_robust(shards: Sequence[str | PathLike[str]], out: str | PathLike[str] | None = None) -> Robust:
    """Merges the files of all shards of one run, in any order; ``out`` is a folder for robust.csv and robust.json.

    Raises
    ------
    ValueError
        A shard is missing, given twice, incomplete or of another run; the message names it.
    """
    csv, json, table, complaint = _limpid.robust_merge(list(shards))
    if out is not None:
        folder = Path(out)
        folder.mkdir(parents=True, exist_ok=True)
        (folder / "robust.csv").write_bytes(csv)
        (folder / "robust.json").write_bytes(json)
    return Robust(table, complaint, csv, json)


def robust(
    client: Client,
    out: str | PathLike[str],
    *,
    shards: int = 16,
    retries: int = 3,
    scenes: Sequence[str] = (),
    estimator: str = "kalman-triple-steady",
    rate: float = 10_000.0,
    devices: int = 1000,
    seed: int = 1,
    seconds: float = 2.0,
    device: dict[str, Any] | None = None,
) -> Robust:
    """Checks the closed loop on devices that differ from the controller's, as ``cargo sim robust`` does.

    Each shard is written into the folder ``out`` as soon as it has ended, under the name that the command line
    gives it. A run that is started again takes the shards that are there and runs the others.

    Parameters
    ----------
    client
        Client of the cluster; its workers need this package.
    out
        Folder of the shards, and of robust.csv and robust.json.
    shards
        Number of parts into which the devices of each scene are divided: several per worker.
    retries
        How often a shard is tried again after an error. A shard whose worker is lost is tried again anyway.
    scenes, estimator, rate, devices, seed, seconds, device
        The options of ``cargo sim robust``.
    """
    from distributed import as_completed

    options = {
        "scenes": list(scenes),
        "estimator": estimator,
        "rate": rate,
        "devices": devices,
        "seed": seed,
        "seconds": seconds,
        "device": device,
    }
    folder = Path(out)
    folder.mkdir(parents=True, exist_ok=True)
    files = {part: folder / f"shard-{part}-of-{shards}.jsonl" for part in range(1, shards + 1)}
    parts = {}
    for part, file in files.items():
        if not file.exists():
            future = client.submit(robust_shard, f"{part}/{shards}", **options, retries=retries, pure=False)
            parts[future] = part
    for future in as_completed(parts):  # type: ignore[no-untyped-call]
        file = files[parts[future]]
        # A file is there as a whole or not at all.
        partial = file.with_suffix(".partial")
        partial.write_bytes(future.result())
        partial.replace(file)
        future.release()
    return merge_robust(list(files.values()), out)
