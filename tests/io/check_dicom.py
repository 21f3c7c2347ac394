"""Compares DICOM series and VTK's .vti images with NumPy, SimpleITK and VTK.

Usage: check_dicom.py COMMAND [EVERY]

Series are written here byte by byte, in all 48 orientations (in every EVERYth of them), with slices in any order
of their names, rescaled values, tilted gantries, a dose grid, enhanced images and colors; the command turns them into NIfTI images, which are parsed and compared. Where SimpleITK is installed, it reads the same series,
and the command reads series that SimpleITK packs by JPEG 2000 and lossless JPEG. Images that the command writes
as .vti are read by VTK, and the command reads what VTK writes, packed and with arrays of bits. Series that make
no volume must be refused in one line. Exits 77 when NumPy is missing, 1 when something differs.
"""
import itertools
import os
import random
import shutil
import struct
import sys
import tempfile

from check_images import expect, read_nifti
from check_transforms import LPS, Command, arguments, np, orientations, sitk

try:
    import vtk
    from vtk.util import numpy_support
except ImportError:
    vtk = None
    print("VTK's Python module is not installed: .vti images are not compared")

DIMS = (7, 6, 5)
SERIES = "1.2.826.0.1.3680043.2.1125.7"
LONG_VR = (b"OB", b"OW", b"SQ", b"UN")


def element(group, number, vr, value):
    value = value.encode() if isinstance(value, str) else value
    value += (b"\0" if vr == b"UI" or vr == b"OB" else b" ") * (len(value) % 2)
    length = struct.pack("<HI", 0, len(value)) if vr in LONG_VR else struct.pack("<H", len(value))
    return struct.pack("<HH", group, number) + vr + length + value


def decimals(numbers):
    return "\\".join(f"{float(x):.9g}" for x in numbers)


def dicom(pixels, facts):
    """A file of explicit little endian. pixels: [row][column], [row][column][color] or, of several frames,
    [frame][row][column]; facts: elements by (group, number), as (VR, value), None to leave one out."""
    short = lambda number: struct.pack("<H", number)
    colors = pixels.ndim == 3 and pixels.shape[2] == 3
    shape = pixels.shape[:2] if colors or pixels.ndim == 2 else pixels.shape[1:]
    bits = 8 * pixels.dtype.itemsize
    kind = facts.get((8, 0x16), (b"UI", "1.2.840.10008.5.1.4.1.1.2"))[1]  # CT
    all_facts = {
        (8, 0x16): (b"UI", kind), (8, 0x18): (b"UI", SERIES + ".1"), (8, 0x60): (b"CS", "CT"),
        (8, 0x103E): (b"LO", "thorax"), (0x10, 0x10): (b"PN", "Nobody"),
        (0x20, 0xE): (b"UI", SERIES), (0x28, 2): (b"US", short(3 if colors else 1)),
        (0x28, 4): (b"CS", "RGB" if colors else "MONOCHROME2"),
        (0x28, 0x10): (b"US", short(shape[0])), (0x28, 0x11): (b"US", short(shape[1])),
        (0x28, 0x100): (b"US", short(bits)), (0x28, 0x101): (b"US", short(bits)),
        (0x28, 0x102): (b"US", short(bits - 1)),
        (0x28, 0x103): (b"US", short(int(pixels.dtype.kind == "i"))),
        (0x7FE0, 0x10): (b"OW", pixels.astype(pixels.dtype.newbyteorder("<")).tobytes()),
        **({(0x28, 6): (b"US", short(0))} if colors else {}), **facts}
    body = b"".join(element(*tag, *fact) for tag, fact in sorted(all_facts.items()) if fact)
    meta = (element(2, 1, b"OB", b"\0\1") + element(2, 2, b"UI", kind)
            + element(2, 3, b"UI", SERIES + ".1") + element(2, 0x10, b"UI", "1.2.840.10008.1.2.1")
            + element(2, 0x12, b"UI", "1.2.3"))
    return b"\0" * 128 + b"DICM" + element(2, 0, b"UL", struct.pack("<I", len(meta))) + meta + body


def sequence(*items):
    """A sequence of items, each of elements by (group, number)."""
    value = b""
    for item in items:
        body = b"".join(element(*tag, *fact) for tag, fact in sorted(item.items()))
        value += struct.pack("<HHI", 0xFFFE, 0xE000, len(body)) + body
    return b"SQ", value


def slice_facts(affine, k):
    """Of slice k of a volume with this map from (column, row, slice) to RAS."""
    turned = LPS @ affine[:3, :3]
    spacing = np.linalg.norm(turned, axis=0)
    position = LPS @ affine[:3, 3] + k * turned[:, 2]
    cosines = (turned / spacing)[:, :2].T.ravel()
    return {(0x20, 0x32): (b"DS", decimals(position)), (0x20, 0x37): (b"DS", decimals(cosines)),
            (0x28, 0x30): (b"DS", decimals(spacing[1::-1])), (0x18, 0x50): (b"DS", decimals([9]))}


def write_series(folder, samples, affine, more=lambda k: {}, seed=1):
    """samples: [i][j][k] or [i][j][k][color] as they are stored; names say nothing of the order."""
    os.makedirs(folder, exist_ok=True)
    names = list(range(samples.shape[2]))
    random.Random(seed).shuffle(names)
    for k, name in enumerate(names):
        pixels = np.swapaxes(samples[:, :, k], 0, 1)
        with open(os.path.join(folder, f"{name:03}.dcm"), "wb") as file:
            file.write(dicom(pixels, {**slice_facts(affine, k), **more(k)}))


def right_handed(affine):
    """Slices are sorted along the normal, which is right-handed in LPS and in RAS."""
    return np.linalg.det(affine[:3, :3]) > 0


def flipped(samples, affine):
    """The same volume with its slices in the other order."""
    turned = affine.copy()
    turned[:3, 3] += (samples.shape[2] - 1) * affine[:3, 2]
    turned[:3, 2] *= -1
    return samples[:, :, ::-1], turned


def sorted_volume(samples, affine):
    return (samples, affine) if right_handed(affine) else flipped(samples, affine)


def itk_volume(folder, series=SERIES):
    reader = sitk.ImageSeriesReader()
    reader.SetFileNames(reader.GetGDCMSeriesFileNames(folder, series))
    image = reader.Execute()
    samples = sitk.GetArrayFromImage(image)
    affine = np.eye(4)
    affine[:3, :3] = LPS @ np.reshape(image.GetDirection(), (3, 3)) * image.GetSpacing()
    affine[:3, 3] = LPS @ image.GetOrigin()
    return np.transpose(samples, (2, 1, 0, 3)[: samples.ndim]), affine


def folder_of(run, name):
    shutil.rmtree(run.path(name), ignore_errors=True)
    return run.path(name)


def read_by_command(run, name, *more):
    if more:
        run("import", name, "-o", "out.vtkhdf", *more)
    run("export", "out.vtkhdf" if more else name, "-o", "out.nii", "--axes", "ras")
    return read_nifti(run.path("out.nii"))


def check_orientations(run, random_numbers, every):
    kinds = itertools.cycle(("i2", "u2", "u1", "i1"))
    for n, affine in enumerate(itertools.islice(orientations(), 0, None, every)):
        samples = random_numbers.integers(0, 120, DIMS).astype(next(kinds))
        write_series(folder_of(run, "series"), samples, affine, seed=n)
        found = read_by_command(run, "series")
        expect(f"orientation {n}", found, sorted_volume(samples, affine))
        if sitk:
            expect(f"orientation {n} by SimpleITK", found, itk_volume(run.path("series")))


def check_values(run, random_numbers):
    affine = np.diag([0.7, 0.7, 3.0, 1])
    affine[:3, 3] = (-100.25, 30.5, 1200)
    stored = random_numbers.integers(0, 4096, DIMS).astype("u2")
    rescale = lambda slope, intercept: {(0x28, 0x1053): (b"DS", decimals([slope])),
                                        (0x28, 0x1052): (b"DS", decimals([intercept]))}
    twelve = {(0x28, 0x101): (b"US", struct.pack("<H", 12)), (0x28, 0x102): (b"US", struct.pack("<H", 11))}
    cases = {"hounsfield": (lambda k: {**twelve, **rescale(1, -1024)}, "i2", stored.astype("i4") - 1024),
             "half": (lambda k: {**twelve, **rescale(0.5, 2)}, "f4", stored * 0.5 + 2),
             "by slice": (lambda k: rescale(0.25 * (k + 1), 0), "f4",
                          stored * 0.25 * (np.arange(DIMS[2]) + 1))}
    for name, (more, kind, values) in cases.items():
        write_series(folder_of(run, "values"), stored, affine, more)
        found = read_by_command(run, "values")
        if found[0].dtype.str[1:] != kind:
            sys.exit(f"{name}: read as {found[0].dtype}, expected {kind}")
        expect(name, found, (values.astype(kind), affine))
        if sitk:
            expect(f"{name} by SimpleITK", found, itk_volume(run.path("values")))
    colors = random_numbers.integers(0, 255, DIMS + (3,)).astype("u1")
    write_series(folder_of(run, "colors"), colors, affine)
    expect("colors", read_by_command(run, "colors"), (colors, affine))
    monochrome = lambda k: {(0x28, 4): (b"CS", "MONOCHROME1")}
    write_series(folder_of(run, "one"), stored, affine, monochrome)
    if "MONOCHROME1" not in run("info", "one"):
        sys.exit("MONOCHROME1 is not named")


def check_places(run, random_numbers):
    """One slice; a tilted gantry; rounded positions; a warp of a folder; a dose grid."""
    samples = random_numbers.integers(0, 120, DIMS).astype("i2")
    affine = np.diag([2.0, 1.5, 3.0, 1])
    write_series(folder_of(run, "single"), samples[:, :, :1], affine)
    thick = np.diag([2.0, 1.5, 9.0, 1])
    expect("one slice", read_by_command(run, "single"), (samples[:, :, :1], thick))
    expect("one file", read_by_command(run, "single/000.dcm"), (samples[:, :, :1], thick))

    tilted = affine.copy()
    tilted[1, 2] = 3 * np.tan(np.radians(12))
    write_series(folder_of(run, "tilted"), samples, tilted)
    expect("tilted gantry", read_by_command(run, "tilted"), (samples, tilted))
    if "(12" not in run("info", "tilted"):
        sys.exit("info does not tell the tilt of 12 degrees")

    rounded = lambda k: {(0x20, 0x32): (b"DS", f"0\\0\\{k * 1.0 / 3:.2f}")}
    thin = np.diag([2.0, 1.5, (round((DIMS[2] - 1) / 3, 2)) / (DIMS[2] - 1), 1])
    write_series(folder_of(run, "rounded"), samples, np.diag([2.0, 1.5, 1, 1]), rounded)
    expect("rounded positions", read_by_command(run, "rounded"), (samples, thin))

    offsets = {(0x3004, 0xC): (b"DS", decimals(3.0 * np.arange(DIMS[2]))),
               (0x3004, 0xE): (b"DS", "0.001"), (0x28, 8): (b"IS", str(DIMS[2])),
               (8, 0x60): (b"CS", "RTDOSE"), (8, 0x16): (b"UI", "1.2.840.10008.5.1.4.1.1.481.2")}
    dose = random_numbers.integers(0, 2**31, DIMS).astype("u4")
    with open(run.path("dose.dcm"), "wb") as file:
        file.write(dicom(np.transpose(dose, (2, 1, 0)), {**slice_facts(affine, 0), **offsets}))
    expect("dose", read_by_command(run, "dose.dcm"), (dose * 0.001, affine))

    write_series(folder_of(run, "head"), samples, affine)
    run("mesh", "head", "-o", "mesh.vtkhdf", "--cells", "3", "--threshold", "-1")
    run("deform", "mesh.vtkhdf", "-o", "moved.vtkhdf", "--kind", "translate", "--offset", "2,0,0",
        "--steps", "1")
    run("warp", "head", "moved.vtkhdf", "-o", "warped.nii", "--filter", "nearest")
    found, place = read_nifti(run.path("warped.nii"))
    expect("warped", (found[1:], place), (samples[:-1], affine))


def check_enhanced(run, random_numbers):
    """Frames in any order with a slope each, whose places are told frame by frame or of all together."""
    samples = random_numbers.integers(-500, 500, DIMS).astype("i2")
    enhanced = {(8, 0x16): (b"UI", "1.2.840.10008.5.1.4.1.1.2.1"), (0x28, 8): (b"IS", str(DIMS[2]))}
    for n, affine in enumerate(itertools.islice(orientations(), 3, None, 12)):
        order = random_numbers.permutation(DIMS[2])
        slopes = random_numbers.integers(1, 4, DIMS[2]) * 0.5

        def groups(k, slope):
            facts = slice_facts(affine, k)
            place = {(0x20, 0x9113): sequence({(0x20, 0x32): facts[(0x20, 0x32)]}),
                     (0x28, 0x9145): sequence({(0x28, 0x1052): (b"DS", "3"),
                                               (0x28, 0x1053): (b"DS", decimals([slope]))})}
            alike = {(0x20, 0x9116): sequence({(0x20, 0x37): facts[(0x20, 0x37)]}),
                     (0x28, 0x9110): sequence({(0x28, 0x30): facts[(0x28, 0x30)],
                                               (0x18, 0x50): facts[(0x18, 0x50)]})}
            return place, alike

        found = [groups(k, slopes[k]) for k in order]
        together = n % 2 == 0
        frames = {(0x5200, 0x9230): sequence(*(p if together else {**p, **a} for p, a in found))}
        shared = {(0x5200, 0x9229): sequence(found[0][1] if together else {})}
        pixels = np.transpose(samples, (2, 1, 0))[order]
        with open(run.path("enhanced.dcm"), "wb") as file:
            file.write(dicom(pixels, {**enhanced, **frames, **shared}))
        expect(f"enhanced {n}", read_by_command(run, "enhanced.dcm"),
               sorted_volume(samples * slopes + 3, affine))

    place, alike = groups(0, 0.5)
    single = {(0x28, 8): (b"IS", "1"), (0x5200, 0x9230): sequence({**place, **alike})}
    with open(run.path("single.dcm"), "wb") as file:
        file.write(dicom(np.transpose(samples, (2, 1, 0))[:1], {**enhanced, **single}))
    thick = affine.copy()
    thick[:3, 2] *= 9 / np.linalg.norm(affine[:3, 2])
    expect("enhanced, of one frame", read_by_command(run, "single.dcm"),
           sorted_volume(samples[:, :, :1] * 0.5 + 3, thick))

    def refused(words, facts):
        with open(run.path("enhanced.dcm"), "wb") as file:
            file.write(dicom(pixels, {**enhanced, **facts}))
        line = run.refused("export", "enhanced.dcm", "-o", "out.nii")
        if words not in line:
            sys.exit(f"enhanced: expected '{words}' in: {line}")

    refused("frames, which are read of dose grids and enhanced images alone", {})
    few = {(0x5200, 0x9230): sequence(*(p for p, _ in found[1:]))}
    refused("frames, which are read of dose grids and enhanced images alone", few)
    refused("no ImagePositionPatient", {(0x5200, 0x9230): sequence(*({} for _ in found))})


def check_packed(run, random_numbers):
    if not sitk:
        return
    samples = random_numbers.integers(-1000, 1000, (6, 16, 20)).astype("i2")
    for name in ("JPEG2000", "JPEG", "none"):
        folder = folder_of(run, "packed")
        os.makedirs(folder)
        for k in range(samples.shape[0]):
            image = sitk.GetImageFromArray(samples[k : k + 1])
            for tag, value in (("0008|0060", "CT"), ("0020|000e", SERIES), ("0020|0013", str(k)),
                               ("0020|0032", decimals([0, 0, 2.5 * k])),
                               ("0020|0037", decimals([1, 0, 0, 0, 1, 0])), ("0028|1053", "1"),
                               ("0028|1052", "0")):
                image.SetMetaData(tag, value)
            writer = sitk.ImageFileWriter()
            writer.KeepOriginalImageUIDOn()
            writer.SetFileName(os.path.join(folder, f"{9 - k}.dcm"))
            if name != "none":
                writer.UseCompressionOn()
                writer.SetCompressor(name)
            writer.Execute(image)
        found = read_by_command(run, "packed")
        expect(f"packed by {name}", found, itk_volume(folder))
        if not np.array_equal(found[0], np.transpose(samples, (2, 1, 0))):
            sys.exit(f"packed by {name}: other samples")


def check_series(run, random_numbers):
    """Two series in a folder, and files that are none."""
    samples = random_numbers.integers(0, 120, DIMS).astype("i2")
    affine = np.diag([2.0, 1.5, 3.0, 1])
    write_series(folder_of(run, "both"), samples, affine)
    other = SERIES + ".9"
    write_series(folder_of(run, "other"), samples[:, :, :3] + 1, affine,
                 lambda k: {(0x20, 0xE): (b"UI", other)})
    for name in os.listdir(run.path("other")):
        shutil.copy(run.path("other/" + name), run.path("both/other_" + name))
    with open(run.path("both/readme.txt"), "w") as file:
        file.write("no image\n")
    line = run.refused("import", "both", "-o", "out.vtkhdf")
    if SERIES not in line or other not in line or "--series" not in line or "3 slices" not in line:
        sys.exit(f"series are not listed: {line}")
    expect("first series", read_by_command(run, "both", "--series", SERIES), (samples, affine))
    expect("second series", read_by_command(run, "both", "--series", other),
           (samples[:, :, :3] + 1, affine))
    run.refused("import", "both", "-o", "out.vtkhdf", "--series", "1.2.3")
    run.refused("info", "out.vtkhdf", "--series", SERIES)

    run("export", "both", "-o", "out.nii", "--series", other)
    expect("exported series", read_nifti(run.path("out.nii")), (samples[:, :, :3] + 1, affine))
    run("render", "both", "-o", "out.png", "--series", other)
    run("mesh", "both", "-o", "mesh.vtkhdf", "--cells", "3", "--threshold", "-1", "--series", SERIES)
    run("deform", "mesh.vtkhdf", "-o", "moved.vtkhdf", "--kind", "translate", "--offset", "2,0,0",
        "--steps", "1")
    run("warp", "both", "moved.vtkhdf", "-o", "warped.nii", "--filter", "nearest", "--series", SERIES,
        "--like", "both", "--like-series", other)
    found, place = read_nifti(run.path("warped.nii"))
    expect("warped onto a series", (found[1:], place), (samples[:-1, :, :3], affine))
    run("compose", "moved.vtkhdf", "-o", "field.vtkhdf", "--like", "both", "--like-series", other)
    run.refused("compose", "moved.vtkhdf", "-o", "field.vtkhdf", "--like", "both")
    run.refused("warp", "both", "moved.vtkhdf", "-o", "warped.nii", "--series", SERIES,
                "--like-series", other)


def check_refusals(run, random_numbers):
    samples = random_numbers.integers(0, 120, DIMS).astype("i2")
    affine = np.diag([2.0, 1.5, 3.0, 1])
    at = lambda z: {(0x20, 0x32): (b"DS", decimals([0, 0, z]))}
    wide = struct.pack("<H", DIMS[0] + 1)
    only = lambda facts: lambda k: facts if k == 2 else {}
    cases = {
        "a slice is missing": lambda k: at(3 * k + (3 if k > 2 else 0)),
        "lies where": lambda k: at(3 * (k // 2)),
        "orientation differs": only({(0x20, 0x37): (b"DS", "1\\0\\0\\0\\0\\1")}),
        "number of rows or columns": only({(0x28, 0x11): (b"US", wide)}),
        "pixel spacing differs": only({(0x28, 0x30): (b"DS", "1\\1")}),
        "has no ImagePositionPatient": only({(0x20, 0x32): None}),
        "not two perpendicular": lambda k: {(0x20, 0x37): (b"DS", "1\\0\\0\\1\\0\\0")},
        "a slope of 0": only({(0x28, 0x1053): (b"DS", "0")}),
        "PhotometricInterpretation": lambda k: {(0x28, 4): (b"CS", "PALETTE COLOR")},
        "'PALETTE COLOR' differs": only({(0x28, 4): (b"CS", "PALETTE COLOR")}),
        "'MONOCHROME1' differs": only({(0x28, 4): (b"CS", "MONOCHROME1")}),
        "frames": only({(0x28, 8): (b"IS", "3")}),
        "PixelData": only({(0x7FE0, 0x10): (b"OW", b"1234")}),
    }
    for phrase, more in cases.items():
        write_series(folder_of(run, "bad"), samples, affine, more)
        line = run.refused("import", "bad", "-o", "out.vtkhdf")
        if phrase not in line:
            sys.exit(f"expected '{phrase}': {line}")
    os.makedirs(folder_of(run, "empty"))
    if "holds no DICOM image" not in run.refused("import", "empty", "-o", "out.vtkhdf"):
        sys.exit("an empty folder")
    write_series(folder_of(run, "bad"), samples, affine)
    with open(run.path("bad/002.dcm"), "rb") as file:
        whole = file.read()
    for seed in range(4):  # damaged files give a volume or one line
        source = random.Random(seed)
        data = bytearray(whole[: source.randrange(100, len(whole))] if seed % 2 else whole)
        for _ in range(8):
            data[source.randrange(len(data))] = source.randrange(256)
        with open(run.path("bad/002.dcm"), "wb") as file:
            file.write(data)
        run.refused("import", "bad", "-o", "out.vtkhdf", may_succeed=True)


def vti_arrays(path):
    reader = vtk.vtkXMLImageDataReader()
    reader.SetFileName(path)
    reader.Update()
    image = reader.GetOutput()
    data = image.GetPointData()
    found = {}
    for n in range(data.GetNumberOfArrays()):
        array = numpy_support.vtk_to_numpy(data.GetArray(n))
        shape = image.GetDimensions()[::-1] + array.shape[1:]
        found[data.GetArrayName(n)] = np.transpose(array.reshape(shape), (2, 1, 0, 3)[: len(shape)])
    affine = np.eye(4)
    direction = image.GetDirectionMatrix()
    for i, j in itertools.product(range(3), repeat=2):
        affine[i, j] = direction.GetElement(i, j) * image.GetSpacing()[j]
    affine[:3, 3] = image.GetOrigin()
    return found, affine


def write_vti(path, samples, affine, compressor):
    image = vtk.vtkImageData()
    image.SetExtent(2, 1 + samples.shape[0], 0, samples.shape[1] - 1, -1, samples.shape[2] - 2)
    spacing = np.linalg.norm(affine[:3, :3], axis=0)
    image.SetSpacing(*spacing)
    image.SetDirectionMatrix(*(affine[:3, :3] / spacing).ravel())
    image.SetOrigin(*(affine[:3, 3] - affine[:3, :3] @ (2, 0, -1)))
    flat = np.ascontiguousarray(np.transpose(samples, (2, 1, 0))).ravel()
    array = numpy_support.numpy_to_vtk(flat, deep=True)
    array.SetName("density 2")
    bits = vtk.vtkBitArray()
    bits.SetName("mask")
    for value in flat:
        bits.InsertNextValue(int(value > 60))
    words = vtk.vtkStringArray()
    words.SetName("words")
    words.SetNumberOfValues(len(flat))
    for one in (bits, array, words):
        image.GetPointData().AddArray(one)
    image.GetPointData().SetActiveScalars("density 2")
    writer = vtk.vtkXMLImageDataWriter()
    writer.SetFileName(path)
    writer.SetInputData(image)
    writer.SetCompressorType(compressor)
    writer.SetDataMode(compressor % 3)  # ASCII, binary, appended
    writer.Write()


def check_vti(run, random_numbers):
    if not vtk:
        return
    for n, affine in enumerate(itertools.islice(orientations(), 0, None, 13)):
        samples = random_numbers.integers(0, 120, DIMS).astype(("i2", "f4", "u1", "f8", "u4", "i1")[n % 6])
        write_vti(run.path("a.vti"), samples, affine, n % 4)
        run("import", "a.vti", "-o", "a.vtkhdf")
        run("export", "a.vtkhdf", "--array", "density 2", "-o", "a.nii")
        expect(f".vti {n}", read_nifti(run.path("a.nii")), (samples, affine))
        run("export", "a.vti", "--array", "mask", "-o", "mask.nii")
        expect(f"bits {n}", read_nifti(run.path("mask.nii")), ((samples > 60).astype("u1"), affine))
        if "PointData/words" not in run("info", "a.vti"):
            sys.exit("the array of texts is not named")
        if n > 0:
            continue
        run("mesh", "a.vti", "--array", "mask", "-o", "m.vtkhdf", "--cells", "3", "--threshold", "-1")
        run("deform", "m.vtkhdf", "-o", "moved.vtkhdf", "--kind", "rotate", "--amount", "0", "--steps", "1")
        run("warp", "a.vti", "moved.vtkhdf", "-o", "w.vti", "--outputs", "mask", "--filter", "nearest")
        found, place = vti_arrays(run.path("w.vti"))
        if sorted(found) != ["density 2", "mask", "tetwarp_mask"]:
            sys.exit(f"arrays of w.vti: {sorted(found)}")
        for name, wanted in (("density 2", samples), ("mask", (samples > 60).astype("u1")),
                             ("tetwarp_mask", np.ones(DIMS, "u1"))):
            expect(f"{name} in w.vti", (found[name], place), (wanted, affine))
        run("export", "w.vti", "--array", "density 2", "-o", "back.nii")
        expect("w.vti again", read_nifti(run.path("back.nii")), (samples, affine))
    with open(run.path("a.vti"), "rb") as file:
        whole = file.read()
    for length in (0, 30, 200, len(whole) // 2):
        with open(run.path("bad.vti"), "wb") as file:
            file.write(whole[:length])
        run.refused("export", "bad.vti", "-o", "out.nii")
    run("deform", "m.vtkhdf", "-o", "two.vtkhdf", "--kind", "swim", "--steps", "2")
    run.refused("warp", "a.vti", "two.vtkhdf", "--array", "mask", "--temporal", "-o", "out.vti")


def main():
    command, every = arguments(__doc__)
    random_numbers = np.random.default_rng(5)
    with tempfile.TemporaryDirectory() as folder:
        run = Command(command, folder)
        check_vti(run, random_numbers)
        if "libgdcm-dev" in run.refused("import", ".", "-o", "out.vtkhdf"):
            print("skipped: built without GDCM (libgdcm-dev)")
            sys.exit(77)
        check_orientations(run, random_numbers, every)
        check_values(run, random_numbers)
        check_places(run, random_numbers)
        check_enhanced(run, random_numbers)
        check_packed(run, random_numbers)
        check_series(run, random_numbers)
        check_refusals(run, random_numbers)
    print("DICOM series of any orientation, values, places, series and refusals; .vti images")


if __name__ == "__main__":
    main()
