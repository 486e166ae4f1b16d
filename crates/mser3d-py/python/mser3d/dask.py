"""Many shapes on Dask: on the cores of one machine, or on the machines of a cluster.

>>> from mser3d.dask import detect_many
>>> batch = detect_many("scans/*.ply", out="regions")    # doctest: +SKIP

The folder is that of ``mser3d batch``, with the same tables. Needs ``pip install "mser3d[dask]"``.
"""

from __future__ import annotations

import contextlib
import os
import uuid
from collections.abc import Callable, Iterator, Sequence
from typing import Any, Union

from . import _native
from ._options import with_options
from ._progress import Progress, ProgressFunction, listening
from ._query import Collection, query
from ._records import Record, Records
from ._warnings import warn_all

try:
    import distributed
except ImportError as error:
    raise ImportError('mser3d.dask needs Dask: pip install "dask[dataframe]" distributed') from error

__all__ = ["Batch", "detect_many", "query_many"]

Path = Union[str, "os.PathLike[str]"]

#: Shapes that are looked at in one task: that they are there, and what they take.
_GROUP = 8
#: Tasks that the scheduler knows at a time, at least: it stays small however many shapes there are.
_UNDER_WAY = 400
#: Of the memory that a worker of ours may use, what shapes get; the rest is Python's, and air.
_FOR_SHAPES = 0.7


class Batch:
    """What became of the shapes that `detect_many` was given.

    * ``folder``: where the results are, a folder for each shape, and the tables.
    * ``computed``: shapes computed.
    * ``kept``: shapes that had a result already; after a worker was killed, also those whose result it had just written.
    * ``failed``: a record of ``name``, ``path`` and ``error`` for each shape without a result, by name.
    * ``shapes``, ``regions``: rows of ``shapes.parquet`` and ``regions.parquet``, which are of all results in the folder.
    """

    def __init__(self, folder: str) -> None:
        self.folder = folder
        self.computed = self.kept = self.shapes = self.regions = 0
        self.failed = Records()

    def __repr__(self) -> str:
        became = f"{self.computed} computed, {self.kept} kept, {len(self.failed)} failed"
        return f"<mser3d.dask.Batch {self.folder}: {became}; {self.regions} regions of {self.shapes} shapes>"


@with_options("batch", leave_out=("shard", "merge", "reference", "workers", "pitch"), threads=1)
def detect_many(
    paths: Path | Sequence[Path],
    *,
    out: Path,
    client: distributed.Client | None = None,
    workers: int | None = None,
    shared_pitch: float | Path | None = None,
    memory: int | None = None,
    retries: int = 2,
    write: Sequence[str] = (),
    progress: Progress = None,
    **options: Any,
) -> Batch:
    """Finds the regions of many shapes, each in a folder of its own, and makes tables of them.

    The same folder as that of ``mser3d batch``, with the same tables to the byte. One task a shape; a worker begins one only
    if the memory that it is expected to take is free. Call it again after whatever has ended it: results that are there, of the
    same input and parameters, are kept.

    Parameters
    ----------
    paths : path or list of paths
        Files, folders, patterns (``"scans/*.ply"``) and lists (``.txt``, one path a line). All workers must see them.
    out : path
        The folder of the collection, on a file system that all workers share.
    client : distributed.Client
        The cluster. Its workers should declare the resource ``memory``, in bytes (``dask worker --resources "memory=4e9"``).
        Default: processes on this machine, which end with the call. A script then needs ``if __name__ == "__main__":``.
    workers : int
        How many processes, where there is no client. Default: one for each core.
    shared_pitch : float, path or "first"
        The voxel size of all shapes; or the shape, which may be the first, whose voxel size and reference measure all have, as
        poses of one body need. Default: each its own.
    memory : int
        Bytes that a shape takes. Default: estimated for each, as ``mser3d inspect`` does.
    retries : int
        How often a task is tried again that could not read or write the folder. A worker that is killed, and its shapes, are
        Dask's own business: see ``distributed.scheduler.allowed-failures``.
    write : list of str
        Files besides, for each shape, as of ``mser3d batch --write``.
    progress : callable or "tqdm"
        Called with ("shapes", share, share) after each shape; what it raises cancels the rest.

    Returns
    -------
    Batch
        A shape that fails is recorded there, in ``failures.json`` and by a warning; the others go on.

    Raises
    ------
    ValueError
        Wrong options, paths that name nothing, or a folder that another batch is writing to.
    OSError
        Where results cannot be written.
    """
    reference = None
    if isinstance(shared_pitch, (str, os.PathLike)):
        reference = shared_pitch if shared_pitch == "first" else os.path.abspath(shared_pitch)
    elif shared_pitch is not None:
        options["pitch"] = shared_pitch
    if memory is not None and not memory > 0:
        raise ValueError(f"memory: must be a number of bytes, more than 0, not {memory!r}")
    if workers is not None and client is not None:
        raise ValueError("workers: is for processes on this machine; a client has its own")
    inputs = [paths] if isinstance(paths, (str, os.PathLike)) else list(paths)
    if not inputs:
        raise ValueError("paths: there are none")
    folder = os.path.abspath(out)
    options.setdefault("threads", 1)
    plan = _native.BatchPlan([os.path.abspath(path) for path in inputs], folder, options, reference, list(write))
    plan.begin()
    try:
        with listening(progress) as hear, contextlib.ExitStack() as closing:
            if client is None:
                limit = None if options.get("memory_limit") is None else int(options["memory_limit"] * 1e6)
                client = closing.enter_context(_local(workers, limit))
            run = _Run(client, plan, memory, retries, limited=options.get("memory_limit") is None, hear=hear)
            run.go()
        batch = Batch(folder)
        batch.computed, batch.kept = run.computed, run.kept
        batch.failed = Records(Record(run.failed[name]) for name in sorted(run.failed))
        batch.shapes, batch.regions, _ = plan.finish()
    except Exception as error:
        # Ctrl-C ends the workers too. That cleaning up then fails does not hide it.
        before: BaseException | None = error
        while before is not None and not isinstance(before, KeyboardInterrupt):
            before = before.__context__
        raise before or error
    finally:
        plan.abandon()
    notes = [f"{path}: label {label} has only {n} voxels and was left out" for path, label, n in plan.skipped]
    failures = [f"{failure.name} failed: {failure.error}" for failure in batch.failed[:3]]
    if len(batch.failed) > 3:
        failures.append(f"and {len(batch.failed) - 3} more shapes failed; see failures.json in {folder}")
    warn_all([*run.warnings, *notes, *failures])
    return batch


@contextlib.contextmanager
def _local(workers: int | None, limit: int | None) -> Iterator[distributed.Client]:
    """Processes on this machine that share its free memory, or what was given."""
    import psutil
    from dask.system import CPU_COUNT
    from distributed.system import MEMORY_LIMIT

    count = max(1, CPU_COUNT if workers is None else workers)
    free = min(MEMORY_LIMIT, psutil.virtual_memory().available)
    share = int((limit or 0.8 * free) / count)
    own = {"memory": _FOR_SHAPES * share}
    with distributed.LocalCluster(
        n_workers=count,
        threads_per_worker=1,
        # What is given is for shapes; Python's own memory is not theirs.
        memory_limit=share if limit is None else int(share / _FOR_SHAPES) + 300_000_000,
        resources=own if limit is None else {"memory": share},
        dashboard_address=None,
    ) as cluster, distributed.Client(cluster) as client:
        yield client


class _Run:
    """A batch under way: a window of tasks over all shapes."""

    def __init__(
        self,
        client: distributed.Client,
        plan: _native.BatchPlan,
        memory: int | None,
        retries: int,
        limited: bool,
        hear: ProgressFunction | None,
    ) -> None:
        self.client = client
        self.settings = plan.settings
        self.memory = memory
        self.retries = retries
        self.limited = limited
        self.hear = hear
        self.waiting = iter(plan.shapes)
        self.total = len(plan.shapes)
        self.computed = self.kept = 0
        self.failed: dict[str, dict[str, str]] = {}
        self.warnings: dict[str, None] = {}
        #: Bytes of the largest worker: none where workers declare nothing.
        self.most: float | None = None
        self.asked = False
        #: What is done with the result of each task, and with one that could not be done.
        self.tasks: dict[distributed.Future, tuple[Callable[[Any], None], Callable[[], None]]] = {}
        self.mark = uuid.uuid4().hex[:12]
        self.number = 0

    def go(self) -> None:
        """Deals with all shapes."""
        self.results = distributed.as_completed()
        try:
            self._fill()
            while self.tasks:
                future = next(self.results)
                done, gone = self.tasks.pop(future)
                try:
                    value = future.result()
                except distributed.KilledWorker:
                    gone()
                else:
                    done(value)
                # Else it is computed anew when its worker is lost.
                future.release()
                self._fill()
                self._tell()
        finally:
            # After an error or Ctrl-C: what has not begun does not.
            self.client.cancel(list(self.tasks))

    def _submit(self, done: Callable[[Any], None], gone: Callable[[], None], function: Any, *values: Any, **how: Any) -> None:
        self.number += 1
        key = f"{function.__name__.strip('_')}-{self.mark}-{self.number}"
        future = self.client.submit(function, *values, key=key, retries=self.retries, pure=False, **how)
        self.tasks[future] = done, gone
        self.results.add(future)

    def _fill(self) -> None:
        """New tasks, so that workers always have some and the scheduler never has all."""
        while len(self.tasks) < _UNDER_WAY:
            group = [shape for _, shape in zip(range(_GROUP if self.memory is None else 1), self.waiting)]
            if not group:
                return
            if self.memory is None:
                self._look_at(group)
            else:
                self._compute(group[0], self.memory)

    def _look_at(self, group: list[tuple]) -> None:
        def done(needs: list[tuple]) -> None:
            for shape, (became, size, _seconds) in zip(group, needs):
                if became is None:
                    self._compute(shape, size)
                else:
                    self._count(shape, became)

        def gone() -> None:
            if len(group) == 1:
                self._was_killed(group[0])
            else:
                for shape in group:
                    self._look_at([shape])

        self._submit(done, gone, _examine, self.settings, group)

    def _compute(self, shape: tuple, size: float) -> None:
        def done(value: tuple) -> None:
            became, warnings = value
            self.warnings.update(dict.fromkeys(warnings))
            self._count(shape, became)

        most = self._most()
        # What needs more than any worker has gets one alone; if it does not fit, its failure says so.
        how = {} if most is None else {"resources": {"memory": min(float(size), most)}}
        gone = lambda: self._was_killed(shape)  # noqa: E731
        self._submit(done, gone, _compute, self.settings, shape, self.limited, priority=1, **how)

    def _most(self) -> float | None:
        """The memory of the largest worker, when there are workers."""
        if self.asked:
            return self.most
        workers = _workers(self.client)
        if workers:
            self.asked = True
            declared = [worker["resources"]["memory"] for worker in workers if "memory" in worker["resources"]]
            self.most = max(declared) if declared else None
            if not declared:
                self.warnings[
                    "no worker declares the resource 'memory', so several shapes may take more together than there is; start "
                    'workers with --resources "memory=BYTES"'
                ] = None
        return self.most

    def _was_killed(self, shape: tuple) -> None:
        why = "its workers were killed, most likely for lack of memory; give them more, or ask for fewer voxels"
        _native.fail_shape(self.settings, shape, why)
        self._count(shape, ("failed", why))

    def _count(self, shape: tuple, became: tuple[str, str | None]) -> None:
        what, why = became
        if what == "failed":
            name, path = shape[0], os.fspath(shape[1])
            self.failed[name] = {"name": name, "path": path, "error": why or ""}
        elif what == "kept":
            self.kept += 1
        else:
            self.computed += 1

    def _tell(self) -> None:
        if self.hear is not None:
            share = (self.computed + self.kept + len(self.failed)) / max(self.total, 1)
            self.hear("shapes", share, share)


def _workers(client: distributed.Client) -> list[dict[str, Any]]:
    try:
        info = client.scheduler_info(n_workers=-1)
    except TypeError:  # Before Dask 2025.
        info = client.scheduler_info()
    return list(info["workers"].values())


def _examine(settings: tuple, shapes: list[tuple]) -> list[tuple]:
    """On a worker: what became of these shapes already, or what they take."""
    return [_native.examine_shape(settings, shape) for shape in shapes]


def _compute(settings: tuple, shape: tuple, limited: bool) -> tuple:
    """On a worker: the result of one shape."""
    declared = distributed.get_worker().state.total_resources.get("memory") if limited else None
    return _native.compute_shape(settings, shape, None if declared is None else int(declared))


@with_options("query", leave_out=("up",))
def query_many(
    collection: Path, shapes: Sequence[Path] | None = None, *, group: int = 100, **options: Any
) -> Any:
    """Finds, for many shapes, the regions of a collection that are most like theirs.

    Parameters
    ----------
    collection : path
        A folder that `detect_many` or ``mser3d batch`` wrote, which all workers see.
    shapes : list of paths
        Folders of results, or names of shapes of the collection. Default: all shapes of the collection that have regions.
    group : int
        Shapes in each partition.

    Returns
    -------
    dask.dataframe.DataFrame
        Not computed yet. A row for each pair: ``shape``, ``region``, ``rank`` (0 is nearest), ``found_shape``,
        ``found_region``, ``volume_fraction``, ``twin``, ``side`` (of what was found) and ``distance``.
    """
    import dask.dataframe

    folder = os.path.abspath(collection)
    # What is wrong with it is said now.
    searched = Collection(folder)
    names = searched.shapes if shapes is None else [_absolute(shape) for shape in shapes]
    if not names:
        raise ValueError("shapes: there are none")
    if group < 1:
        raise ValueError(f"group: must be at least 1, not {group}")
    parts = [names[start : start + group] for start in range(0, len(names), group)]
    return dask.dataframe.from_map(_query, parts, folder=folder, options=options, meta=_frame([]))


def _absolute(shape: Path) -> str:
    """A folder as it is called everywhere; names of the collection as they are."""
    return os.path.abspath(shape) if os.path.isdir(shape) else os.fspath(shape)


#: The collection that was searched last, and when its table was written.
_LAST: dict[tuple[str, int], Collection] = {}


def _query(names: list[str], folder: str, options: dict[str, Any]) -> Any:
    key = folder, os.stat(os.path.join(folder, "regions.parquet")).st_mtime_ns
    searched = _LAST.get(key)
    if searched is None:
        searched = Collection(folder)
        _LAST.clear()
        _LAST[key] = searched
    rows = []
    for name in names:
        called = os.path.basename(name)
        for region, hits in query(searched, name, **options).items():
            rows += [(called, region, rank, *hit.values()) for rank, hit in enumerate(hits)]
    return _frame(rows)


def _frame(rows: list[tuple]) -> Any:
    import pandas

    kinds = {
        "shape": "str",
        "region": "int64",
        "rank": "int64",
        "found_shape": "str",
        "found_region": "int64",
        "volume_fraction": "float64",
        "twin": "Int64",
        "side": "Float64",
        "distance": "float64",
    }
    return pandas.DataFrame(rows, columns=list(kinds)).astype(kinds)
