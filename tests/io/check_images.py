"""Compares NRRD files, MetaImages and images of FreeSurfer with NumPy, SimpleITK and nibabel.

Usage: check_images.py COMMAND [EVERY]

Images of all 48 orientations (of every EVERYth of them) are written here byte by byte in each
format, exported to NIfTI by the command and compared; the command writes each format from NIfTI,
which is parsed here. Where SimpleITK is installed, it reads what the command writes and the command
what it writes; so does nibabel with .mgh and .mgz. So are images of two axes. Series are compared step by step. Damaged files
must be refused in one line. Exits 77 when NumPy is missing, 1 when something differs.
"""
import gzip
import itertools
import struct
import sys
import tempfile
import zlib

from check_transforms import LPS, Command, arguments, np, orientations, sitk, write_nifti

try:
    import nibabel
except ImportError:
    nibabel = None
    print("nibabel is not installed: its images are not compared")

DIMS = (6, 5, 4)
NRRD_TYPES = {"u1": "uchar", "i1": "int8", "u2": "unsigned short", "i2": "short", "u4": "uint",
              "i4": "int", "f4": "float", "f8": "double"}
META_TYPES = {"u1": "MET_UCHAR", "i1": "MET_CHAR", "u2": "MET_USHORT", "i2": "MET_SHORT",
              "u4": "MET_UINT", "i4": "MET_INT", "f4": "MET_FLOAT", "f8": "MET_DOUBLE"}
NIFTI_TYPES = {2: "u1", 256: "i1", 512: "u2", 4: "i2", 768: "u4", 8: "i4", 16: "f4", 64: "f8"}


def bytes_of(samples, big):
    """[i][j][k] or [i][j][k][c] in the order of the formats."""
    kind = samples.dtype.newbyteorder(">" if big else "<")
    axes = (2, 1, 0, 3)[: samples.ndim]
    return np.transpose(samples, axes).astype(kind).tobytes()


def write_nrrd(path, samples, affine, packed=False, big=False, space="left-posterior-superior"):
    turn = LPS if space.startswith("left-posterior") else np.eye(3)
    vectors = turn @ affine[:3, :3]
    components = samples.shape[3:]
    sizes = " ".join(str(n) for n in components + samples.shape[:3])
    axes = ["none"] * len(components) + ["(%r,%r,%r)" % tuple(vectors[:, a].tolist()) for a in range(3)]
    origin = (turn @ affine[:3, 3]).tolist()
    header = (f"NRRD0005\n# a comment\ntype: {NRRD_TYPES[samples.dtype.str[1:]]}\n"
              f"dimension: {len(axes)}\nspace: {space}\nsizes: {sizes}\n"
              f"space directions: {' '.join(axes)}\n"
              f"kinds: {'vector ' * len(components)}domain domain domain\n"
              f"endian: {'big' if big else 'little'}\nencoding: {'gzip' if packed else 'raw'}\n"
              f"space origin: ({origin[0]!r},{origin[1]!r},{origin[2]!r})\nmodality:=CT\n\n")
    data = bytes_of(samples, big)
    with open(path, "wb") as file:
        file.write(header.encode() + (gzip.compress(data) if packed else data))


def write_meta(path, samples, affine, packed=False, big=False, raw=None):
    matrix = LPS @ affine[:3, :3]
    spacing = np.linalg.norm(matrix, axis=0)
    data = bytes_of(samples, big)
    data = zlib.compress(data) if packed else data
    lines = ["ObjectType = Image", "NDims = 3", "BinaryData = True",
             f"BinaryDataByteOrderMSB = {big}", f"CompressedData = {packed}",
             "TransformMatrix = " + " ".join(repr(float(x)) for x in (matrix / spacing).T.ravel()),
             "Offset = " + " ".join(repr(float(x)) for x in LPS @ affine[:3, 3]),
             "CenterOfRotation = 0 0 0", "AnatomicalOrientation = RAI",
             "ElementSpacing = " + " ".join(repr(float(x)) for x in spacing),
             "DimSize = " + " ".join(str(n) for n in samples.shape[:3])]
    if samples.ndim == 4:
        lines.append(f"ElementNumberOfChannels = {samples.shape[3]}")
    lines += [f"ElementType = {META_TYPES[samples.dtype.str[1:]]}",
              f"ElementDataFile = {raw.rsplit('/', 1)[-1] if raw else 'LOCAL'}"]
    with open(path, "wb") as file:
        file.write(("\n".join(lines) + "\n").encode() + (b"" if raw else data))
    if raw:
        with open(raw, "wb") as file:
            file.write(data)


def read_nifti(path):
    """Samples [i][j][k] or [i][j][k][c], and the affine map of the sform."""
    with open(path, "rb") as file:
        data = file.read()
    dim = struct.unpack_from("<8h", data, 40)
    kind = NIFTI_TYPES[struct.unpack_from("<h", data, 70)[0]]
    offset = int(struct.unpack_from("<f", data, 108)[0])
    affine = np.eye(4)
    affine[:3] = np.array(struct.unpack_from("<12f", data, 280)).reshape(3, 4)
    samples = np.frombuffer(data, "<" + kind, offset=offset).reshape(dim[1 : dim[0] + 1], order="F")
    return samples[:, :, :, 0] if dim[0] == 5 else samples, affine


MGH_TYPES = {"u1": 0, "i4": 1, "f4": 3, "i2": 4, "u2": 10}


def write_mgh(path, samples, affine, packed=False):
    """[i][j][k] or, of a series, [i][j][k][step]."""
    spacing = np.linalg.norm(affine[:3, :3], axis=0)
    dims = samples.shape[:3]
    center = affine[:3, :3] @ (np.array(dims) / 2) + affine[:3, 3]
    steps = samples.shape[3] if samples.ndim == 4 else 1
    header = struct.pack(">7ih15f", 1, *dims, steps, MGH_TYPES[samples.dtype.str[1:]], 0, 1, *spacing,
                         *(affine[:3, :3] / spacing).T.ravel(), *center)
    data = header.ljust(284, b"\0") + samples.astype(samples.dtype.newbyteorder(">")).tobytes(order="F")
    with open(path, "wb") as file:
        file.write(gzip.compress(data) if packed else data)


def parse_mgh(path):
    with open(path, "rb") as file:
        data = file.read()
    data = gzip.decompress(data) if data.startswith(b"\x1f\x8b") else data
    numbers = struct.unpack_from(">7ih15f", data)
    assert numbers[0] == 1 and numbers[7] == 1
    kind = {v: k for k, v in MGH_TYPES.items()}[numbers[5]]
    shape = numbers[1:4] + ((numbers[4],) if numbers[4] > 1 else ())
    samples = np.frombuffer(data, ">" + kind, offset=284).reshape(shape, order="F").astype(kind)
    affine = np.eye(4)
    affine[:3, :3] = np.array(numbers[11:20]).reshape(3, 3).T * numbers[8:11]
    affine[:3, 3] = np.array(numbers[20:23]) - affine[:3, :3] @ (np.array(numbers[1:4]) / 2)
    return samples, affine


def check_mgh(run, random, every):
    kinds = itertools.cycle(MGH_TYPES)
    for n, affine in enumerate(itertools.islice(orientations(), 0, None, every)):
        samples = random.integers(0, 100, DIMS).astype(next(kinds))
        for name in ("a.mgh", "a.mgz"):
            write_mgh(run.path(name), samples, affine, name == "a.mgz")
            run("export", name, "-o", "out.nii")
            expect(f"{name}, orientation {n}", read_nifti(run.path("out.nii")), (samples, affine))
            run("export", "out.nii", "-o", "w" + name)
            expect(f"{name} written", parse_mgh(run.path("w" + name)), (samples, affine))
            if not nibabel:
                continue
            image = nibabel.load(run.path("w" + name))
            expect(f"{name} by nibabel", (np.asarray(image.dataobj), image.affine), (samples, affine))
            nibabel.save(nibabel.MGHImage(samples, affine), run.path("n" + name))
            run("export", "n" + name, "-o", "out.nii")
            expect(f"{name} of nibabel", read_nifti(run.path("out.nii")), (samples, affine))


def read_series(path):
    """Steps of a NIfTI file, and their interval."""
    with open(path, "rb") as file:
        data = file.read()
    dim = struct.unpack_from("<8h", data, 40)
    kind = NIFTI_TYPES[struct.unpack_from("<h", data, 70)[0]]
    offset = int(struct.unpack_from("<f", data, 108)[0])
    assert dim[0] == 4, dim
    return (np.frombuffer(data, "<" + kind, offset=offset).reshape(dim[1:5], order="F"),
            struct.unpack_from("<f", data, 76 + 16)[0])


def check_series(run, random):
    """Four axes in every format, there and back; SimpleITK reads and writes 4D MetaImages and NRRD."""
    steps, interval = 3, 0.5
    samples = random.integers(0, 100, DIMS + (steps,)).astype("i2")
    for affine in itertools.islice(orientations(), 0, None, 9):
        write_mgh(run.path("s.mgz"), samples, affine, True)
        run("export", "s.mgz", "--temporal", "-o", "s.nii")
        if not np.array_equal(read_series(run.path("s.nii"))[0], samples):
            sys.exit("frames of FreeSurfer differ")
        with open(run.path("s.nii"), "r+b") as file:
            file.seek(76 + 16)
            file.write(struct.pack("<f", interval))
            file.seek(123)
            file.write(struct.pack("<B", 2 + 8))
        for name in ("t.nrrd", "t.mha", "t.mhd", "t.mgz"):
            run("export", "s.nii", "--temporal", "-o", name)
            run("export", name, "--temporal", "-o", "back.nii")
            found, between = read_series(run.path("back.nii"))
            if not np.array_equal(found, samples):
                sys.exit(f"{name}: steps differ")
            if name != "t.mgz" and abs(between - interval) > 1e-6:
                sys.exit(f"{name}: interval {between}")
            if nibabel and name == "t.mgz":
                if not np.array_equal(np.asarray(nibabel.load(run.path(name)).dataobj), samples):
                    sys.exit("nibabel reads other frames")
            if sitk and name != "t.mgz":
                image = sitk.ReadImage(run.path(name))
                if image.GetDimension() == 4:
                    found = np.transpose(sitk.GetArrayFromImage(image), (3, 2, 1, 0))
                else:  # ITK takes the last axis of NRRD for components
                    found = np.transpose(sitk.GetArrayFromImage(image), (2, 1, 0, 3))
                if not np.array_equal(found, samples):
                    sys.exit(f"{name}: SimpleITK reads other steps")
        if sitk:
            image = sitk.ReadImage(run.path("t.mha"))
            sitk.WriteImage(image, run.path("i.mha"))
            run("export", "i.mha", "--temporal", "-o", "back.nii")
            found, between = read_series(run.path("back.nii"))
            if not np.array_equal(found, samples) or abs(between - interval) > 1e-6:
                sys.exit("steps of SimpleITK differ")


def parse(path):
    """What the command wrote: samples and the affine map to RAS."""
    with open(path, "rb") as file:
        data = file.read()
    is_nrrd = data.startswith(b"NRRD")
    end = data.index(b"\n\n") + 2 if is_nrrd else data.index(b"LOCAL\n") + 6
    lines = data[:end].decode().splitlines()
    fields = dict(line.split(": " if is_nrrd else " = ", 1) for line in lines
                  if (": " if is_nrrd else " = ") in line)
    affine = np.eye(4)
    if is_nrrd:
        sizes = [int(n) for n in fields["sizes"].split()]
        vectors = [v for v in fields["space directions"].split() if v != "none"]
        matrix = np.array([[float(x) for x in v.strip("()").split(",")] for v in vectors]).T
        origin = [float(x) for x in fields["space origin"].strip("()").split(",")]
        kind = {v: k for k, v in NRRD_TYPES.items()} | {"uint8": "u1", "uint16": "u2", "int16": "i2",
                                                       "uint32": "u4", "int32": "i4"}
        dtype, packed = kind[fields["type"]], fields["encoding"] == "gzip"
        shape = sizes[::-1]
    else:
        numbers = lambda key: np.array([float(x) for x in fields[key].split()])
        matrix = numbers("TransformMatrix").reshape(3, 3).T * numbers("ElementSpacing")
        origin = numbers("Offset")
        dtype = {v: k for k, v in META_TYPES.items()}[fields["ElementType"]]
        packed = fields["CompressedData"] == "True"
        shape = [int(n) for n in fields["DimSize"].split()][::-1]
        if "ElementNumberOfChannels" in fields:
            shape.append(int(fields["ElementNumberOfChannels"]))
    affine[:3, :3], affine[:3, 3] = LPS @ matrix, LPS @ np.asarray(origin)
    body = data[end:]
    if packed:
        body = gzip.decompress(body) if is_nrrd else zlib.decompress(body)
    samples = np.frombuffer(body, "<" + dtype).reshape(shape)
    return np.transpose(samples, (2, 1, 0, 3)[: samples.ndim]), affine


def expect(what, found, expected):
    (samples, affine), (other, wanted) = found, expected
    if samples.shape != other.shape or not np.array_equal(samples, other):
        sys.exit(f"{what}: other samples")
    if not np.allclose(affine, wanted, rtol=0, atol=1e-5):
        sys.exit(f"{what}: affine map\n{affine}\nexpected\n{wanted}")


def check_orientations(run, random, every):
    kinds = itertools.cycle(NRRD_TYPES)
    for n, affine in enumerate(itertools.islice(orientations(), 0, None, every)):
        kind, shape = next(kinds), DIMS + ((3,) if n % 3 == 0 else ())
        samples = random.integers(0, 100, shape).astype(kind)
        packed, big = n % 2 == 1, n % 5 == 0
        write_nrrd(run.path("a.nrrd"), samples, affine, packed, big)
        write_nrrd(run.path("b.nrrd"), samples, affine, packed, big, "right-anterior-superior")
        write_meta(run.path("a.mha"), samples, affine, packed, big)
        write_meta(run.path("a.mhd"), samples, affine, False, big, run.path("a.raw"))
        for name in ("a.nrrd", "b.nrrd", "a.mha", "a.mhd"):
            run("export", name, "-o", "out.nii")
            expect(f"{name}, orientation {n}", read_nifti(run.path("out.nii")), (samples, affine))
            for written in ("w.nrrd", "w.mha", "w.mhd"):
                run("export", name, "-o", written)
                if written != "w.mhd":
                    expect(f"{name} to {written}", parse(run.path(written)), (samples, affine))
                if sitk:
                    image = sitk.ReadImage(run.path(written))
                    array = sitk.GetArrayFromImage(image)
                    found = np.transpose(array, (2, 1, 0, 3)[: array.ndim])
                    matrix = np.eye(4)
                    direction = np.array(image.GetDirection()).reshape(3, 3)
                    matrix[:3, :3] = LPS @ (direction * np.array(image.GetSpacing()))
                    matrix[:3, 3] = LPS @ np.array(image.GetOrigin())
                    expect(f"{written} by SimpleITK", (found, matrix), (samples, affine))
        if sitk and samples.ndim == 3:
            image = sitk.ReadImage(run.path("w.mha"))
            for name in ("s.nrrd", "s.mha", "s.mhd"):
                sitk.WriteImage(image, run.path(name), useCompression=packed)
                run("export", name, "-o", "out.nii")
                expect(f"{name} of SimpleITK", read_nifti(run.path("out.nii")), (samples, affine))


def check_flat(run, random):
    """Images of two axes are a slice at 0, along ITK's first two axes."""
    spacing, origin = np.array([1.3, 0.8]), np.array([-5.0, 7.0])
    for n, (angle, flip) in enumerate(((0.0, 1), (0.4, 1), (-0.7, -1))):
        c, s = np.cos(angle), np.sin(angle)
        axes = np.array([[c, -s * flip], [s, c * flip]])  # columns, along LPS
        affine = np.eye(4)
        affine[:2, :2], affine[:2, 3] = -axes * spacing, -origin
        samples = random.integers(0, 100, DIMS[:2] + (1,) + ((3,) if n == 1 else ())).astype("u1")
        data = bytes_of(samples, False)
        numbers = lambda values: " ".join(repr(float(x)) for x in np.ravel(values))
        steps = ["(" + numbers(step).replace(" ", ",") + ")" for step in (axes * spacing).T]
        first = ("3 ", "none ", "vector ") if n == 1 else ("", "", "")
        with open(run.path("flat.nrrd"), "wb") as file:
            file.write((f"NRRD0004\ntype: uchar\ndimension: {3 if n == 1 else 2}\nspace dimension: 2\n"
                        f"sizes: {first[0]}{DIMS[0]} {DIMS[1]}\nspace directions: {first[1]}{' '.join(steps)}\n"
                        f"kinds: {first[2]}domain domain\nencoding: raw\n"
                        f"space origin: ({numbers(origin).replace(' ', ',')})\n\n").encode() + data)
        with open(run.path("flat.mha"), "wb") as file:
            file.write(("ObjectType = Image\nNDims = 2\nBinaryData = True\nBinaryDataByteOrderMSB = False\n"
                        f"TransformMatrix = {numbers(axes.T)}\nOffset = {numbers(origin)}\n"
                        f"ElementSpacing = {numbers(spacing)}\nDimSize = {DIMS[0]} {DIMS[1]}\n"
                        f"ElementNumberOfChannels = {samples.size // (DIMS[0] * DIMS[1])}\n"
                        "ElementType = MET_UCHAR\nElementDataFile = LOCAL\n").encode() + data)
        for name in ("flat.nrrd", "flat.mha"):
            names = [name]
            if sitk:
                image = sitk.ReadImage(run.path(name))
                there = np.array(image.TransformIndexToPhysicalPoint((2, 3)))
                expect(f"{name} by SimpleITK", (sitk.GetArrayFromImage(image).ravel(), -there),
                       (samples.reshape(DIMS[:2] + samples.shape[3:]).swapaxes(0, 1).ravel(),
                        (affine @ (2, 3, 0, 1))[:2]))
                sitk.WriteImage(image, run.path("itk_" + name))
                names.append("itk_" + name)
            for written in names:
                run("export", written, "-o", "out.nii")
                found, matrix = read_nifti(run.path("out.nii"))
                expect(written, (found.reshape(samples.shape), matrix), (samples, affine))


def check_warps(run, random):
    """Blocks of packed files, packed outputs, fields."""
    affine = next(itertools.islice(orientations(), 11, None))
    samples = random.uniform(0, 9, DIMS).astype("f4")
    write_nrrd(run.path("a.nrrd"), samples, affine, True)
    write_nifti(run.path("a.nii"), samples, affine)
    vectors = random.uniform(-1, 1, DIMS + (3,)).astype("f4")
    write_nifti(run.path("field.nii"), vectors @ LPS.astype("f4"), affine, intent=1007)
    write_meta(run.path("field.mha"), vectors @ LPS.astype("f4"), affine)
    run("warp", "a.nii", "field.nii", "-o", "expected.nii")
    expected = read_nifti(run.path("expected.nii"))
    for field, output in itertools.product(("field.mha", "field.nii"), ("o.nrrd", "o.mha")):
        run("warp", "a.nrrd", field, "-o", output, "--compress", "3")
        expect(f"warp to {output}", parse(run.path(output)), expected)
    run("compose", "field.mha", "-o", "joined.mha", "--like", "a.nrrd")
    run("warp", "a.nrrd", "joined.mha", "-o", "o.nrrd")
    if np.abs(parse(run.path("o.nrrd"))[0] - expected[0]).max() > 1e-4:
        sys.exit("the composed field differs")
    run("mesh", "a.nrrd", "-o", "mesh.vtkhdf", "--cells", "2")
    run("deform", "mesh.vtkhdf", "-o", "moving.vtkhdf", "--steps", "1", "--amount", "0.3")
    run("warp", "a.nii", "moving.vtkhdf", "-o", "expected.nii")
    run("warp", "a.nrrd", "moving.vtkhdf", "-o", "o.mha")
    expect("warp by a mesh", parse(run.path("o.mha")), read_nifti(run.path("expected.nii")))


def check_refusals(run, random):
    samples = random.integers(0, 100, DIMS).astype("i2")
    affine = next(orientations())
    for name, write in ("a.nrrd", write_nrrd), ("a.mha", write_meta):
        for packed in (False, True):
            write(run.path(name), samples, affine, packed)
            with open(run.path(name), "rb") as file:
                data = file.read()
            for length in (20, 150, len(data) - 40):
                with open(run.path("bad" + name[1:]), "wb") as file:
                    file.write(data[:length])
                run.refused("export", "bad" + name[1:], "-o", "out.nii")
            for old, new in ((b"sizes: 6", b"sizes: 9999999"), (b"DimSize = 6", b"DimSize = 999999999"),
                             (b"type: short", b"type: block"), (b"MET_SHORT", b"MET_OTHER"),
                             (b"encoding: ", b"encoding: hex"), (b"left-posterior", b"scanner"),
                             (b"Offset = ", b"Offset = x "), (b"space origin: (", b"space origin: (a")):
                if old not in data:
                    continue
                with open(run.path("bad" + name[1:]), "wb") as file:
                    file.write(data.replace(old, new))
                run.refused("export", "bad" + name[1:], "-o", "out.nii")


def main():
    command, every = arguments(__doc__)
    random = np.random.default_rng(5)
    with tempfile.TemporaryDirectory() as folder:
        run = Command(command, folder)
        check_orientations(run, random, every)
        check_mgh(run, random, every)
        check_series(run, random)
        check_flat(run, random)
        check_warps(run, random)
        check_refusals(run, random)
    print("orientations of NRRD, MetaImage and FreeSurfer, warps and refusals")


if __name__ == "__main__":
    main()
