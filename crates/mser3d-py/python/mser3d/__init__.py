"""Stable volumetric regions of 3D shapes: parts that stay the same when a body moves.

>>> import mser3d
>>> result = mser3d.detect("body.off")        # doctest: +SKIP
>>> result.vertex_labels, result.regions[0]   # doctest: +SKIP

The method is that of R. Litman, A. Bronstein and M. Bronstein, *Stable volumetric features in deformable shapes*, Computers &
Graphics 36 (2012). Keyword arguments are the options of the command line; ``help(mser3d.detect)`` lists them.
"""

from ._detect import detect, detect_volume, parts
from ._detector import Detector
from ._match import Matching, match
from ._msv import MsvResult, msv
from ._native import __version__
from ._records import Record, Records
from ._operators import Laplacian, cotangent_laplacian, eigs, grid_laplacian
from ._query import Collection, query
from ._result import Region, Result, load
from ._signatures import heat_kernel, si_vhks
from ._track import Tracks, track
from ._trees import ComponentTree, component_tree
from ._voxels import Voxels, solid, voxelize
from ._warnings import Mser3dWarning

__all__ = [
    "Collection",
    "ComponentTree",
    "Detector",
    "Laplacian",
    "Matching",
    "Mser3dWarning",
    "MsvResult",
    "Record",
    "Records",
    "Region",
    "Result",
    "Tracks",
    "Voxels",
    "__version__",
    "component_tree",
    "cotangent_laplacian",
    "detect",
    "detect_volume",
    "eigs",
    "grid_laplacian",
    "heat_kernel",
    "load",
    "match",
    "msv",
    "parts",
    "query",
    "si_vhks",
    "solid",
    "track",
    "voxelize",
]
