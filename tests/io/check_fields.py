"""What files of fields state beside numbers: where they lead, what components are; transforms of two axes.

Usage: check_fields.py COMMAND [EVERY]

Fields and splines that lead from the source to the output (NRRD's `displacement field type`, 3D Slicer's types
of inverse transforms) are joined by `compose`, on images of all 48 orientations (of every EVERYth of them); that
the result inverts them is computed from the definition. Facts that are not read must be refused where they
matter. Transforms and fields of two axes are compared with SimpleITK on images of two axes, where it is installed.
Exits 77 when NumPy is missing, 1 when something differs.
"""
import itertools
import sys
import tempfile

from check_images import write_nrrd
from check_transforms import (DIMS, LPS, MOVE, VECTOR, CENTER, Command, arguments, displacement, expect,
                              expect_but_rims, grid_in_lps, np, orientations, points_of, read_nifti,
                              sampled, sitk, splined, text_of, transforms, worst_of, write_nifti)

TYPE = "displacement field type"


def write_field(path, vectors, affine, *lines, kind="vector"):
    """An NRRD file of vectors along RAS, whose header has more lines."""
    write_nrrd(path, (vectors @ LPS).astype(np.float32), affine)
    with open(path, "rb") as file:
        data = file.read()
    data = data.replace(b"modality:=CT", "\n".join(lines).encode() if lines else b"modality:=CT")
    with open(path, "wb") as file:
        file.write(data.replace(b"kinds: vector", b"kinds: " + kind.encode()))


def write_text(path, *words):
    with open(path, "w", encoding="ascii") as file:
        file.write(text_of(*words))


def read_field(path):
    """Vectors along RAS of a field that the command wrote for ITK."""
    return read_nifti(path)[:, :, :, 0] @ LPS


def inner(points, affine, margin=2):
    """Which points are well within the grid of images."""
    index = (points - affine[:3, 3]) @ np.linalg.inv(affine[:3, :3]).T
    return np.all((index >= margin) & (index <= np.array(DIMS) - 1 - margin), axis=-1)


def check_inverse(run, what, file, affine, forward):
    """compose FILE at y leads to an x with forward(x) = y, warp by FILE samples there, with the bits
    of warp by the composed field; compose FILE^-1 is forward itself.
    """
    y = points_of(DIMS, affine)
    near = inner(y, affine)
    assert np.count_nonzero(near) > 20
    run("compose", file, "-o", "inverse.nii", "--like", "image.nii")
    run("warp", "image.nii", "inverse.nii", "-o", "by_field.nii")
    line = run.refused("warp", "image.nii", file, "-o", "out.nii", "--outside", "background")
    assert "leave out --outside" in line, line
    run("warp", "image.nii", file, "-o", "out.nii")
    assert np.array_equal(read_nifti(run.path("out.nii")), read_nifti(run.path("by_field.nii"))), what
    x = y + read_field(run.path("inverse.nii"))
    expect(f"{what}, inverse", forward(x)[near], y[near], 2e-4)
    run("compose", file + "^-1", "-o", "itself.nii", "--like", "image.nii")
    expect(f"{what}, inverse of the inverse", (y + read_field(run.path("itself.nii")))[near],
           forward(y)[near], 2e-4)


def check_directions(run, image, affine, random):
    write_nifti(run.path("image.nii"), image, affine)
    points = points_of(DIMS, affine)
    vectors = displacement(points).astype(np.float32)
    by_field = lambda x: x + sampled(vectors, affine, x, 0)
    write_field(run.path("modeling.nrrd"), vectors, affine, TYPE + ":=modeling")
    check_inverse(run, "NRRD of modeling", "modeling.nrrd", affine, by_field)

    write_field(run.path("resampling.nrrd"), vectors, affine, TYPE + ":=resampling")
    run("warp", "image.nii", "resampling.nrrd", "-o", "out.nii")
    expect("NRRD of resampling", read_nifti(run.path("out.nii")),
           sampled(image, affine, by_field(points), 0), 2e-4)

    lps = np.transpose(vectors.astype(float) @ LPS, (2, 1, 0, 3)).ravel()
    field = ("InverseDisplacementFieldTransform", lps, grid_in_lps(affine, DIMS))
    write_text(run.path("field.tfm"), [field])
    check_inverse(run, "InverseDisplacementFieldTransform", "field.tfm", affine, by_field)
    _, parameters, fixed, matrix, move = next(transforms())
    write_text(run.path("both.tfm"), [("CompositeTransform", [], []), field,
                                      ("AffineTransform", parameters, fixed)])
    run("compose", "both.tfm", "-o", "both.nii", "--like", "image.nii")
    x = points + read_field(run.path("both.nii"))
    moved = ((points @ LPS - CENTER) @ matrix.T + CENTER + move) @ LPS  # a composite applies its last one first
    near = inner(moved, affine)
    expect("composite with an inverse", by_field(x)[near], moved[near], 2e-4)

    knots = affine.copy()
    knots[:3, :3] = affine[:3, :3] @ np.diag([3.1, 2.9, 3.0])
    knots[:3, 3] += affine[:3, :3] @ (-4.6, -4.3, -4.7)
    coefficients = random.uniform(-1, 1, (7, 7, 7, 3))
    spline = ("InverseBSplineTransform",
              np.concatenate([coefficients[..., a].ravel(order="F") for a in range(3)]),
              grid_in_lps(knots, (7, 7, 7)))
    write_text(run.path("spline.tfm"), [spline])
    check_inverse(run, "InverseBSplineTransform", "spline.tfm", affine,
                  lambda x: x + splined(coefficients @ LPS, knots, x))


def check_written(run, image, affine):
    """The mesh moves by an affine map, so linear fields hold its displacements and their inverse."""
    write_nifti(run.path("image.nii"), image, affine)
    run("mesh", "image.nii", "-o", "mesh.vtkhdf", "--cells", "2")
    run("deform", "mesh.vtkhdf", "-o", "moving.vtkhdf", "--kind", "rotate", "--steps", "1", "--amount", "0.1")
    run("warp", "image.nii", "moving.vtkhdf", "-o", "out.nrrd", "--outputs", "displacement,forward,mask")
    for name, word in ("displacement", b"resampling"), ("forward", b"modeling"), ("mask", None):
        with open(run.path(f"out_{name}.nrrd"), "rb") as file:
            header = file.read().split(b"\n\n")[0]
        assert (word is None) == (TYPE.encode() not in header), header
        assert word is None or b"\n" + TYPE.encode() + b":=" + word in header + b"\n", header
    run("compose", "out_displacement.nrrd", "-o", "by_rest.nii", "--like", "image.nii")
    run("compose", "out_forward.nrrd", "-o", "by_forward.nii", "--like", "image.nii")
    near = inner(points_of(DIMS, affine), affine)
    found, expected = (read_field(run.path(f"by_{name}.nii"))[near] for name in ("forward", "rest"))
    assert np.abs(expected).max() > 0.05
    expect("forward and displacement of a warp", found, expected, 2e-4)


def check_facts(run, image, affine):
    """Facts that are not read are refused where they matter, and only there."""
    write_nifti(run.path("image.nii"), image, affine)
    vectors = displacement(points_of(DIMS, affine)).astype(np.float32)
    unit = "measurement frame: (1,0,0) (0,1,0) (0,0,1)"
    turned = "measurement frame: (0,1,0) (-1,0,0) (0,0,1)"
    ways = itertools.cycle((("warp", "image.nii", "bad.nrrd", "-o", "out.nii"),
                            ("compose", "bad.nrrd", "-o", "out.nii", "--like", "image.nii")))
    for lines, kind, word in (
            ((TYPE + ":=forward",), "vector", "expected resampling or modeling"),
            ((TYPE + ":=",), "vector", "expected resampling or modeling"),
            ((TYPE + ":=modeling", TYPE + ":=resampling"), "vector", "is there twice"),
            ((turned,), "vector", "turns the components"),
            ((), "3-color", "are of kind '3-color'"),
            ((), "covariant-vector", "are of kind 'covariant-vector'"),
            ((), "point", "are of kind 'point'")):
        write_field(run.path("bad.nrrd"), vectors, affine, *lines, kind=kind)
        line = run.refused(*next(ways))
        assert word in line, line
    for lines, kind in ((unit,), "vector"), ((), "list"), ((TYPE + ":= Resampling",), "3-vector"):
        write_field(run.path("good.nrrd"), vectors, affine, *lines, kind=kind)
        run("warp", "image.nii", "good.nrrd", "-o", "out.nii")
    write_field(run.path("bad.nrrd"), vectors, affine, unit)
    with open(run.path("bad.nrrd"), "rb") as file:
        data = file.read().replace(b"left-posterior-superior", b"right-anterior-superior")
    with open(run.path("bad.nrrd"), "wb") as file:
        file.write(data)  # its unit frame is that of RAS
    assert "turns the components" in run.refused(*next(ways))
    run("mesh", "image.nii", "-o", "mesh.vtkhdf", "--cells", "2")
    run("deform", "mesh.vtkhdf", "-o", "moving.vtkhdf", "--steps", "1", "--amount", "0.1")
    warp = lambda name, *words: ("warp", name, "moving.vtkhdf", "-o", "out.nii", *words)
    write_field(run.path("turned.nrrd"), vectors, affine, turned)
    run(*warp("turned.nrrd"))
    assert "turns the components" in run.refused(*warp("turned.nrrd", "--vectors", "values"))
    assert "turns the components" in run.refused(*warp("turned.nrrd", "--axes", "lps"))
    write_nrrd(run.path("a.nrrd"), np.zeros(DIMS + (6,), np.float32), affine)
    with open(run.path("a.nrrd"), "rb") as file:
        data = file.read().replace(b"kinds: vector", b"kinds: 3D-symmetric-matrix")
    with open(run.path("tensors.nrrd"), "wb") as file:
        file.write(data)
    run(*warp("a.nrrd", "--tensors", "values"))
    run(*warp("tensors.nrrd"))
    assert "another order" in run.refused(*warp("tensors.nrrd", "--tensors", "values"))
    write_nifti(run.path("nifty.nii"), vectors, affine, intent=VECTOR, name="NREG_TRANS", parameter=4)
    for words in (), ("--axes", "ras"):
        line = run.refused("warp", "image.nii", "nifty.nii", "-o", "out.nii", *words)
        assert "neither a displacement nor a deformation field" in line, line
    write_nifti(run.path("nifty.nii"), vectors, affine, intent=VECTOR, name="NREG_TRANS")
    line = run.refused("warp", "image.nii", "nifty.nii", "-o", "out.nii", "--axes", "lps")
    assert "leave out --axes lps" in line, line


FLAT = (12, 10)


def flat_transforms(image, random):
    """Transforms of two axes by type, with parameters and fixed parameters, for a grid of SimpleITK's."""
    middle = np.array(image.TransformContinuousIndexToPhysicalPoint([(n - 1) / 2 for n in FLAT])) + 0.31
    move = MOVE[:2]
    matrix = np.array([[1.1, 0.12], [-0.07, 0.93]])
    place = [*image.GetOrigin(), *image.GetSpacing(), *image.GetDirection()]
    yield "TranslationTransform", move, []
    yield "AffineTransform", [*matrix.ravel(), *move], middle
    yield "Euler2DTransform", [0.3, *move], middle
    yield "Similarity2DTransform", [1.1, -0.2, *move], middle
    yield "ScaleTransform", [1.1, 0.9], middle
    yield "DisplacementFieldTransform", random.uniform(-1, 1, 2 * FLAT[0] * FLAT[1]), [*FLAT, *place]
    knots = sitk.BSplineTransformInitializer(image, [4, 3])
    yield "BSplineTransform", random.uniform(-2, 2, len(knots.GetParameters())), knots.GetFixedParameters()


def in_two_axes(path):
    """What the command wrote for an image of two axes."""
    return np.squeeze(read_nifti(path))


def check_flat(run, random, is_short):
    """Images and transforms of all formats; with `is_short` each transform in one of them, on one grid."""
    names = ("flat.nrrd", "flat.mha", "flat.nii")
    pairs = list(itertools.product(names, ("t.tfm", "t.h5")))
    turn = itertools.cycle(pairs)
    for n, (angle, flip) in enumerate(((0.0, 1), (0.4, 1), (-0.7, -1))):
        image = sitk.GetImageFromArray(random.uniform(0, 100, FLAT[::-1]).astype(np.float32))
        c, s = np.cos(angle), np.sin(angle)
        image.SetDirection([c, -s * flip, s, c * flip])
        image.SetSpacing([1.3, 0.8])
        image.SetOrigin([-5.0, 7.0])
        for name in names:
            sitk.WriteImage(image, run.path(name))
        kinds = list(flat_transforms(image, random))
        chain = [kinds[1], kinds[-2], kinds[2]]
        for kind in (kinds + [None])[n :: 3 if is_short else 1]:
            what = kind[0] if kind else "composite of two axes"
            write_text(run.path("t.tfm"), [kind] if kind else [("CompositeTransform", [], [])] + chain, 2)
            transform = sitk.ReadTransform(run.path("t.tfm"))
            sitk.WriteTransform(transform, run.path("t.h5"))
            expected = sitk.GetArrayFromImage(sitk.Resample(image, transform, sitk.sitkLinear, 0.0)).T
            for source, name in itertools.islice(turn, 1 if is_short else len(pairs)):
                run("warp", source, name, "-o", "out.nii")
                expect_but_rims(f"{what} in {name}", in_two_axes(run.path("out.nii")), expected)
        field = sitk.TransformToDisplacementField(
            transform, sitk.sitkVectorFloat32, image.GetSize(),
            image.GetOrigin(), image.GetSpacing(), image.GetDirection())
        by_itk = sitk.Resample(image, sitk.DisplacementFieldTransform(
            sitk.Cast(field, sitk.sitkVectorFloat64)), sitk.sitkLinear, 0.0)
        for source in names[n : n + 1] if is_short else names:
            name = source.replace("flat", "field")
            sitk.WriteImage(field, run.path(name))
            run("warp", source, name, "-o", "out.nii")
            expect_but_rims(f"{name} of two axes", in_two_axes(run.path("out.nii")),
                            sitk.GetArrayFromImage(by_itk).T)


def check_slice(run, random):
    """A slice of a volume: ITK reads its displacements, of two components, as an image of two axes."""
    affine = np.diag([1.5, 2.0, 2.5, 1.0])
    affine[:3, 3] = 3, -4, 50
    image = random.uniform(0, 100, FLAT + (1,)).astype(np.float32)
    write_nifti(run.path("slice.nii"), image, affine)
    run("mesh", "slice.nii", "-o", "mesh.vtkhdf", "--cells", "2")
    run("deform", "mesh.vtkhdf", "-o", "moving.vtkhdf", "--steps", "1", "--amount", "0.2")
    run("warp", "slice.nii", "moving.vtkhdf", "-o", "by_mesh.nii", "--outputs", "displacement",
        "--outside", "identity")
    field = "by_mesh_displacement.nii"
    run("warp", "slice.nii", field, "-o", "out.nii")
    vectors = np.zeros(FLAT + (1, 3))
    vectors[..., :2] = read_nifti(run.path(field))[:, :, :, 0]
    assert np.abs(vectors).max() > 0.1
    x = points_of(FLAT + (1,), affine)
    expect_but_rims("field of a slice", read_nifti(run.path("out.nii")),
                    sampled(image, affine, x + vectors @ LPS, 0))
    if sitk:
        by_itk = sitk.Resample(
            sitk.ReadImage(run.path("slice.nii"), sitk.sitkFloat64)[:, :, 0], sitk.DisplacementFieldTransform(
                sitk.ReadImage(run.path(field), sitk.sitkVectorFloat64)), sitk.sitkLinear, 0.0)
        expect_but_rims("field of a slice by SimpleITK", in_two_axes(run.path("out.nii")),
                        np.squeeze(sitk.GetArrayFromImage(by_itk)).T)
    sagittal = affine[:, [1, 2, 0, 3]]
    write_nifti(run.path("sagittal.nii"), np.zeros(FLAT + (1, 2)), sagittal, intent=VECTOR)
    write_nifti(run.path("thick.nii"), np.zeros(FLAT + (2, 2)), affine, intent=VECTOR)
    assert "two of a single slice" in run.refused("warp", "slice.nii", "sagittal.nii", "-o", "out.nii")
    run.refused("warp", "slice.nii", "thick.nii", "-o", "out.nii")
    for text, word in {
        text_of([("ThinPlateSplineKernelTransform", [0], [0])], 2): "is no transform that is read",
        text_of([("Euler2DTransform", [0, 0], [])], 2): "expected 3 parameters",
        text_of([("AffineTransform", [1, 0, 0, 1, 0, 0], [0, 0, 0])], 2): "expected 2 fixed parameters",
        text_of([("DisplacementFieldTransform", [0] * 7, [2, 2, 0, 0, 1, 1, 1, 0, 0, 1])], 2): "pairs",
        text_of([("DisplacementFieldTransform", [0] * 6, [2, 2, 0, 0, 1, 1, 1, 0, 0, 1])], 2):
            "parameters, three per grid point",
        text_of([("DisplacementFieldTransform", [0] * 8, [2, 2, 0, 0])], 2): "expected 10 fixed parameters",
    }.items():
        with open(run.path("bad.tfm"), "w", encoding="ascii") as file:
            file.write(text)
        line = run.refused("warp", "slice.nii", "bad.tfm", "-o", "out.nii")
        assert word in line, line


def main():
    command, every = arguments(__doc__)
    random = np.random.default_rng(11)
    image = random.uniform(0, 100, DIMS).astype(np.float32)
    with tempfile.TemporaryDirectory() as folder:
        run = Command(command, folder)
        for affine in itertools.islice(orientations(), 0, None, every):
            check_directions(run, image, affine, random)
        for affine in itertools.islice(orientations(), 3, None, 4 * every):
            check_written(run, image, affine)
        check_facts(run, image, next(orientations()))
        check_slice(run, random)
        if sitk:
            check_flat(run, random, every > 1)
    for what, worst in worst_of.items():
        print(f"{what}: {worst:.1e}")


if __name__ == "__main__":
    main()
