"""Compares warps by displacement fields and transforms with NumPy, SimpleITK, fslpy and nitransforms.

Usage: check_transforms.py COMMAND [EVERY]

Images and fields of all 48 orientations (of every EVERYth of them) are written here byte by byte,
one physical displacement in each convention that fields have, and the warped image is computed from
the definition. Affine transforms are written as ITK's text and MATLAB files; their matrices are
computed here. B-splines, fields and composites are written as text, and as HDF5 where SimpleITK is
installed, warp fields of FSL as NIfTI. Where SimpleITK, fslpy and nitransforms are installed, their
results are compared, too. Exits 77 when NumPy is missing, 1 when a value differs.
"""
import itertools
import os
import struct
import subprocess
import sys
import tempfile

try:
    import numpy as np
except ImportError as error:
    print(f"skipped: {error}; install NumPy")
    sys.exit(77)
try:
    import SimpleITK as sitk
except ImportError:
    sitk = None
    print("SimpleITK is not installed: its results are not compared")

try:
    from fsl.data.image import Image as FslImage
    from fsl.transform import fnirt as fsl_fnirt
except ImportError:
    fsl_fnirt = None
    print("fslpy is not installed: its results are not compared")

try:
    import nitransforms
except ImportError:
    nitransforms = None
    print("nitransforms is not installed: its results are not compared")

LPS = np.diag([-1.0, -1.0, 1.0])  # from RAS to LPS and back
DIMS = (9, 8, 7)
DISPVECT, VECTOR = 1006, 1007


def write_nifti(path, samples, affine, intent=0, name="", parameter=0.0, unit=2, form=1, steps=False):
    """A file of float32 [i][j][k] or [i][j][k][c]; affine from voxel to RAS; c along the axis of time
    or of components."""
    samples = np.asarray(samples, np.float32)
    dims = samples.shape[:3]
    components = samples.shape[3] if samples.ndim == 4 else 0
    header = bytearray(352)
    dim = [5, *dims, 1, components, 1, 1] if components else [3, *dims, 1, 1, 1, 1]
    if steps:
        dim = [4, *dims, components, 1, 1, 1]
    struct.pack_into("<i", header, 0, 348)
    struct.pack_into("<8h", header, 40, *dim)
    struct.pack_into("<3f", header, 56, parameter, 0, 0)
    struct.pack_into("<hhh", header, 68, intent, 16, 32)
    spacing = np.linalg.norm(affine[:3, :3], axis=0)
    struct.pack_into("<8f", header, 76, 1, *spacing, 1, 1, 1, 1)
    struct.pack_into("<f", header, 108, 352)
    struct.pack_into("<B", header, 123, unit)
    struct.pack_into("<hh", header, 252, 0, form)
    struct.pack_into("<12f", header, 280, *affine[:3].ravel())
    struct.pack_into("<16s", header, 328, name.encode())
    struct.pack_into("<4s", header, 344, b"n+1\0")
    with open(path, "wb") as file:
        file.write(header)
        file.write(samples.tobytes(order="F"))


def read_nifti(path):
    """Samples of a file of float32 that the command wrote."""
    with open(path, "rb") as file:
        data = file.read()
    dim = struct.unpack_from("<8h", data, 40)
    assert struct.unpack_from("<h", data, 70)[0] == 16, "expected float32"
    shape = dim[1 : dim[0] + 1]
    offset = int(struct.unpack_from("<f", data, 108)[0])
    return np.frombuffer(data, "<f4", offset=offset).reshape(shape, order="F")


def points_of(dims, affine):
    index = np.stack(np.meshgrid(*[np.arange(n) for n in dims], indexing="ij"), axis=-1)
    return index @ affine[:3, :3].T + affine[:3, 3]


def sampled(samples, affine, points, beyond):
    """Linear between centers, constant for the last half voxel, `beyond` farther out."""
    index = (points - affine[:3, 3]) @ np.linalg.inv(affine[:3, :3]).T
    last = np.array(samples.shape[:3]) - 1
    inside = np.all((index >= -0.5 - 1e-6) & (index <= last + 0.5 + 1e-6), axis=-1)
    index = np.clip(index, 0, last)
    lower = np.minimum(np.floor(index).astype(int), np.maximum(last - 1, 0))
    fraction = index - lower
    result = np.zeros(points.shape[:-1] + samples.shape[3:])
    for corner in itertools.product((0, 1), repeat=3):
        place = np.minimum(lower + corner, last)
        weight = np.prod(np.where(corner, fraction, 1 - fraction), axis=-1)
        values = samples[place[..., 0], place[..., 1], place[..., 2]].astype(float)
        result += values * weight.reshape(weight.shape + (1,) * (samples.ndim - 3))
    inside = inside.reshape(inside.shape + (1,) * (samples.ndim - 3))
    return np.where(inside, result, beyond)


def orientations():
    """From voxel to RAS: every order of the axes and every sign."""
    for order in itertools.permutations(range(3)):
        for signs in itertools.product((1, -1), repeat=3):
            affine = np.eye(4)
            for axis in range(3):
                affine[:3, axis] = 0
                affine[order[axis], axis] = signs[axis] * (1.5, 2.0, 2.5)[axis]
            affine[:3, 3] = (12, -34, 56)
            yield affine


def arguments(usage):
    """The command, and of which orientations every nth is taken; ends where there are other words."""
    if len(sys.argv) not in (2, 3):
        sys.exit(usage)
    return sys.argv[1], int(sys.argv[2]) if len(sys.argv) == 3 else 1


def displacement(points):
    """Along RAS."""
    x, y, z = np.moveaxis(points - (12, -34, 56), -1, 0)
    return np.stack([1.03 + np.sin(y / 5), 0.8 * np.cos(z / 4 + x / 9), 1.2 * np.sin(x / 6)], axis=-1)


class Command:
    def __init__(self, command, folder):
        self.command, self.folder = os.path.abspath(command), folder

    def __call__(self, *words):
        result = subprocess.run([self.command, *words], cwd=self.folder, capture_output=True,
                                text=True, check=False)
        if result.returncode != 0:
            sys.exit(f"tetwarp {' '.join(words)}: {result.stderr}")
        return result.stdout

    def refused(self, *words, may_succeed=False):
        result = subprocess.run([self.command, *words], cwd=self.folder, capture_output=True,
                                text=True, check=False)
        if may_succeed and result.returncode == 0:
            return ""
        if result.returncode == 0 or result.stderr.count("\n") != 1:
            sys.exit(f"tetwarp {' '.join(words)}: expected one line, got {result.stderr!r}")
        return result.stderr

    def path(self, name):
        return os.path.join(self.folder, name)


worst_of = {}


def expect(what, found, expected, tolerance):
    if np.shape(found) != np.shape(expected):
        sys.exit(f"{what}: shape {np.shape(found)}, expected {np.shape(expected)}")
    worst = float(np.max(np.abs(np.asarray(found, float) - expected)))
    worst_of[what] = max(worst_of.get(what, 0), worst)
    if not worst <= tolerance:
        sys.exit(f"{what}: differs by {worst}, expected at most {tolerance}")


def check_orientation(run, image, affine, coarse):
    """One displacement in every convention, on the image's grid and on a coarser one."""
    write_nifti(run.path("image.nii"), image, affine)
    for name, grid, dims in ("same", affine, DIMS), ("coarse", coarse, (6, 5, 5)):
        points = points_of(dims, grid)
        vectors = displacement(points).astype(np.float32)
        kinds = {
            "VECTOR": (vectors @ LPS, dict(intent=VECTOR)),
            "DISPVECT": (vectors, dict(intent=DISPVECT)),
            "NREG_TRANS displacement": (vectors, dict(intent=VECTOR, name="NREG_TRANS",
                                                      parameter=1)),
            "NREG_TRANS positions": (vectors + points, dict(intent=VECTOR, name="NREG_TRANS")),
        }
        x = points_of(DIMS, affine)
        field = vectors if name == "same" else sampled(vectors, grid, x, 0)
        expected = sampled(image, affine, x + field, -1)
        for kind, (numbers, words) in kinds.items():
            write_nifti(run.path("field.nii"), numbers, grid, **words)
            run("warp", "image.nii", "field.nii", "-o", "out.nii", "--background", "-1")
            expect(f"{kind}, {name} grid", read_nifti(run.path("out.nii")), expected, 2e-4)
        if sitk:
            write_nifti(run.path("field.nii"), vectors @ LPS, grid, intent=VECTOR)
            run("warp", "image.nii", "field.nii", "-o", "out.nii", "--background", "-1")
            source = sitk.ReadImage(run.path("image.nii"), sitk.sitkFloat64)
            by_itk = sitk.Resample(source, sitk.DisplacementFieldTransform(
                sitk.ReadImage(run.path("field.nii"), sitk.sitkVectorFloat64)),
                sitk.sitkLinear, -1.0)
            expect(f"SimpleITK, {name} grid", read_nifti(run.path("out.nii")),
                   np.swapaxes(sitk.GetArrayFromImage(by_itk), 0, 2), 2e-4)


def check_units(run, image, affine):
    """Displacements of intent VECTOR are in mm whatever the unit of the header."""
    vectors = displacement(points_of(DIMS, affine)).astype(np.float32)
    expected = sampled(image, affine, points_of(DIMS, affine) + vectors, 0)
    for unit, millimeters in (1, 1000), (3, 0.001):
        scaled = affine.copy()
        scaled[:3] /= millimeters
        write_nifti(run.path("image.nii"), image, scaled, unit=unit)
        write_nifti(run.path("field.nii"), vectors @ LPS, scaled, intent=VECTOR, unit=unit)
        run("warp", "image.nii", "field.nii", "-o", "out.nii")
        expect(f"unit {unit}", read_nifti(run.path("out.nii")), expected, 1e-3)


def rotation(axis, angle):
    c, s = np.cos(angle), np.sin(angle)
    turn = np.eye(3)
    i, j = (axis + 1) % 3, (axis + 2) % 3
    turn[i, i], turn[i, j], turn[j, i], turn[j, j] = c, -s, s, c
    return turn


def versor(axis, angle):
    return np.sin(angle / 2) * np.asarray(axis) / np.linalg.norm(axis)


def about(axis, angle):
    """Rodrigues' formula."""
    x, y, z = np.asarray(axis) / np.linalg.norm(axis)
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross


CENTER = np.array([-10.37, 30.11, 60.73])  # no position falls on the rim of a source
MOVE = np.array([1.513, -2.027, 0.711])
TURN = np.array([1.0, 2.0, -0.5])


def transforms():
    """Type, parameters, fixed parameters, matrix and translation about the center, in LPS."""
    matrix = np.array([[1.1, 0.1, -0.2], [0.05, 0.9, 0.1], [0.1, -0.1, 1.05]])
    x, y, z = rotation(0, 0.2), rotation(1, -0.3), rotation(2, 0.4)
    yield "AffineTransform", [*matrix.ravel(), *MOVE], CENTER, matrix, MOVE
    yield "MatrixOffsetTransformBase", [*matrix.ravel(), *MOVE], CENTER, matrix, MOVE
    yield "TranslationTransform", MOVE, [], np.eye(3), MOVE
    yield "Euler3DTransform", [0.2, -0.3, 0.4, *MOVE], [*CENTER, 0], z @ x @ y, MOVE
    yield "Euler3DTransform", [0.2, -0.3, 0.4, *MOVE], [*CENTER, 1], z @ y @ x, MOVE
    yield "VersorRigid3DTransform", [*versor(TURN, 0.5), *MOVE], CENTER, about(TURN, 0.5), MOVE
    yield ("Similarity3DTransform", [*versor(TURN, 0.5), *MOVE, 1.2], CENTER,
           1.2 * about(TURN, 0.5), MOVE)
    yield "ScaleTransform", [1.1, 0.9, 1.2], CENTER, np.diag([1.1, 0.9, 1.2]), np.zeros(3)


def text_of(kinds, axes=3):
    lines = ["#Insight Transform File V1.0"]
    for n, (kind, parameters, fixed) in enumerate(kinds):
        lines += [f"#Transform {n}", f"Transform: {kind}_double_{axes}_{axes}"]
        if not kind.startswith("Composite"):
            lines += ["Parameters: " + " ".join(repr(float(p)) for p in parameters),
                      "FixedParameters: " + " ".join(repr(float(f)) for f in fixed)]
    return "\n".join(lines) + "\n"


def matlab_of(kind, parameters, fixed):
    data = b""
    for name, numbers in (f"{kind}_double_3_3", parameters), ("fixed", fixed):
        data += struct.pack("<5i", 0, len(numbers), 1, 0, len(name) + 1) + name.encode() + b"\0"
        data += np.asarray(numbers, "<f8").tobytes()
    return data


def check_affine(run, image, affine):
    write_nifti(run.path("image.nii"), image, affine)
    x = points_of(DIMS, affine) @ LPS
    moved = {}
    for kind, parameters, fixed, matrix, move in transforms():
        center = np.zeros(3) if len(fixed) == 0 else np.asarray(fixed[:3])
        there = (x - center) @ matrix.T + center + move
        expected = sampled(image, affine, there @ LPS, 0)
        moved[kind] = (parameters, fixed, matrix, center, move)
        with open(run.path("a.tfm"), "w", encoding="ascii") as file:
            file.write(text_of([(kind, parameters, fixed)]))
        with open(run.path("a.mat"), "wb") as file:
            file.write(matlab_of(kind, parameters, fixed))
        for name in ("a.tfm", "a.mat"):
            run("warp", "image.nii", name, "-o", "out.nii")
            expect(f"{kind} in {name}", read_nifti(run.path("out.nii")), expected, 2e-4)
        if sitk and not kind.startswith("Matrix"):
            by_itk = sitk.Resample(sitk.ReadImage(run.path("image.nii"), sitk.sitkFloat64),
                                   sitk.ReadTransform(run.path("a.tfm")), sitk.sitkLinear, 0.0)
            expect(f"{kind} by SimpleITK", read_nifti(run.path("out.nii")),
                   np.swapaxes(sitk.GetArrayFromImage(by_itk), 0, 2), 2e-4)
    # A composite applies its last transform first.
    chain = ["ScaleTransform", "AffineTransform"]
    there = x
    for kind in reversed(chain):
        _, _, matrix, center, move = moved[kind]
        there = (there - center) @ matrix.T + center + move
    with open(run.path("c.tfm"), "w", encoding="ascii") as file:
        file.write(text_of([("CompositeTransform", [], []),
                            *[(kind, *moved[kind][:2]) for kind in chain]]))
    run("warp", "image.nii", "c.tfm", "-o", "out.nii")
    expect("composite", read_nifti(run.path("out.nii")), sampled(image, affine, there @ LPS, 0), 2e-4)


def grid_in_lps(affine, dims):
    """Fixed parameters of a grid: size, origin, spacing, direction."""
    matrix = LPS @ affine[:3, :3]
    spacing = np.linalg.norm(matrix, axis=0)
    return [*dims, *(LPS @ affine[:3, 3]), *spacing, *(matrix / spacing).ravel()]


def basis(x):
    t = np.abs(x)
    return np.where(t < 1, 2 / 3 - t * t + t**3 / 2, np.where(t < 2, (2 - t) ** 3 / 6, 0))


def splined(coefficients, affine, points):
    """The definition of ITK: zero where not all 64 coefficients are there."""
    index = (points - affine[:3, 3]) @ np.linalg.inv(affine[:3, :3]).T
    dims = np.array(coefficients.shape[:3])
    weights = [basis(index[..., axis, None] - np.arange(dims[axis])) for axis in range(3)]
    vectors = np.einsum("...a,...b,...c,abcv->...v", *weights, coefficients)
    inside = np.all((index >= 1 - 1e-9) & (index <= dims - 2 + 1e-9), axis=-1)
    return np.where(inside[..., None], vectors, 0)


def check_splines(run, image, affine, random, is_short):
    """A composite of a spline, a field and affine transforms; without `is_short` also its parts."""
    write_nifti(run.path("image.nii"), image, affine)
    x = points_of(DIMS, affine)
    knots = affine.copy()
    knots[:3, :3] = affine[:3, :3] @ np.diag([2.11, 1.87, 2.03])
    knots[:3, 3] += affine[:3, :3] @ (-2.6, -2.3, -2.7)
    size = (7, 8, 6)
    coefficients = random.uniform(-2, 2, size + (3,))  # along LPS
    # x, y, z one after the other, each with the first index fastest
    parameters = np.concatenate([coefficients[..., a].ravel(order="F") for a in range(3)])
    spline = ("BSplineTransform", parameters, grid_in_lps(knots, size))
    coarse = affine.copy()
    coarse[:3, :3] *= 1.4
    vectors = random.uniform(-2, 2, DIMS + (3,))  # along LPS
    interleaved = np.transpose(vectors, (2, 1, 0, 3)).ravel()
    field = ("DisplacementFieldTransform", interleaved, grid_in_lps(coarse, DIMS))
    matrix = np.array([[1.05, 0.1, -0.1], [0.05, 0.95, 0.1], [0.1, -0.1, 1.02]])
    affine_kind = ("AffineTransform", [*matrix.ravel(), *MOVE], CENTER)
    steps = {
        spline[0]: lambda p: p + splined(coefficients @ LPS, knots, p),
        field[0]: lambda p: p + sampled((vectors @ LPS).astype(np.float32), coarse, p, 0),
        affine_kind[0]: lambda p: ((p @ LPS - CENTER) @ matrix.T + CENTER + MOVE) @ LPS,
    }
    chains = [[spline], [field], [spline, affine_kind], [affine_kind, field, spline, affine_kind]]
    for chain in chains[-1:] if is_short else chains:
        with open(run.path("b.tfm"), "w", encoding="ascii") as file:
            file.write(text_of(([("CompositeTransform", [], [])] if len(chain) > 1 else []) + chain))
        there = x
        for kind, _, _ in reversed(chain):  # a composite applies its last transform first
            there = steps[kind](there)
        name = " ".join(kind for kind, _, _ in chain)
        expected = sampled(image, affine, there, 0)
        run("warp", "image.nii", "b.tfm", "-o", "out.nii")
        expect_but_rims(f"{name} as text", read_nifti(run.path("out.nii")), expected)
        if not is_short:
            run("compose", "b.tfm", "-o", "joined.nii", "--like", "image.nii")
            joined = read_nifti(run.path("joined.nii"))[:, :, :, 0] @ LPS
            expect_but_rims(f"compose {name}", joined, there - x)
        if not sitk:
            continue
        transform = sitk.ReadTransform(run.path("b.tfm"))
        sitk.WriteTransform(transform, run.path("b.h5"))
        run("warp", "image.nii", "b.h5", "-o", "out.nii")
        expect_but_rims(f"{name} as HDF5", read_nifti(run.path("out.nii")), expected)
        by_itk = sitk.Resample(sitk.ReadImage(run.path("image.nii"), sitk.sitkFloat64), transform,
                               sitk.sitkLinear, 0.0)
        expect_but_rims(f"{name} by SimpleITK", read_nifti(run.path("out.nii")),
                        np.swapaxes(sitk.GetArrayFromImage(by_itk), 0, 2))


def expect_but_rims(what, found, expected):
    """Positions within rounding of a rim may fall on either side of it: at most one voxel in 200."""
    near = np.isclose(found, expected, rtol=0, atol=5e-4)
    if np.mean(near) < 0.995:
        sys.exit(f"{what}: {np.sum(~near)} of {near.size} differ")
    expect(what, np.where(near, found, 0), np.where(near, expected, 0), 5e-4)


def fsl_points(dims, affine, index):
    """FSL's coordinates: scaled indices, the first one from the other end if right-handed."""
    spacing = np.linalg.norm(affine[:3, :3], axis=0)
    x = index.astype(float).copy()
    if np.linalg.det(affine[:3, :3]) > 0:
        x[..., 0] = dims[0] - 1 - x[..., 0]
    return x * spacing


def check_fsl(run, image, affine, random, is_short):
    """A field that takes voxels of a reference to those of an image on another grid."""
    source = affine.copy()
    source[:3, :3] = affine[:3, :3] @ np.diag([1, -1, 1]) * 0.9  # of the other handedness
    source[:3, 3] += 3
    write_nifti(run.path("image.nii"), image, source)
    dims = (8, 7, 6)
    index = np.stack(np.meshgrid(*[np.arange(n) for n in dims], indexing="ij"), axis=-1)
    write_nifti(run.path("like.nii"), np.zeros(dims), affine)
    start = fsl_points(dims, affine, index)
    relative = random.uniform(-1.5, 1.5, dims + (3,)).astype(np.float32)
    there = start + relative  # in FSL's coordinates of the image
    spacing = np.linalg.norm(source[:3, :3], axis=0)
    voxel = there / spacing
    if np.linalg.det(source[:3, :3]) > 0:
        voxel[..., 0] = DIMS[0] - 1 - voxel[..., 0]
    expected = sampled(image, source, voxel @ source[:3, :3].T + source[:3, 3], 0)
    for kind, numbers in ("relative", relative), ("absolute", there):
        write_nifti(run.path("warp.nii"), numbers, affine, intent=2006, steps=True)
        for words in [[]] if is_short else [[], ["--fsl", kind]]:
            run("warp", "image.nii", "warp.nii", "-o", "out.nii", "--like", "like.nii", *words)
            expect_but_rims(f"FSL, {kind}", read_nifti(run.path("out.nii")), expected)
        if not is_short:
            write_nifti(run.path("warp.nii"), numbers, affine, intent=0, steps=True)
            run("warp", "image.nii", "warp.nii", "-o", "out.nii", "--like", "like.nii", "--fsl", kind)
            expect_but_rims(f"FSL, {kind}, as said", read_nifti(run.path("out.nii")), expected)
        if not fsl_fnirt:
            continue
        write_nifti(run.path("warp.nii"), numbers, affine, intent=2006, steps=True)
        moved = fsl_fnirt.readFnirt(run.path("warp.nii"), FslImage(run.path("image.nii")),
                                    FslImage(run.path("like.nii")), defType=kind)
        world = index @ affine[:3, :3].T + affine[:3, 3]
        found = moved.transform(world.reshape(-1, 3), "world", "world").reshape(dims + (3,))
        expect_but_rims(f"FSL, {kind}, by fslpy", read_nifti(run.path("out.nii")),
                        sampled(image, source, found, 0))


def check_fsl_refusals(run, affine, random):
    write_nifti(run.path("image.nii"), np.zeros(DIMS), affine)
    for numbers, intent, word in (
            (np.zeros(DIMS + (3,)), 2007, "fnirtfileutils"),
            (np.zeros(DIMS + (2,)), 2006, "three volumes"),
            (fsl_points(DIMS, affine, np.stack(np.meshgrid(*[np.arange(n) for n in DIMS],
                                               indexing="ij"), axis=-1)) * 0.5, 2006,
             "state --fsl relative")):
        write_nifti(run.path("warp.nii"), numbers, affine, intent=intent, steps=True)
        line = run.refused("warp", "image.nii", "warp.nii", "-o", "out.nii")
        assert word in line, line
    write_nifti(run.path("warp.nii"), np.zeros(DIMS + (3,)), affine, intent=2006, steps=True)
    line = run.refused("compose", "warp.nii", "-o", "out.nii", "--like", "image.nii")
    assert "leads to voxels of the image" in line, line


def check_compose(run, image, affine):
    """An image warped by A, then by B: sampled at A(B(x))."""
    write_nifti(run.path("image.nii"), image, affine)
    kind, parameters, fixed, matrix, move = next(transforms())
    with open(run.path("a.tfm"), "w", encoding="ascii") as file:
        file.write(text_of([(kind, parameters, fixed)]))
    x = points_of(DIMS, affine)
    vectors = displacement(x).astype(np.float32)
    write_nifti(run.path("field.nii"), vectors, affine, intent=DISPVECT)

    def by_affine(points):
        return ((points @ LPS - CENTER) @ matrix.T + CENTER + move) @ LPS

    def by_inverse(points):
        return ((points @ LPS - CENTER - move) @ np.linalg.inv(matrix).T + CENTER) @ LPS

    def by_field(points):
        return points + sampled(vectors, affine, points, 0)

    for words, expected in {
        ("field.nii", "a.tfm"): by_field(by_affine(x)),
        ("a.tfm", "field.nii"): by_affine(by_field(x)),
        ("a.tfm^-1", "field.nii"): by_inverse(by_field(x)),
    }.items():
        run("compose", *words, "-o", "joined.nii", "--like", "image.nii")
        field = read_nifti(run.path("joined.nii"))[:, :, :, 0] @ LPS
        expect(f"compose {' '.join(words)}", field, expected - x, 2e-5)
    run("compose", "field.nii^-1", "field.nii", "-o", "joined.nii", "--like", "image.nii")
    field = read_nifti(run.path("joined.nii"))[:, :, :, 0]
    inner = by_field(x)
    index = (inner - affine[:3, 3]) @ np.linalg.inv(affine[:3, :3]).T
    near = np.all((index > 1) & (index < np.array(DIMS) - 2), axis=-1)
    expect("inverse of a field", field[near], np.zeros_like(field[near]), 1e-4)


def check_nitransforms(run, image, affine):
    """Where nitransforms takes voxels by a field of ITK, an affine map, and both from HDF5."""
    write_nifti(run.path("image.nii"), image, affine)
    x = points_of(DIMS, affine)
    flat = x.reshape(-1, 3)
    vectors = displacement(x).astype(np.float32) @ LPS
    write_nifti(run.path("field.nii"), vectors, affine, intent=VECTOR)
    kind, parameters, fixed, _, _ = next(transforms())
    interleaved = np.transpose(vectors, (2, 1, 0, 3)).ravel()
    field = ("DisplacementFieldTransform", interleaved, grid_in_lps(affine, DIMS))
    for name, kinds in (("a.tfm", [(kind, parameters, fixed)]),
                        ("b.tfm", [("CompositeTransform", [], []), (kind, parameters, fixed), field])):
        with open(run.path(name), "w", encoding="ascii") as file:
            file.write(text_of(kinds))
    linear = nitransforms.io.itk.ITKLinearTransform.from_filename(run.path("a.tfm"))
    wanted = {"field.nii": nitransforms.nonlinear.DenseFieldTransform.from_filename(
                  run.path("field.nii"), fmt="itk"),
              "a.tfm": nitransforms.linear.Affine(linear.to_ras())}
    if sitk:
        sitk.WriteTransform(sitk.ReadTransform(run.path("b.tfm")), run.path("b.h5"))
        wanted["b.h5"] = nitransforms.manip.TransformChain.from_filename(run.path("b.h5"), fmt="itk")
    for name, transform in wanted.items():
        run("compose", name, "-o", "joined.nii", "--like", "image.nii")
        moved = x + read_nifti(run.path("joined.nii"))[:, :, :, 0] @ LPS
        expect(f"{name} by nitransforms", moved, transform.map(flat).reshape(x.shape), 1e-4)


def check_refusals(run, image, affine):
    write_nifti(run.path("image.nii"), image, affine)
    vectors = displacement(points_of(DIMS, affine))
    write_nifti(run.path("field.nii"), vectors, affine)
    line = run.refused("warp", "image.nii", "field.nii", "-o", "out.nii")
    assert "state --axes lps" in line, line
    run("warp", "image.nii", "field.nii", "-o", "out.nii", "--axes", "ras")
    expected = sampled(image, affine, points_of(DIMS, affine) + vectors, 0)
    expect("--axes ras", read_nifti(run.path("out.nii")), expected, 2e-4)
    for text, word in {
        "1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n": "does not tell its axes",
        text_of([("BSplineTransform", [0], [0])]): "expected 18 fixed parameters",
        text_of([("BSplineTransform", [0], grid_in_lps(affine, (4, 4, 4)))]): "expected 192 parameters",
        text_of([("BSplineTransform", [0] * 24, grid_in_lps(affine, (2, 2, 2)))]): "fewer than 4",
        text_of([("DisplacementFieldTransform", [0], grid_in_lps(affine, (1e9, 2, 2.5)))]): "a size of",
        text_of([("ThinPlateSplineKernelTransform", [0], [0])]): "is no transform that is read",
        text_of([("AffineTransform", [1, 2], [])]): "expected 12 parameters",
        text_of([("ScaleTransform", [1, 1, 1], [])] * 2): "write a composite",
        "#Insight Transform File V1.0\nTransform: AffineTransform_double_3_3\nParameters: 1 x\n":
            "Transform 0: Parameters[1]: 'x' is no number",
        text_of([("CompositeTransform", [], []), ("ScaleTransform", [1, np.nan, 1], [])]):
            "Transform 1: Parameters[1]: is not a number",
        text_of([("ScaleTransform", [1, 1, 1], [0, 0, -np.inf])]):
            "Transform 0: FixedParameters[2]: is infinite",
        "#Insight Transform File V1.0\n": "holds no transform",
    }.items():
        with open(run.path("bad.tfm"), "w", encoding="ascii") as file:
            file.write(text)
        line = run.refused("warp", "image.nii", "bad.tfm", "-o", "out.nii")
        assert word in line, line
    for data in b"", b"\0" * 7, struct.pack("<5i", 0, 999, 999, 0, 4) + b"abc\0":
        with open(run.path("bad.mat"), "wb") as file:
            file.write(data)
        run.refused("warp", "image.nii", "bad.mat", "-o", "out.nii")
    with open(run.path("bad.mat"), "wb") as file:
        for name, numbers in ("ScaleTransform_double_3_3", [1, 1, 1]), ("fixed", [0, np.nan, 0]):
            file.write(struct.pack("<5i", 0, 3, 1, 0, len(name) + 1) + name.encode() + b"\0")
            file.write(np.array(numbers, float).tobytes())
    line = run.refused("warp", "image.nii", "bad.mat", "-o", "out.nii")
    assert "fixed[1]: is not a number" in line, line
    line = run.refused("warp", "image.nii", "field.nii", "-o", "out.nii", "--axes", "ras",
                       "--temporal")
    assert "--temporal is for warps by a mesh" in line, line


def main():
    command, every = arguments(__doc__)
    random = np.random.default_rng(7)
    image = random.uniform(0, 100, DIMS).astype(np.float32)
    with tempfile.TemporaryDirectory() as folder:
        run = Command(command, folder)
        for n, affine in enumerate(itertools.islice(orientations(), 0, None, every)):
            coarse = affine.copy()
            coarse[:3, :3] *= 1.3
            coarse[:3, 3] += affine[:3, :3] @ (0.4, 0.9, -0.3)
            check_orientation(run, image, affine, coarse)
            check_splines(run, image, affine, random, n % 3 > 0)
            check_fsl(run, image, affine, random, n % 3 > 0)
            if nitransforms:
                check_nitransforms(run, image, affine)
        for affine in itertools.islice(orientations(), 0, None, 7 if every > 1 else 1):
            check_affine(run, image, affine)
            check_compose(run, image, affine)
        check_fsl_refusals(run, next(orientations()), random)
        check_units(run, image, next(orientations()))
        check_refusals(run, image, next(orientations()))
    for what, worst in worst_of.items():
        print(f"{what}: {worst:.1e}")


if __name__ == "__main__":
    main()
