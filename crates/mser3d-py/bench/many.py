"""How `mser3d.dask` scales: `python bench/many.py`, needs `mser3d[dask]`.

1. Two workers beside one, each with one thread, in turns: the ratio of the times of the same shapes, which other work on the
   machine spoils; and the ratios of the tasks under way on average and of the CPU seconds, which it spoils less: how busy Dask keeps the workers, and whether they are in each other's way.
2. The memory of two workers over many shapes: it should be flat.
3. A query among 100,000 regions.
4. The CPU seconds and the bytes of a shape, one thread: what the costs of large collections are computed from.

`--shapes` and `--rounds` make it shorter. The load of the machine is said beside each figure.
"""

from __future__ import annotations

import argparse
import os
import pathlib
import statistics
import sys
import tempfile
import time

import distributed
import mser3d
import numpy as np
import psutil
from mser3d.dask import detect_many

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "tests"))
from shapes import QUICK, write_shapes  # noqa: E402


def load():
    return f"load {os.getloadavg()[0]:.1f} on {os.cpu_count()} cores"


def cluster(workers):
    return distributed.LocalCluster(
        n_workers=workers, threads_per_worker=1, resources={"memory": 2e9}, memory_limit="4GB", dashboard_address=None
    )


def two_beside_one(folder, rounds):
    shapes = write_shapes(folder / "turns", 60, seed=2)
    options = {**QUICK, "voxels": 20000, "eigenpairs": 100}
    ratios = []
    with cluster(1) as one, cluster(2) as two, distributed.Client(one) as first, distributed.Client(two) as second:
        for client in (first, second):
            detect_many(shapes[:4], out=folder / f"warm{client.id}", client=client, **options)
        for number in range(rounds):
            seconds, busy, work = [], [], []
            for name, client in (("one", first), ("two", second)):
                start, before = time.perf_counter(), sum(client.run(time.process_time).values())
                with distributed.get_task_stream(client) as stream:
                    detect_many(shapes, out=folder / f"{name}{number}", client=client, **options)
                seconds.append(time.perf_counter() - start)
                work.append(sum(client.run(time.process_time).values()) - before)
                spans = [span for task in stream.data for span in task["startstops"] if span["action"] == "compute"]
                busy.append(sum(span["stop"] - span["start"] for span in spans) / seconds[-1])
            ratios.append((seconds[0] / seconds[1], busy[1] / busy[0], work[1] / work[0]))
            print(
                f"  one worker {seconds[0]:6.2f} s, two {seconds[1]:6.2f} s: {ratios[-1][0]:.2f} times as fast; tasks under way "
                f"{busy[0]:.2f} and {busy[1]:.2f}: {ratios[-1][1]:.2f} times as many; CPU {work[0]:.2f} s and {work[1]:.2f} s ({load()})"
            )
    fast, many, work = map(statistics.median, zip(*ratios))
    print(
        f"two workers are {fast:.2f} times as fast as one, with {many:.2f} times as many tasks under way, which take {work:.2f} times "
        f"as many CPU seconds (medians of {rounds}): {many / work:.2f} times as fast where each has a core of its own"
    )


def memory_over(folder, count):
    shapes = folder / "many"
    write_shapes(shapes, count, seed=3)
    told = []
    with cluster(2) as local, distributed.Client(local) as client:
        workers = [psutil.Process(pid) for pid in client.run(os.getpid).values()]

        def hear(_stage, _done, overall):
            if overall * 20 >= len(told):
                told.append([worker.memory_info().rss / 1e6 for worker in workers])
                print(f"  {100 * overall:3.0f} %: workers have {' and '.join(f'{m:.0f}' for m in told[-1])} MB")

        start = time.perf_counter()
        batch = detect_many(shapes, out=folder / "out", client=client, progress=hear, **QUICK)
        seconds = time.perf_counter() - start
    growth = [max(worker[10:]) - max(worker[2:10]) for worker in zip(*told)]
    print(f"{batch}: {seconds:.0f} s, {1000 * seconds / count:.0f} ms a shape ({load()})")
    print(f"the second half's most is {' and '.join(f'{g:+.0f}' for g in growth)} MB beside the first half's")
    return folder / "out"


def query_among(folder, source, count):
    import pyarrow
    import pyarrow.parquet as parquet

    table = parquet.read_table(source / "regions.parquet")
    rows = np.arange(count) % table.num_rows
    many = table.take(pyarrow.array(rows))
    names = pyarrow.array([f"{name}-{i // table.num_rows}" for i, name in enumerate(many["shape"].to_pylist())])
    many = many.set_column(0, table.schema.field("shape"), names)
    # Descriptors that differ, as those of other shapes would.
    noise = np.random.default_rng(4).normal(0.0, 1e-3, sum(map(len, many["descriptor"].to_pylist())))
    flat = np.concatenate([np.asarray(chunk.values) for chunk in many["descriptor"].chunks]) + noise
    width = len(flat) // count
    lists = pyarrow.ListArray.from_arrays(np.arange(0, len(flat) + 1, width, dtype=np.int32), flat)
    at = many.schema.get_field_index("descriptor")
    many = many.set_column(at, table.schema.field(at), lists.cast(table.schema.field(at).type))
    folder = folder / "regions"
    folder.mkdir()
    parquet.write_table(many, folder / "regions.parquet", compression="none", use_dictionary=False)
    start = time.perf_counter()
    collection = mser3d.Collection(folder)
    read = time.perf_counter() - start
    shape = next(path for path in sorted(source.iterdir()) if (path / "regions.json").exists())
    result = mser3d.load(shape)
    seconds = []
    for _ in range(5):
        start = time.perf_counter()
        hits = mser3d.query(collection, result, k=5)
        seconds.append(time.perf_counter() - start)
    print(
        f"{len(collection):,} regions of {width} numbers: read in {read:.2f} s; the 5 nearest to each of the {len(hits)} regions of a "
        f"shape in {1000 * statistics.median(seconds):.0f} ms ({load()})"
    )


def cost_of_a_shape(folder):
    shape = pathlib.Path(__file__).resolve().parents[3] / "fixtures" / "human_rest.off"
    for name, options in (("all defaults", {}), ("reliability=0", {"reliability": 0})):
        seconds = []
        for _ in range(3):
            start = time.process_time()
            result = mser3d.detect(shape, threads=1, **options)
            seconds.append(time.process_time() - start)
        result.save(folder / name)
        files = [file.stat().st_size for file in (folder / name).iterdir()]
        print(f"{shape.name}, {name}: {min(seconds):.2f} CPU seconds, {sum(files) / 1e6:.1f} MB in {len(files)} files ({load()})")


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--shapes", type=int, default=2000)
    parser.add_argument("--rounds", type=int, default=5)
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        two_beside_one(folder, arguments.rounds)
        cost_of_a_shape(folder)
        if arguments.shapes:
            query_among(folder, memory_over(folder, arguments.shapes), 100_000)


if __name__ == "__main__":
    main()
