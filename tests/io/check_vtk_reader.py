"""Opens VTKHDF files with VTK's own vtkHDFReader and compares what it reads with h5py.

Usage: check_vtk_reader.py FILE...     static image and mesh files
       check_vtk_reader.py COMMAND     all static files that `COMMAND demo` writes

Exits 77 when VTK or h5py is missing, 1 when a file reads differently.
"""
import os
import subprocess
import sys
import tempfile

try:
    import h5py
    import numpy as np
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkIOHDF import vtkHDFReader
except ImportError as error:
    print(f"skipped: {error}; the packages are python3-vtk9 and python3-h5py")
    sys.exit(77)


def read(path):
    reader = vtkHDFReader()
    assert reader.CanReadFile(path), "vtkHDFReader does not take this file"
    reader.SetFileName(path)
    reader.Update()
    data = reader.GetOutputDataObject(0)
    return data.GetPartition(0) if data.IsA("vtkPartitionedDataSet") else data


def check_arrays(stored, data, tuples):
    for name, dataset in stored.items():
        array = data.GetPointData().GetArray(name)
        assert array is not None, f"array '{name}' is missing"
        seen = vtk_to_numpy(array)
        expected = dataset[()].reshape(tuples, -1)
        assert seen.dtype == dataset.dtype.newbyteorder("="), f"{name}: {seen.dtype}"
        assert np.array_equal(seen.reshape(tuples, -1), expected), f"{name}: other samples"
        print(f"  {name}: {seen.dtype}, {expected.shape[1]} component(s)")


def check_image(group, data):
    extent = np.asarray(group.attrs["WholeExtent"])
    dims = tuple(int(d) for d in extent[1::2] - extent[0::2] + 1)
    direction = data.GetDirectionMatrix()
    cosines = [direction.GetElement(row, axis) for row in range(3) for axis in range(3)]
    print(f"  dims {data.GetDimensions()}, spacing {data.GetSpacing()}, origin {data.GetOrigin()}")
    assert data.GetDimensions() == dims, f"dims {data.GetDimensions()}, not {dims}"
    assert data.GetSpacing() == tuple(group.attrs["Spacing"]), "other spacing"
    assert data.GetOrigin() == tuple(group.attrs["Origin"]), "other origin"
    assert cosines == list(group.attrs["Direction"]), "other direction"
    check_arrays(group["PointData"], data, int(np.prod(dims)))


def check_mesh(group, data):
    nodes = int(group["NumberOfPoints"][0])
    cells = int(group["NumberOfCells"][0])
    print(f"  {data.GetNumberOfPoints()} nodes, {data.GetNumberOfCells()} cells")
    assert data.GetNumberOfPoints() == nodes and data.GetNumberOfCells() == cells
    points = vtk_to_numpy(data.GetPoints().GetData())
    assert np.array_equal(points, group["Points"][:nodes]), "other points"
    connectivity = vtk_to_numpy(data.GetCells().GetConnectivityArray())
    assert np.array_equal(connectivity, group["Connectivity"][()]), "other connectivity"
    assert all(data.GetCellType(cell) == 10 for cell in range(cells)), "cells are no tetrahedra"
    check_arrays(group["PointData"], data, nodes)


def check(path):
    """False when the file is none of the static ones that every VTKHDF reader supports."""
    with h5py.File(path, "r") as file:
        group = file["VTKHDF"]
        kind = group.attrs["Type"].decode()
        if "Steps" in group:
            print(f"{path}: {kind} with steps, not for this reader")
            return False
        print(f"{path}: {kind}")
        data = read(path)
        if kind == "ImageData":
            check_image(group, data)
        else:
            check_mesh(group, data)
    return True


def check_all(paths):
    checked = 0
    for path in paths:
        try:
            checked += check(path)
        except AssertionError as error:
            sys.exit(f"{path}: {error}")
    if checked == 0:
        sys.exit("no static VTKHDF file was given")
    print(f"{checked} file(s) read alike by VTK and h5py")


def check_demo(command):
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run([command, "demo", "-o", folder], check=True, stdout=subprocess.DEVNULL)
        names = sorted(name for name in os.listdir(folder) if name.endswith(".vtkhdf"))
        check_all([os.path.join(folder, name) for name in names])


if __name__ == "__main__":
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    is_command = not h5py.is_hdf5(sys.argv[1]) and os.access(sys.argv[1], os.X_OK)
    check_demo(sys.argv[1]) if is_command else check_all(sys.argv[1:])
