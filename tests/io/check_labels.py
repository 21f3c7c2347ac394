"""What the filters nearest and labels keep of a tube of one voxel that is turned in any direction, and
labels by Gaussian weights beside those of SimpleITK.

Usage: check_labels.py COMMAND

The tube is resampled by random rotations through its middle, to its own grid and to a coarser one. NumPy computes
the labels from their definitions in float64, and what share of each voxel lies in the turned tube from
4x4x4 points in it. The figures of docs/guide.md are means of volume (of the true one) and Dice (with these shares).
Where SimpleITK is installed, labels of its sitkLabelGaussian are compared with --label-rule gaussian.
Exits 77 when NumPy is missing, 1 when labels or figures differ.
"""
import sys
import tempfile

from check_images import read_nifti
from check_transforms import LPS, Command, np, sampled, sitk, write_nifti

COUNT = 24  # voxels of 1 mm along each axis
MIDDLE = np.full(3, COUNT / 2 - 0.5)
PARTS = 4
TURNS = 6
# Of the guide: voxels along an axis, filter: volume and Dice.
FIGURES = {(24, "nearest"): (0.96, 0.57), (24, "labels"): (0.58, 0.50),
           (16, "nearest"): (0.92, 0.39), (16, "labels"): (0.64, 0.34)}


def rotation(random):
    w, x, y, z = (lambda q: q / np.linalg.norm(q))(random.normal(size=4))
    return np.array([[1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
                     [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
                     [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)]])


def centers(count, parts=1):
    """Positions of parts of the voxels of a grid over the same box."""
    step = COUNT / (count * parts)
    line = (np.arange(count * parts) + 0.5) * step - 0.5
    return np.stack(np.meshgrid(line, line, line, indexing="ij"), axis=-1)


def nearest(tube, points):
    index = np.floor(points + 0.5).astype(int)
    inside = np.all((index >= 0) & (index < COUNT), axis=-1)
    index = np.clip(index, 0, COUNT - 1)
    return np.where(inside, tube[index[..., 0], index[..., 1], index[..., 2]], 0)


def write_turn(path, turn, shift):
    """A turn about the middle, then a shift, as a transform of ITK."""
    with open(path, "w") as file:
        numbers = lambda row: " ".join(repr(float(x)) for x in row)
        file.write("#Insight Transform File V1.0\n#Transform 0\n"
                   "Transform: AffineTransform_double_3_3\n"
                   f"Parameters: {numbers(turn.ravel())} {numbers(shift)}\n"
                   f"FixedParameters: {numbers(LPS @ MIDDLE)}\n")


def check_gaussian(run, random):
    """Every label of a turned volume of blocks with noise, within the source and beyond it."""
    blocks = np.kron(random.integers(1, 6, (6, 6, 6)), np.ones((4, 4, 4)))
    noise = random.integers(0, 9, blocks.shape)
    labels = np.where(random.random(blocks.shape) < 0.2, noise, blocks)
    write_nifti(run.path("blocks.nii"), labels, np.eye(4))
    write_turn(run.path("turn.tfm"), 0.8 * rotation(random), random.uniform(-0.5, 0.5, 3))
    run("warp", "blocks.nii", "turn.tfm", "-o", "out.nii", "--filter", "labels",
        "--label-rule", "gaussian", "--background", "77")
    found = read_nifti(run.path("out.nii"))[0]
    image = sitk.Cast(sitk.ReadImage(run.path("blocks.nii")), sitk.sitkInt16)
    wanted = sitk.GetArrayFromImage(sitk.Resample(
        image, image, sitk.ReadTransform(run.path("turn.tfm")), sitk.sitkLabelGaussian, 77.0)).T
    differing = np.count_nonzero(found != wanted)
    print(f"gaussian: {differing} of {wanted.size} labels differ from SimpleITK's")
    if differing > 0 or len(np.unique(wanted)) < 6:
        sys.exit("gaussian: other labels than SimpleITK's")


def main():
    random = np.random.default_rng(7)
    tube = np.zeros((COUNT,) * 3, np.float32)
    tube[12, 12, 4:20] = 1
    found = {}
    with tempfile.TemporaryDirectory() as folder:
        run = Command(sys.argv[1], folder)
        write_nifti(run.path("tube.nii"), tube, np.eye(4))
        for _ in range(TURNS):
            turn, shift = rotation(random), random.uniform(-0.5, 0.5, 3)
            write_turn(run.path("turn.tfm"), turn, shift)
            place = lambda x: (x - MIDDLE) @ (LPS @ turn @ LPS).T + MIDDLE + LPS @ shift
            for count in (24, 16):
                volume = (COUNT / count) ** 3
                fine = nearest(tube, place(centers(count, PARTS)))
                share = fine.reshape(count, PARTS, count, PARTS, count, PARTS).mean(axis=(1, 3, 5))
                points = place(centers(count))
                weight = sampled(tube, np.eye(4), points, 0.0)
                wanted = {"nearest": nearest(tube, points), "labels": weight > 0.5}
                # Where rounding may decide.
                unsure = {"nearest": np.any(np.abs((points + 0.5) % 1 - 0.5) > 0.499999, axis=-1),
                          "labels": np.abs(weight - 0.5) < 1e-5}
                for filter in wanted:
                    run("warp", "tube.nii", "turn.tfm", "-o", "out.nii", "--filter", filter,
                        "--dims", ",".join([str(count)] * 3))
                    label = read_nifti(run.path("out.nii"))[0] > 0.5
                    if np.any((label != wanted[filter]) & ~unsure[filter]):
                        sys.exit(f"{filter}: other labels than by the definition")
                    dice = 2 * (share * label).sum() / (share.sum() + label.sum())
                    row = (label.sum() / share.sum(), dice)
                    found.setdefault((count, filter), []).append(row)
        if sitk is not None:
            check_gaussian(run, random)
    for case, rows in found.items():
        means = np.mean(rows, axis=0)
        print(f"{case[0]} voxels, {case[1]}: volume {means[0]:.2f}, Dice {means[1]:.2f}")
        if np.any(np.abs(means - FIGURES[case]) > 0.0051):
            sys.exit(f"docs/guide.md tells {FIGURES[case]} of {case}")


if __name__ == "__main__":
    main()
