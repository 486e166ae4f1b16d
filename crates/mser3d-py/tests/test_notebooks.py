"""The notebooks run, from the first cell to the last, and are kept without outputs."""

import json
import pathlib

import pytest

NOTEBOOKS = sorted((pathlib.Path(__file__).resolve().parents[1] / "notebooks").glob("*.ipynb"))


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_a_notebook_runs(path, tmp_path):
    nbclient = pytest.importorskip("nbclient")
    nbformat = pytest.importorskip("nbformat")
    pytest.importorskip("ipykernel")
    pytest.importorskip("pandas")
    notebook = nbformat.read(path, as_version=4)
    # What it writes goes elsewhere; paths in it are from where it lies.
    here = f"import os, pathlib; os.chdir({str(tmp_path)!r})"
    root = path.parents[3]
    for cell in notebook.cells:
        for up, where in (("../../../../shared", root.parent / "shared"), ("../../../fixtures", root / "fixtures")):
            cell.source = cell.source.replace(up, str(where))
    notebook.cells.insert(0, nbformat.v4.new_code_cell(here))
    nbclient.NotebookClient(notebook, timeout=120).execute()


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_a_notebook_has_no_outputs(path):
    cells = json.loads(path.read_text())["cells"]
    assert len(cells) > 5
    for cell in cells:
        assert cell["cell_type"] == "markdown" or (cell["outputs"] == [] and cell["execution_count"] is None)
