"""Solid voxelization by other people's libraries, timed and compared voxel by voxel.

    python voxelize.py JOB.json

JOB.json names raw files: vertices (float64, n x 3), triangles (uint32, m x 3), and `inside`, our own bits
(rows along x in little-endian 64-bit words); and the grid: dims, origin, spacing. One JSON line for each peer
named in `peers` goes to stdout: name, version, output, seconds (wall and CPU, best of `runs`), voxels inside, voxels that
differ from ours. A peer that is not installed is left out.

    pip install numpy open3d vtk libigl trimesh scipy
"""

import importlib.metadata
import json
import sys
import time

import numpy as np


def best_of(runs, task):
    """The task's result and its least wall and CPU seconds."""
    wall = cpu = float("inf")
    for _ in range(runs):
        start, start_cpu = time.perf_counter(), time.process_time()
        result = task()
        wall = min(wall, time.perf_counter() - start)
        cpu = min(cpu, time.process_time() - start_cpu)
    return result, wall, cpu


class Job:
    def __init__(self, path):
        with open(path) as file:
            job = json.load(file)
        self.vertices = np.fromfile(job["vertices"], np.float64).reshape(-1, 3)
        self.triangles = np.fromfile(job["triangles"], np.uint32).reshape(-1, 3).astype(np.int64)
        self.dims, self.runs, self.slow, self.peers = job["dims"], job["runs"], job["slow"], job["peers"]
        self.origin, self.spacing = np.array(job["origin"]), job["spacing"]
        nx, ny, nz = self.dims
        words = np.fromfile(job["inside"], np.uint8)
        bits = np.unpackbits(words, bitorder="little").reshape(nz, ny, -1)
        self.inside = bits[:, :, :nx].astype(bool)

    def centres(self, axis):
        return self.origin[axis] + self.spacing * (np.arange(self.dims[axis]) + 0.5)

    def report(self, name, package, output, task, runs=None):
        inside, wall, cpu = best_of(runs or self.runs, task)
        line = {"peer": name, "version": importlib.metadata.version(package), "output": output}
        line |= {"wall": wall, "cpu": cpu}
        if inside is not None:
            inside = inside.reshape(self.inside.shape)
            line |= {"inside": int(inside.sum()), "differing": int((inside != self.inside).sum())}
        print(json.dumps(line), flush=True)


def open3d_columns(job):
    import open3d as o3d

    mesh = o3d.t.geometry.TriangleMesh(
        o3d.core.Tensor(job.vertices.astype(np.float32)), o3d.core.Tensor(job.triangles.astype(np.int32))
    )
    scene = o3d.t.geometry.RaycastingScene()
    scene.add_triangles(mesh)
    nx, ny, nz = job.dims

    def rays():
        z, y = np.meshgrid(job.centres(2), job.centres(1), indexing="ij")
        rays = np.zeros((ny * nz, 6), np.float32)
        rays[:, 0], rays[:, 1], rays[:, 2], rays[:, 3] = job.origin[0], y.ravel(), z.ravel(), 1
        return scene.list_intersections(o3d.core.Tensor(rays))

    def columns():
        hits = rays()
        cell = np.ceil(hits["t_hit"].numpy().astype(np.float64) / job.spacing - 0.5).astype(np.int64)
        crossings = np.zeros((ny * nz, nx + 1), np.uint8)
        np.add.at(crossings, (hits["ray_ids"].numpy(), np.clip(cell, 0, nx)), 1)
        return np.bitwise_xor.accumulate(crossings & 1, axis=1)[:, :nx].astype(bool)

    rays()  # builds the tree
    job.report("Open3D columns (tree excluded)", "open3d", "bytes", columns)
    job.report("Open3D rays alone", "open3d", "hits", lambda: rays() and None)


def vtk_stencil(job):
    import vtk
    from vtk.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray, vtk_to_numpy

    points, cells, surface = vtk.vtkPoints(), vtk.vtkCellArray(), vtk.vtkPolyData()
    points.SetData(numpy_to_vtk(job.vertices, deep=1))
    offsets = np.arange(0, 3 * len(job.triangles) + 1, 3, dtype=np.int64)
    cells.SetData(numpy_to_vtkIdTypeArray(offsets, deep=1), numpy_to_vtkIdTypeArray(job.triangles.ravel(), deep=1))
    surface.SetPoints(points)
    surface.SetPolys(cells)
    nx, ny, nz = job.dims

    def stencil():
        inside = vtk.vtkPolyDataToImageStencil()
        inside.SetInputData(surface)
        inside.SetOutputOrigin(*(job.origin + job.spacing / 2))
        inside.SetOutputSpacing(job.spacing, job.spacing, job.spacing)
        inside.SetOutputWholeExtent(0, nx - 1, 0, ny - 1, 0, nz - 1)
        inside.SetTolerance(0)
        image = vtk.vtkImageStencilToImage()
        image.SetInputConnection(inside.GetOutputPort())
        image.SetInsideValue(1)
        image.SetOutsideValue(0)
        image.SetOutputScalarTypeToUnsignedChar()
        image.Update()
        return vtk_to_numpy(image.GetOutput().GetPointData().GetScalars()).astype(bool)

    job.report("VTK PolyDataToImageStencil", "vtk", "bytes", stencil, 1 if job.slow else None)


def libigl_winding(job):
    import igl

    def winding():
        z, y, x = np.meshgrid(*(job.centres(a) for a in (2, 1, 0)), indexing="ij")
        points = np.stack([x, y, z], -1).reshape(-1, 3)
        return igl.fast_winding_number(job.vertices, job.triangles, points) > 0.5

    job.report("libigl fast winding number", "libigl", "doubles", winding, 1)


def trimesh_fill(job):
    import trimesh

    mesh = trimesh.Trimesh(job.vertices, job.triangles, process=False)
    # Its grid is its own, so that voxels cannot be compared.
    job.report("trimesh voxelized().fill()", "trimesh", "bytes", lambda: mesh.voxelized(job.spacing).fill() and None, 1)


def main():
    job = Job(sys.argv[1])
    peers = {"open3d": open3d_columns, "vtk": vtk_stencil, "libigl": libigl_winding, "trimesh": trimesh_fill}
    for peer in job.peers:
        try:
            peers[peer](job)
        except (ImportError, importlib.metadata.PackageNotFoundError) as missing:
            print(f"left out: {missing}", file=sys.stderr)


if __name__ == "__main__":
    main()
