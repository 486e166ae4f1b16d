"""Maps between surfaces with pyFM (Magnet and Ovsjanikov), for `cargo xtask maps`.

    python functional_map.py probe              the version, as JSON
    python functional_map.py OUT MESH...        the first mesh with each other one, both ways

OUT gets, for each other mesh in order, an int32 for each of its vertices, its vertex on the first mesh; and for each
vertex of the first mesh its vertex on the other.

    pip install numpy pyfmaps
"""
import importlib.metadata
import json
import sys

import numpy as np


def probe():
    versions = {}
    try:
        versions['pyFM'] = ', '.join(f'{p} {importlib.metadata.version(p)}' for p in ('pyfmaps', 'numpy'))
    except importlib.metadata.PackageNotFoundError:
        pass
    print(json.dumps(versions))


def vertex_map(first, second):
    """For each vertex of the second mesh one of the first."""
    from pyFM.functional import FunctionalMapping

    model = FunctionalMapping(first, second)
    model.preprocess(n_descr=100, descr_type='WKS', k_process=100, subsample_step=10)
    model.fit(K=(30, 30), w_descr=1e-1, w_lap=1e-3, w_dcomm=1)
    refined = model.zoomout_refine(nit=14, step=5, subsample=2000)
    return model.get_p2p(FM=refined)


def run(out, paths):
    from pyFM.mesh import TriMesh

    meshes = [TriMesh.load(path) for path in paths]
    for mesh in meshes:
        mesh.process(k=100)
    with open(out, 'wb') as file:
        for other in meshes[1:]:
            for pair in ((meshes[0], other), (other, meshes[0])):
                np.asarray(vertex_map(*pair), '<i4').tofile(file)


if sys.argv[1] == 'probe':
    probe()
else:
    run(sys.argv[1], sys.argv[2:])
    print('{}')
