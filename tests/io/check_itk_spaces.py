"""Compares transforms and fields on NIfTI images of all units and forms with SimpleITK.

Usage: check_itk_spaces.py COMMAND

Images in no unit, meters, millimeters and micrometers, with a sform, a qform or neither, are warped
by transforms and fields that ITK wrote, also onto the grid of an image of another unit and form,
there by fields along RAS axes, of NiftyReg and of FSL, too, and fields that the command wrote for
them are applied by SimpleITK. Exits 77 when NumPy or SimpleITK is missing, 1 when a value differs.
"""
import struct
import sys
import tempfile

from check_transforms import (DIMS, DISPVECT, VECTOR, Command, arguments, np, sitk, worst_of,
                              write_nifti, expect)

if sitk is None:
    sys.exit(77)
UNITS = {"none": (0, 1.0), "m": (1, 1e3), "mm": (2, 1.0), "um": (3, 1e-3)}  # code, millimeters
FORMS = "sform", "qform", "none"


def affine_of(form, spacing=(1.5, 2.0, 2.5)):
    """Oblique with a sform, with an origin also with a qform."""
    turn, _ = np.linalg.qr(np.array([[1.0, 0.3, -0.2], [-0.25, 1.0, 0.1], [0.15, -0.2, 1.0]]))
    affine = np.eye(4)
    affine[:3, :3] = (turn if form == "sform" else np.eye(3)) @ np.diag(spacing)
    affine[:3, 3] = (0, 0, 0) if form == "none" else (12, -34, 56)
    return affine


def write_image(path, samples, unit, form, spacing=(1.5, 2.0, 2.5), **words):
    write_nifti(path, samples, affine_of(form, spacing), unit=UNITS[unit][0],
                form=int(form == "sform"), **words)
    if form == "qform":
        with open(path, "r+b") as file:
            file.seek(252)
            file.write(struct.pack("<hh3f3f", 1, 0, 0, 0, 0, 12, -34, 56))


def transform_of(image, scale):
    """A rotation about the center of an image and a B-spline, in ITK's space."""
    rigid = sitk.Euler3DTransform()
    rigid.SetRotation(0.1, 0.05, -0.1)
    rigid.SetTranslation([1.3 * scale, -0.7 * scale, 0.9 * scale])
    rigid.SetCenter(image.TransformContinuousIndexToPhysicalPoint([(n - 1) / 2 for n in DIMS]))
    spline = sitk.BSplineTransformInitializer(image, [3, 3, 3], 3)
    count = len(spline.GetParameters())
    spline.SetParameters((scale * np.sin(1.7 * np.arange(count))).tolist())
    return rigid, spline


def resampled(moving, fixed, transform):
    return np.swapaxes(sitk.GetArrayFromImage(
        sitk.Resample(moving, fixed, transform, sitk.sitkLinear, 0.0)), 0, 2)


def warped(run, image, field, *words):
    """The samples of a warp, read by SimpleITK, away from the rim of the source."""
    run("warp", image, field, "-o", "out.mha", *words)
    return np.swapaxes(sitk.GetArrayFromImage(sitk.ReadImage(run.path("out.mha"))), 0, 2)


INNER = np.s_[3:-3, 3:-3, 3:-3]


def check_read(run, name, rigid, spline):
    """Transforms and fields that ITK wrote."""
    image = sitk.ReadImage(run.path("image.nii"), sitk.sitkFloat32)
    field = sitk.TransformToDisplacementField(rigid, sitk.sitkVectorFloat64, image.GetSize(),
                                              image.GetOrigin(), image.GetSpacing(),
                                              image.GetDirection())
    both = sitk.CompositeTransform([rigid, spline])
    for transform, files in ((rigid, ["rigid.tfm"]), (both, ["both.tfm"]),
                             (rigid, ["field.mha", "field.nrrd", "field.nii"])):
        expected = resampled(image, image, transform)
        for file in files:
            if file.endswith(".tfm"):
                sitk.WriteTransform(transform, run.path(file))
            else:
                sitk.WriteImage(field, run.path(file))
            expect(f"{file} on {name}", warped(run, "image.nii", file)[INNER], expected[INNER],
                   2e-4)


def check_written(run, name, rigid):
    """Fields that the command writes for ITK, and reads again."""
    image = sitk.ReadImage(run.path("image.nii"), sitk.sitkFloat32)
    expected = resampled(image, image, rigid)
    for file in "composed.nii", "composed.mha", "composed.nrrd", "composed.vtkhdf":
        run("compose", "rigid.tfm", "-o", file, "--like", "image.nii")
        expect(f"{file} read again on {name}", warped(run, "image.nii", file)[INNER],
               expected[INNER], 2e-4)
        if file.endswith(".vtkhdf"):
            run("export", file, "-o", "exported.nii")
            file = "exported.nii"
        field = sitk.DisplacementFieldTransform(
            sitk.ReadImage(run.path(file), sitk.sitkVectorFloat64))
        expect(f"{file} of {name} in ITK", resampled(image, image, field)[INNER], expected[INNER],
               2e-4)


def fields_across(transform, moving, fixed, from_header, to_header, spacing):
    """A transform from an image to another one in the conventions along RAS axes and of FSL: the
    numbers in the other image's header, fields of this header, and words of the command."""
    def to_ras(unit, form):  # from LPS and mm along the axes and to the unit of a header
        return (np.array([1, 1, 1]) if form == "none" else np.array([-1, -1, 1])) / UNITS[unit][1]

    index = np.stack(np.meshgrid(*[np.arange(n) for n in DIMS], indexing="ij"), axis=-1)
    here = np.array([fixed.TransformIndexToPhysicalPoint(i.tolist())
                     for i in index.reshape(-1, 3)])
    there = np.array([transform.TransformPoint(p.tolist()) for p in here])
    voxels = np.array([moving.TransformPhysicalPointToContinuousIndex(p.tolist()) for p in there])
    shape = (*DIMS, 3)
    vectors = ((there - here) * to_ras(*to_header)).reshape(shape)
    places = (there * to_ras(*to_header)).reshape(shape)
    absolute = fsl_points(voxels.reshape(shape), from_header[1], (1.5, 2.0, 2.5))
    relative = absolute - fsl_points(index, to_header[1], spacing)
    nifty = {"intent": VECTOR, "name": "NREG_TRANS"}
    return {"dispvect": (vectors, {"intent": DISPVECT}, []),
            "ras": (vectors, {}, ["--axes", "ras"]),
            "nifty_vectors": (vectors, {**nifty, "parameter": 1.0}, []),
            "nifty_places": (places, nifty, []),
            "fsl_absolute": (absolute, {"intent": 2006, "steps": True}, ["--fsl", "absolute"]),
            "fsl_relative": (relative, {"intent": 2006, "steps": True}, ["--fsl", "relative"])}


def fsl_points(index, form, spacing):
    """Scaled indices, the first one from the other end in a right-handed header with a form."""
    x = np.array(index, float)
    if form != "none" and np.linalg.det(affine_of(form, spacing)[:3, :3]) > 0:
        x[..., 0] = DIMS[0] - 1 - x[..., 0]
    return x * spacing


def check_like(run, samples, unit, form):
    """Onto a grid of another unit and form, which overlaps in ITK's space."""
    other = {"none": "um", "m": "mm", "mm": "m", "um": "none"}[unit]
    spacing = np.array([1.4, 2.1, 2.2]) * UNITS[unit][1] / UNITS[other][1]
    other_form = "qform" if form == "none" else "none"
    write_image(run.path("like.nii"), samples, other, other_form, spacing)
    moving = sitk.ReadImage(run.path("image.nii"), sitk.sitkFloat32)
    fixed = sitk.ReadImage(run.path("like.nii"), sitk.sitkFloat32)
    middle = [(n - 1) / 2 for n in DIMS]
    start = np.array(fixed.TransformContinuousIndexToPhysicalPoint(middle))
    end = np.array(moving.TransformContinuousIndexToPhysicalPoint(middle))
    rigid = sitk.Euler3DTransform()
    rigid.SetRotation(0.1, 0.05, -0.1)
    rigid.SetCenter(start.tolist())
    rigid.SetTranslation((end - start).tolist())
    sitk.WriteTransform(rigid, run.path("across.tfm"))
    run("compose", "across.tfm", "-o", "across.vtkhdf", "--like", "like.nii")
    run("compose", "across.tfm", "-o", "across.nii", "--like", "like.nii")
    # The largest numbers of float32 in voxels, which are at least 1.5 wide.
    reach = np.max(np.abs(start) + np.abs(end)) / UNITS[unit][1] / 1.5
    files = {"across.tfm": ([], 0), "across.vtkhdf": ([], reach), "across.nii": ([], reach)}
    for kind, (numbers, header, words) in fields_across(rigid, moving, fixed, (unit, form),
                                                        (other, other_form), spacing).items():
        of_fsl = np.abs(numbers).max() / 1.5 if kind.startswith("fsl") else 0
        files[f"{kind}.nii"] = words, max(reach, of_fsl)
        write_image(run.path(f"{kind}.nii"), numbers, other, other_form, spacing, **header)
    expected = resampled(moving, fixed, rigid)[INNER]
    for file, (words, reach) in files.items():
        found = warped(run, "image.nii", file, "--like", "like.nii", *words)
        expect(f"{unit} {form} onto {other} {other_form} by {file}", found[INNER], expected,
               2e-4 + 3 * 100 * reach * 2.0**-24)  # samples differ by 100 per voxel and axis
    place = sitk.ReadImage(run.path("out.mha"))
    corner = [n - 1 for n in DIMS]
    expect("place of the output", np.array(place.TransformIndexToPhysicalPoint(corner)) /
           UNITS[unit][1], np.array(fixed.TransformIndexToPhysicalPoint(corner)) / UNITS[unit][1],
           1e-3)


def main():
    command, _ = arguments(__doc__)
    samples = np.random.default_rng(5).uniform(0, 100, DIMS).astype(np.float32)
    with tempfile.TemporaryDirectory() as folder:
        run = Command(command, folder)
        for unit in UNITS:
            for form in FORMS:
                write_image(run.path("image.nii"), samples, unit, form)
                image = sitk.ReadImage(run.path("image.nii"))
                rigid, spline = transform_of(image, UNITS[unit][1])
                check_read(run, f"{unit} {form}", rigid, spline)
                check_written(run, f"{unit} {form}", rigid)
                check_like(run, samples, unit, form)
    print(f"{len(worst_of)} comparisons, worst {max(worst_of.values()):.1e}")


if __name__ == "__main__":
    main()
