"""Uses an installed wheel, beside h5py in the same process, with the command and tetwarp-read."""

import pathlib
import subprocess

import h5py
import numpy as np

import tetwarp

volume = tetwarp.phantom(shape=(30, 40, 50))
mesh = tetwarp.lattice_mesh(volume, cells=3)
twisted = tetwarp.deform(*mesh, kind="twist", amount=0.5)
result = tetwarp.warp(volume, *mesh, twisted, backend="cpu")

# h5py holds a file of its own while the other HDF5 writes, and reads what that has written.
with h5py.File("other.h5", "w") as other:
    other["numbers"] = np.arange(10)
    tetwarp.write("volume.vtkhdf", volume)
    tetwarp.write("mesh.vtkhdf", mesh, deformed=[twisted])
    assert other["numbers"][3] == 3
with h5py.File("volume.vtkhdf") as file:
    values = next(iter(file["VTKHDF/PointData"].values()))
    assert np.array_equal(values[...].ravel(), volume.array.ravel())
print(f"HDF5 of h5py: {h5py.version.hdf5_version}")

subprocess.run("tetwarp --version".split(), check=True)
subprocess.run(
    "tetwarp warp volume.vtkhdf mesh.vtkhdf -o warped.vtkhdf --steps -1 --backend cpu".split(),
    check=True, stdout=subprocess.DEVNULL)
assert np.array_equal(tetwarp.read("warped.vtkhdf").array, result.volume)

pathlib.Path("points.vtu").write_text("<VTKFile/>")
read = subprocess.run("tetwarp info points.vtu".split(), text=True, capture_output=True,
                      check=False)
assert read.returncode != 0 and "VTK" in read.stderr, read
print(read.stderr.strip())
for backend in tetwarp.available_backends():
    print(backend)
