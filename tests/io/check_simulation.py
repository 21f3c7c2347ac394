"""Runs `tetwarp simulate` on small scenes and checks the folders with h5py: names, shapes, laws.

Usage: check_simulation.py COMMAND

Exits 77 when h5py is missing, 1 when a folder does not hold what docs/formats.md says.
"""
import json
import os
import subprocess
import sys
import tempfile

try:
    import h5py
    import numpy as np
except ImportError as error:
    print(f"skipped: {error}; the package is python3-h5py")
    sys.exit(77)

VECTORS = ["centre", "velocity", "angular_momentum", "contact_force", "support_force",
           "handle_force", "coupling_force", "load_force"]
COUNTS = ["contacts", "contact_passes", "substeps", "clamped_islands", "stalled_scripts",
          "inverted", "islands", "sleeping", "linear_iterations", "sweeps", "outer_iterations",
          "converged"]
NUMBERS = ["time", "energy/kinetic", "energy/elastic", "energy/gravity", "energy/adhesion",
           "energy/total", "energy/work", "contact_residual", "linear_residual", "adhered_area",
           *(f"seconds/{s}" for s in ("forces", "assembly", "linear", "detection", "contact",
                                      "update", "total"))]

SCENE = {
    "tetwarp_scene": 1, "time_step": 0.01, "duration": 0.2,
    "bodies": [
        {"name": "beam", "kind": "fem", "shape": {"type": "box", "half": [0.2, 0.05, 0.05]},
         "lattice": {"cells": [4, 1, 1]}, "material": {"E": 1e5, "nu": 0.3, "density": 1000},
         "fixed": [{"half_space": [-1, 0, 0, 0.19]}]},
        {"name": "ball", "kind": "rigid", "shape": {"type": "sphere", "radius": 0.1},
         "pose": {"position": [0, 0, 1]}, "density": 500, "angular_velocity": [0, 0, 3]},
        {"name": "flag", "kind": "cloth",
         "sheet": {"size": [0.4, 0.4], "cells": [4, 4], "origin": [0, 1, 0],
                   "axes": [[1, 0, 0], [0, 1, 0]]},
         "areal_density": 0.3, "stretch": 400, "shear": 80, "bend": 2e-4,
         "fixed": [{"box": [[-1, 0.99, -1], [1, 1.01, 1]]}]},
    ],
    "obstacles": [{"name": "floor", "plane": {"normal": [0, 0, 1], "point": [0, 0, -1]}}],
    "couplings": [{"name": "link", "a": "beam", "b": "ball", "points": [[0.2, 0, 0]],
                   "stiffness": 10}],
    "output": {"every": 5, "fields": ["velocity", "stress", "jacobian"]},
}


def run(command, folder, *words, code=0):
    done = subprocess.run([command, "simulate", *words], cwd=folder, capture_output=True,
                          text=True, check=False)
    assert done.returncode == code, f"exit {done.returncode}: {done.stderr}"
    return done


def check_series(path, scene, steps):
    bodies = {body["name"]: body["kind"] for body in scene["bodies"]}
    mass_gravity = scene.get("gravity", [0, 0, -9.81])
    with h5py.File(path, "r") as file:
        for name in NUMBERS:
            assert file[name].shape == (steps + 1,) and file[name].dtype == np.float64, name
            assert np.isfinite(file[name][()]).all(), name
        for name in COUNTS:
            assert file[name].shape == (steps + 1,) and file[name].dtype == np.int64, name
        for name in ("momentum", "angular_momentum"):
            assert file[name].shape == (steps + 1, 3), name
        time = file["time"][()]
        assert np.allclose(time, scene["time_step"] * np.arange(steps + 1), rtol=1e-14, atol=0)
        energy = file["energy"]
        parts = sum(energy[p][()] for p in ("kinetic", "elastic", "gravity", "adhesion"))
        assert np.allclose(energy["total"][()], parts, rtol=1e-12, atol=1e-14)
        for body, kind in bodies.items():
            group = file["bodies"][body]
            for name in VECTORS:
                assert group[name].shape == (steps + 1, 3), f"{body}/{name}"
                assert group[name].dtype == np.float64, f"{body}/{name}"
            for name in VECTORS[3:]:
                assert (group[name][0] == 0).all(), f"{body}/{name} at the start"
            if kind == "rigid":
                turns = group["rotation"][()]
                assert turns.shape == (steps + 1, 4) and (turns[:, 0] >= 0).all()
                assert np.allclose(np.linalg.norm(turns, axis=1), 1, atol=1e-12)
                assert group["angular_velocity"].shape == (steps + 1, 3)
        for obstacle in scene.get("obstacles", []):
            assert file["obstacles"][obstacle["name"]]["contact_force"].shape == (steps + 1, 3)
        for coupling in scene.get("couplings", []):
            assert file["couplings"][coupling["name"]]["force"].shape == (steps + 1, 3)
        masses = json.load(open(os.path.join(os.path.dirname(path), "report.json")))["bodies"]
        for body, kind in bodies.items():
            if kind == "scripted":
                continue
            group, mass = file["bodies"][body], masses[body]["mass"]
            force = sum(group[name][1:] for name in VECTORS[3:])
            change = mass * np.diff(group["velocity"][()], axis=0) / scene["time_step"]
            scale = mass * 9.81 + np.abs(force).max()
            defect = np.abs(change - mass * np.asarray(mass_gravity) - force).max() / scale
            assert defect < 1e-4, f"{body}: forces miss the change of momentum by {defect}"


def check_mesh(path, cell_type, frames, times, arrays):
    with h5py.File(path, "r") as file:
        root = file["VTKHDF"]
        assert list(root.attrs["Version"]) == [2, 0] and root.attrs["Type"] == b"UnstructuredGrid"
        points, cells = int(root["NumberOfPoints"][0]), int(root["NumberOfCells"][0])
        assert set(root["Types"][()]) == {cell_type}, path
        assert root["Points"].shape == (points, 3) and root["Points"].dtype == np.float64
        assert root["Connectivity"][()].max() < points
        steps = root["Steps"]
        assert steps.attrs["NSteps"] == frames
        assert np.array_equal(steps["Values"][()], times), f"{path}: other times"
        assert root["PointData/displacement"].dtype == np.float64
        for name, group, components in arrays:
            data = root[group][name][()]
            rows = points if group == "PointData" else cells
            expected = (frames * rows,) if components == 1 else (frames * rows, components)
            assert data.shape == expected, f"{path}: {name} {data.shape}"
            assert np.isfinite(data).all(), f"{path}: {name}"
            offsets = steps[f"{group}Offsets"][name][()]
            assert np.array_equal(offsets, rows * np.arange(frames))
        return root["Points"][()], root["PointData/displacement"][()].reshape(frames, points, 3)


def check_folder(folder, scene, steps):
    out = os.path.join(folder, "out")
    check_series(os.path.join(out, "series.h5"), scene, steps)
    frame_steps = np.arange(0, steps + 1, scene["output"]["every"])
    times = scene["time_step"] * frame_steps
    vector = ("displacement", "PointData", 3)
    velocity = ("velocity", "PointData", 3)
    cells = [("stress", "CellData", 1), ("jacobian", "CellData", 1)]
    for name, kind, arrays in (("beam", 10, [vector, velocity, *cells]),
                               ("beam.surface", 5, [vector]),
                               ("ball", 5, [vector, velocity]), ("ball.surface", 5, [vector]),
                               ("flag", 5, [vector, velocity])):
        points, moved = check_mesh(os.path.join(out, name + ".vtkhdf"), kind, len(times), times,
                                   arrays)
        if name == "beam":
            fixed = points[:, 0] < -0.19
            assert fixed.any() and (moved[:, fixed] == 0).all(), "a fixed node has moved"
        if name == "ball":
            assert np.allclose((points + moved[0]).mean(axis=0), [0, 0, 1], atol=1e-3)
    report = json.load(open(os.path.join(out, "report.json")))
    assert report["status"] == "done" and report["converged"]
    assert report["steps_done"] == steps and report["frames"] == len(times)
    for body in scene["bodies"]:
        facts = report["bodies"][body["name"]]
        assert set(facts) == {"mass", "tetrahedra", "nodes", "triangles", "cells_across"}
        assert facts["mass"] > 0 and facts["triangles"] > 0
    assert abs(report["bodies"]["beam"]["mass"] - 0.4 * 0.1 * 0.1 * 1000) < 1e-9
    for summary in report["series"].values():
        assert set(summary) == {"mean", "max"}
    with h5py.File(os.path.join(out, "series.h5"), "r") as file:
        kinetic = file["energy/kinetic"][()]
        assert np.isclose(report["series"]["energy/kinetic"]["mean"], kinetic.mean(), rtol=1e-12)
        assert report["series"]["energy/kinetic"]["max"] == kinetic.max()


def main():
    command = os.path.abspath(sys.argv[1])
    with tempfile.TemporaryDirectory() as folder:
        with open(os.path.join(folder, "scene.json"), "w", encoding="utf-8") as file:
            json.dump(SCENE, file)
        run(command, folder, "scene.json", "-o", "out", "--quiet")
        check_folder(folder, SCENE, 20)
        with open(os.path.join(folder, "rate.json"), "w", encoding="utf-8") as file:
            json.dump({**SCENE, "output": {"rate": 30}}, file)
        run(command, folder, "rate.json", "-o", "rate", "--quiet")
        with h5py.File(os.path.join(folder, "rate", "beam.vtkhdf"), "r") as file:
            frames = file["VTKHDF/Steps/Values"][()] / SCENE["time_step"]
        expected = [round(k / (30 * SCENE["time_step"])) for k in range(7)]
        assert np.allclose(frames, expected), f"frames at steps {frames}, not {expected}"
    print("the folder of a simulation holds what the formats say")


if __name__ == "__main__":
    main()
