"""What the filter nearest and the rules of labels keep of a tube of one voxel that is turned in any direction,
and labels by Gaussian weights beside those of SimpleITK.

Usage: check_labels.py COMMAND

The tube is resampled by random rotations through its middle, to its own grid, a finer and a coarser one. NumPy computes
the labels from their definitions in float64, and what share of each voxel lies in the turned tube from
2x2x2 or 4x4x4 points in it. The figures of docs/guide.md are means of volume (of the true one) and Dice (with these shares).
Labels by volume are of a mesh that turns as the transform does, where h5py is installed.
Where SimpleITK is installed, labels of its sitkLabelGaussian are compared with --label-rule gaussian.
Exits 77 when NumPy is missing, 1 when labels or figures differ.
"""
import sys
import tempfile

try:
    import h5py
except ImportError:
    h5py = None
    print("h5py is not installed: labels by volume are not compared")

from check_images import read_nifti
from check_transforms import LPS, Command, np, sampled, sitk, write_nifti

COUNT = 24  # voxels of 1 mm along each axis
MIDDLE = np.full(3, COUNT / 2 - 0.5)
PARTS = {48: 2, 24: 4, 16: 4}  # of a voxel along each axis, whose middles are the points in it
TURNS = 6
# Of the guide, by voxels along an axis and rule: volume and Dice.
FIGURES = {
    48: {"nearest": (1.00, 0.80), "linear": (0.59, 0.68), "volume": (0.92, 0.79), "gaussian": (0, 0)},
    24: {"nearest": (0.96, 0.57), "linear": (0.58, 0.50), "volume": (0.63, 0.51), "gaussian": (0, 0)},
    16: {"nearest": (0.92, 0.39), "linear": (0.64, 0.34), "volume": (0, 0), "gaussian": (0, 0)}}
WORDS = {"nearest": ["--filter", "nearest"], "linear": ["--filter", "labels"],
         "volume": ["--filter", "labels", "--label-rule", "volume"],
         "gaussian": ["--filter", "labels", "--label-rule", "gaussian"]}
CORNERS = np.array([[x, y, z] for z in (-1, 1) for y in (-1, 1) for x in (-1, 1)], float)
TETS = [[0, 3, 5, 6], [1, 0, 3, 5], [2, 0, 3, 6], [4, 0, 5, 6], [7, 3, 5, 6]]  # of these corners


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


def write_mesh(path, place):
    """A box around all grids whose deformation takes place(x) to x."""
    moved = MIDDLE + 4 * COUNT * CORNERS
    with h5py.File(path, "w") as file:
        root = file.create_group("VTKHDF")
        root.attrs["Version"] = np.array([1, 0])
        root.attrs["Type"] = np.bytes_("UnstructuredGrid")
        for name, count in ("Points", 8), ("Cells", 5), ("ConnectivityIds", 20):
            root["NumberOf" + name] = np.array([count])
        root["Points"] = place(moved)
        root["Offsets"] = 4 * np.arange(6)
        root["Connectivity"] = np.ravel(TETS)
        root["Types"] = np.full(5, 10, np.uint8)
        root["PointData/displacement"] = moved - place(moved)


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
            if h5py is not None:
                write_mesh(run.path("turn.vtkhdf"), place)
            for count, parts in PARTS.items():
                fine = nearest(tube, place(centers(count, parts)))
                share = fine.reshape(count, parts, count, parts, count, parts).mean(axis=(1, 3, 5))
                points = place(centers(count))
                # By the definition, and where rounding, or the points in a voxel, may decide.
                wanted = {"nearest": (nearest(tube, points),
                                      np.any(np.abs((points + 0.5) % 1 - 0.5) > 0.499999, axis=-1)),
                          "volume": (share > 0.5, np.abs(share - 0.5) < 0.5 / parts)}
                if count <= COUNT:
                    weight = sampled(tube, np.eye(4), points, 0.0)
                    wanted["linear"] = weight > 0.5, np.abs(weight - 0.5) < 1e-5
                for rule, words in WORDS.items():
                    is_known = rule == "gaussian" and (count, rule) in found  # keeps nothing
                    if is_known or (rule == "volume" and h5py is None):
                        continue
                    by = "turn.vtkhdf" if rule == "volume" else "turn.tfm"
                    run("warp", "tube.nii", by, "-o", "out.nii", *words,
                        "--dims", ",".join([str(count)] * 3))
                    label = read_nifti(run.path("out.nii"))[0] > 0.5
                    definition, unsure = wanted.get(rule, (label, False))
                    if np.any((label != definition) & ~np.asarray(unsure)):
                        sys.exit(f"{rule}: other labels than by the definition")
                    dice = 2 * (share * label).sum() / (share.sum() + label.sum())
                    row = (label.sum() / share.sum(), dice)
                    found.setdefault((count, rule), []).append(row)
        if sitk is not None:
            check_gaussian(run, random)
    for (count, rule), rows in found.items():
        means = np.mean(rows, axis=0)
        print(f"{count} voxels, {rule}: volume {means[0]:.2f}, Dice {means[1]:.2f}")
        if np.any(np.abs(means - FIGURES[count][rule]) > 0.0051):
            sys.exit(f"docs/guide.md tells {FIGURES[count][rule]} of {rule} on {count} voxels")


if __name__ == "__main__":
    main()
