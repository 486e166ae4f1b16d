"""Component trees: ours against Higra (and SciPy's spanning tree), one run, same fields, trees compared.

    pip install numpy scipy higra
    cargo build --release -p mser3d-comptree --example timed_tree
    python xtask/peers/tree.py [--sizes 45000,1000000,10000000] [--repeats 3] [--noise]

Prints the best wall and processor seconds of the repeats, and bytes a voxel at the peak beyond the input.
Compare ratios of one run, and processor seconds before wall seconds where a machine is shared.
"""
import argparse
import importlib.metadata
import os
import pathlib
import subprocess
import tempfile
import time

import higra
import numpy as np
import scipy
from scipy.sparse import csr_matrix
from scipy.sparse.csgraph import minimum_spanning_tree

ROOT = pathlib.Path(__file__).resolve().parents[2]
SIDES = {45_000: (36, 36, 35), 1_000_000: (100, 100, 100), 10_000_000: (200, 223, 224)}


def smooth(shape):
    """waves in random directions and a little noise, as PEERS' float field"""
    rng = np.random.default_rng(0)
    axes = np.meshgrid(*[np.linspace(0, 1, s) for s in shape], indexing='ij')
    field = 0.002 * rng.standard_normal(shape)
    for _ in range(12):
        direction, phase = rng.uniform(-19, 19, 3), rng.uniform(0, 2 * np.pi)
        field += np.sin(sum(d * a for d, a in zip(direction, axes)) + phase)
    return field


def best(run, repeats):
    """smallest wall and processor seconds, and the last result"""
    wall, cpu = [], []
    for _ in range(repeats):
        result = None  # frees the last one first
        start, worked = time.perf_counter(), time.process_time()
        result = run()
        wall.append(time.perf_counter() - start)
        cpu.append(time.process_time() - worked)
    return min(wall), min(cpu), result


def ours(field, weights, repeats, threads, out):
    with tempfile.NamedTemporaryFile() as file:
        field.tofile(file.name)
        nz, ny, nx = field.shape
        command = [ROOT / 'target/release/examples/timed_tree', file.name, 'f64', *map(str, (nx, ny, nz)), '6', weights,
                   str(repeats if field.size > 500_000 else 40 * repeats), out]
        environment = dict(os.environ, RAYON_NUM_THREADS=str(threads))
        lines = subprocess.run(command, env=environment, check=True, capture_output=True, text=True).stdout.split('\n')
    found = {}
    for line in filter(None, lines):
        name, value = line.split()
        found.setdefault(name, []).append(float(value))
    nodes = np.fromfile(out).reshape(-1, 2)
    return min(found['seconds']), found['cpu'][0], found['bytes'][0] / field.size, nodes


def node_pairs(tree, altitudes):
    """(altitude, vertices) of all nodes of more than one vertex, sorted"""
    area = higra.attribute_area(tree)
    inner = np.arange(tree.num_vertices()) >= tree.num_leaves()
    return canonical(np.c_[altitudes, area][inner])


def canonical(pairs):
    pairs = pairs[pairs[:, 1] > 1]
    return pairs[np.lexsort(pairs.T)]


def report(case, peer, wall, cpu, note=''):
    print(f'{case:28} {peer:34} {wall:8.4f} {cpu:8.3f}  {note}', flush=True)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument('--sizes', default='45000,1000000,10000000')
    parser.add_argument('--repeats', type=int, default=3)
    parser.add_argument('--noise', action='store_true', help='white noise instead of a smooth field')
    options = parser.parse_args()
    print(f"Higra {importlib.metadata.version('higra')}, SciPy {scipy.__version__}, NumPy {np.__version__}")
    print(f'{"case":28} {"":34} {"wall s":>8} {"cpu s":>8}')
    out = tempfile.NamedTemporaryFile(delete=False).name
    for size in map(int, options.sizes.split(',')):
        shape = SIDES[size]
        field = np.random.default_rng(1).standard_normal(shape) if options.noise else smooth(shape)
        steps = [(-1, 0, 0), (0, -1, 0), (0, 0, -1), (0, 0, 1), (0, 1, 0), (1, 0, 0)]
        implicit = higra.get_nd_regular_implicit_graph(shape, steps)
        case = f'vertex {size}'
        wall, cpu, (tree, altitudes) = best(lambda: higra.component_tree_min_tree(implicit, field), options.repeats)
        report(case, 'Higra, implicit graph', wall, cpu)
        expected = node_pairs(tree, altitudes)
        del tree, altitudes
        for threads in (1, 2):
            w, c, bytes_each, nodes = ours(field, 'vertex', options.repeats, threads, out)
            same = np.array_equal(canonical(nodes), expected)
            report(case, f'mser3d, {threads} threads', w, c,
                   f'wall x {wall / w:.1f}, cpu x {cpu / c if c else float("nan"):.1f}, {bytes_each:.1f} bytes a voxel, {"same tree" if same else "TREES DIFFER"}')
        del expected, nodes
        case = f'edge {size}'
        built, _, graph = best(lambda: higra.get_nd_regular_graph(shape, [(0, 0, 1), (0, 1, 0), (1, 0, 0)]), 1)
        weights = higra.weight_graph(graph, field.ravel(), higra.WeightFunction.L1)
        wall, cpu, (tree, altitudes) = best(lambda: higra.quasi_flat_zone_hierarchy(graph, weights), options.repeats)
        report(case, 'Higra, quasi-flat zones', wall, cpu, f'and {built:.3f} s for the graph')
        expected = node_pairs(tree, altitudes)
        sources, targets = graph.edge_list()
        matrix = csr_matrix((weights + 1e-300, (sources, targets)), shape=(field.size, field.size))
        del tree, altitudes, graph, weights, sources, targets
        spanning = best(lambda: minimum_spanning_tree(matrix), 1)
        report(case, 'SciPy, spanning tree only', *spanning[:2])
        del matrix, spanning
        for threads in (1, 2):
            w, c, bytes_each, nodes = ours(field, 'edge', options.repeats, threads, out)
            same = np.array_equal(canonical(nodes), expected)
            report(case, f'mser3d, {threads} threads', w, c,
                   f'wall x {wall / w:.1f}, cpu x {cpu / c if c else float("nan"):.1f}, {bytes_each:.1f} bytes a voxel, {"same tree" if same else "TREES DIFFER"}')
    os.unlink(out)


if __name__ == '__main__':
    main()
