"""Uses an installed wheel, its command and tetwarp-read, in one process with packages that bring
libraries of their own for the same files: python check_wheel.py PACKAGE... imports them in this
order."""

import importlib
import pathlib
import re
import subprocess
import sys

import numpy as np

#: Libraries that a wheel may carry beside HDF5 (BSD), which is in the module, and their licenses: none
#: would bind a program that uses the wheel, as the GPL would.
LICENSES = {
    "aec": "BSD-2-Clause", "fmt": "MIT", "gif": "MIT", "hwy": "Apache-2.0 or BSD-3-Clause",
    "niftiio": "public domain", "png16": "libpng-2.0", "sz": "BSD-2-Clause", "z": "Zlib",
    "znz": "public domain",
}

for package in sys.argv[1:]:
    importlib.import_module(package)
h5py, sitk, tetwarp, vtk = (sys.modules[name] for name in ("h5py", "SimpleITK", "tetwarp", "vtk"))

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
reader = vtk.vtkHDFReader()
reader.SetFileName("volume.vtkhdf")
reader.Update()
assert np.array_equal(reader.GetOutput().GetPointData().GetArray(0), volume.array.ravel())
tetwarp.write("volume.nii.gz", volume)
assert np.array_equal(sitk.GetArrayFromImage(sitk.ReadImage("volume.nii.gz")), volume.array)
sitk.WriteImage(sitk.GetImageFromArray(volume.array), "other.nii.gz")
assert np.array_equal(tetwarp.read("other.nii.gz").array, volume.array)

# Libraries of the wheel have names that no other package looks for, and are those in use.
libraries = pathlib.Path(tetwarp.__file__).parent.parent / "tetwarp.libs"
names = {path.name for path in libraries.iterdir()}
assert all(re.search(r"-[0-9a-f]{8}\.so", name) for name in names), names
unknown = {re.match(r"(?:lib)?(.+)-[0-9a-f]{8}", name)[1] for name in names} - set(LICENSES)
assert not unknown, f"find out the licenses of {unknown}, and add them to LICENSES or leave them out"
used = {name for name in names if name in pathlib.Path("/proc/self/maps").read_text("utf8")}
print(f"{sys.argv[1:]}: {len(used)} of {len(names)} libraries of the wheel in this process; "
      f"HDF5 of h5py: {h5py.version.hdf5_version}")
assert used

subprocess.run("tetwarp --version".split(), check=True)
subprocess.run(
    "tetwarp warp volume.vtkhdf mesh.vtkhdf -o warped.vtkhdf --steps -1 --backend cpu".split(),
    check=True, stdout=subprocess.DEVNULL)
assert np.array_equal(tetwarp.read("warped.vtkhdf").array, result.volume)
namespace = ["unshare", "--mount", "--map-root-user", "sh", "-c"]
if subprocess.run([*namespace, "mount -t tmpfs none /proc"], check=False).returncode == 0:
    subprocess.run([*namespace, "mount -t tmpfs none /proc && exec tetwarp --version"], check=True)
else:
    print("not tried: the command without /proc")

# The wheel's reader has no VTK; in Python meshio takes its place.
tetwarp.to_meshio(mesh).write("mesh.vtu")
assert np.array_equal(tetwarp.read("mesh.vtu").mesh.points, mesh.points)
read = subprocess.run("tetwarp info mesh.vtu".split(), text=True, capture_output=True, check=False)
assert read.returncode != 0 and "VTK" in read.stderr, read
print(read.stderr.strip())
for backend in tetwarp.available_backends():
    print(backend)
