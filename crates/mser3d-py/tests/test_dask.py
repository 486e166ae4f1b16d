"""Many shapes on Dask: the same as `mser3d batch`, whatever happens to workers."""

import json
import os
import pathlib
import signal
import subprocess
import sys
import threading
import time

import mser3d
import pytest
from conftest import FIXTURES, cli
from shapes import QUICK, QUICK_WORDS, write_shapes

distributed = pytest.importorskip("distributed")
pytest.importorskip("dask.dataframe")

from mser3d.dask import detect_many, query_many  # noqa: E402

TABLES = ["regions.parquet", "shapes.parquet", "failures.json"]
COUNT = 60


@pytest.fixture(scope="module")
def shapes(tmp_path_factory):
    """Sixty shapes and one that cannot be read, and what the command line makes of them."""
    folder = tmp_path_factory.mktemp("many")
    write_shapes(folder / "in", COUNT)
    (folder / "in/bad.off").write_text("OFF\n3 1 0\n0 0 0\n")
    done = cli("batch", folder / "in", "-o", folder / "expected", "-q", *QUICK_WORDS)
    assert done.returncode == 1 and "1 of 61 shapes failed" in done.stderr
    return folder


@pytest.fixture(scope="module")
def client():
    """Two processes with a thread each."""
    with distributed.LocalCluster(
        n_workers=2, threads_per_worker=1, resources={"memory": 2e9}, memory_limit="3GB", dashboard_address=None
    ) as cluster, distributed.Client(cluster) as client:
        yield client


def assert_as_expected(folder, shapes):
    for table in TABLES:
        assert (folder / table).read_bytes() == (shapes / "expected" / table).read_bytes(), table
    names = sorted(path.name for path in folder.iterdir() if path.is_dir())
    assert names == sorted(path.name for path in (shapes / "expected").iterdir() if path.is_dir())


def test_the_same_as_batch_and_again_nothing(shapes, client, tmp_path):
    told = []
    hear = lambda *now: told.append(now)  # noqa: E731
    with pytest.warns(mser3d.Mser3dWarning, match="bad failed: .*bad.off"):
        batch = detect_many(shapes / "in", out=tmp_path / "out", client=client, progress=hear, **QUICK)
    assert (batch.computed, batch.kept, [failure.name for failure in batch.failed]) == (COUNT, 0, ["bad"])
    assert batch.shapes == COUNT and batch.regions > COUNT
    assert_as_expected(tmp_path / "out", shapes)
    shares = [overall for _, _, overall in told]
    assert shares == sorted(shares) and shares[-1] == 1.0 and told[0][0] == "shapes"

    written = {path: path.stat().st_mtime_ns for path in (tmp_path / "out").glob("*/regions.json")}
    with pytest.warns(mser3d.Mser3dWarning, match="bad failed"):
        again = detect_many(shapes / "in", out=tmp_path / "out", client=client, **QUICK)
    assert (again.computed, again.kept) == (0, COUNT)
    assert written == {path: path.stat().st_mtime_ns for path in written}
    assert_as_expected(tmp_path / "out", shapes)

    # Batch keeps them too, and other parameters are no longer theirs.
    summary = json.loads(cli("batch", shapes / "in", "-o", tmp_path / "out", "--json", *QUICK_WORDS).stdout)
    assert (summary["computed"], summary["kept"]) == (0, COUNT)
    few = [shapes / "in/shape00000.off", shapes / "in/shape00001.off"]
    other = detect_many(few, out=tmp_path / "out", client=client, **{**QUICK, "min_volume": 0.03})
    assert (other.computed, other.kept, other.shapes) == (2, 0, COUNT)


@pytest.mark.skipif(os.name == "nt", reason="signals of Unix")
def test_a_worker_that_is_killed_loses_and_doubles_nothing(shapes, client, tmp_path):
    out = tmp_path / "out"
    victims = list(client.run(os.getpid).values())
    killed = []

    def kill():
        while not killed:
            if len(list(out.glob("shape*/regions.json"))) >= 8:
                os.kill(victims[0], signal.SIGKILL)
                killed.append(victims[0])
            time.sleep(0.002)

    thread = threading.Thread(target=kill)
    thread.start()
    with pytest.warns(mser3d.Mser3dWarning, match="bad failed"):
        batch = detect_many(shapes / "in", out=out, client=client, **QUICK)
    thread.join()
    assert killed and batch.computed + batch.kept == COUNT
    assert_as_expected(out, shapes)
    assert not list(out.glob(".*.partial"))


def test_a_shape_that_kills_its_workers_is_recorded(shapes, tmp_path):
    deadly = str(shapes / "in/shape00001.off")
    paths = [str(shapes / f"in/shape{number:05}.off") for number in range(3)]
    # Loaded by the nanny and again by the worker, which may be the same process.
    code = (
        "import os, mser3d.dask as d\n"
        "def compute(settings, shape, limit=None, good=d._native.compute_shape):\n"
        f"    return os._exit(1) if os.fspath(shape[1]) == {deadly!r} else good(settings, shape, limit)\n"
        "if d._native.compute_shape.__name__ != 'compute':\n"
        "    d._native.compute_shape = compute\n"
    )
    (tmp_path / "deadly.py").write_text(code)
    with distributed.LocalCluster(
        n_workers=2, threads_per_worker=1, resources={"memory": 2e9}, dashboard_address=None, preload=[str(tmp_path / "deadly.py")]
    ) as cluster, distributed.Client(cluster) as client:
        with pytest.warns(mser3d.Mser3dWarning, match="shape00001 failed: its workers were killed"):
            batch = detect_many(paths, out=tmp_path / "out", client=client, retries=0, **QUICK)
    # What a worker had computed before it was killed is kept when another looks.
    assert (batch.computed + batch.kept, batch.shapes, len(batch.failed)) == (2, 2, 1)
    assert "killed" in json.loads((tmp_path / "out/failures.json").read_text())[0]["error"]
    # Where it can be computed, it is.
    cured = detect_many(paths, out=tmp_path / "out", workers=1, **QUICK)
    assert (cured.computed, cured.kept, cured.failed) == (1, 2, ())


def test_no_more_memory_is_given_than_there_is(shapes, tmp_path, monkeypatch):
    spans, compute = [], mser3d.dask._native.compute_shape

    def timed(*values):
        start = time.perf_counter()
        done = compute(*values)
        spans.append((start, time.perf_counter()))
        return done

    # The workers are threads of this process.
    monkeypatch.setattr(mser3d.dask._native, "compute_shape", timed)
    paths = [shapes / f"in/shape{number:05}.off" for number in range(12)]
    with distributed.LocalCluster(
        n_workers=1, threads_per_worker=3, processes=False, resources={"memory": 1e9}, dashboard_address=None
    ) as cluster, distributed.Client(cluster) as client:

        def most_at_a_time(memory):
            spans.clear()
            detect_many(paths, out=tmp_path / str(memory), client=client, memory=memory, **QUICK)
            runs = list(spans)
            assert len(runs) == len(paths)
            ends = sorted([(start, 1) for start, _ in runs] + [(stop, -1) for _, stop in runs])
            under_way = [0]
            for _, step in ends:
                under_way.append(under_way[-1] + step)
            return max(under_way)

        assert most_at_a_time(600_000_000) == 1
        # One that needs more than there is runs alone.
        assert most_at_a_time(5_000_000_000) == 1
        assert most_at_a_time(1_000_000) > 1


def test_without_declared_memory_it_says_so(shapes, tmp_path):
    with distributed.Client(processes=False, n_workers=1, threads_per_worker=1, dashboard_address=None) as client:
        with pytest.warns(mser3d.Mser3dWarning, match="no worker declares the resource 'memory'"):
            batch = detect_many(shapes / "in/shape00000.off", out=tmp_path / "out", client=client, **QUICK)
    assert batch.computed == 1


@pytest.mark.parametrize("pitch, words", [("first", ["--reference=first"]), (0.3, ["--pitch=0.3"])])
def test_a_shared_pitch_is_as_on_the_command_line(shapes, client, tmp_path, pitch, words):
    paths = [shapes / f"in/shape{number:05}.off" for number in range(3)]
    options = {"eigenpairs": 30, "reliability": 0, "client": client}
    detect_many(paths, out=tmp_path / "python", shared_pitch=pitch, **options)
    assert cli("batch", *paths, "-o", tmp_path / "cli", *words, *QUICK_WORDS[1:]).returncode == 0
    for table in TABLES:
        assert (tmp_path / "python" / table).read_bytes() == (tmp_path / "cli" / table).read_bytes()


def test_labels_and_frames_are_shapes(client, tmp_path):
    import numpy as np

    labels = np.zeros((24, 12, 12), dtype=np.uint8)
    labels[2:12, 2:10, 2:10] = 1
    labels[12:22, 4:8, 4:8] = 2
    labels[22, 5, 5] = 3
    np.save(tmp_path / "map.npy", labels)
    options = {"eigenpairs": 20, "reliability": 0}
    with pytest.warns(mser3d.Mser3dWarning, match="label 3 has only 1 voxels"):
        batch = detect_many(tmp_path / "map.npy", out=tmp_path / "labels", client=client, label="all", **options)
    words = ["--eigenpairs=20", "--reliability=0"]
    assert cli("batch", tmp_path / "map.npy", "-o", tmp_path / "cli", "--label=all", *words).returncode == 0
    for table in [*TABLES, "labels.csv"]:
        assert (tmp_path / "labels" / table).read_bytes() == (tmp_path / "cli" / table).read_bytes()
    assert batch.shapes == 2

    moving = {"animation": "0", "fps": 1.0, "voxels": 1500, **options}
    batch = detect_many(FIXTURES / "quadruped.glb", out=tmp_path / "frames", client=client, **moving)
    assert cli("batch", FIXTURES / "quadruped.glb", "-o", tmp_path / "cli2", "--animation=0", "--fps=1", "--voxels=1500", *words).returncode == 0
    assert batch.shapes > 1
    for table in TABLES:
        assert (tmp_path / "frames" / table).read_bytes() == (tmp_path / "cli2" / table).read_bytes()


def test_queries_are_those_of_one_shape(shapes, client):
    folder = shapes / "expected"
    found = query_many(folder, k=2, group=25)
    assert found.npartitions == 3
    table = found.compute()
    assert list(table.columns) == list(found.columns) and len(table.groupby("shape")) == COUNT
    for name in ["shape00000", "shape00031"]:
        hits = mser3d.query(folder, name, k=2)
        rows = table[table["shape"] == name]
        assert [tuple(row) for row in rows[["region", "found_shape", "found_region", "distance"]].values] == [
            (region, hit.shape, hit.region, hit.distance) for region, near in hits.items() for hit in near
        ]
    one = query_many(folder, [folder / "shape00003"], k=1).compute()
    assert set(one["shape"]) == {"shape00003"} and "shape00003" not in set(one["found_shape"])


def test_wrong_use_is_said_before_anything_is_started(shapes, tmp_path):
    good = shapes / "in/shape00000.off"
    for message, call in [
        ("no such file", lambda: detect_many(tmp_path / "none.off", out=tmp_path / "out")),
        ("there are none", lambda: detect_many([], out=tmp_path / "out")),
        ("--voxels", lambda: detect_many(good, out=tmp_path / "out", voxels=0)),
        ("memory: must be", lambda: detect_many(good, out=tmp_path / "out", memory=0)),
        ("no collection", lambda: query_many(tmp_path)),
        ("cannot be used with", lambda: detect_many(good, out=tmp_path / "out", shared_pitch=0.1, voxels=2000)),
    ]:
        with pytest.raises(ValueError, match=message):
            call()
    with pytest.raises(TypeError, match="did you mean 'voxels'"):
        detect_many(good, out=tmp_path / "out", voxel=2000)
    assert not (tmp_path / "out").exists()


RUNNING = """
import sys
from mser3d.dask import detect_many

if __name__ == "__main__":
    try:
        detect_many(sys.argv[1], out=sys.argv[2], workers=2, voxels=20000, reliability=0)
    except KeyboardInterrupt:
        print("interrupted", flush=True)
"""


@pytest.mark.skipif(os.name == "nt", reason="signals of Unix")
def test_ctrl_c_ends_all_processes(shapes, tmp_path):
    script, out = tmp_path / "run.py", tmp_path / "out"
    script.write_text(RUNNING)
    with subprocess.Popen(
        [sys.executable, script, shapes / "in", out], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, start_new_session=True
    ) as child:
        deadline = time.time() + 60
        while not list(out.glob("shape*/regions.json")) and time.time() < deadline:
            time.sleep(0.05)
        # A terminal's Ctrl-C goes to all processes of the group.
        os.killpg(child.pid, signal.SIGINT)
        said, _ = child.communicate(timeout=30)
    assert said == "interrupted\n"
    assert not (out / "regions.parquet").exists()
    for _ in range(100):
        try:
            os.killpg(child.pid, 0)
        except ProcessLookupError:
            break
        # Ended, and waits until the system takes note.
        time.sleep(0.1)
    else:
        pytest.fail("processes are left")
