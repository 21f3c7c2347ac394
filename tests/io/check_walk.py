"""The walk of docs/guide.md with a head of float32 samples: images straight in and out, and the
displacement field of the warp applied by ITK.

Usage: check_walk.py COMMAND

tetwarp warps a NIfTI image and its labels by three steps to NIfTI. SimpleITK reads the displacement
field of the last step and resamples the head by it; the result is compared with the warp where the
mesh covers a voxel and ITK has a sample. nibabel reads the 4D image, writes the head in the other
forms of NIfTI, and reads an image of NIfTI-2. Exits 77 when SimpleITK or
nibabel is missing, 1 when something differs.
"""
import os
import subprocess
import sys
import tempfile

try:
    import nibabel
    import numpy as np
    import SimpleITK as sitk
except ImportError as error:
    print(f"skipped: {error}; install SimpleITK and nibabel by pip")
    sys.exit(77)

DIMS = (40, 48, 36)
SPACING = 2.0
OUTSIDE = -1000.0  # no sample is so small
TOLERANCE = 2e-5  # of the samples' range


def write_images(folder):
    """A smooth head of range 0 to 1 and its labels, on an oblique grid."""
    index = np.stack(np.meshgrid(*[np.arange(n) for n in DIMS], indexing="ij"), axis=-1)
    half = (np.array(DIMS) - 1) / 2
    radius = np.linalg.norm((index - half) / (0.4 * np.array(DIMS)), axis=-1)
    waves = np.sin(index @ [0.4, 0.3, 0.2]) * np.cos(index @ [0.1, -0.3, 0.5])
    head = np.where(radius < 1, 0.6 + 0.4 * waves, 0)
    turn = np.array([[0.8, -0.6, 0], [0.6, 0.8, 0], [0, 0, 1]])
    affine = np.eye(4)
    affine[:3, :3] = SPACING * turn
    affine[:3, 3] = -affine[:3, :3] @ half
    image = nibabel.Nifti1Image(head.astype(np.float32), affine)
    image.header.set_xyzt_units("mm", "msec")
    nibabel.save(image, os.path.join(folder, "head.nii.gz"))
    labels = np.where(radius < 0.7, 2, np.where(radius < 1, 1, 0)).astype(np.uint8)
    nibabel.save(nibabel.Nifti1Image(labels, affine), os.path.join(folder, "labels.nii.gz"))


def run(command, folder, *words):
    result = subprocess.run(
        [command, *words], cwd=folder, capture_output=True, text=True, check=False
    )
    if result.returncode != 0:
        sys.exit(f"tetwarp {' '.join(words)}: {result.stderr}")


def check_itk(folder):
    head = sitk.ReadImage(os.path.join(folder, "head.nii.gz"))
    field = sitk.ReadImage(os.path.join(folder, "bent_displacement.nii.gz"), sitk.sitkVectorFloat64)
    moved = float(np.max(np.linalg.norm(sitk.GetArrayFromImage(field), axis=-1)))
    print(f"largest displacement: {moved:.1f} mm")
    # The transform takes the field over and leaves it empty.
    resampled = sitk.Resample(
        head, sitk.DisplacementFieldTransform(field), sitk.sitkLinear, OUTSIDE, sitk.sitkFloat64
    )
    found = sitk.GetArrayFromImage(resampled)
    warped = sitk.GetArrayFromImage(sitk.ReadImage(os.path.join(folder, "bent.nii.gz")))
    mask = sitk.GetArrayFromImage(sitk.ReadImage(os.path.join(folder, "bent_mask.nii.gz")))
    compared = (mask == 1) & (found != OUTSIDE)
    worst = float(np.max(np.abs(found - warped)[compared]))
    print(f"ITK against the warp: {worst:.1e} of the range in {compared.sum()} voxels")
    if not worst <= TOLERANCE or compared.sum() < 0.1 * mask.size or moved < 4:
        sys.exit("the resampled image is not the warp")


def check_series(folder):
    series = nibabel.load(os.path.join(folder, "bending.nii.gz"))
    last = nibabel.load(os.path.join(folder, "bent.nii.gz"))
    if series.shape != (*DIMS, 3):
        sys.exit(f"the series has the shape {series.shape}")
    if not np.array_equal(np.asarray(series.dataobj)[..., 2], np.asarray(last.dataobj)):
        sys.exit("the last step of the series is not the warp of the last step")
    if abs(series.header["pixdim"][4] - 500) > 1e-3:  # steps at 0, 0.5 and 1 s, in ms
        sys.exit(f"pixdim[4] is {series.header['pixdim'][4]}")
    labels = nibabel.load(os.path.join(folder, "bending_labels.nii.gz"))
    if set(np.unique(np.asarray(labels.dataobj))) != {0, 1, 2}:
        sys.exit("labels other than 0, 1 and 2")


def check_forms(command, folder):
    """NIfTI-2, a pair of files and the other byte order give the warp of the single NIfTI-1 file."""
    expected = np.asarray(nibabel.load(os.path.join(folder, "bent.nii.gz")).dataobj)
    head = nibabel.load(os.path.join(folder, "head.nii.gz"))
    samples = np.asarray(head.dataobj)
    second = nibabel.Nifti2Image(samples, head.affine)
    big_header = nibabel.Nifti2Header(endianness=">")
    big_header.set_data_dtype(">f4")
    forms = {
        "second.nii.gz": second,
        "pair.hdr": nibabel.Nifti1Pair(samples, head.affine),
        "big.nii": nibabel.Nifti2Image(samples.astype(">f4"), head.affine, big_header),
    }
    for name, image in forms.items():
        nibabel.save(image, os.path.join(folder, name))
        run(command, folder, "warp", name, "bending.vtkhdf", "-o", "form.nii", "--steps", "-1")
        found = np.asarray(nibabel.load(os.path.join(folder, "form.nii")).dataobj)
        if not np.array_equal(found, expected):
            sys.exit(f"{name}: the warp differs from that of head.nii.gz")
    run(
        command, folder, "warp", "head.nii.gz", "bending.vtkhdf", "-o", "long.nii.gz", "--steps",
        "0", "--dims", "40000,4,3", "--spacing", "0.002,10,10",
    )
    long = nibabel.load(os.path.join(folder, "long.nii.gz"))
    if not isinstance(long, nibabel.Nifti2Image) or long.shape != (40000, 4, 3):
        sys.exit(f"an axis of 40000 voxels: {type(long)} of shape {long.shape}")
    if not np.allclose(np.linalg.norm(long.affine[:3, :3], axis=0), (0.002, 10, 10)):
        sys.exit(f"an axis of 40000 voxels: the affine map is {long.affine}")
    print(f"other forms of NIfTI: {', '.join(forms)}, and one written")


def main(command):
    command = os.path.abspath(command)
    with tempfile.TemporaryDirectory() as folder:
        write_images(folder)
        for words in (
            "mesh head.nii.gz -o mesh.vtkhdf --cells 8 --threshold 0.1",
            "deform mesh.vtkhdf -o bending.vtkhdf --kind bend --amount 0.4 --steps 3",
            "warp head.nii.gz bending.vtkhdf -o bending.nii.gz --temporal",
            "warp labels.nii.gz bending.vtkhdf -o bending_labels.nii.gz --temporal --filter labels",
            "warp head.nii.gz bending.vtkhdf -o bent.nii.gz --steps -1 --outputs displacement,mask",
        ):
            run(command, folder, *words.split())
        check_series(folder)
        check_itk(folder)
        check_forms(command, folder)


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    main(sys.argv[1])
