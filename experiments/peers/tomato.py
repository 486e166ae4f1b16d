"""Clusters by persistence (ToMATo, Chazal et al. 2013) with GUDHI, for `cargo xtask peers`.

    python tomato.py probe                      the version, as JSON
    python tomato.py PROBLEM OUT COUNT...       clusters of a weighted graph, once for each count

PROBLEM holds, little-endian: uint64 vertices and edges; a float64 for each vertex, its density; two uint32 for each edge.
OUT gets, for each COUNT, an int32 for each vertex: its cluster, when the COUNT most persistent ones are left (or all, if
there are fewer).

    pip install numpy gudhi
"""
import importlib.metadata
import json
import sys

import numpy as np


def probe():
    versions = {}
    try:
        versions['gudhi'] = ', '.join(f'{p} {importlib.metadata.version(p)}' for p in ('gudhi', 'numpy'))
    except importlib.metadata.PackageNotFoundError:
        pass
    print(json.dumps(versions))


def run(problem, out, counts):
    from gudhi.clustering.tomato import Tomato

    with open(problem, 'rb') as file:
        vertices, edges = np.fromfile(file, '<u8', 2).astype(int)
        density = np.fromfile(file, '<f8', vertices)
        ends = np.fromfile(file, '<u4', 2 * edges).reshape(edges, 2).astype(np.int64)
    both = np.concatenate([ends, ends[:, ::-1]])
    both = both[np.lexsort((both[:, 1], both[:, 0]))]
    starts = np.searchsorted(both[:, 0], np.arange(1, vertices))
    neighbours = np.split(both[:, 1], starts)
    tomato = Tomato(graph_type='manual', density_type='manual').fit(neighbours, weights=density)
    with open(out, 'wb') as file:
        for count in counts:
            # GUDHI refuses to merge into more clusters than there are at first.
            tomato.n_clusters_ = min(count, tomato.n_leaves_)
            np.asarray(tomato.labels_).astype('<i4').tofile(file)
    print(json.dumps({'clusters': int(tomato.n_leaves_)}))


if __name__ == '__main__':
    if sys.argv[1] == 'probe':
        probe()
    else:
        run(sys.argv[1], sys.argv[2], list(map(int, sys.argv[3:])))
