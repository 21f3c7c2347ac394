"""Compares vectors, tensors and displacements in NIfTI files with SimpleITK and nibabel.

Usage: check_axes.py COMMAND [EVERY]

A linear vector field and a linear tensor field on an oblique, a mirrored and a sheared grid are
imported, warped by a rotation about three axes and exported. SimpleITK and nibabel write the input
and read the output; what they must find there is computed here. Displacement fields of images of all
48 orientations (of every EVERYth of them) and three units of length, without a form and of one slice
are applied by SimpleITK, in NIfTI and MetaImage files, of volumes that take unit and form of another
image, and composed. Exits 77 when SimpleITK, nibabel or h5py is missing, 1 when a value or a
field of a header differs.
"""
import itertools
import os
import subprocess
import sys
import tempfile

try:
    import h5py
    import nibabel
    import numpy as np
    import SimpleITK as sitk
except ImportError as error:
    print(f"skipped: {error}; install SimpleITK, nibabel and h5py by pip")
    sys.exit(77)

LPS = np.diag([-1.0, -1.0, 1.0])  # from RAS to LPS and back
DIMS = (9, 8, 7)
BOX_TETS = [[0, 3, 5, 6], [1, 0, 3, 5], [2, 0, 3, 6], [4, 0, 5, 6], [7, 3, 5, 6]]
NIFTI_ROWS, NIFTI_COLUMNS = [0, 1, 1, 2, 2, 2], [0, 0, 1, 0, 1, 2]  # xx xy yy xz yz zz


def rotation(x, y, z):
    """About x, then y, then z [degrees]."""
    result = np.eye(3)
    for axis, angle in enumerate(np.radians([x, y, z])):
        c, s = np.cos(angle), np.sin(angle)
        turn = np.eye(3)
        i, j = (axis + 1) % 3, (axis + 2) % 3
        turn[i, i], turn[i, j], turn[j, i], turn[j, j] = c, -s, s, c
        result = turn @ result
    return result


TURN = rotation(25, -40, 70)  # of the mesh, in RAS
SLOPE = np.array([[0.02, -0.01, 0.03], [0.01, 0.04, -0.02], [-0.03, 0.02, 0.01]])
VECTOR = np.array([1.0, 2.0, 3.0])
FRAME = rotation(-30, 50, 20)
TENSOR = FRAME @ np.diag([3.0, 2.0, 1.0]) @ FRAME.T
GROWTH = np.array([0.01, -0.02, 0.015])  # of the tensor, per unit of length


def affines():
    """From voxel to RAS."""
    oblique = rotation(20, 35, -15) @ np.diag([1.5, 2.0, 2.5])
    mirrored = oblique @ np.diag([-1.0, 1.0, 1.0])
    shear = np.array([[1, 0.3, 0], [0, 1, 0.2], [0, 0, 1]])
    for name, matrix in ("oblique", oblique), ("mirrored", mirrored), ("sheared", oblique @ shear):
        affine = np.eye(4)
        affine[:3, :3] = matrix
        affine[:3, 3] = [12, -34, 56]
        yield name, affine


def points_of(affine):
    """World positions [i][j][k][3] of voxels."""
    index = np.stack(np.meshgrid(*[np.arange(n) for n in DIMS], indexing="ij"), axis=-1)
    return index @ affine[:3, :3].T + affine[:3, 3]


def write_box(path, center):
    """A box around every grid above, displaced by a rotation about `center`."""
    corners = np.array([[x, y, z] for z in (-1, 1) for y in (-1, 1) for x in (-1, 1)], float)
    points = center + 60 * corners
    moved = (points - center) @ TURN.T + center
    with h5py.File(path, "w") as file:
        root = file.create_group("VTKHDF")
        root.attrs["Version"] = np.array([1, 0])
        root.attrs["Type"] = np.bytes_("UnstructuredGrid")
        for name, count in ("Points", 8), ("Cells", 5), ("ConnectivityIds", 20):
            root["NumberOf" + name] = np.array([count])
        root["Points"] = points
        root["Offsets"] = 4 * np.arange(6)
        root["Connectivity"] = np.ravel(BOX_TETS)
        root["Types"] = np.full(5, 10, np.uint8)
        root["PointData/displacement"] = moved - points


def rest_of(points, center):
    """Where the material at `points` was before the rotation."""
    return (points - center) @ TURN + center


def expect(what, found, expected, tolerance):
    worst = float(np.max(np.abs(np.asarray(found) - expected)))
    print(f"  {what}: {worst:.1e}")
    if not worst <= tolerance:
        sys.exit(f"{what}: differs by {worst}, expected at most {tolerance}")


def expect_equal(what, found, expected):
    if found != expected:
        sys.exit(f"{what}: {found}, expected {expected}")


class Files:
    """The command, run in a folder."""

    def __init__(self, command, folder):
        self.command, self.folder = os.path.abspath(command), folder

    def __call__(self, *words):
        result = subprocess.run(
            [self.command, *words], cwd=self.folder, capture_output=True, text=True, check=False
        )
        if result.returncode != 0:
            sys.exit(f"tetwarp {' '.join(words)}: {result.stderr}")

    def path(self, name):
        return os.path.join(self.folder, name)

    def warp(self, image, *words, axes=()):
        self("import", image, "-o", "in.vtkhdf", *axes)
        self("warp", "in.vtkhdf", "mesh.vtkhdf", "-o", "out.vtkhdf", "--quiet", *words)
        self("export", "out.vtkhdf", "--array", "values", "-o", "out.nii")


def sitk_image(samples, affine):
    """An image of vectors; samples and their components [i][j][k][3] are LPS, affine is RAS."""
    image = sitk.GetImageFromArray(np.swapaxes(samples, 0, 2).astype(np.float32), isVector=True)
    spacing = np.linalg.norm(affine[:3, :3], axis=0)
    image.SetSpacing(spacing.tolist())
    image.SetDirection((LPS @ affine[:3, :3] / spacing).ravel().tolist())
    image.SetOrigin((LPS @ affine[:3, 3]).tolist())
    return image


def check_vectors(files, affine, center):
    """SimpleITK writes and reads vectors along LPS."""
    points = points_of(affine)
    field = points @ SLOPE.T + VECTOR  # RAS
    sitk.WriteImage(sitk_image(field @ LPS, affine), files.path("vectors.nii"))

    files.warp("vectors.nii", "--vectors", "values", axes=("--axes", "lps"))

    found = sitk.ReadImage(files.path("out.nii"))
    inner = [(i, j, k) for i in (3, 4, 5) for j in (3, 4) for k in (2, 3, 4)]
    for index in inner:
        place = LPS @ np.array(found.TransformIndexToPhysicalPoint(index))
        expected = LPS @ TURN @ (SLOPE @ rest_of(place, center) + VECTOR)
        worst = np.max(np.abs(np.array(found.GetPixel(index)) - expected))
        if not worst < 2e-5:
            sys.exit(f"vector at {index}: differs by {worst}")
    print(f"  vectors read by SimpleITK: {len(inner)} voxels")


def check_displacement(files, center):
    """Either export of the displacement gives SimpleITK the same transform."""
    files("warp", "in.vtkhdf", "mesh.vtkhdf", "-o", "field.vtkhdf", "--outputs", "displacement")
    for axes in (), ("--axes", "lps"), ("--axes", "ras"):
        files("export", "field.vtkhdf", "--array", "tetwarp_displacement", "-o", "field.nii", *axes)
        image = sitk.ReadImage(files.path("field.nii"), sitk.sitkVectorFloat64)
        place = np.array(image.TransformIndexToPhysicalPoint((4, 4, 3)))
        moved = sitk.DisplacementFieldTransform(image).TransformPoint(place.tolist())
        expected = LPS @ rest_of(LPS @ place, center)
        expect(f"displacement {' '.join(axes) or 'as by default'}", moved, expected, 1e-4)


UNITS = {"mm": 1.0, "micron": 1e-3, "meter": 1e3}  # in ITK's millimeters


def orientations():
    """All 48: axes of the image along those of the world in any order and direction."""
    for order in itertools.permutations(range(3)):
        for signs in itertools.product((1.0, -1.0), repeat=3):
            matrix = np.zeros((3, 3))
            matrix[order, range(3)] = signs
            yield matrix @ np.diag([1.5, 2.0, 2.5])


def field_cases(every):
    """Affine map, unit, dims and whether the header has a form."""
    for n, matrix in enumerate(itertools.islice(orientations(), 0, None, every)):
        yield matrix, np.array([12.0, -34, 56]), list(UNITS)[n % 3], DIMS, True
    for unit in UNITS:
        yield np.diag([1.5, 2.0, 2.5]), np.zeros(3), unit, DIMS, False
        for has_form in True, False:
            yield np.diag([1.5, 2.0, 2.5]), np.zeros(3), unit, (9, 8, 1), has_form
        yield np.diag([-1.5, 2.0, 2.5]), np.array([1.0, 2, 3]), unit, (9, 8), True


def remove_facts(path):
    """Leaves a volume whose positions have no unit."""
    with h5py.File(path, "r+") as file:
        for array in file["VTKHDF/PointData"].values():
            for name in [name for name in array.attrs if name.startswith("tetwarp_nifti_")]:
                del array.attrs[name]


def check_fields(files, every):
    """ITK applies displacement fields in millimeters, along the axes in which it places the image:
    LPS, but where the header has no form, the header's own."""
    worst = 0.0
    for matrix, origin, unit, dims, has_form in field_cases(every):
        affine = np.eye(4)
        affine[:3, :3], affine[:3, 3] = matrix, origin
        image = nibabel.Nifti1Image(np.ones(dims, np.float32), affine)
        image.set_sform(affine, code=int(has_form))
        image.set_qform(affine, code=int(has_form))
        image.header.set_xyzt_units(unit)
        nibabel.save(image, files.path("head.nii"))
        index = np.array([4, 4, 3 if len(dims) == 3 and dims[2] > 1 else 0])
        center = origin + matrix @ index + [0.3, -0.2, 0]
        write_box(files.path("mesh.vtkhdf"), center)
        to_itk = UNITS[unit] * (LPS if has_form else np.eye(3))
        is_flat = index[2] == 0
        files("warp", "head.nii", "mesh.vtkhdf", "-o", "out.nii", "--outputs",
              "displacement,forward", "--quiet")
        names = ["out_displacement.nii", "out_forward.nii"]
        if not is_flat:
            files("import", "head.nii", "-o", "head.vtkhdf")
            files("warp", "head.vtkhdf", "mesh.vtkhdf", "-o", "out.vtkhdf", "--outputs",
                  "displacement", "--quiet")
            files("export", "out.vtkhdf", "--array", "tetwarp_displacement", "-o", "exported.nii")
            files("warp", "head.nii", "mesh.vtkhdf", "-o", "out.mha", "--outputs", "displacement")
            remove_facts(files.path("head.vtkhdf"))
            files("warp", "head.vtkhdf", "mesh.vtkhdf", "-o", "bare.nii", "--outputs",
                  "displacement", "--like", "head.nii")
            files("compose", "mesh.vtkhdf", "-o", "composed.nii", "--like", "head.nii")
            names += ["exported.nii", "out_displacement.mha", "bare_displacement.nii",
                      "composed.nii"]
        for name in names:
            read = sitk.ReadImage(files.path(name), sitk.sitkVectorFloat64)
            axes = read.GetDimension()
            expect_equal("axes of the field", axes, 2 if is_flat else 3)
            place = np.array(read.TransformIndexToPhysicalPoint(index[:axes].tolist()))
            moved = sitk.DisplacementFieldTransform(read).TransformPoint(place.tolist())
            world = matrix @ index + origin
            rest = rest_of(world, center)
            if name == "out_forward.nii":
                rest = (world - center) @ TURN.T + center
            error = np.abs(np.array(moved) - (to_itk @ rest)[:axes]).max() / UNITS[unit]
            worst = max(worst, error)
            if not error < 1e-4:
                sys.exit(f"{name}: {matrix.tolist()} {unit} {dims} form {has_form}: {error}")
    print(f"fields for ITK, worst: {worst:.1e} units")


def check_tensors(files, affine, center, axes):
    """nibabel writes and reads tensors in NIfTI's order, along RAS or LPS."""
    turn = LPS if axes == "lps" else np.eye(3)
    points = points_of(affine)
    scale = 1 + (points - center) @ GROWTH
    stored = scale[..., None] * (turn @ TENSOR @ turn)[NIFTI_ROWS, NIFTI_COLUMNS]
    image = nibabel.Nifti1Image(stored[:, :, :, None, :].astype(np.float32), None)
    image.set_sform(affine, code=4)
    image.set_qform(None, code=0)
    image.header["intent_code"], image.header["intent_p1"] = 1005, 3
    image.header["descrip"] = b"three eigenvalues"
    image.header.set_xyzt_units("mm", "sec")
    nibabel.save(image, files.path("tensors.nii"))

    files.warp("tensors.nii", "--tensors", "values", axes=("--axes", axes))

    found = nibabel.load(files.path("out.nii"))
    rest_scale = 1 + (rest_of(points_of(found.affine), center) - center) @ GROWTH
    tensor = turn @ TURN @ TENSOR @ TURN.T @ turn
    expected = rest_scale[..., None] * tensor[NIFTI_ROWS, NIFTI_COLUMNS]
    inner = (slice(3, 6), slice(3, 5), slice(2, 5))
    samples = np.asarray(found.dataobj)[:, :, :, 0, :]
    expect(f"tensors along {axes} read by nibabel", samples[inner], expected[inner], 2e-5)
    expect("affine map", found.affine, affine, 1e-5)
    for name in "sform_code", "qform_code", "intent_code", "intent_p1", "xyzt_units", "descrip":
        expect_equal(name, found.header[name], image.header[name])


def main(command, every=1):
    with tempfile.TemporaryDirectory() as folder:
        files = Files(command, folder)
        for name, affine in affines():
            print(name)
            center = (affine @ np.append((np.array(DIMS) - 1) / 2, 1))[:3]
            write_box(files.path("mesh.vtkhdf"), center)
            for axes in "ras", "lps":
                check_tensors(files, affine, center, axes)
            if name == "sheared":  # ITK reads and writes no shear
                continue
            check_vectors(files, affine, center)
            check_displacement(files, center)
        check_fields(files, every)


if __name__ == "__main__":
    if len(sys.argv) not in (2, 3):
        sys.exit(__doc__)
    main(sys.argv[1], *map(int, sys.argv[2:]))
