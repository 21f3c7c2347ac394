"""The scenes that ship, through the command: what a step costs and does, beside the paper's numbers, and
how results converge with finer meshes and shorter steps.

    python3 bench/simulate/scenes.py build/release/tetwarp RESULTS.json [--only NAME]... [--steps N]

measures the rows whose names begin with a NAME, or all, puts them into RESULTS.json, whose other rows are
kept, and prints all as tables. Runs take one thread, that of the whole candy two; times are processor times
of the whole command, so that other work on the machine changes them little. --steps ends runs early, but those of a number of their own.
Needs h5py.
"""
import argparse
import datetime
import glob
import json
import math
import os
import platform
import resource
import subprocess
import sys
import tempfile

import h5py
import numpy as np

COARSE_CANDY = [('"triangles": 5000', '"triangles": 800'), ('"triangles": 1280', '"triangles": 200'),
                ('"triangles": 320', '"triangles": 80'), ('"cells": [12, 12, 4]', '"cells": [6, 6, 2]'),
                ('"tets": 475', '"tets": 90')]
PAPER = {"candy": "151, 531", "candy without adhesion": "97, 330", "shoulder": "65, 153"}
PAPERS_LAWS = ["--law", "pyramid", "--rule", "restrictive"]
STAGES = ("forces", "assembly", "linear", "detection", "contact", "update")
FREE = ["--no-adhesion"]
STEEP = 9.81 * math.sin(math.radians(20))  # m/s^2
PLATES = os.path.join(os.path.dirname(os.path.abspath(__file__)), "shoulder_plates.json")
FINE_STRIP = [('"cells": [40, 4]', '"cells": [90, 2]'), ('"stretch": 4000, "shear": 800', '"stretch": 40000, "shear": 8000'),
              ('"energy": 2', '"energy": 1.5')]


def text_of(tool, name):
    return subprocess.run([tool, "simulate", "--scene", name, "--print"], check=True, capture_output=True,
                          text=True).stdout


def changed(text, replacements):
    for old, new in replacements:
        if old not in text:
            raise SystemExit(f"the scene no longer holds {old}")
        text = text.replace(old, new)
    return json.loads(text)


def refined(scene, factor):
    """Cells along edges times a factor: of lattices, sheets and surfaces."""
    for body in scene["bodies"]:
        lattice, sheet = body.get("lattice", {}), body.get("sheet", {})
        for of in (lattice, sheet):
            if "cells" in of:
                of["cells"] = [max(1, round(factor * n)) for n in of["cells"]]
        if "tets" in lattice:
            lattice["tets"] = round(factor**3 * lattice["tets"])
        if "edge" in lattice:
            lattice["edge"] /= factor
        if "triangles" in body.get("surface", {}):
            body["surface"]["triangles"] = round(factor**2 * body["surface"]["triangles"])
    return scene


def rolling(text, time_step, triangles):
    """One stiff orange at rest on the slope, for 0.8 s."""
    scene = changed(text, [("[198, 199, 160]", "[66, 66, 54]"),
                           ("[0.0004, 0.0004, 0.0005]", "[0.0012, 0.0012, 0.0015]")])
    body = scene["bodies"][0]
    body["transfer"] = [{"value": 0, "E": 1e7, "nu": 0.4, "density": 1000}]
    body["surface"] = {"triangles": triangles}
    body["pose"] = {"position": [0, 0, 0.0388]}
    scene.update(bodies=[body], time_step=time_step, duration=0.8)
    return scene


def rolling_ball(time_step, points, tets):
    """An elastic ball of 8 cm with E = 1e6 Pa on a slope of 20 degrees, for 0.5 s."""
    body = {"name": "ball", "kind": "fem", "shape": {"type": "sphere", "radius": 0.04}, "lattice": {"tets": tets},
            "surface": {"triangles": 2 * points}, "material": {"E": 1e6, "nu": 0.4, "density": 1000},
            "pose": {"position": [0, 0, 0.0402]}}
    return {"tetwarp_scene": 1, "time_step": time_step, "duration": 0.5, "thickness": 1e-4,
            "gravity": [STEEP, 0, -9.81 * math.cos(math.radians(20))], "contact": {"friction": 0.6},
            "solver": {"contact_tolerance": 1e-6, "linear_tolerance": 1e-8}, "bodies": [body],
            "obstacles": [{"name": "floor", "plane": {"normal": [0, 0, 1]}}]}


def finely_covered(text, factor):
    """Surfaces of more triangles on the same lattices; of rigid bodies at most twice as many, as the humerus and
    the tendon of the biceps would intersect."""
    scene = json.loads(text)
    for body in scene["bodies"]:
        if "triangles" in body.get("surface", {}):
            body["surface"]["triangles"] *= factor if body["kind"] == "fem" else min(factor, 2)
    return scene


def pushing_counts(path):
    """Numbers of contacts that carry an impulse, of each output."""
    with h5py.File(path, "r") as file:
        group = file["VTKHDF"]
        carries = np.linalg.norm(group["PointData/impulse"][()], axis=1) > 0
        starts = group["Steps/PointOffsets"][()]
    return np.array([part.sum() for part in np.split(carries, starts[1:])])


def sum_of_density(path):
    """Of the voxels that the mesh covers, over the volume of a voxel's grid."""
    with h5py.File(path, "r") as file:
        group = file["VTKHDF"]
        mask = group["PointData/tetwarp_mask"][()] > 0
        name = next(name for name in group["PointData"] if not name.startswith("tetwarp_"))
        return float(group["PointData"][name][()][mask].sum(dtype=np.float64) * np.prod(group.attrs["Spacing"]))


def largest_change(folder):
    """Of the sum of density of any body from its first frame on, over this sum."""
    firsts = glob.glob(os.path.join(folder, "*.warped_0000.vtkhdf"))
    if not firsts:
        raise SystemExit(f"{folder}: expected warped volumes of frames, *.warped_0000.vtkhdf")
    change = 0
    for first in firsts:
        start = sum_of_density(first)
        later = set(glob.glob(first.replace("_0000.vtkhdf", "_*.vtkhdf"))) - {first}
        if not later:
            raise SystemExit(f"{first}: is the only frame of its body; nothing can change")
        change = max(change, *(abs(sum_of_density(path) / start - 1) for path in later))
    return change


def run(tool, scene, options, steps):
    """The columns of the series by name, the report, and the processor time [s]."""
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "scene.json")
        with open(path, "w", encoding="utf-8") as file:
            json.dump(scene, file)
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        words = [tool, "simulate", path, "-o", "out", "--quiet", "--contacts", "out/contacts.vtkhdf"]
        words += options + ([] if "--threads" in options else ["--threads", "1"])
        words += ["--steps", str(steps)] if steps and "--steps" not in options else []
        done = subprocess.run(words, capture_output=True, text=True, cwd=folder)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        if done.returncode not in (0, 3):  # 3: a step stayed above its tolerance
            raise SystemExit(done.stderr)
        columns = {}
        with h5py.File(os.path.join(folder, "out", "series.h5"), "r") as file:
            file.visititems(lambda name, item: columns.update({name: item[()]}) if isinstance(item, h5py.Dataset)
                            else None)
        columns["pushing"] = pushing_counts(os.path.join(folder, "out", "contacts.vtkhdf"))
        if "--warp" in options:
            columns["density"] = largest_change(os.path.join(folder, "out"))
        with open(os.path.join(folder, "out", "report.json"), encoding="utf-8") as file:
            report = json.load(file)
    seconds = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    return columns, report, seconds


def step_row(columns, report, seconds):
    """What steps cost and do."""
    steps = len(columns["time"]) - 1
    total = columns["energy/total"] - columns["energy/work"]
    whole = sum(columns[f"seconds/{stage}"].sum() for stage in STAGES) or 1
    setup = sum(report["timings"][part] for part in ("read", "setup", "write", "warp", "draw"))
    share = report["timings"]["step"] / (report["timings"]["step"] + setup)
    return {"steps": steps, "tetrahedra": sum(body["tetrahedra"] for body in report["bodies"].values()),
            "triangles": sum(body["triangles"] for body in report["bodies"].values()),
            "contacts": [float(columns["contacts"].mean()), int(columns["contacts"].max())],
            "pushing": [float(columns["pushing"].mean()), int(columns["pushing"].max())],
            "ms": 1e3 * seconds * share / steps,
            "shares": {stage: float(columns[f"seconds/{stage}"].sum() / whole) for stage in STAGES},
            "energy": [float(total[0]), float(total[-1]), float(np.diff(total).max())],
            "passes": [float(columns["contact_passes"][1:].mean()), int(columns["contact_passes"].max())],
            "sweeps": float(columns["sweeps"].mean()), "outer": float(columns["outer_iterations"].mean()),
            "divided": int((columns["substeps"] > 1).sum()),
            "clamped": int((columns["clamped_islands"] > 0).sum()),
            "unconverged": report["unconverged_steps"]}


def bond_row(columns, report, seconds):
    """When bodies touch and part, and what bonds in between."""
    row = step_row(columns, report, seconds)
    touching = columns["time"][columns["contacts"] > 0]
    bonded = columns["time"][columns["adhered_area"] > 0]
    row.update(first_contact=float(touching[0]) if len(touching) else None,
               last_bond=float(bonded[-1]) if len(bonded) else None,
               bonded_cm2=1e4 * float(columns["adhered_area"].max()), work=float(columns["energy/work"][-1]))
    return row


def close_row(columns, report, seconds):
    """What holds the lips when they are closed: at the end of the run."""
    row = bond_row(columns, report, seconds)
    row.update(closed_contacts=int(columns["contacts"][-1]), closed_cm2=1e4 * float(columns["adhered_area"][-1]))
    return row


def warp_row(columns, report, seconds):
    """Frames of all volumes a second of processor time, with the steps between them."""
    row = step_row(columns, report, seconds)
    timings = report["timings"]
    parts = sum(timings[part] for part in ("read", "setup", "step", "write", "warp", "draw"))
    busy = seconds * (timings["step"] + timings["warp"]) / parts
    row.update(frames=report["frames"], warp_ms=1e3 * seconds * timings["warp"] / parts / report["frames"],
               frames_a_second=report["frames"] / busy, density_change=columns["density"])
    return row


def roll_row(columns, report, seconds):
    """Acceleration down the slope over that of a solid ball, from the second half of the run."""
    row = step_row(columns, report, seconds)
    half = len(columns["time"]) // 2
    speed = columns["bodies/orange0/velocity"][half:, 0]
    row["acceleration"] = float(np.polyfit(columns["time"][half:], speed, 1)[0] / (5 / 7 * 0.51341616))
    return row


def steep_row(columns, report, seconds):
    """The same on the steep slope, from 0.1 to 0.5 s."""
    row = step_row(columns, report, seconds)
    early = np.searchsorted(columns["time"], 0.1)
    gain = columns["bodies/ball/velocity"][-1, 0] - columns["bodies/ball/velocity"][early, 0]
    row["acceleration"] = float(gain / (columns["time"][-1] - columns["time"][early]) / (5 / 7 * STEEP))
    return row


def cloth_on_floor(cells):
    """A square sheet of cells^2 cells just above the floor, which all its nodes touch."""
    sheet = {"size": [1, 1], "cells": [cells, cells], "origin": [0, 0, 2e-4]}
    return {"tetwarp_scene": 1, "time_step": 0.004, "duration": 0.02, "thickness": 1e-4, "contact": {"friction": 0.5},
            "obstacles": [{"name": "floor", "plane": {"normal": [0, 0, 1], "point": [0, 0, 0]}}],
            "bodies": [{"name": "cloth", "kind": "cloth", "sheet": sheet, "areal_density": 0.3, "stretch": 400, "shear": 80,
                        "bend": 2e-4, "self": False}]}


def cases(tool):
    """Name of a row, its scene, options and what is kept of it."""
    text = {name: text_of(tool, name) for name in
            ("cantilever", "chain", "sheet", "top", "carps", "torso", "oranges", "cloth", "cloth_peels", "peel", "mouth",
             "candy", "shoulder")}
    for name in ("cantilever", "chain", "sheet", "top", "carps", "torso", "oranges", "peel", "shoulder"):
        yield f"scene/{name}", json.loads(text[name]), [], step_row
    for factor in (2, 4):
        yield f"scene/shoulder, triangles x {factor}", finely_covered(text["shoulder"], factor), [], step_row
    for name in ("cloth", "cloth_peels", "mouth"):
        yield f"scene/{name}", json.loads(text[name]), [], bond_row
        yield f"scene/{name} without adhesion", json.loads(text[name]), FREE, bond_row
    candy = changed(text["candy"], COARSE_CANDY)
    candy["duration"] = 4
    yield "scene/candy", candy, [], bond_row
    yield "scene/candy without adhesion", candy, FREE, bond_row
    for name, scene in (("candy", candy), ("mouth", json.loads(text["mouth"]))):
        yield f"scene/{name} by the paper's laws", scene, PAPERS_LAWS, bond_row
        yield f"scene/{name} by the paper's laws without adhesion", scene, PAPERS_LAWS + FREE, bond_row
    with open(PLATES, encoding="utf-8") as file:
        yield "scene/shoulder of plates", json.load(file), [], step_row
    yield "scene/peel, 90 x 2 stiff cells", changed(text["peel"], FINE_STRIP), [], step_row
    yield "scene/cloth on a floor, 316 x 316 cells", cloth_on_floor(316), [], step_row
    yield "scene/candy, first 100 steps", json.loads(text["candy"]), ["--steps", "100"], step_row
    whole = json.loads(text["candy"])
    whole["output"] = {"rate": 5}
    yield "scene/candy whole", whole, ["--threads", "2"], bond_row
    yield "scene/candy whole without adhesion", whole, FREE + ["--threads", "2"], bond_row
    for name, steps in (("torso", 100), ("oranges", 50), ("carps", 10)):
        options = ["--warp", "--intensity", "density", "--outputs", "mask", "--steps", str(steps)]
        yield f"volumes/{name}", json.loads(text[name]), options, warp_row
    # The lips of coarser lattices cross.
    for name, factors in (("cloth", (0.5, 1, 2)), ("mouth", (1, 4 / 3, 5 / 3, 2))):
        for factor in factors:
            yield f"finer/{name} x {factor:.3g}", refined(json.loads(text[name]), factor), [], bond_row
    for factor in (1, 4 / 3, 5 / 3, 2):
        yield f"closing/mouth x {factor:.3g}", refined(json.loads(text["mouth"]), factor), ["--steps", "30"], close_row
    for time_step, triangles in ((4e-3, 3200), (2e-3, 3200), (1e-3, 3200), (2e-3, 800), (2e-3, 12800), (5e-4, 12800)):
        yield (f"roll/{1e3 * time_step:g} ms, {triangles // 2} points", rolling(text["oranges"], time_step, triangles), [],
               roll_row)
    for time_step, points, tets in ((2e-3, 400, 232), (2e-3, 1600, 232), (2e-3, 6400, 232), (5e-4, 6400, 232),
                                    (5e-4, 6400, 1800)):
        yield (f"steep/{1e3 * time_step:g} ms, {points} points, {tets} tetrahedra",
               rolling_ball(time_step, points, tets), [], steep_row)


def print_tables(rows):
    print("| scene | steps | tetrahedra | triangles | contacts, mean and most | that carry an impulse (outputs) | the paper | ms "
          "| forces, assembly, linear, detection, contact, update [%] | energy at start and end, largest gain [J] | passes, mean and most "
          "| steps with stopped groups, above tolerance |")
    print("|---" * 12 + "|")
    for name, row in rows.items():
        if name.startswith("scene/"):
            mean, most = row["contacts"]
            pushing = "" if most == 0 or "pushing" not in row else f"{row['pushing'][0]:.0f}, {row['pushing'][1]}"
            shares = ", ".join(f"{100 * row['shares'][stage]:.0f}" for stage in STAGES)
            energy = ", ".join(f"{number:.3g}" for number in row["energy"])
            print(f"| {name[6:]} | {row['steps']} | {row['tetrahedra']} | {row['triangles']} | {mean:.0f}, {most} | {pushing} "
                  f"| {PAPER.get(name[6:], '')} | {row['ms']:.2g} | {shares} | {energy} "
                  f"| {row['passes'][0]:.1f}, {row['passes'][1]} | {row['clamped']}, {row['unconverged']} |")
    print("\n| volumes | frames | a step [ms] | warps of a frame [ms] | frames a second | density's sum, largest change [%] |\n|---|---|---|---|---|---|")
    for name, row in rows.items():
        if name.startswith("volumes/"):
            print(f"| {name[8:]} | {row['frames']} | {row['ms']:.2g} | {row['warp_ms']:.3g} | {row['frames_a_second']:.2g} "
                  f"| {100 * row['density_change']:.2g} |")
    print("\n| | triangles | contacts, mean and most | first contact [s] | last bond [s] | bonded at most [cm^2] | work [mJ] | ms |")
    print("|---" * 8 + "|")
    for name, row in rows.items():
        if name.startswith("finer/"):
            mean, most = row["contacts"]
            last = "" if row["last_bond"] is None else f"{row['last_bond']:.3f}"
            print(f"| {name[6:]} | {row['triangles']} | {mean:.0f}, {most} | {row['first_contact']:.3f} | {last} "
                  f"| {row['bonded_cm2']:.4g} | {1e3 * row['work']:.3g} | {row['ms']:.2g} |")
    print("\n| | contacts when closed | bonded [cm^2] | work [mJ] |\n|---|---|---|---|")
    for name, row in rows.items():
        if name.startswith("closing/"):
            print(f"| {name[8:]} | {row['closed_contacts']} | {row['closed_cm2']:.3g} | {1e3 * row['work']:.3g} |")
    print("\n| time step, points | acceleration / (5/7 g sin) | steps with stopped groups | ms |\n|---|---|---|---|")
    for name, row in rows.items():
        if name.startswith("roll/"):
            print(f"| {name[5:]} | {row['acceleration']:.3f} | {row['clamped']} | {row['ms']:.2g} |")
    print("\n| time step, points, tetrahedra | acceleration / (5/7 g sin) | ms |\n|---|---|---|")
    for name, row in rows.items():
        if name.startswith("steep/"):
            print(f"| {name[6:]} | {row['acceleration']:.3f} | {row['ms']:.2g} |")


def processor():
    with open("/proc/cpuinfo", encoding="utf-8") as file:
        names = [line.split(":")[1].strip() for line in file if line.startswith("model name")]
    return names[0] if names else platform.machine()


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("tool")
    parser.add_argument("results")
    parser.add_argument("--only", action="append", default=[])
    parser.add_argument("--steps", type=int)
    arguments = parser.parse_args()
    rows = {}
    if os.path.exists(arguments.results):
        with open(arguments.results, encoding="utf-8") as file:
            rows = json.load(file)["rows"]
    tool = os.path.abspath(arguments.tool)
    for name, scene, options, row_of in cases(tool):
        if arguments.only and not name.startswith(tuple(arguments.only)):
            continue
        rows[name] = row_of(*run(tool, scene, options, arguments.steps))
        if "--threads" in options:
            rows[name]["threads"] = int(options[options.index("--threads") + 1])
        print(f"{name}: {rows[name]['ms']:.3g} ms a step", file=sys.stderr)
        version = subprocess.run([tool, "--version"], capture_output=True, text=True).stdout.strip()
        with open(arguments.results, "w", encoding="utf-8") as file:
            json.dump({"context": {"date": datetime.date.today().isoformat(), "processor": processor(),
                                   "version": version, "threads": 1}, "rows": rows}, file, indent=1)
            file.write("\n")
    print_tables(rows)


main()
