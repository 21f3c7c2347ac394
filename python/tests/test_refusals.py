"""What an argument must not be is a ValueError of one line that names the argument: by kinds of
arguments, for all calls. Hints beyond that are tested where the calls are."""

import re

import numpy as np
import pytest

import tetwarp

REST, CELLS = tetwarp.lattice_mesh(np.ones((5, 5, 5), np.uint8), cells=2)
MESH = dict(rest=REST, cells=CELLS, deformed=REST + 0.25)
SAMPLES = np.arange(125, dtype=np.float32).reshape(5, 5, 5)
OPERATOR = tetwarp.WarpOperator(tetwarp.Grid((5, 5, 5)), **MESH)
FOUND = dict(keys=[(0, 0, 1, 0)], point_a=[(0.0, 0, 0)], point_b=[(0.0, 0, 0)],
             normal=[(0.0, 0, 1)], area=[0.5])
UPRIGHT = ((0, 0, 0), (1, 0, 0, 0))


def _certify(start=REST, end=REST, triangles=np.array([(0, 1, 2)]), **options):
    return tetwarp.certify([(start, end, triangles)], **options)


def _begin_step(time_step=0.01, **found):
    return tetwarp.ContactTracker().begin_step({**FOUND, **found}, [UPRIGHT, UPRIGHT], time_step)


def _collisions(points=REST, triangles=np.array([(0, 1, 2)]), **options):
    return tetwarp.find_collisions([(points, triangles)], **options)


def _end_step(impulse=np.zeros((1, 3)), velocity=np.zeros((1, 3))):
    tracker = tetwarp.ContactTracker()
    tracker.begin_step(FOUND, [UPRIGHT, UPRIGHT], 0.01)
    return tracker.end_step(impulse, [UPRIGHT, UPRIGHT], velocity=velocity)


def _simulator(method):
    simulator = tetwarp.Simulator(tetwarp.shipped_scene("top"), threads=1)
    return getattr(simulator, method)


class Odd:
    """Nothing that an argument could be."""


ARRAYS = [None, 5, "text", Odd(), {}, {1}, [], [[1, 2], [3]], np.zeros((4, 4, 4), complex),
          np.array(["1"]), np.zeros(3, "M8[s]"), np.ma.masked_less(np.ones((5, 5, 5)), 2)]
ARRAYS += [list(ARRAYS[-1]), [ARRAYS[-1].tolist(), ARRAYS[-1]], tuple(ARRAYS[-1])]
NUMBERS = [np.ma.masked, np.ma.array(0.5, mask=True), np.ma.array(3, mask=True), np.ones((9, 9)), "3", b"1", Odd(), {}, [1.0], 1j, np.complex128(1j), np.ones(2), 10**400]
WORDS = [3, None, Odd(), b"linear", "linear\0", "\udcff"]
#: What none of a kind is.
BAD = {
    "samples": ARRAYS,
    "points": ARRAYS + [REST[:, :2], np.full(REST.shape, np.nan), np.full(REST.shape, np.inf)],
    "where": ARRAYS + [REST[:, :2]],
    "cells": ARRAYS + [CELLS.astype(float), -CELLS - 1, CELLS.astype(np.uint64) + 2**63, CELLS > 0],
    "numbers": [a for a in ARRAYS if not isinstance(a, (int, list))] + [[[1, 2], [3]], [np.nan]],
    "matrix": ARRAYS + [np.full((4, 4), np.nan), np.zeros((3, 3)), np.eye(2)],
    "vector": ARRAYS + [(1, 2), (0, np.nan, 0), (1j, 0, 0), (np.inf, 1, 1), (10**400, 1, 1)],
    "shape": ARRAYS + [(0, 1, 1), (-1, 2, 2), (1.0, 2, 3), (2**40, 1, 1), (1, 2)],
    "number": NUMBERS,
    "integer": NUMBERS + [None, 1.5, np.float64(2), 2**70, -2**70],
    "word": WORDS,
    "path": [3, None, Odd(), "", "a\0b", "\udcff"],
    "callback": [3, "text", [print]],
    "flag": ["no", "False", 0, 1, None, 1.0, [], [True], Odd(), np.array([1, 2])],
    "folder": [0, False, 0.0, [], {}, b"", (), np.array([]), np.array(0), Odd(), "a\0b", "\udcff"],
    "masked": [a for a in ARRAYS if not isinstance(a, (int, type(None), str))][-4:],
}
BAD["rows"] = [a for a in ARRAYS if not isinstance(a, list)] + [np.ones((1, 4)), -np.ones((1, 3), int)]
BAD["impulses"] = [a for a in ARRAYS if not isinstance(a, list)] + [np.full((1, 3), np.nan), np.zeros((2, 3)), [1, 2, 3]]
BAD["out"] = [a for a in ARRAYS if a is not None] + [
    np.ma.masked_less(SAMPLES, 3), np.ma.masked_less(SAMPLES.astype(float), 3), SAMPLES[1:],
    SAMPLES.astype(">f4"), np.asfortranarray(SAMPLES), np.asfortranarray(SAMPLES.astype(float))]
BAD["many cells"] = [a for a in BAD["cells"] if not isinstance(a, int)]
BAD["body"] = ["none", 5, -1, 0.0, None, b"top", [0], Odd(), np.ma.array(0, mask=True)]
#: Name, call, arguments that are good, and kinds of arguments.
CALLS = {
    "warp": (tetwarp.warp, dict(volume=SAMPLES, **MESH), dict(
        volume="samples", rest="points", cells="cells", deformed="points", spacing="vector",
        origin="vector", direction="matrix", affine="matrix", default_value="number",
        falloff="number", device="integer", threads="integer", interpolator="word",
        out="out", label_rule="word", antialias="flag", outside="word", overshoot="word", intensity="word", backend="word",
        progress="callback")),
    "operator": (tetwarp.WarpOperator, dict(source=SAMPLES, **MESH), dict(
        rest="points", cells="cells", deformed="points", interpolator="word", outside="word",
        intensity="word", threads="integer", mask="masked")),
    "matvec": (OPERATOR.matvec, {}, dict(x="masked")),
    "rmatvec": (OPERATOR.rmatvec, {}, dict(y="masked")),
    "forward": (OPERATOR.forward, dict(x=SAMPLES), dict(x="samples", out="out")),
    "adjoint": (OPERATOR.adjoint, dict(y=SAMPLES), dict(y="samples", out="out")),
    "node_gradient": (OPERATOR.node_gradient, dict(x=SAMPLES, y=SAMPLES),
                      dict(x="samples", y="samples")),
    "displacement_field": (tetwarp.displacement_field, dict(**MESH, shape=(5, 5, 5)), dict(
        rest="points", cells="cells", deformed="points", convention="word", spacing="vector")),
    "strain": (tetwarp.strain, dict(**MESH, shape=(5, 5, 5)), dict(
        rest="points", cells="cells", deformed="points", shape="shape", origin="vector",
        direction="matrix", backend="word", device="integer", threads="integer")),
    "jacobian_determinant": (tetwarp.jacobian_determinant, dict(**MESH, shape=(5, 5, 5)), dict(
        rest="points", cells="cells", deformed="points", spacing="vector", affine="matrix")),
    "rasterize": (tetwarp.rasterize, dict(points=REST, cells=CELLS, shape=(5, 5, 5)),
                  dict(points="points", cells="cells")),
    "transform_points": (tetwarp.transform_points, dict(points=REST, **MESH), dict(
        points="where", rest="points", cells="cells", deformed="points",
        default_value="number", inverse="flag", return_owners="flag")),
    "lattice_mesh": (tetwarp.lattice_mesh, dict(volume=SAMPLES),
                     dict(volume="samples", cells="integer", threshold="number",
                          hexahedra="flag")),
    "deform": (tetwarp.deform, dict(points=REST, cells=CELLS), dict(
        points="points", cells="cells", kind="word", axis="word", amount="number", time="number",
        seed="integer", offset="vector")),
    "boundary_surface": (tetwarp.boundary_surface, dict(points=REST, cells=CELLS),
                         dict(points="points", cells="cells")),
    "isosurface": (tetwarp.isosurface, dict(volume=SAMPLES, value=9),
                   dict(volume="samples", value="number")),
    "phantom": (tetwarp.phantom, dict(kind="fish", shape=(3, 3, 3)),
                dict(kind="word", shape="shape", spacing="vector")),
    "Grid": (tetwarp.Grid, dict(shape=(4, 5, 6)), dict(
        shape="shape", spacing="vector", origin="vector", direction="matrix")),
    "certify": (_certify, {}, dict(start="points", end="points", triangles="rows",
                                   most_intervals="integer", threads="integer",
                                   self_intersections="flag")),
    "solve_contacts": (
        tetwarp.solve_contacts,
        dict(delassus=np.eye(3), free_velocity=[-1.0, 2, 0], friction=[0.5]),
        dict(free_velocity="numbers", friction="numbers", impulse_guess="numbers",
             tolerance="number", recovery_speed="number", max_seconds="number",
             max_sweeps="integer", device="integer", threads="integer", law="word", rule="word",
             method="word", measure="word", backend="word", progress="callback")),
    "ContactTracker": (tetwarp.ContactTracker, {}, dict(
        match_distance="number", touch_distance="number", restitution_speed="number",
        debond_gap_factor="number", debond_intensity="number", integrator="word",
        threads="integer")),
    "begin_step": (_begin_step, {}, dict(keys="rows", point_a="points", point_b="points",
                                         normal="points", time_step="number")),
    "Simulator": (tetwarp.Simulator, dict(scene=tetwarp.shipped_scene("top")), dict(
        folder="folder", backend="word", device="integer", threads="integer", untangle="flag",
        max_step_seconds="number")),
    "Simulator of a file": (tetwarp.Simulator, dict(scene="none.json"), dict(folder="folder")),
    "step": (_simulator("step"), {}, dict(count="integer", progress="callback")),
    "add_handle": (_simulator("add_handle"),
                   dict(name="h", body=0, center=(0, 0, 0), stiffness=1.0),
                   dict(name="word", center="vector", stiffness="number", radius="number",
                        damping="number")),
    "move_handle": (_simulator("move_handle"), dict(name="h", displacement=(0, 0, 0)),
                    dict(name="word", displacement="vector")),
    "move_script": (_simulator("move_script"), dict(name="h", displacement=(0, 0, 0)),
                    dict(name="word", displacement="vector", axis_angle="vector")),
    "positions": (_simulator("positions"), {}, dict(body="body")),
    "find_collisions": (_collisions, {}, dict(points="points", triangles="rows", threads="integer",
                                              self_intersections="flag")),
    "split_ten_nodes": (tetwarp.split_ten_nodes, {}, dict(cells="many cells")),
    "end_step": (_end_step, {}, dict(impulse="impulses", velocity="impulses")),
    "MeshFile": (tetwarp.MeshFile, dict(path="none.vtu"), dict(
        path="path", rest_step="integer", axes="word", ten_nodes="word")),
    "read_header": (tetwarp.read_header, {}, dict(path="path")),
    "available_backends": (tetwarp.available_backends, {}, dict(device="integer")),
    "shipped_scene": (tetwarp.shipped_scene, {}, dict(name="word")),
    "read": (tetwarp.read, dict(path="none.nii"), dict(path="path", axes="word", step="integer",
                                                          ten_nodes="word", labels="flag")),
    "write": (tetwarp.write, dict(path="a.nii", value=SAMPLES, grid=tetwarp.Grid((5, 5, 5))),
              dict(path="path", compress="integer")),
}


#: Arguments that are not given where they are None.
OPTIONAL = ("velocity", "spacing", "origin", "direction", "affine", "impulse_guess")


@pytest.mark.parametrize("name", CALLS)
def test_arguments_of_another_kind_are_named(name, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    call, good, kinds = CALLS[name]

    for argument, kind in kinds.items():
        for value in BAD[kind]:
            if value is None and argument in OPTIONAL:
                continue
            with pytest.raises(ValueError) as caught:
                call(**{**good, argument: value})
            text = str(caught.value)
            assert re.search(rf"\b{argument}\b", text) and "\n" not in text, (argument, value, text)
    assert not list(tmp_path.iterdir())
