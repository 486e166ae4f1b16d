"""Component trees by other people's libraries.

    python tree.py probe                                   which are here, as JSON
    python tree.py METHOD FIELD TYPE NX NY NZ              builds a tree and says what it took, as JSON
    python tree.py fixtures FILE                           Higra's answers on small fields: comptree/tests/it/data/higra.txt

METHOD is higra-vertex, higra-edge or scipy-edge. FIELD holds numbers of NumPy's TYPE, x fastest; neighbours share
a face, and edge weights are absolute differences. Times leave out reading and, for edge trees, making the graph
and its weights; memory is all beyond the field.

    pip install numpy scipy higra
"""
import importlib.metadata
import json
import sys
import time

import numpy as np


def probe():
    versions = {}
    for method, packages in (('higra', ('higra', 'numpy')), ('scipy', ('scipy', 'numpy'))):
        try:
            versions[method] = ', '.join(f'{p} {importlib.metadata.version(p)}' for p in packages)
        except importlib.metadata.PackageNotFoundError:
            pass
    print(json.dumps(versions))


def memory(key):
    with open('/proc/self/status') as status:
        return 1024 * next(int(line.split()[1]) for line in status if line.startswith(key))


def steps(neighbours, forward_only):
    """neighbours as steps (z, y, x), ascending"""
    found = []
    for z, y, x in np.ndindex(3, 3, 3):
        step = (z - 1, y - 1, x - 1)
        distance = sum(map(abs, step))
        near = {4: step[0] == 0 and distance == 1, 8: step[0] == 0, 6: distance == 1, 18: distance <= 2, 26: True}
        if distance > 0 and near[neighbours] and (not forward_only or step > (0, 0, 0)):
            found.append(step)
    return found


def node_pairs(tree, altitudes):
    """Altitude and number of vertices of each inner node and of its parent (a root's is itself)."""
    import higra

    inner = np.arange(tree.num_leaves(), tree.num_vertices())
    own = np.c_[altitudes + 0.0, higra.attribute_area(tree)]
    return own[inner], own[tree.parents()[inner]]


def digest(own, above):
    """A number that trees share when their nodes of more than one vertex do: see tree/ours.rs."""
    with np.errstate(over='ignore'):
        def words(pairs):
            return pairs[:, 0].copy().view(np.uint64), pairs[:, 1].astype(np.uint64)

        large = own[:, 1] > 1
        (a, n), (b, m) = words(own[large]), words(above[large])
        factors = [0x9E3779B97F4A7C15, 0xC2B2AE3D27D4EB4F, 0x165667B19E3779F9, 0x27D4EB2F165667C5]
        h = sum(x * np.uint64(f) for x, f in zip((a, n, b, m), factors))
        h = (h ^ (h >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
        h = (h ^ (h >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
        return f'{int((h ^ (h >> np.uint64(31))).sum(dtype=np.uint64)):016x}', int(large.sum())


def run(method, path, dtype, dims):
    if method.startswith('higra'):
        import higra
    else:
        from scipy.sparse import csr_matrix
        from scipy.sparse.csgraph import minimum_spanning_tree
    shape = dims[::-1]
    field = np.fromfile(path, dtype).reshape(shape)
    before = memory('VmRSS:')
    try:
        with open('/proc/self/clear_refs', 'w') as peak:
            peak.write('5')
    except OSError:
        pass
    if method == 'higra-vertex':
        graph = higra.get_nd_regular_implicit_graph(shape, steps(6, False))
        build = lambda: higra.component_tree_min_tree(graph, field)
    elif method == 'higra-edge':
        graph = higra.get_nd_regular_graph(shape, steps(6, True))
        weights = higra.weight_graph(graph, field.ravel(), higra.WeightFunction.L1)
        build = lambda: higra.quasi_flat_zone_hierarchy(graph, weights)
    else:
        numbers = np.arange(field.size, dtype=np.int32).reshape(shape)
        ends, weights = [], []
        for axis in range(3):
            low, high = ([slice(None)] * 3 for _ in range(2))
            low[axis], high[axis] = slice(None, -1), slice(1, None)
            low, high = tuple(low), tuple(high)
            ends.append((numbers[low].ravel(), numbers[high].ravel()))
            # A zero is no entry of a sparse matrix.
            weights.append(np.abs(field[low] - field[high]).ravel() + 1e-300)
        rows, columns = (np.concatenate(e) for e in zip(*ends))
        matrix = csr_matrix((np.concatenate(weights), (rows, columns)), shape=(field.size,) * 2)
        del numbers, ends, weights, rows, columns
        build = lambda: minimum_spanning_tree(matrix)
    start, worked = time.perf_counter(), time.process_time()
    result = build()
    wall, cpu = time.perf_counter() - start, time.process_time() - worked
    answer = {'cpu': cpu, 'wall': wall, 'memory': memory('VmHWM:') - before}
    if method.startswith('higra'):
        answer['digest'], answer['nodes'] = digest(*node_pairs(*result))
    print(json.dumps(answer))


def fixtures(path):
    """Small fields with and without ties, all neighbourhoods, masks, both kinds of weights."""
    import higra
    from scipy import ndimage

    rng = np.random.default_rng(20)
    cases = []
    for neighbours, shape in ((4, (1, 7, 9)), (8, (1, 7, 9)), (6, (4, 5, 6)), (18, (4, 5, 6)), (26, (4, 5, 6))):
        for values in (rng.integers(0, 5, shape).astype(float), np.round(rng.standard_normal(shape), 3)):
            cases.append((neighbours, values, np.ones(shape, bool)))
            if neighbours in (6, 26):
                mask = rng.random(shape) < (0.7 if neighbours == 6 else 0.4)
                structure = np.zeros((3, 3, 3), bool)
                for step in steps(neighbours, False):
                    structure[tuple(1 + s for s in step)] = True
                parts, _ = ndimage.label(mask, structure)
                # Higra's trees need connected graphs.
                cases.append((neighbours, values, parts == 1 + np.bincount(parts.ravel())[1:].argmax()))
    lines = [f'Higra {importlib.metadata.version("higra")}, by experiments/peers/tree.py fixtures']
    number = lambda x: repr(float(x)).removesuffix('.0')
    for neighbours, values, mask in cases:
        inside = -np.ones(mask.shape, int)
        inside[mask] = np.arange(mask.sum())
        weights = values[mask]
        edges = []
        for at in zip(*np.nonzero(mask)):
            for step in steps(neighbours, True):
                to = tuple(a + s for a, s in zip(at, step))
                if all(0 <= t < n for t, n in zip(to, mask.shape)) and mask[to]:
                    edges.append((inside[at], inside[to]))
        graph = higra.UndirectedGraph(len(weights))
        sources, targets = np.array(edges).T
        graph.add_edges(sources, targets)
        differences = np.abs(weights[sources] - weights[targets])
        for kind, (tree, altitudes) in {
            'vertex': higra.component_tree_min_tree(graph, weights),
            'edge': higra.quasi_flat_zone_hierarchy(graph, differences),
        }.items():
            own, above = node_pairs(tree, altitudes)
            area = higra.attribute_area(tree)
            leaves = tree.parents()[: tree.num_leaves()]
            lines += [
                f'case {kind} {neighbours} ' + ' '.join(map(str, values.shape[::-1])),
                'values ' + ' '.join(map(number, values.ravel())),
                'mask ' + ''.join('01'[int(m)] for m in mask.ravel()),
                'nodes ' + ' '.join(f'{number(a)} {int(n)} {number(b)} {int(m)}'
                                    for (a, n), (b, m) in sorted(zip(map(tuple, own), map(tuple, above)))),
                'smallest ' + ' '.join(f'{number(altitudes[i])} {int(area[i])}' for i in leaves),
            ]
    with open(path, 'w') as file:
        file.write('\n'.join(lines) + '\n')


def main():
    if sys.argv[1] == 'probe':
        probe()
    elif sys.argv[1] == 'fixtures':
        fixtures(sys.argv[2])
    else:
        run(sys.argv[1], sys.argv[2], sys.argv[3], tuple(map(int, sys.argv[4:7])))


if __name__ == '__main__':
    main()
