"""Small NIfTI images for the documentation's commands: a head and its labels."""
import gzip
import struct

DIMS = (40, 48, 36)
SPACING = 2.0  # mm


def write_nifti(path, value_of):
    """Writes uint8 samples; value_of(i, j, k) gives each."""
    header = bytearray(352)
    struct.pack_into("<i", header, 0, 348)
    struct.pack_into("<8h", header, 40, 3, *DIMS, 1, 1, 1, 1)
    struct.pack_into("<hh", header, 70, 2, 8)  # uint8
    struct.pack_into("<8f", header, 76, 1, SPACING, SPACING, SPACING, 0, 0, 0, 0)
    struct.pack_into("<ff", header, 108, 352, 1)  # offset of the samples, slope
    struct.pack_into("<hh", header, 252, 0, 1)  # no qform; sform
    for axis in range(3):
        row = [0.0, 0.0, 0.0, -DIMS[axis] * SPACING / 2]
        row[axis] = SPACING
        struct.pack_into("<4f", header, 280 + 16 * axis, *row)
    header[344:348] = b"n+1\0"
    samples = bytes(
        value_of(i, j, k) for k in range(DIMS[2]) for j in range(DIMS[1]) for i in range(DIMS[0])
    )
    with gzip.open(path, "wb") as file:
        file.write(bytes(header) + samples)


def radius_of(i, j, k):
    """Distance from the center, 1 on the head's surface."""
    return sum(((x - (n - 1) / 2) / (0.4 * n)) ** 2 for x, n in zip((i, j, k), DIMS)) ** 0.5


def head_sample(i, j, k):
    radius = radius_of(i, j, k)
    if radius > 1:
        return 0
    return 180 if radius > 0.9 else 90 + 10 * ((i // 6 + j // 6 + k // 6) % 3)


def label(i, j, k):
    radius = radius_of(i, j, k)
    return 0 if radius > 1 else 1 if radius > 0.7 else 2


def write_images(folder):
    write_nifti(folder / "head.nii.gz", head_sample)
    write_nifti(folder / "labels.nii.gz", label)
