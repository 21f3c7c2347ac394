"""Runs `tetwarp simulate` on small scenes and checks the folders with h5py: names, shapes, laws.

Usage: check_simulation.py COMMAND

Where VTK 9.3 or later is installed, its reader opens the file of contacts as well. Exits 77 when
h5py is missing, 1 when a folder does not hold what docs/formats.md says.
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
           "smallest_distance",
           *(f"seconds/{s}" for s in ("forces", "assembly", "linear", "detection", "contact",
                                      "update", "total"))]

CONTACT = {"normal": (3, np.float64), "impulse": (3, np.float64), "intensity": (1, np.float64),
           "gap": (1, np.float64), "area": (1, np.float64), "body_a": (1, np.int64),
           "body_b": (1, np.int64)}

SCENE = {
    "tetwarp_scene": 1, "time_step": 0.01, "duration": 0.2, "thickness": 1e-4,
    "contact": {"friction": 0.5, "adhesion": {"stiffness": 1e5, "energy": 1e-3, "viscosity": 0.01,
                                              "bonding_rate": 0.01, "saturation_pressure": 10}},
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
        {"name": "crate", "kind": "fem", "shape": {"type": "box", "half": [0.1, 0.1, 0.1]},
         "lattice": {"cells": [2, 2, 2]}, "material": {"E": 1e5, "nu": 0.3, "density": 1000},
         "pose": {"position": [1, 0, -0.895]}},
    ],
    "obstacles": [{"name": "floor", "plane": {"normal": [0, 0, 1], "point": [0, 0, -1]}}],
    "couplings": [{"name": "link", "a": "beam", "b": "ball", "points": [[0.2, 0, 0]],
                   "stiffness": 10}],
    "output": {"every": 5, "fields": ["velocity", "stress", "jacobian", "contact"]},
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
        for name in COUNTS[:5] + COUNTS[9:11]:
            assert file[name][0] == 0, f"{name} at the start"
        assert (file["smallest_distance"][()] > 0).all(), "surfaces intersect"
        assert file["contacts"][-1] > 0 and file["adhered_area"][-1] > 0, "the crate floats"
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


def check_contacts(path, times, bodies):
    """The file of --contacts: every frame has its own points; all are vertices."""
    with h5py.File(path, "r") as file:
        root, steps = file["VTKHDF"], file["VTKHDF/Steps"]
        assert list(root.attrs["Version"]) == [2, 0] and root.attrs["Type"] == b"UnstructuredGrid"
        assert steps.attrs["NSteps"] == len(times) and np.array_equal(steps["Values"][()], times)
        counts = root["NumberOfPoints"][()]
        assert counts[0] == 0 and counts[-1] > 0, f"contacts per frame {counts}"
        firsts = np.concatenate([[0], np.cumsum(counts)[:-1]])
        for name in ("PointOffsets", "CellOffsets", "ConnectivityIdOffsets",
                     *(f"PointDataOffsets/{array}" for array in CONTACT)):
            assert np.array_equal(steps[name][()].ravel(), firsts), name
        assert np.array_equal(steps["PartOffsets"][()], np.arange(len(times)))
        assert (root["Types"][()] == 1).all() and len(root["Types"]) == counts.sum()
        assert len(root["Offsets"]) == counts.sum() + len(times)
        assert root["Points"].shape == (counts.sum(), 3) and np.isfinite(root["Points"][()]).all()
        for name, (components, kind) in CONTACT.items():
            array = root["PointData"][name]
            shape = (counts.sum(),) if components == 1 else (counts.sum(), components)
            assert array.shape == shape and array.dtype == kind, name
            assert np.isfinite(array[()]).all(), name
        normals = root["PointData/normal"][()]
        assert np.allclose(np.linalg.norm(normals, axis=1), 1, atol=1e-12)
        assert 0 <= root["PointData/body_a"][()].min()
        assert root["PointData/body_b"][()].max() < bodies
        beta = root["PointData/intensity"][()]
        assert beta.min() >= 0 and beta.max() <= 1 and (root["PointData/area"][()] >= 0).all()
        return counts


def check_vtk_points(path, counts):
    """VTK reads each frame of a temporal file of points."""
    try:
        from vtkmodules.vtkCommonCore import vtkVersion
        from vtkmodules.vtkIOHDF import vtkHDFReader
    except ImportError:
        return
    if (vtkVersion.GetVTKMajorVersion(), vtkVersion.GetVTKMinorVersion()) < (9, 3):
        return
    reader = vtkHDFReader()
    reader.SetFileName(path)
    reader.UpdateInformation()
    assert reader.GetNumberOfSteps() == len(counts)
    for step, count in enumerate(counts):
        reader.SetStep(step)
        reader.Update()
        data = reader.GetOutputDataObject(0)
        assert data.GetNumberOfPoints() == count == data.GetNumberOfCells(), f"frame {step}"


def check_folder(folder, scene, steps):
    out = os.path.join(folder, "out")
    check_series(os.path.join(out, "series.h5"), scene, steps)
    frame_steps = np.arange(0, steps + 1, scene["output"]["every"])
    times = scene["time_step"] * frame_steps
    bodies = len(scene["bodies"]) + len(scene["obstacles"])
    contacts = os.path.join(folder, "contacts.vtkhdf")
    check_vtk_points(contacts, check_contacts(contacts, times, bodies))
    vector = ("displacement", "PointData", 3)
    velocity = ("velocity", "PointData", 3)
    touch = [("impulse", "PointData", 3), ("intensity", "PointData", 1), ("gap", "PointData", 1)]
    cells = [("stress", "CellData", 1), ("jacobian", "CellData", 1)]
    for name, kind, arrays in (("beam", 10, [vector, velocity, *cells]),
                               ("beam.surface", 5, [vector, *touch]),
                               ("ball", 5, [vector, velocity, *touch]),
                               ("ball.surface", 5, [vector]), ("crate", 10, [vector, *cells]),
                               ("crate.surface", 5, [vector, *touch]),
                               ("flag", 5, [vector, velocity, *touch])):
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
        run(command, folder, "scene.json", "-o", "out", "--contacts", "contacts.vtkhdf", "--quiet")
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
