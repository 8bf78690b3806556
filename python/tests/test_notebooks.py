"""The notebooks run, draw, and have the measured figures."""

from __future__ import annotations

import base64
import csv
import os
from pathlib import Path

import nbformat
import pytest
from nbclient import NotebookClient

pytestmark = pytest.mark.filterwarnings("ignore")

NOTEBOOKS = Path(__file__).parents[1] / "notebooks"


@pytest.fixture
def execute(data, monkeypatch, tmp_path):
    monkeypatch.setenv("LIMPID_DATA", str(data))
    monkeypatch.setenv("MPLBACKEND", "module://matplotlib_inline.backend_inline")

    def run(name, ask):
        """Executes a notebook; returns the values of the expression ``ask`` at its end, and its pictures."""
        notebook = nbformat.read(NOTEBOOKS / name, as_version=4)
        for cell in notebook.cells:
            assert not cell.get("outputs"), f"{name}: is committed without outputs"
        notebook.cells.append(nbformat.v4.new_code_cell(f"import json; print(json.dumps({ask}))"))
        NotebookClient(notebook, timeout=300, resources={"metadata": {"path": str(tmp_path)}}).execute()
        outputs = [output for cell in notebook.cells for output in cell.get("outputs", [])]
        pictures = [
            base64.b64decode(output["data"]["image/png"]) for output in outputs if "image/png" in output.get("data", {})
        ]
        if folder := os.environ.get("NOTEBOOK_PICTURES"):
            for number, picture in enumerate(pictures):
                (Path(folder) / f"{name}-{number}.png").write_bytes(picture)
        assert all(picture.startswith(b"\x89PNG") and len(picture) > 10_000 for picture in pictures)
        errors = [output for output in outputs if output.get("name") == "stderr"]
        assert not errors, errors
        return __import__("json").loads(outputs[-1]["text"]), len(pictures)

    return run


def test_your_own_log(execute):
    ask = "[errors, limpid.scores(shipped, hand)['rms_rad_s'], limpid.scores(tuned, hand)['rms_rad_s'], float(np.abs(imm.velocity - velocities).max())]"
    (errors, shipped, tuned, apart), pictures = execute("your-own-log.ipynb", ask)
    assert pictures == 4
    assert apart == 0
    assert tuned < 0.8 * shipped
    best = min(errors, key=errors.get)
    assert errors["finite-difference"] > 2 * errors[best] and len(errors) == 3


def test_figure_8(execute):
    """The figures are those of the measured table, which has six digits."""
    found, pictures = execute("figure-8.ipynb", "[[*key, value] for key, value in percent.items()]")
    assert pictures == 2
    percent = {(name, rate): value for name, rate, value in found}
    with (Path(__file__).parents[2] / "measured" / "paper.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == 5
    for row in rows:
        for rate, column in ((1000.0, "pct_1000hz"), (11_600.0, "pct_11600hz")):
            assert percent[row["estimator"], rate] == pytest.approx(float(row[column]), rel=1e-4)
    assert percent["adaptive", 1000.0] < percent["kalman-triple", 1000.0]
