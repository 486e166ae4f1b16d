"""Makes the files beside this one by VTK, meshio and Gmsh (pip install vtk meshio gmsh).

All hold the same solid: a cube of a hexahedron, a wedge at its side, a pyramid on top and a tetrahedron at the
pyramid, 10 points and one that no cell uses; volume 1 + 1/2 + 1/3 + 1/6. Those of VTK and Gmsh also hold a
triangle and a line, which are left out.
"""
import gmsh
import meshio
import numpy as np
import vtk

POINTS = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1], [9, 9, 9],
          [2, 0, 0], [2, 0, 1], [0.5, 0.5, 2], [0.5, -1, 1]]
HEXAHEDRON = [0, 1, 2, 3, 4, 5, 6, 7]
WEDGE = [1, 9, 2, 5, 10, 6]
PYRAMID = [4, 5, 6, 7, 11]
TETRAHEDRON = [4, 5, 11, 12]


def vtk_grid():
    grid, points = vtk.vtkUnstructuredGrid(), vtk.vtkPoints()
    points.SetDataType(vtk.VTK_FLOAT)
    for p in POINTS:
        points.InsertNextPoint(p)
    grid.SetPoints(points)
    for kind, nodes in [(12, HEXAHEDRON), (5, [0, 1, 5]), (13, WEDGE), (14, PYRAMID), (10, TETRAHEDRON), (3, [0, 1])]:
        grid.InsertNextCell(kind, len(nodes), nodes)
    words = vtk.vtkStringArray()
    words.SetName("made by")
    words.InsertNextValue("make.py")
    grid.GetFieldData().AddArray(words)
    return grid


def xml(name, mode, packed, bits, big_endian, base64=True):
    writer = vtk.vtkXMLUnstructuredGridWriter()
    writer.SetInputData(vtk_grid())
    writer.SetFileName(name)
    writer.SetDataMode({"ascii": 0, "binary": 1, "appended": 2}[mode])
    writer.SetCompressorTypeToZLib() if packed else writer.SetCompressorTypeToNone()
    writer.SetHeaderTypeToUInt32() if bits == 32 else writer.SetHeaderTypeToUInt64()
    writer.SetByteOrder(0 if big_endian else 1)
    writer.SetEncodeAppendedData(base64)
    writer.Write()


def legacy(name, version, binary):
    writer = vtk.vtkUnstructuredGridWriter()
    writer.SetInputData(vtk_grid())
    writer.SetFileName(name)
    writer.SetFileVersion(version)
    writer.SetFileType(2 if binary else 1)
    writer.Write()


def gmsh_files():
    gmsh.initialize()
    gmsh.option.setNumber("General.Terminal", 0)
    gmsh.model.addDiscreteEntity(3, 1)
    gmsh.model.addDiscreteEntity(2, 1)
    gmsh.model.addDiscreteEntity(1, 1)
    # Gmsh renumbers nothing: tags are as sparse as these.
    tags = [3 * i + 5 for i in range(len(POINTS))]
    tag = lambda nodes: [tags[i] for i in nodes]
    gmsh.model.mesh.addNodes(3, 1, tags, [x for p in POINTS for x in p])
    kinds = [(5, HEXAHEDRON), (6, WEDGE), (7, PYRAMID), (4, TETRAHEDRON)]
    gmsh.model.mesh.addElements(3, 1, [k for k, _ in kinds], [[i + 1] for i in range(4)], [tag(n) for _, n in kinds])
    gmsh.model.mesh.addElements(2, 1, [2], [[5]], [tag([0, 1, 5])])
    gmsh.model.mesh.addElements(1, 1, [1], [[6]], [tag([0, 1])])
    gmsh.option.setNumber("Mesh.SaveAll", 1)
    for version, binary in [(2.2, 0), (2.2, 1), (4.0, 0), (4.1, 0), (4.1, 1)]:
        gmsh.option.setNumber("Mesh.MshFileVersion", version)
        gmsh.option.setNumber("Mesh.Binary", binary)
        gmsh.write(f"gmsh_{version}_{'binary' if binary else 'ascii'}.msh")
    gmsh.finalize()


xml("vtk_ascii.vtu", "ascii", False, 32, False)
xml("vtk_inline_zlib_big.vtu", "binary", True, 64, True)
xml("vtk_inline.vtu", "binary", False, 32, False)
xml("vtk_appended_raw_big.vtu", "appended", False, 64, True, base64=False)
xml("vtk_appended_raw_zlib.vtu", "appended", True, 32, False, base64=False)
xml("vtk_appended_base64_zlib.vtu", "appended", True, 64, False)
for version in (42, 51):
    legacy(f"vtk_{version}_ascii.vtk", version, False)
    legacy(f"vtk_{version}_binary.vtk", version, True)
cells = [("hexahedron", [HEXAHEDRON]), ("wedge", [WEDGE]), ("pyramid", [PYRAMID]), ("tetra", [TETRAHEDRON])]
mesh = meshio.Mesh(np.array(POINTS, dtype=float), [(kind, np.array(nodes)) for kind, nodes in cells])
mesh.write("meshio_zlib.vtu", compression="zlib")
mesh.write("meshio_inline.vtu", compression=None)
mesh.write("meshio.mesh")
gmsh_files()
