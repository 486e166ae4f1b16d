"""Written by `python -m mser3d._stubs`; what is changed here is lost."""

import os
from collections.abc import Mapping, Sequence
from typing import Any, Literal, Union

from ._match import ResultOrFolder
from ._progress import Progress
from ._track import Path
from ._detector import Detector as Detector
from ._match import Matching as Matching
from ._msv import MsvResult as MsvResult
from ._native import __version__ as __version__
from ._operators import Laplacian as Laplacian
from ._operators import cotangent_laplacian as cotangent_laplacian
from ._operators import eigs as eigs
from ._operators import grid_laplacian as grid_laplacian
from ._query import Collection as Collection
from ._records import Record as Record
from ._records import Records as Records
from ._result import Region as Region
from ._result import Result as Result
from ._result import load as load
from ._signatures import heat_kernel as heat_kernel
from ._signatures import si_vhks as si_vhks
from ._track import Tracks as Tracks
from ._trees import ComponentTree as ComponentTree
from ._trees import component_tree as component_tree
from ._voxels import Voxels as Voxels
from ._voxels import solid as solid
from ._warnings import Mser3dWarning as Mser3dWarning

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

def detect(
    mesh: Any,
    faces: Any = None,
    *,
    progress: Progress = None,
    format: Literal['obj', 'gltf', 'glb', 'off', 'ply', 'stl', 'vtu', 'vtp', 'vtk', 'msh', 'mesh', 'npy', 'nifti', 'nrrd', 'metaimage', 'mgh', 'tiff'] | None = None,
    animation: str | None = None,
    time: float = 0.0,
    volume: int | None = None,
    label: int | str | None = None,
    threshold: float | None = None,
    labels: Mapping[int, str] | str | os.PathLike[str] | None = None,
    affine: Any = None,
    threads: int | None = None,
    surface: bool = False,
    weight: Any = 'heat',
    smooth_weight: float | None = None,
    time_scale: float | Sequence[float] = (0.25, 0.5, 1.0, 2.0),
    absolute_time: float | Sequence[float] | None = None,
    reference_measure: float | None = None,
    bodies: Literal['largest', 'all', 'join'] = 'largest',
    polarity: Literal['sublevel', 'superlevel'] | None = None,
    voxels: int | None = None,
    resolution: int | None = None,
    pitch: float | None = None,
    spacing: float | Sequence[float] | None = None,
    origin: float | Sequence[float] | None = None,
    connectivity: Literal['6', '26', 6, 26] = '6',
    inside: Literal['auto', 'parity', 'vote', 'winding'] = 'auto',
    overlap: Literal['auto', 'part', 'join'] = 'auto',
    no_cut_links: bool = False,
    morphology: Literal['open', 'close'] | None = None,
    memory_limit: int | None = None,
    max_box_voxels: int = 4294967296,
    time_limit: float | None = None,
    allow_outside: bool = False,
    eigenpairs: int | None = None,
    lambda_max: float | None = None,
    tolerance: float | None = None,
    solver: Literal['auto', 'shift-invert', 'filter', 'multigrid'] = 'auto',
    cache: str | os.PathLike[str] | None = None,
    stability_rule: Literal['windowed', 'paper', 'baseline'] = 'windowed',
    window: float = 0.25,
    min_lifetime: float | None = None,
    altitude: Literal['log', 'linear'] | None = None,
    min_volume: float = 0.01,
    max_volume: float = 0.75,
    min_diversity: float = 0.2,
    min_stability: float | None = None,
    duplicate_overlap: float = 0.9,
    reliability: int | None = None,
    min_reliability: float | None = None,
    descriptor: Literal['sided-si-hks', 'sized-si-hks', 'si-hks', 'hks'] = 'sided-si-hks',
    parts: int | str = 'auto',
) -> Result:
    """Finds and describes the stable regions of a mesh, or of the shape in a file.

    The same options, defaults and results as ``mser3d detect``. Ctrl-C ends it within a second.

    Parameters
    ----------
    mesh : path, array or object
        A file (mesh or volume); vertices, (n, 3), with ``faces``; a pair of both; or a mesh of trimesh, meshio or PyVista.
    faces : array
        Triangles, (m, 3) integers, with vertices numbered from 0.
    progress : callable or "tqdm"
        Called with (stage, share of the stage, share of all) now and then; what it raises cancels the work.

    Returns
    -------
    Result

    Raises
    ------
    ValueError
        Wrong input, in the words of the command line.
    MemoryError
        For work that would not fit into memory.

    Notes
    -----
    ``weight`` may be an array too, with a value (n,) or a vector (n, d) for each vertex; ``affine`` a 4 x 4 array, and
    ``labels`` a dict from numbers to names, for files of volumes.

    Other Parameters
    ----------------
    format : {'obj', 'gltf', 'glb', 'off', 'ply', 'stl', 'vtu', 'vtp', 'vtk', 'msh', 'mesh', 'npy', 'nifti', 'nrrd', 'metaimage', 'mgh', 'tiff'}, default None
        Format of the input, whatever its name says; standard input, -, has none
        * 'obj':
        * 'gltf':
        * 'glb':
        * 'off':
        * 'ply':
        * 'stl':
        * 'vtu':
        * 'vtp':
        * 'vtk':
        * 'msh':
        * 'mesh':
        * 'npy':
        * 'nifti':
        * 'nrrd':
        * 'metaimage':
        * 'mgh':
        * 'tiff':
    animation : str, default None
        glTF animation that poses the figure, by name or number from 0
    time : float, default 0.0
        When in the animation, in seconds
    volume : int, default None
        Which volume of a file that holds several (times, frames, components), from 0
    label : str, default None
        The body is this label, by number or name; all: each label is a shape of its own
    threshold : float, default None
        The body is the voxels of at least this value
    labels : path, default None
        Table with the names of labels, a line each: 3,liver
    affine : path, default None
        Voxel-to-world map in place of the file's: a text or .npy file of 4 x 4 numbers
    threads : int, default None
        Threads to use, 32 or the number of cores at most; the result is the same for any number [default: all
        cores]
    surface : bool, default False
        Search the surface instead of the volume inside
    weight : {'heat', 'commute', 'edge', 'diffusion', 'curvature', 'field'}, default 'heat'
        What the component tree is built on; FIELD.npy: values or vectors of its own for each vertex or voxel
        * 'heat': The heat kernel H_t(v,v) of voxels or vertices: heat that stays
        * 'commute': The commute time (eq. 6) of voxels or vertices, which has no time scale
        * 'edge': 1/H_t(u,v) of neighbours, on the links or edges: where heat passes badly
        * 'diffusion': The diffusion distance of neighbours over their distance: where heat spreads differently
        * 'curvature': The mean curvature of a mesh's surface, in a volume carried inside
        * 'field': The values of a file in place of this name, FIELD.npy: a value or a vector for each vertex or
          voxel
    smooth_weight : float, default None
        How long heat smooths the weight first, in units of volume^(2/3) (surface: area); not edge and diffusion
        [default: none]
    time_scale : float or a list of them, default (0.25, 0.5, 1.0, 2.0)
        Time scales, in units of volume^(2/3) (surface: area); one tree each, regions pooled
    absolute_time : float or a list of them, default None
        Time scales in squared units of the input's coordinates, instead of --time-scale
    reference_measure : float, default None
        Volume (surface: area) that time scales and descriptors refer to, in the input's units; give all poses of
        a body that of one [default: the shape's own]
    bodies : {'largest', 'all', 'join'}, default 'largest'
        What to do with a shape of several bodies
        * 'largest': The largest body is searched, the others are left out
        * 'all': Each body is searched on its own
        * 'join': All bodies are searched together, as one shape
    polarity : {'sublevel', 'superlevel'}, default None
        Which way the tree grows [default: the one that finds limbs; of a field where its values are high, of
        vectors where they differ little]
        * 'sublevel': The level rises: components of low weight
        * 'superlevel': The level falls: components of high weight
    voxels : int, default None
        Voxels in the solid, about [default: 45000]
    resolution : int, default None
        Voxels on the longest axis
    pitch : float, default None
        Edge of a voxel, in the input's units; of a volume, in place of its file's
    spacing : float or a list of them, default None
        Lengths of a voxel along the axes, in the input's units; of a volume, in place of its file's
    origin : float or a list of them, default None
        First corner of the grid, to share it with another tool [default: that of a grid around the body's
        middle]; of a volume, the centre of its first voxel, in place of its file's
    connectivity : {'6', '26'}, default '6'
        Neighbours of a voxel in the tree (the Laplacian has 6)
        * '6': Voxels that share a face; in an image, 4 pixels
        * '26': Voxels that share a face, an edge or a corner; in an image, 8 pixels
    inside : {'auto', 'parity', 'vote', 'winding'}, default 'auto'
        How inside is told from outside
        * 'auto': What the mesh needs, as its diagnosis says
        * 'parity': Crossings of rays along x, counted modulo 2: closed meshes only
        * 'vote': The same along x, y and z, and the majority
        * 'winding': The winding number: for open and overlapping meshes too
    overlap : {'auto', 'part', 'join'}, default 'auto'
        What to do where the solid overlaps itself
        * 'auto': A surface that overlaps itself is parted, different bodies are joined
        * 'part': Voxels that are covered twice are left out
        * 'join': Voxels that are covered twice belong to the solid
    no_cut_links : bool, default False
        Link all neighbours, even where the surface runs between them
    morphology : {'open', 'close'}, default None
        Change the solid by a voxel, against artefacts of the mesh [default: none]
        * 'open': Erosion, then dilation: drops what is thinner than three voxels
        * 'close': Dilation, then erosion: fills slits and pits a voxel wide
    memory_limit : int, default None
        Refuse what takes more memory, in MB: a file, a grid, a spectrum [default: 80 % of what is free, within
        the limits of the system and of control groups]
    max_box_voxels : int, default 4294967296
        Refuse boxes of more voxels than this, of a mesh's grid and of a file; a grid takes half a byte for each
    time_limit : float, default None
        End with an error when the work takes longer; of many shapes, each [default: no limit]
    allow_outside : bool, default False
        Read files outside of its folder too that a file names: buffers of glTF, data of NRRD and MetaImage
    eigenpairs : int, default None
        Smallest eigenpairs of the Laplacian [default: 100, or as many as a small shape has]
    lambda_max : float, default None
        All eigenpairs with lambda V^(2/3) below this (lambda A with --surface): the same scales on any shape
    tolerance : float, default None
        Largest relative residual of an eigenpair; below 1e-4 regions stay the same [default: 1e-4; 1e-9 where
        --write asks for eigenfunctions, signatures or fields]
    solver : {'auto', 'shift-invert', 'filter', 'multigrid'}, default 'auto'
        How eigenpairs are found
        * 'auto': By size and kind: dense, the filter for grids, shift-invert for all others
        * 'shift-invert': Block Lanczos on the inverse, by sparse L D L^T factorizations
        * 'filter': Block Lanczos on a Chebyshev polynomial of the grid's stencil, without a matrix
        * 'multigrid': Eigenvectors of coarser grids, carried up level by level and corrected by multigrid cycles
    cache : path, default None
        Keep spectra in this folder and take them from there; results are the same with and without
    stability_rule : {'windowed', 'paper', 'baseline'}, default 'windowed'
        How stable regions are chosen
        * 'windowed': Change of volume over a window of altitude, within branches that end at real merges
        * 'paper': The published rule (eq. 5): change of volume from a node to its parent
        * 'baseline': No stability: every node whose parent is clearly larger
    window : float, default 0.25
        Half width of the stability window, in units of log altitude; linear: of the weight's spread
    min_lifetime : float, default None
        Least lifetime of a part, in units of (log) altitude [default: 0.1; with linear altitude 0]
    altitude : {'log', 'linear'}, default None
        Scale on which altitude, and so stability, is measured [default: log; linear for curvature and fields]
        * 'log': ln(weight): stability does not depend on the unit of the weight
        * 'linear': The weight itself, as for grey values
    min_volume : float, default 0.01
        Smallest region, as a fraction of the whole
    max_volume : float, default 0.75
        Largest region, as a fraction of the whole
    min_diversity : float, default 0.2
        How much smaller than the next larger region a nested one must be, as a fraction
    min_stability : float, default None
        Drop regions that are less stable [default: none]
    duplicate_overlap : float, default 0.9
        Overlap from which regions of two time scales are one
    reliability : int, default None
        Deformed copies of the shape that are searched, to measure how surely each region is found again; 0 for
        none [default: 6, fewer where they take over 10 s]
    min_reliability : float, default None
        Drop regions that are found again less surely, 0 to 1
    descriptor : {'sided-si-hks', 'sized-si-hks', 'si-hks', 'hks'}, default 'sided-si-hks'
        Heat kernel signature that describes a region
        * 'sided-si-hks': SI-vHKS, the region's share of the volume, and on which side of the body it is
        * 'sized-si-hks': The same without the side: the same for left and right
        * 'si-hks': SI-vHKS alone, as in the paper
        * 'hks': vHKS
    parts : str, default 'auto'
        Divide each body into parts too, every voxel and vertex in exactly one: limbs and trunk (auto), this many,
        or none
    """
    ...

def detect_volume(
    volume: Any,
    *,
    volume_number: int | None = None,
    affine: Any = None,
    labels: Mapping[int, str] | str | os.PathLike[str] | None = None,
    progress: Progress = None,
    format: Literal['obj', 'gltf', 'glb', 'off', 'ply', 'stl', 'vtu', 'vtp', 'vtk', 'msh', 'mesh', 'npy', 'nifti', 'nrrd', 'metaimage', 'mgh', 'tiff'] | None = None,
    label: int | str | None = None,
    threshold: float | None = None,
    threads: int | None = None,
    weight: Any = 'heat',
    smooth_weight: float | None = None,
    time_scale: float | Sequence[float] = (0.25, 0.5, 1.0, 2.0),
    absolute_time: float | Sequence[float] | None = None,
    reference_measure: float | None = None,
    bodies: Literal['largest', 'all', 'join'] = 'largest',
    polarity: Literal['sublevel', 'superlevel'] | None = None,
    voxels: int | None = None,
    resolution: int | None = None,
    pitch: float | None = None,
    spacing: float | Sequence[float] | None = None,
    origin: float | Sequence[float] | None = None,
    connectivity: Literal['6', '26', 6, 26] = '6',
    inside: Literal['auto', 'parity', 'vote', 'winding'] = 'auto',
    overlap: Literal['auto', 'part', 'join'] = 'auto',
    no_cut_links: bool = False,
    morphology: Literal['open', 'close'] | None = None,
    memory_limit: int | None = None,
    max_box_voxels: int = 4294967296,
    time_limit: float | None = None,
    allow_outside: bool = False,
    eigenpairs: int | None = None,
    lambda_max: float | None = None,
    tolerance: float | None = None,
    solver: Literal['auto', 'shift-invert', 'filter', 'multigrid'] = 'auto',
    cache: str | os.PathLike[str] | None = None,
    stability_rule: Literal['windowed', 'paper', 'baseline'] = 'windowed',
    window: float = 0.25,
    min_lifetime: float | None = None,
    altitude: Literal['log', 'linear'] | None = None,
    min_volume: float = 0.01,
    max_volume: float = 0.75,
    min_diversity: float = 0.2,
    min_stability: float | None = None,
    duplicate_overlap: float = 0.9,
    reliability: int | None = None,
    min_reliability: float | None = None,
    descriptor: Literal['sided-si-hks', 'sized-si-hks', 'si-hks', 'hks'] = 'sided-si-hks',
    parts: int | str = 'auto',
) -> Result:
    """Finds and describes the stable regions of a body that is given as voxels.

    Parameters
    ----------
    volume : array
        Indexed [x, y, z]: a mask of 0 and one other value, a label map with ``label``, or grey values with ``threshold``. A
        fourth axis holds several volumes.
    volume_number : int
        Which of several volumes, from 0.
    affine : array
        Index to world, 4 x 4: the centre of voxel (i, j, k) is ``affine @ (i, j, k, 1)``, as in nibabel. Default: voxels of
        size 1. In its place: ``spacing`` and ``origin``.
    labels : dict or path
        Names of labels, so that ``label`` can be one.
    progress : callable or "tqdm"
        Called with (stage, share of the stage, share of all) now and then.

    Returns
    -------
    Result
        Its surface is that of the voxels; see ``voxel_labels`` and ``volume_of``.

    Raises
    ------
    ValueError
        Wrong input, in the words of the command line.
    MemoryError
        For work that would not fit into memory.

    Other Parameters
    ----------------
    format : {'obj', 'gltf', 'glb', 'off', 'ply', 'stl', 'vtu', 'vtp', 'vtk', 'msh', 'mesh', 'npy', 'nifti', 'nrrd', 'metaimage', 'mgh', 'tiff'}, default None
        Format of the input, whatever its name says; standard input, -, has none
        * 'obj':
        * 'gltf':
        * 'glb':
        * 'off':
        * 'ply':
        * 'stl':
        * 'vtu':
        * 'vtp':
        * 'vtk':
        * 'msh':
        * 'mesh':
        * 'npy':
        * 'nifti':
        * 'nrrd':
        * 'metaimage':
        * 'mgh':
        * 'tiff':
    label : str, default None
        The body is this label, by number or name; all: each label is a shape of its own
    threshold : float, default None
        The body is the voxels of at least this value
    threads : int, default None
        Threads to use, 32 or the number of cores at most; the result is the same for any number [default: all
        cores]
    weight : {'heat', 'commute', 'edge', 'diffusion', 'curvature', 'field'}, default 'heat'
        What the component tree is built on; FIELD.npy: values or vectors of its own for each vertex or voxel
        * 'heat': The heat kernel H_t(v,v) of voxels or vertices: heat that stays
        * 'commute': The commute time (eq. 6) of voxels or vertices, which has no time scale
        * 'edge': 1/H_t(u,v) of neighbours, on the links or edges: where heat passes badly
        * 'diffusion': The diffusion distance of neighbours over their distance: where heat spreads differently
        * 'curvature': The mean curvature of a mesh's surface, in a volume carried inside
        * 'field': The values of a file in place of this name, FIELD.npy: a value or a vector for each vertex or
          voxel
    smooth_weight : float, default None
        How long heat smooths the weight first, in units of volume^(2/3) (surface: area); not edge and diffusion
        [default: none]
    time_scale : float or a list of them, default (0.25, 0.5, 1.0, 2.0)
        Time scales, in units of volume^(2/3) (surface: area); one tree each, regions pooled
    absolute_time : float or a list of them, default None
        Time scales in squared units of the input's coordinates, instead of --time-scale
    reference_measure : float, default None
        Volume (surface: area) that time scales and descriptors refer to, in the input's units; give all poses of
        a body that of one [default: the shape's own]
    bodies : {'largest', 'all', 'join'}, default 'largest'
        What to do with a shape of several bodies
        * 'largest': The largest body is searched, the others are left out
        * 'all': Each body is searched on its own
        * 'join': All bodies are searched together, as one shape
    polarity : {'sublevel', 'superlevel'}, default None
        Which way the tree grows [default: the one that finds limbs; of a field where its values are high, of
        vectors where they differ little]
        * 'sublevel': The level rises: components of low weight
        * 'superlevel': The level falls: components of high weight
    voxels : int, default None
        Voxels in the solid, about [default: 45000]
    resolution : int, default None
        Voxels on the longest axis
    pitch : float, default None
        Edge of a voxel, in the input's units; of a volume, in place of its file's
    spacing : float or a list of them, default None
        Lengths of a voxel along the axes, in the input's units; of a volume, in place of its file's
    origin : float or a list of them, default None
        First corner of the grid, to share it with another tool [default: that of a grid around the body's
        middle]; of a volume, the centre of its first voxel, in place of its file's
    connectivity : {'6', '26'}, default '6'
        Neighbours of a voxel in the tree (the Laplacian has 6)
        * '6': Voxels that share a face; in an image, 4 pixels
        * '26': Voxels that share a face, an edge or a corner; in an image, 8 pixels
    inside : {'auto', 'parity', 'vote', 'winding'}, default 'auto'
        How inside is told from outside
        * 'auto': What the mesh needs, as its diagnosis says
        * 'parity': Crossings of rays along x, counted modulo 2: closed meshes only
        * 'vote': The same along x, y and z, and the majority
        * 'winding': The winding number: for open and overlapping meshes too
    overlap : {'auto', 'part', 'join'}, default 'auto'
        What to do where the solid overlaps itself
        * 'auto': A surface that overlaps itself is parted, different bodies are joined
        * 'part': Voxels that are covered twice are left out
        * 'join': Voxels that are covered twice belong to the solid
    no_cut_links : bool, default False
        Link all neighbours, even where the surface runs between them
    morphology : {'open', 'close'}, default None
        Change the solid by a voxel, against artefacts of the mesh [default: none]
        * 'open': Erosion, then dilation: drops what is thinner than three voxels
        * 'close': Dilation, then erosion: fills slits and pits a voxel wide
    memory_limit : int, default None
        Refuse what takes more memory, in MB: a file, a grid, a spectrum [default: 80 % of what is free, within
        the limits of the system and of control groups]
    max_box_voxels : int, default 4294967296
        Refuse boxes of more voxels than this, of a mesh's grid and of a file; a grid takes half a byte for each
    time_limit : float, default None
        End with an error when the work takes longer; of many shapes, each [default: no limit]
    allow_outside : bool, default False
        Read files outside of its folder too that a file names: buffers of glTF, data of NRRD and MetaImage
    eigenpairs : int, default None
        Smallest eigenpairs of the Laplacian [default: 100, or as many as a small shape has]
    lambda_max : float, default None
        All eigenpairs with lambda V^(2/3) below this (lambda A with --surface): the same scales on any shape
    tolerance : float, default None
        Largest relative residual of an eigenpair; below 1e-4 regions stay the same [default: 1e-4; 1e-9 where
        --write asks for eigenfunctions, signatures or fields]
    solver : {'auto', 'shift-invert', 'filter', 'multigrid'}, default 'auto'
        How eigenpairs are found
        * 'auto': By size and kind: dense, the filter for grids, shift-invert for all others
        * 'shift-invert': Block Lanczos on the inverse, by sparse L D L^T factorizations
        * 'filter': Block Lanczos on a Chebyshev polynomial of the grid's stencil, without a matrix
        * 'multigrid': Eigenvectors of coarser grids, carried up level by level and corrected by multigrid cycles
    cache : path, default None
        Keep spectra in this folder and take them from there; results are the same with and without
    stability_rule : {'windowed', 'paper', 'baseline'}, default 'windowed'
        How stable regions are chosen
        * 'windowed': Change of volume over a window of altitude, within branches that end at real merges
        * 'paper': The published rule (eq. 5): change of volume from a node to its parent
        * 'baseline': No stability: every node whose parent is clearly larger
    window : float, default 0.25
        Half width of the stability window, in units of log altitude; linear: of the weight's spread
    min_lifetime : float, default None
        Least lifetime of a part, in units of (log) altitude [default: 0.1; with linear altitude 0]
    altitude : {'log', 'linear'}, default None
        Scale on which altitude, and so stability, is measured [default: log; linear for curvature and fields]
        * 'log': ln(weight): stability does not depend on the unit of the weight
        * 'linear': The weight itself, as for grey values
    min_volume : float, default 0.01
        Smallest region, as a fraction of the whole
    max_volume : float, default 0.75
        Largest region, as a fraction of the whole
    min_diversity : float, default 0.2
        How much smaller than the next larger region a nested one must be, as a fraction
    min_stability : float, default None
        Drop regions that are less stable [default: none]
    duplicate_overlap : float, default 0.9
        Overlap from which regions of two time scales are one
    reliability : int, default None
        Deformed copies of the shape that are searched, to measure how surely each region is found again; 0 for
        none [default: 6, fewer where they take over 10 s]
    min_reliability : float, default None
        Drop regions that are found again less surely, 0 to 1
    descriptor : {'sided-si-hks', 'sized-si-hks', 'si-hks', 'hks'}, default 'sided-si-hks'
        Heat kernel signature that describes a region
        * 'sided-si-hks': SI-vHKS, the region's share of the volume, and on which side of the body it is
        * 'sized-si-hks': The same without the side: the same for left and right
        * 'si-hks': SI-vHKS alone, as in the paper
        * 'hks': vHKS
    parts : str, default 'auto'
        Divide each body into parts too, every voxel and vertex in exactly one: limbs and trunk (auto), this many,
        or none
    """
    ...

def match(
    first: ResultOrFolder,
    second: ResultOrFolder,
    *,
    rule: Literal['nearest', 'mutual', 'one-to-one'] = 'nearest',
    max_ratio: float | None = None,
    max_distance: float | None = None,
    ambiguity: float = 0.8,
    consistency: float = 30.0,
    allow_mirror: bool = False,
    same_vertices: bool = False,
    symmetry: str | os.PathLike[str] | None = None,
    min_overlap: float = 0.8,
) -> Matching:
    """Finds out which regions of two shapes are the same: a partner on the first for each region of the second.

    Parameters
    ----------
    first, second : Result or path
        What `mser3d.detect` gave, or a folder with it.

    Returns
    -------
    Matching

    Other Parameters
    ----------------
    rule : {'nearest', 'mutual', 'one-to-one'}, default 'nearest'
        How partners are chosen
        * 'nearest': Each query gets its nearest reference; several may share one
        * 'mutual': As nearest, but only where the query is also the nearest of its partner
        * 'one-to-one': The one-to-one assignment with the least sum of distances
    max_ratio : float, default None
        Ratio test: drop matches at least this times as far as the next best (off by default; on a symmetric shape
        it drops one of many pairs)
    max_distance : float, default None
        Drop matches of a greater distance
    ambiguity : float, default 0.8
        Call a match ambiguous from this ratio to the next best on
    consistency : float, default 30.0
        How much matches count that hold together: near each other on both shapes. 0: each region alone, as in the
        paper
    allow_mirror : bool, default False
        Let the whole second shape be matched as a mirror image, left to right, where that fits better
    same_vertices : bool, default False
        Vertex i of one mesh is vertex i of the other: say which matches are right
    symmetry : path, default None
        Left-right symmetry of the first mesh: entry i is the vertex that mirrors vertex i (.txt, .mat). Matches
        with the mirror image are then told apart from wrong ones
    min_overlap : float, default 0.8
        Overlap from which a match is right
    """
    ...

def msv(
    volume: Any,
    *,
    affine: Any = None,
    volume_number: int | None = None,
    save: str | os.PathLike[str] | None = None,
    format: Literal['obj', 'gltf', 'glb', 'off', 'ply', 'stl', 'vtu', 'vtp', 'vtk', 'msh', 'mesh', 'npy', 'nifti', 'nrrd', 'metaimage', 'mgh', 'tiff'] | None = None,
    regions: Literal['dark', 'bright', 'alike'] | Sequence[Literal['dark', 'bright', 'alike']] | None = None,
    delta: float | None = None,
    min_area: float = 0.0,
    max_area: float = 0.75,
    max_variation: float = 0.25,
    min_diversity: float = 0.2,
    connectivity: Literal['6', '26', 6, 26] = '26',
    spacing: float | Sequence[float] | None = None,
    origin: float | Sequence[float] | None = None,
    memory_limit: int | None = None,
    max_box_voxels: int = 4294967296,
    time_limit: float | None = None,
    allow_outside: bool = False,
) -> MsvResult:
    """Finds the maximally stable regions of a grey-value volume or an image (MSER).

    Parameters
    ----------
    volume : array or path
        Grey values, indexed [x, y] or [x, y, z]; [x, y, z, channel] for colours.
    affine : array
        Index to world, 4 x 4.
    volume_number : int
        Which of several volumes, from 0.
    save : path
        Also write the folder of ``mser3d msv``.

    Returns
    -------
    MsvResult

    Other Parameters
    ----------------
    format : {'obj', 'gltf', 'glb', 'off', 'ply', 'stl', 'vtu', 'vtp', 'vtk', 'msh', 'mesh', 'npy', 'nifti', 'nrrd', 'metaimage', 'mgh', 'tiff'}, default None
        Format of the input, whatever its name says; standard input, -, has none
        * 'obj':
        * 'gltf':
        * 'glb':
        * 'off':
        * 'ply':
        * 'stl':
        * 'vtu':
        * 'vtp':
        * 'vtk':
        * 'msh':
        * 'mesh':
        * 'npy':
        * 'nifti':
        * 'nrrd':
        * 'metaimage':
        * 'mgh':
        * 'tiff':
    regions : {'dark', 'bright', 'alike'} or a list of them, default None
        Which regions are searched [default: dark,bright; of colours alike]
        * 'dark': Dark regions on brighter ground (MSER+)
        * 'bright': Bright regions on darker ground (MSER-)
        * 'alike': Regions of like colour: vectors have no order, but distances
    delta : float, default None
        Over how many grey values a region is compared with what it grows into [default: 5 for integers, 2 % of
        the range for others, where it is also the step that 1 is for integers]
    min_area : float, default 0.0
        Smallest region, as a fraction of all voxels
    max_area : float, default 0.75
        Largest region, as a fraction of all voxels
    max_variation : float, default 0.25
        Drop regions that grow by this share of their size or more within delta
    min_diversity : float, default 0.2
        How much smaller than the next larger region a nested one must be, as a fraction
    connectivity : {'6', '26'}, default '26'
        Which voxels are neighbours; VLFeat's are 26
        * '6': Voxels that share a face; in an image, 4 pixels
        * '26': Voxels that share a face, an edge or a corner; in an image, 8 pixels
    spacing : float or a list of them, default None
        Distances of the voxels along the axes, in place of the file's
    origin : float or a list of them, default None
        Centre of the first voxel, in place of the file's
    memory_limit : int, default None
        Refuse what takes more memory, in MB: a file, a grid, a spectrum [default: 80 % of what is free, within
        the limits of the system and of control groups]
    max_box_voxels : int, default 4294967296
        Refuse boxes of more voxels than this, of a mesh's grid and of a file; a grid takes half a byte for each
    time_limit : float, default None
        End with an error when the work takes longer; of many shapes, each [default: no limit]
    allow_outside : bool, default False
        Read files outside of its folder too that a file names: buffers of glTF, data of NRRD and MetaImage
    """
    ...

def parts(
    mesh: Any,
    faces: Any = None,
    *,
    n: int | str = 'auto',
    progress: Progress = None,
    format: Literal['obj', 'gltf', 'glb', 'off', 'ply', 'stl', 'vtu', 'vtp', 'vtk', 'msh', 'mesh', 'npy', 'nifti', 'nrrd', 'metaimage', 'mgh', 'tiff'] | None = None,
    animation: str | None = None,
    time: float = 0.0,
    volume: int | None = None,
    label: int | str | None = None,
    threshold: float | None = None,
    labels: Mapping[int, str] | str | os.PathLike[str] | None = None,
    affine: Any = None,
    threads: int | None = None,
    surface: bool = False,
    weight: Any = 'heat',
    smooth_weight: float | None = None,
    time_scale: float | Sequence[float] = (0.25, 0.5, 1.0, 2.0),
    absolute_time: float | Sequence[float] | None = None,
    reference_measure: float | None = None,
    bodies: Literal['largest', 'all', 'join'] = 'largest',
    polarity: Literal['sublevel', 'superlevel'] | None = None,
    voxels: int | None = None,
    resolution: int | None = None,
    pitch: float | None = None,
    spacing: float | Sequence[float] | None = None,
    origin: float | Sequence[float] | None = None,
    connectivity: Literal['6', '26', 6, 26] = '6',
    inside: Literal['auto', 'parity', 'vote', 'winding'] = 'auto',
    overlap: Literal['auto', 'part', 'join'] = 'auto',
    no_cut_links: bool = False,
    morphology: Literal['open', 'close'] | None = None,
    memory_limit: int | None = None,
    max_box_voxels: int = 4294967296,
    time_limit: float | None = None,
    allow_outside: bool = False,
    eigenpairs: int | None = None,
    lambda_max: float | None = None,
    tolerance: float | None = None,
    solver: Literal['auto', 'shift-invert', 'filter', 'multigrid'] = 'auto',
    cache: str | os.PathLike[str] | None = None,
    stability_rule: Literal['windowed', 'paper', 'baseline'] = 'windowed',
    window: float = 0.25,
    min_lifetime: float | None = None,
    altitude: Literal['log', 'linear'] | None = None,
    min_volume: float = 0.01,
    max_volume: float = 0.75,
    min_diversity: float = 0.2,
    min_stability: float | None = None,
    duplicate_overlap: float = 0.9,
    reliability: int | None = 0,
    min_reliability: float | None = None,
    descriptor: Literal['sided-si-hks', 'sized-si-hks', 'si-hks', 'hks'] = 'sided-si-hks',
) -> Result:
    """Divides a shape into parts: limbs and trunk, each vertex and voxel in exactly one.

    As `detect`, without measuring how surely regions are found again, which parts do not need.

    Parameters
    ----------
    mesh, faces
        As of `detect`; a mask, indexed [x, y, z], serves too.
    n : int or "auto"
        How many parts.

    Returns
    -------
    Result
        See ``parts``, ``vertex_parts`` and ``voxel_parts``.

    Other Parameters
    ----------------
    format : {'obj', 'gltf', 'glb', 'off', 'ply', 'stl', 'vtu', 'vtp', 'vtk', 'msh', 'mesh', 'npy', 'nifti', 'nrrd', 'metaimage', 'mgh', 'tiff'}, default None
        Format of the input, whatever its name says; standard input, -, has none
        * 'obj':
        * 'gltf':
        * 'glb':
        * 'off':
        * 'ply':
        * 'stl':
        * 'vtu':
        * 'vtp':
        * 'vtk':
        * 'msh':
        * 'mesh':
        * 'npy':
        * 'nifti':
        * 'nrrd':
        * 'metaimage':
        * 'mgh':
        * 'tiff':
    animation : str, default None
        glTF animation that poses the figure, by name or number from 0
    time : float, default 0.0
        When in the animation, in seconds
    volume : int, default None
        Which volume of a file that holds several (times, frames, components), from 0
    label : str, default None
        The body is this label, by number or name; all: each label is a shape of its own
    threshold : float, default None
        The body is the voxels of at least this value
    labels : path, default None
        Table with the names of labels, a line each: 3,liver
    affine : path, default None
        Voxel-to-world map in place of the file's: a text or .npy file of 4 x 4 numbers
    threads : int, default None
        Threads to use, 32 or the number of cores at most; the result is the same for any number [default: all
        cores]
    surface : bool, default False
        Search the surface instead of the volume inside
    weight : {'heat', 'commute', 'edge', 'diffusion', 'curvature', 'field'}, default 'heat'
        What the component tree is built on; FIELD.npy: values or vectors of its own for each vertex or voxel
        * 'heat': The heat kernel H_t(v,v) of voxels or vertices: heat that stays
        * 'commute': The commute time (eq. 6) of voxels or vertices, which has no time scale
        * 'edge': 1/H_t(u,v) of neighbours, on the links or edges: where heat passes badly
        * 'diffusion': The diffusion distance of neighbours over their distance: where heat spreads differently
        * 'curvature': The mean curvature of a mesh's surface, in a volume carried inside
        * 'field': The values of a file in place of this name, FIELD.npy: a value or a vector for each vertex or
          voxel
    smooth_weight : float, default None
        How long heat smooths the weight first, in units of volume^(2/3) (surface: area); not edge and diffusion
        [default: none]
    time_scale : float or a list of them, default (0.25, 0.5, 1.0, 2.0)
        Time scales, in units of volume^(2/3) (surface: area); one tree each, regions pooled
    absolute_time : float or a list of them, default None
        Time scales in squared units of the input's coordinates, instead of --time-scale
    reference_measure : float, default None
        Volume (surface: area) that time scales and descriptors refer to, in the input's units; give all poses of
        a body that of one [default: the shape's own]
    bodies : {'largest', 'all', 'join'}, default 'largest'
        What to do with a shape of several bodies
        * 'largest': The largest body is searched, the others are left out
        * 'all': Each body is searched on its own
        * 'join': All bodies are searched together, as one shape
    polarity : {'sublevel', 'superlevel'}, default None
        Which way the tree grows [default: the one that finds limbs; of a field where its values are high, of
        vectors where they differ little]
        * 'sublevel': The level rises: components of low weight
        * 'superlevel': The level falls: components of high weight
    voxels : int, default None
        Voxels in the solid, about [default: 45000]
    resolution : int, default None
        Voxels on the longest axis
    pitch : float, default None
        Edge of a voxel, in the input's units; of a volume, in place of its file's
    spacing : float or a list of them, default None
        Lengths of a voxel along the axes, in the input's units; of a volume, in place of its file's
    origin : float or a list of them, default None
        First corner of the grid, to share it with another tool [default: that of a grid around the body's
        middle]; of a volume, the centre of its first voxel, in place of its file's
    connectivity : {'6', '26'}, default '6'
        Neighbours of a voxel in the tree (the Laplacian has 6)
        * '6': Voxels that share a face; in an image, 4 pixels
        * '26': Voxels that share a face, an edge or a corner; in an image, 8 pixels
    inside : {'auto', 'parity', 'vote', 'winding'}, default 'auto'
        How inside is told from outside
        * 'auto': What the mesh needs, as its diagnosis says
        * 'parity': Crossings of rays along x, counted modulo 2: closed meshes only
        * 'vote': The same along x, y and z, and the majority
        * 'winding': The winding number: for open and overlapping meshes too
    overlap : {'auto', 'part', 'join'}, default 'auto'
        What to do where the solid overlaps itself
        * 'auto': A surface that overlaps itself is parted, different bodies are joined
        * 'part': Voxels that are covered twice are left out
        * 'join': Voxels that are covered twice belong to the solid
    no_cut_links : bool, default False
        Link all neighbours, even where the surface runs between them
    morphology : {'open', 'close'}, default None
        Change the solid by a voxel, against artefacts of the mesh [default: none]
        * 'open': Erosion, then dilation: drops what is thinner than three voxels
        * 'close': Dilation, then erosion: fills slits and pits a voxel wide
    memory_limit : int, default None
        Refuse what takes more memory, in MB: a file, a grid, a spectrum [default: 80 % of what is free, within
        the limits of the system and of control groups]
    max_box_voxels : int, default 4294967296
        Refuse boxes of more voxels than this, of a mesh's grid and of a file; a grid takes half a byte for each
    time_limit : float, default None
        End with an error when the work takes longer; of many shapes, each [default: no limit]
    allow_outside : bool, default False
        Read files outside of its folder too that a file names: buffers of glTF, data of NRRD and MetaImage
    eigenpairs : int, default None
        Smallest eigenpairs of the Laplacian [default: 100, or as many as a small shape has]
    lambda_max : float, default None
        All eigenpairs with lambda V^(2/3) below this (lambda A with --surface): the same scales on any shape
    tolerance : float, default None
        Largest relative residual of an eigenpair; below 1e-4 regions stay the same [default: 1e-4; 1e-9 where
        --write asks for eigenfunctions, signatures or fields]
    solver : {'auto', 'shift-invert', 'filter', 'multigrid'}, default 'auto'
        How eigenpairs are found
        * 'auto': By size and kind: dense, the filter for grids, shift-invert for all others
        * 'shift-invert': Block Lanczos on the inverse, by sparse L D L^T factorizations
        * 'filter': Block Lanczos on a Chebyshev polynomial of the grid's stencil, without a matrix
        * 'multigrid': Eigenvectors of coarser grids, carried up level by level and corrected by multigrid cycles
    cache : path, default None
        Keep spectra in this folder and take them from there; results are the same with and without
    stability_rule : {'windowed', 'paper', 'baseline'}, default 'windowed'
        How stable regions are chosen
        * 'windowed': Change of volume over a window of altitude, within branches that end at real merges
        * 'paper': The published rule (eq. 5): change of volume from a node to its parent
        * 'baseline': No stability: every node whose parent is clearly larger
    window : float, default 0.25
        Half width of the stability window, in units of log altitude; linear: of the weight's spread
    min_lifetime : float, default None
        Least lifetime of a part, in units of (log) altitude [default: 0.1; with linear altitude 0]
    altitude : {'log', 'linear'}, default None
        Scale on which altitude, and so stability, is measured [default: log; linear for curvature and fields]
        * 'log': ln(weight): stability does not depend on the unit of the weight
        * 'linear': The weight itself, as for grey values
    min_volume : float, default 0.01
        Smallest region, as a fraction of the whole
    max_volume : float, default 0.75
        Largest region, as a fraction of the whole
    min_diversity : float, default 0.2
        How much smaller than the next larger region a nested one must be, as a fraction
    min_stability : float, default None
        Drop regions that are less stable [default: none]
    duplicate_overlap : float, default 0.9
        Overlap from which regions of two time scales are one
    reliability : int, default None
        Deformed copies of the shape that are searched, to measure how surely each region is found again; 0 for
        none [default: 6, fewer where they take over 10 s]
    min_reliability : float, default None
        Drop regions that are found again less surely, 0 to 1
    descriptor : {'sided-si-hks', 'sized-si-hks', 'si-hks', 'hks'}, default 'sided-si-hks'
        Heat kernel signature that describes a region
        * 'sided-si-hks': SI-vHKS, the region's share of the volume, and on which side of the body it is
        * 'sized-si-hks': The same without the side: the same for left and right
        * 'si-hks': SI-vHKS alone, as in the paper
        * 'hks': vHKS
    """
    ...

def query(
    collection: Union[Collection, str, os.PathLike[str]],
    shape: ResultOrFolder,
    *,
    k: int = 5,
    region: int | None = None,
    include_itself: bool = False,
) -> dict[int, Records]:
    """Finds the regions of a collection that are most like those of a shape.

    Parameters
    ----------
    collection : Collection or path
        A folder that ``mser3d batch`` wrote. For many queries make a `mser3d.Collection` of it, which is read once.
    shape : Result or path
        What `mser3d.detect` gave, a folder with it, or the name of a shape of the collection.

    Returns
    -------
    dict
        For each region of the shape, the nearest regions, nearest first: records of ``shape``, ``region``, ``distance``, ...

    Other Parameters
    ----------------
    k : int, default 5
        How many of the closest regions to list
    region : int, default None
        Only for this region of the shape
    include_itself : bool, default False
        List regions of the shape itself too, when it is in the collection
    """
    ...

def track(
    frames: Path | Sequence[Path],
    folder: Path | None = None,
    *,
    write: Sequence[str] = (),
    progress: Progress = None,
    workers: int | None = None,
    threads: int | None = None,
    animation: str | None = None,
    every: float | None = None,
    min_overlap: float = 0.5,
    min_likeness: float = 0.2,
    max_gap: int = 3,
    volume: int | None = None,
    label: int | str | None = None,
    threshold: float | None = None,
    labels: Mapping[int, str] | str | os.PathLike[str] | None = None,
    affine: Any = None,
    surface: bool = False,
    weight: Any = 'heat',
    smooth_weight: float | None = None,
    time_scale: float | Sequence[float] = (0.25, 0.5, 1.0, 2.0),
    absolute_time: float | Sequence[float] | None = None,
    reference_measure: float | None = None,
    bodies: Literal['largest', 'all', 'join'] = 'largest',
    polarity: Literal['sublevel', 'superlevel'] | None = None,
    voxels: int | None = None,
    resolution: int | None = None,
    pitch: float | None = None,
    spacing: float | Sequence[float] | None = None,
    origin: float | Sequence[float] | None = None,
    connectivity: Literal['6', '26', 6, 26] = '6',
    inside: Literal['auto', 'parity', 'vote', 'winding'] = 'auto',
    overlap: Literal['auto', 'part', 'join'] = 'auto',
    no_cut_links: bool = False,
    morphology: Literal['open', 'close'] | None = None,
    memory_limit: int | None = None,
    max_box_voxels: int = 4294967296,
    time_limit: float | None = None,
    allow_outside: bool = False,
    eigenpairs: int | None = None,
    lambda_max: float | None = None,
    tolerance: float | None = None,
    solver: Literal['auto', 'shift-invert', 'filter', 'multigrid'] = 'auto',
    cache: str | os.PathLike[str] | None = None,
    stability_rule: Literal['windowed', 'paper', 'baseline'] = 'windowed',
    window: float = 0.25,
    min_lifetime: float | None = None,
    altitude: Literal['log', 'linear'] | None = None,
    min_volume: float = 0.01,
    max_volume: float = 0.75,
    min_diversity: float = 0.2,
    min_stability: float | None = None,
    duplicate_overlap: float = 0.9,
    reliability: int | None = None,
    min_reliability: float | None = None,
    descriptor: Literal['sided-si-hks', 'sized-si-hks', 'si-hks', 'hks'] = 'sided-si-hks',
    parts: int | str = 'auto',
) -> Tracks:
    """Follows the regions of a body through a sequence.

    Parameters
    ----------
    frames : path or list of paths
        An animated glTF file; or the frames in their order: files, folders or patterns.
    folder : path
        Where the results of the frames go, and ``tracks.json``: what is there is not computed again. Default: not kept.
    write : list of str
        Files besides, for each frame, as of ``mser3d track --write``.
    progress : callable or "tqdm"
        Called with ("frames", share, share) now and then.

    Returns
    -------
    Tracks

    Raises
    ------
    ValueError
        Wrong input; also where frames have failed and none is left.

    Other Parameters
    ----------------
    workers : int, default None
        Shapes in parallel, as far as memory allows [default: one a thread]
    threads : int, default None
        Threads to use, 32 or the number of cores at most; the result is the same for any number [default: all
        cores]
    animation : str, default None
        glTF animation, by name or number from 0 [default: the file's only one]
    every : float, default None
        Seconds between frames of the animation, at most [default: 1/24]
    min_overlap : float, default 0.5
        Least overlap at which regions of two frames are the same, where the frames have the same vertices
    min_likeness : float, default 0.2
        Least likeness at which they are the same, where the frames have other vertices
    max_gap : int, default 3
        In how many frames in a row a region may be missing and keep its identity
    volume : int, default None
        Which volume of a file that holds several (times, frames, components), from 0
    label : str, default None
        The body is this label, by number or name; all: each label is a shape of its own
    threshold : float, default None
        The body is the voxels of at least this value
    labels : path, default None
        Table with the names of labels, a line each: 3,liver
    affine : path, default None
        Voxel-to-world map in place of the file's: a text or .npy file of 4 x 4 numbers
    surface : bool, default False
        Search the surface instead of the volume inside
    weight : {'heat', 'commute', 'edge', 'diffusion', 'curvature', 'field'}, default 'heat'
        What the component tree is built on; FIELD.npy: values or vectors of its own for each vertex or voxel
        * 'heat': The heat kernel H_t(v,v) of voxels or vertices: heat that stays
        * 'commute': The commute time (eq. 6) of voxels or vertices, which has no time scale
        * 'edge': 1/H_t(u,v) of neighbours, on the links or edges: where heat passes badly
        * 'diffusion': The diffusion distance of neighbours over their distance: where heat spreads differently
        * 'curvature': The mean curvature of a mesh's surface, in a volume carried inside
        * 'field': The values of a file in place of this name, FIELD.npy: a value or a vector for each vertex or
          voxel
    smooth_weight : float, default None
        How long heat smooths the weight first, in units of volume^(2/3) (surface: area); not edge and diffusion
        [default: none]
    time_scale : float or a list of them, default (0.25, 0.5, 1.0, 2.0)
        Time scales, in units of volume^(2/3) (surface: area); one tree each, regions pooled
    absolute_time : float or a list of them, default None
        Time scales in squared units of the input's coordinates, instead of --time-scale
    reference_measure : float, default None
        Volume (surface: area) that time scales and descriptors refer to, in the input's units; give all poses of
        a body that of one [default: the shape's own]
    bodies : {'largest', 'all', 'join'}, default 'largest'
        What to do with a shape of several bodies
        * 'largest': The largest body is searched, the others are left out
        * 'all': Each body is searched on its own
        * 'join': All bodies are searched together, as one shape
    polarity : {'sublevel', 'superlevel'}, default None
        Which way the tree grows [default: the one that finds limbs; of a field where its values are high, of
        vectors where they differ little]
        * 'sublevel': The level rises: components of low weight
        * 'superlevel': The level falls: components of high weight
    voxels : int, default None
        Voxels in the solid, about [default: 45000]
    resolution : int, default None
        Voxels on the longest axis
    pitch : float, default None
        Edge of a voxel, in the input's units; of a volume, in place of its file's
    spacing : float or a list of them, default None
        Lengths of a voxel along the axes, in the input's units; of a volume, in place of its file's
    origin : float or a list of them, default None
        First corner of the grid, to share it with another tool [default: that of a grid around the body's
        middle]; of a volume, the centre of its first voxel, in place of its file's
    connectivity : {'6', '26'}, default '6'
        Neighbours of a voxel in the tree (the Laplacian has 6)
        * '6': Voxels that share a face; in an image, 4 pixels
        * '26': Voxels that share a face, an edge or a corner; in an image, 8 pixels
    inside : {'auto', 'parity', 'vote', 'winding'}, default 'auto'
        How inside is told from outside
        * 'auto': What the mesh needs, as its diagnosis says
        * 'parity': Crossings of rays along x, counted modulo 2: closed meshes only
        * 'vote': The same along x, y and z, and the majority
        * 'winding': The winding number: for open and overlapping meshes too
    overlap : {'auto', 'part', 'join'}, default 'auto'
        What to do where the solid overlaps itself
        * 'auto': A surface that overlaps itself is parted, different bodies are joined
        * 'part': Voxels that are covered twice are left out
        * 'join': Voxels that are covered twice belong to the solid
    no_cut_links : bool, default False
        Link all neighbours, even where the surface runs between them
    morphology : {'open', 'close'}, default None
        Change the solid by a voxel, against artefacts of the mesh [default: none]
        * 'open': Erosion, then dilation: drops what is thinner than three voxels
        * 'close': Dilation, then erosion: fills slits and pits a voxel wide
    memory_limit : int, default None
        Refuse what takes more memory, in MB: a file, a grid, a spectrum [default: 80 % of what is free, within
        the limits of the system and of control groups]
    max_box_voxels : int, default 4294967296
        Refuse boxes of more voxels than this, of a mesh's grid and of a file; a grid takes half a byte for each
    time_limit : float, default None
        End with an error when the work takes longer; of many shapes, each [default: no limit]
    allow_outside : bool, default False
        Read files outside of its folder too that a file names: buffers of glTF, data of NRRD and MetaImage
    eigenpairs : int, default None
        Smallest eigenpairs of the Laplacian [default: 100, or as many as a small shape has]
    lambda_max : float, default None
        All eigenpairs with lambda V^(2/3) below this (lambda A with --surface): the same scales on any shape
    tolerance : float, default None
        Largest relative residual of an eigenpair; below 1e-4 regions stay the same [default: 1e-4; 1e-9 where
        --write asks for eigenfunctions, signatures or fields]
    solver : {'auto', 'shift-invert', 'filter', 'multigrid'}, default 'auto'
        How eigenpairs are found
        * 'auto': By size and kind: dense, the filter for grids, shift-invert for all others
        * 'shift-invert': Block Lanczos on the inverse, by sparse L D L^T factorizations
        * 'filter': Block Lanczos on a Chebyshev polynomial of the grid's stencil, without a matrix
        * 'multigrid': Eigenvectors of coarser grids, carried up level by level and corrected by multigrid cycles
    cache : path, default None
        Keep spectra in this folder and take them from there; results are the same with and without
    stability_rule : {'windowed', 'paper', 'baseline'}, default 'windowed'
        How stable regions are chosen
        * 'windowed': Change of volume over a window of altitude, within branches that end at real merges
        * 'paper': The published rule (eq. 5): change of volume from a node to its parent
        * 'baseline': No stability: every node whose parent is clearly larger
    window : float, default 0.25
        Half width of the stability window, in units of log altitude; linear: of the weight's spread
    min_lifetime : float, default None
        Least lifetime of a part, in units of (log) altitude [default: 0.1; with linear altitude 0]
    altitude : {'log', 'linear'}, default None
        Scale on which altitude, and so stability, is measured [default: log; linear for curvature and fields]
        * 'log': ln(weight): stability does not depend on the unit of the weight
        * 'linear': The weight itself, as for grey values
    min_volume : float, default 0.01
        Smallest region, as a fraction of the whole
    max_volume : float, default 0.75
        Largest region, as a fraction of the whole
    min_diversity : float, default 0.2
        How much smaller than the next larger region a nested one must be, as a fraction
    min_stability : float, default None
        Drop regions that are less stable [default: none]
    duplicate_overlap : float, default 0.9
        Overlap from which regions of two time scales are one
    reliability : int, default None
        Deformed copies of the shape that are searched, to measure how surely each region is found again; 0 for
        none [default: 6, fewer where they take over 10 s]
    min_reliability : float, default None
        Drop regions that are found again less surely, 0 to 1
    descriptor : {'sided-si-hks', 'sized-si-hks', 'si-hks', 'hks'}, default 'sided-si-hks'
        Heat kernel signature that describes a region
        * 'sided-si-hks': SI-vHKS, the region's share of the volume, and on which side of the body it is
        * 'sized-si-hks': The same without the side: the same for left and right
        * 'si-hks': SI-vHKS alone, as in the paper
        * 'hks': vHKS
    parts : str, default 'auto'
        Divide each body into parts too, every voxel and vertex in exactly one: limbs and trunk (auto), this many,
        or none
    """
    ...

def voxelize(
    mesh: Any,
    faces: Any = None,
    *,
    threads: int | None = None,
    format: Literal['obj', 'gltf', 'glb', 'off', 'ply', 'stl', 'vtu', 'vtp', 'vtk', 'msh', 'mesh', 'npy', 'nifti', 'nrrd', 'metaimage', 'mgh', 'tiff'] | None = None,
    animation: str | None = None,
    time: float = 0.0,
    voxels: int | None = None,
    resolution: int | None = None,
    pitch: float | None = None,
    spacing: float | Sequence[float] | None = None,
    origin: float | Sequence[float] | None = None,
    connectivity: Literal['6', '26', 6, 26] = '6',
    inside: Literal['auto', 'parity', 'vote', 'winding'] = 'auto',
    overlap: Literal['auto', 'part', 'join'] = 'auto',
    no_cut_links: bool = False,
    morphology: Literal['open', 'close'] | None = None,
    memory_limit: int | None = None,
    max_box_voxels: int = 4294967296,
    time_limit: float | None = None,
    allow_outside: bool = False,
) -> Voxels:
    """Makes the solid inside a mesh: all voxels whose centres are inside, linked where no surface runs between them.

    Parameters
    ----------
    mesh, faces
        As of `mser3d.detect`.
    threads : int
        Threads to use; the result is the same for any number.

    Returns
    -------
    Voxels

    Raises
    ------
    ValueError, MemoryError
        In the words of the command line.

    Other Parameters
    ----------------
    format : {'obj', 'gltf', 'glb', 'off', 'ply', 'stl', 'vtu', 'vtp', 'vtk', 'msh', 'mesh', 'npy', 'nifti', 'nrrd', 'metaimage', 'mgh', 'tiff'}, default None
        Format of the input, whatever its name says; standard input, -, has none
        * 'obj':
        * 'gltf':
        * 'glb':
        * 'off':
        * 'ply':
        * 'stl':
        * 'vtu':
        * 'vtp':
        * 'vtk':
        * 'msh':
        * 'mesh':
        * 'npy':
        * 'nifti':
        * 'nrrd':
        * 'metaimage':
        * 'mgh':
        * 'tiff':
    animation : str, default None
        glTF animation that poses the figure, by name or number from 0
    time : float, default 0.0
        When in the animation, in seconds
    voxels : int, default None
        Voxels in the solid, about [default: 45000]
    resolution : int, default None
        Voxels on the longest axis
    pitch : float, default None
        Edge of a voxel, in the input's units; of a volume, in place of its file's
    spacing : float or a list of them, default None
        Lengths of a voxel along the axes, in the input's units; of a volume, in place of its file's
    origin : float or a list of them, default None
        First corner of the grid, to share it with another tool [default: that of a grid around the body's
        middle]; of a volume, the centre of its first voxel, in place of its file's
    connectivity : {'6', '26'}, default '6'
        Neighbours of a voxel in the tree (the Laplacian has 6)
        * '6': Voxels that share a face; in an image, 4 pixels
        * '26': Voxels that share a face, an edge or a corner; in an image, 8 pixels
    inside : {'auto', 'parity', 'vote', 'winding'}, default 'auto'
        How inside is told from outside
        * 'auto': What the mesh needs, as its diagnosis says
        * 'parity': Crossings of rays along x, counted modulo 2: closed meshes only
        * 'vote': The same along x, y and z, and the majority
        * 'winding': The winding number: for open and overlapping meshes too
    overlap : {'auto', 'part', 'join'}, default 'auto'
        What to do where the solid overlaps itself
        * 'auto': A surface that overlaps itself is parted, different bodies are joined
        * 'part': Voxels that are covered twice are left out
        * 'join': Voxels that are covered twice belong to the solid
    no_cut_links : bool, default False
        Link all neighbours, even where the surface runs between them
    morphology : {'open', 'close'}, default None
        Change the solid by a voxel, against artefacts of the mesh [default: none]
        * 'open': Erosion, then dilation: drops what is thinner than three voxels
        * 'close': Dilation, then erosion: fills slits and pits a voxel wide
    memory_limit : int, default None
        Refuse what takes more memory, in MB: a file, a grid, a spectrum [default: 80 % of what is free, within
        the limits of the system and of control groups]
    max_box_voxels : int, default 4294967296
        Refuse boxes of more voxels than this, of a mesh's grid and of a file; a grid takes half a byte for each
    time_limit : float, default None
        End with an error when the work takes longer; of many shapes, each [default: no limit]
    allow_outside : bool, default False
        Read files outside of its folder too that a file names: buffers of glTF, data of NRRD and MetaImage
    """
    ...
