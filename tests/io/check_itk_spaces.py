"""Compares transforms and fields on NIfTI images of all units and forms with SimpleITK.

Usage: check_itk_spaces.py COMMAND

Images in no unit, meters, millimeters and micrometers, with a sform, a qform or neither, are warped
by transforms and fields that ITK wrote, also onto the grid of an image of another unit and form, and
fields that the command wrote for them are applied by SimpleITK. Exits 77 when NumPy or SimpleITK is
missing, 1 when a value differs.
"""
import struct
import sys
import tempfile

from check_transforms import DIMS, Command, arguments, np, sitk, worst_of, write_nifti, expect

if sitk is None:
    sys.exit(77)
UNITS = {"none": (0, 1.0), "m": (1, 1e3), "mm": (2, 1.0), "um": (3, 1e-3)}  # code, millimeters
FORMS = "sform", "qform", "none"


def write_image(path, samples, unit, form, spacing=(1.5, 2.0, 2.5)):
    """Oblique with a sform, with an origin also with a qform."""
    turn, _ = np.linalg.qr(np.array([[1.0, 0.3, -0.2], [-0.25, 1.0, 0.1], [0.15, -0.2, 1.0]]))
    affine = np.eye(4)
    affine[:3, :3] = (turn if form == "sform" else np.eye(3)) @ np.diag(spacing)
    affine[:3, 3] = (0, 0, 0) if form == "none" else (12, -34, 56)
    write_nifti(path, samples, affine, unit=UNITS[unit][0], form=int(form == "sform"))
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
    found = warped(run, "image.nii", "across.tfm", "--like", "like.nii")
    expect(f"{unit} {form} onto {other} {other_form}", found[INNER],
           resampled(moving, fixed, rigid)[INNER], 2e-4)
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
