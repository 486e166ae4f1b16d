"""Ctrl-C, progress, memory and other processes."""

import os
import pathlib
import signal
import subprocess
import sys
import time

import mser3d
import numpy as np
import pytest
from conftest import FIXTURES, SMALL, box, cli

RUNNING = """
import sys, time, mser3d
print("go", flush=True)
try:
    mser3d.detect(sys.argv[1], voxels=int(sys.argv[2]), eigenpairs=300, reliability=20)
except KeyboardInterrupt:
    print("interrupted", time.time(), flush=True)
"""


@pytest.mark.skipif(os.name == "nt", reason="signals of Unix")
@pytest.mark.parametrize("wait", [0.3, 2.0])
def test_ctrl_c_ends_it_within_a_second(human, wait):
    with subprocess.Popen([sys.executable, "-c", RUNNING, str(human), "400000"], stdout=subprocess.PIPE, text=True) as child:
        assert child.stdout.readline() == "go\n"
        time.sleep(wait)
        sent = time.time()
        child.send_signal(signal.SIGINT)
        word, at = child.stdout.readline().split()
        assert word == "interrupted" and float(at) - sent < 1.5
        # What is left to itself does not keep the process.
        child.wait(timeout=20)


def test_progress_is_told_and_can_cancel(human):
    told = []
    mser3d.detect(human, voxels=20000, reliability=3, progress=lambda *now: told.append(now))
    shares = [overall for _, _, overall in told]
    assert shares == sorted(shares) and 0.0 <= shares[0] and shares[-1] <= 1.0
    # Each stage is told, however short it is.
    stages = list(dict.fromkeys(stage for stage, _, _ in told))
    assert stages == ["voxelize", "spectrum", "regions", "reliability", "descriptors", "parts"]

    class Enough(Exception):
        pass

    def stop(stage, done, overall):
        raise Enough

    with pytest.raises(Enough):
        mser3d.detect(human, voxels=20000, progress=stop)


def test_progress_is_a_bar(human, capsys):
    pytest.importorskip("tqdm")
    mser3d.detect(human, progress="tqdm", **SMALL)
    assert "100 %" in capsys.readouterr().err


def test_other_threads_run_meanwhile(human):
    import threading

    counts = []
    done = threading.Event()

    def count():
        while not done.is_set():
            counts.append(time.perf_counter())
            time.sleep(0.001)

    thread = threading.Thread(target=count)
    thread.start()
    mser3d.detect(human, voxels=20000, reliability=0)
    done.set()
    thread.join()
    assert len(counts) > 20 and np.diff(counts).max() < 0.5


def test_memory_does_not_grow():
    vertices, faces = box((0, 0, 0), (3, 1, 1))

    def once():
        result = mser3d.detect(vertices, faces, voxels=600, eigenpairs=10, reliability=0)
        result.evecs, result.vertex_labels, result.record
        mser3d.component_tree(np.arange(60000).reshape(300, 200) % 251)

    def resident():
        for line in pathlib.Path("/proc/self/status").read_text().splitlines():
            if line.startswith("VmRSS"):
                return int(line.split()[1])

    if not pathlib.Path("/proc/self/status").exists():
        pytest.skip("needs /proc")
    for _ in range(40):
        once()
    before = resident()
    for _ in range(200):
        once()
    # A single leaked result or tree would be more than 100 kB a run.
    assert resident() - before < 8000


@pytest.mark.skipif(not hasattr(os, "fork"), reason="no fork")
def test_a_forked_process_works(human):
    mser3d.detect(human, **SMALL)
    script = (
        "import os, sys, mser3d\n"
        "kw = dict(voxels=2000, reliability=0)\n"
        "n = len(mser3d.detect(sys.argv[1], **kw).regions)\n"
        "child = os.fork()\n"
        "if child == 0:\n"
        "    os._exit(0 if len(mser3d.detect(sys.argv[1], **kw).regions) == n else 1)\n"
        "sys.exit(os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]))\n"
    )
    assert subprocess.run([sys.executable, "-c", script, str(human)], timeout=120).returncode == 0


@pytest.mark.skipif(not hasattr(os, "fork"), reason="no fork")
def test_a_sequence_is_tracked_by_the_threads_that_are_given_also_in_a_forked_process():
    script = (
        "import os, sys, mser3d\n"
        "tracks = lambda **kw: len(mser3d.track(sys.argv[1:], voxels=2000, reliability=0, workers=2, **kw).tracks)\n"
        "threads = lambda: len(os.listdir('/proc/self/task')) if os.path.isdir('/proc/self/task') else 0\n"
        "before = threads()\n"
        "n = tracks(threads=1)\n"
        # One that stays for the next call; those of the libraries' own would be one for each core.
        "assert threads() <= before + 1, (before, threads())\n"
        "assert tracks() == n > 3\n"
        "child = os.fork()\n"
        "if child == 0:\n"
        "    os._exit(0 if tracks() == n else 1)\n"
        "sys.exit(os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]))\n"
    )
    poses = [str(FIXTURES / f"human_{pose}.off") for pose in ("rest", "walk")]
    assert subprocess.run([sys.executable, "-W", "ignore", "-c", script, *poses], timeout=120).returncode == 0


def test_the_command_is_there(human, tmp_path):
    assert f"mser3d {mser3d.__version__}" in cli("--version").stdout
    wrong = cli("detect", "no.off")
    assert wrong.returncode == 1 and "no.off: cannot be read" in wrong.stderr and "Traceback" not in wrong.stderr
    assert cli("detect").returncode == 2
    script = pathlib.Path(sys.executable).with_name("mser3d")
    if script.exists():
        assert subprocess.run([script, "--version"], capture_output=True).returncode == 0


@pytest.mark.skipif(os.name == "nt", reason="signals of Unix")
def test_ctrl_c_ends_the_command(human, tmp_path):
    arguments = [sys.executable, "-m", "mser3d", "detect", human, "-o", tmp_path / "out", "--voxels=400000", "-q"]
    with subprocess.Popen([str(a) for a in arguments], stderr=subprocess.PIPE, text=True) as child:
        time.sleep(1.5)
        child.send_signal(signal.SIGINT)
        assert child.wait(timeout=5) == 130
        assert "Traceback" not in child.stderr.read()
    assert not (tmp_path / "out").exists()
