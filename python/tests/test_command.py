"""The package gives the bits of the command."""

import json

import numpy as np
import pytest

import tetwarp

FISH_GRID = dict(shape=(40, 22, 24), spacing=(1.5, 1.5, 2.0))


def _labels(volume):
    levels = (volume.array > 0).astype(np.int32) + (volume.array > 100)
    return tetwarp.Volume(levels.astype(np.int16), volume.grid, "labels")


def _vectors(volume):
    z, y, x = np.meshgrid(*(np.linspace(-1, 1, n) for n in volume.shape), indexing="ij")
    return tetwarp.Volume(np.stack([x, y * z, x - z], -1), volume.grid, "vectors")


def _same(volume):
    return volume


#: Name: source, keywords of the package, options of the command, hexahedra.
JOBS = {
    "linear": (_same, {}, [], False),
    "hexahedra": (_same, {}, [], True),
    "cubic, clamped": (
        _same, dict(interpolator="cubic", overshoot="clamp", default_value=7),
        ["--filter", "cubic", "--overshoot", "clamp", "--background", "7"], False),
    "bspline": (_same, dict(interpolator="bspline"), ["--filter", "bspline"], False),
    "lanczos, averaged": (
        _same, dict(interpolator="lanczos", antialias=True),
        ["--filter", "lanczos", "--antialias"], False),
    "nearest, identity": (
        _same, dict(interpolator="nearest", outside="identity"),
        ["--filter", "nearest", "--outside", "identity"], False),
    "labels": (_labels, dict(interpolator="labels"), ["--filter", "labels"], False),
    "density": (_same, dict(intensity="density"), ["--intensity", "density"], False),
    "conservative": (
        _same, dict(intensity="conservative"), ["--intensity", "conservative"], False),
    "vectors": (_vectors, dict(quantity="rotate"), ["--vectors", "vectors"], False),
    "one thread": (_same, dict(threads=1), ["--threads", "1"], False),
    "reference": (_same, dict(backend="reference"), [], False),
}


@pytest.mark.parametrize("name", JOBS)
def test_warps_have_the_bits_of_the_command(name, tmp_path, command):
    prepare, keywords, options, hexahedra = JOBS[name]
    source = prepare(tetwarp.phantom("fish", **FISH_GRID))
    mesh = tetwarp.lattice_mesh(source, cells=5, hexahedra=hexahedra)
    deformed = tetwarp.deform(*mesh, kind="swim", amount=0.4, axis="z")
    tetwarp.write(tmp_path / "source.vtkhdf", source)
    tetwarp.write(tmp_path / "mesh.vtkhdf", mesh, deformed=[deformed])
    command("warp", tmp_path / "source.vtkhdf", tmp_path / "mesh.vtkhdf", "-o",
            tmp_path / "out.vtkhdf", "--backend", keywords.get("backend", "cpu"), *options)
    # The file holds displacements, so positions may differ by rounding from those given above.
    stored = tetwarp.read(tmp_path / "mesh.vtkhdf").step(0)

    result = tetwarp.warp(source, *mesh, stored, **{"backend": "cpu", **keywords})

    expected = tetwarp.read(tmp_path / "out.vtkhdf")
    assert expected.array.dtype == result.volume.dtype
    assert np.array_equal(expected.array, result.volume)
    assert expected.grid == result.grid and expected.name == result.names[0]
    assert result.report["counts"]["covered"] > 0


def test_further_outputs_have_the_bits_of_the_command(tmp_path, command):
    source = tetwarp.phantom("fish", **FISH_GRID)
    mesh = tetwarp.lattice_mesh(source, cells=5)
    tetwarp.write(tmp_path / "source.vtkhdf", source)
    tetwarp.write(tmp_path / "mesh.vtkhdf", mesh,
                  deformed=[tetwarp.deform(*mesh, kind="bend", amount=0.3, axis="z")])
    names = ("mask", "owner", "displacement", "jacobian", "gradient", "strain", "forward")
    command("warp", tmp_path / "source.vtkhdf", tmp_path / "mesh.vtkhdf", "-o",
            tmp_path / "out.vtkhdf", "--backend", "cpu",
            "--outputs", ",".join(names).replace("owner", "tet"))
    stored = tetwarp.read(tmp_path / "mesh.vtkhdf").step(0)

    result = tetwarp.warp(source, *mesh, stored, outputs=names, backend="cpu")

    for name in names:
        stored_name = "tetwarp_tet" if name == "owner" else f"tetwarp_{name}"
        expected = tetwarp.read(tmp_path / "out.vtkhdf", array=stored_name)
        assert np.array_equal(expected.array, result.extras[name]), name
    tetwarp.write(tmp_path / "mine.vtkhdf", result)
    mine, theirs = (tetwarp.read_header(tmp_path / f"{n}.vtkhdf").arrays for n in ("mine", "out"))
    assert sorted(a["name"] for a in mine) == sorted(a["name"] for a in theirs)


def test_another_grid_and_nifti_have_the_bits_of_the_command(tmp_path, command):
    turn = np.array([(0.8, -0.6, 0), (0.6, 0.8, 0), (0, 0, 1)])
    samples = np.ascontiguousarray(tetwarp.phantom(shape=(20, 24, 32)).array)
    grid = tetwarp.Grid((20, 24, 32), (2, 2, 2.5), (-10, 5, 3), turn)
    tetwarp.write(tmp_path / "source.nii.gz", tetwarp.Volume(samples, grid))
    source = tetwarp.read(tmp_path / "source.nii.gz")
    mesh = tetwarp.lattice_mesh(source, cells=3)
    tetwarp.write(tmp_path / "mesh.vtkhdf", mesh, deformed=[tetwarp.deform(*mesh, amount=0.5)])
    command("warp", tmp_path / "source.nii.gz", tmp_path / "mesh.vtkhdf", "-o",
            tmp_path / "out.nii.gz", "--dims", "30,20,10", "--spacing", "2.5,3,4", "--backend",
            "cpu")
    expected = tetwarp.read(tmp_path / "out.nii.gz")
    assert np.allclose(expected.grid.spacing, (2.5, 3, 4)) and expected.shape == (10, 20, 30)
    # The command's grid, without the rounding of a NIfTI header to float32.
    wanted = tetwarp.Grid((10, 20, 30), (2.5, 3, 4), source.grid.origin, source.grid.direction)

    stored = tetwarp.read(tmp_path / "mesh.vtkhdf").step(0)
    result = tetwarp.warp(source, *mesh, stored, reference=wanted, backend="cpu")

    assert np.array_equal(expected.array, result.volume)


def test_meshes_and_deformations_are_those_of_the_command(tmp_path, command):
    source = tetwarp.phantom(shape=(20, 24, 32))
    tetwarp.write(tmp_path / "source.vtkhdf", source)
    command("mesh", tmp_path / "source.vtkhdf", "-o", tmp_path / "mesh.vtkhdf", "--cells", "5",
            "--threshold", "0.3")
    command("deform", tmp_path / "mesh.vtkhdf", "-o", tmp_path / "moved.vtkhdf", "--kind", "random",
            "--amount", "0.7", "--seed", "9", "--steps", "1")

    mesh = tetwarp.lattice_mesh(source, cells=5, threshold=0.3)
    moved = tetwarp.deform(*mesh, kind="random", amount=0.7, seed=9)

    file = tetwarp.read(tmp_path / "moved.vtkhdf")
    assert np.array_equal(file.mesh.points, mesh.points)
    assert np.array_equal(file.mesh.cells, mesh.cells)
    assert np.allclose(file.step(0), moved, rtol=0, atol=1e-12)


def test_simulations_have_the_state_of_the_command(tmp_path, command):
    scene = tmp_path / "scene.json"
    scene.write_text(json.dumps(tetwarp.shipped_scene("chain")))
    command("simulate", scene, "-o", tmp_path / "run", "--steps", "6", "--checkpoint",
            tmp_path / "state", "--backend", "cpu")
    simulator = tetwarp.Simulator(scene, backend="cpu")

    assert simulator.step(6)

    assert simulator.checkpoint() == (tmp_path / "state").read_bytes()


def test_contact_problems_have_the_impulses_of_the_command(tmp_path, command):
    problem = tetwarp.ContactProblem(
        system=np.diag([2.0, 2, 2, 1, 1, 1]),
        jacobian=[(1, 0, 0, -1, 0, 0), (0, 1, 0, 0, -1, 0), (0, 0, 1, 0, 0, -1)],
        load=[-3.0, 1, 0, 0, 0, 0], velocity_offset=[0.0, 0, 0], friction=[0.4])
    tetwarp.write(tmp_path / "problem.h5", problem)
    command("contact", tmp_path / "problem.h5", "-o", tmp_path / "solution.h5")

    solution = tetwarp.solve_contacts(problem)

    assert solution.converged
    stored = tetwarp.read(tmp_path / "solution.h5").impulse_guess  # of the file's solution
    assert np.array_equal(stored, solution.impulse.ravel())


def test_proofs_are_those_of_the_command(tmp_path, command):
    points, triangles = tetwarp.isosurface(tetwarp.phantom("orange", (12, 12, 12)), 0.5)
    size, random = np.ptp(points, axis=0)[0], np.random.default_rng(6)
    for way, verdict, status in ((0.2, "free", 0), (0.6, "meets", 3)):
        other = points + (1.5 * size, 0, 0)
        ends = [points + (way * size, 0, 0), other - (way * size, 0, 0)]
        if verdict == "meets":  # also triangles of one surface, where neighbors cross
            ends[1] = ends[1] + 0.01 * size * random.random(points.shape)
        for name, place in (("a", points), ("b", other), ("c", ends[0]), ("d", ends[1])):
            tetwarp.write(tmp_path / f"{name}.vtkhdf", tetwarp.Surface(place, triangles))
        a, b, c, d = (tmp_path / f"{name}.vtkhdf" for name in "abcd")
        command("certify", a, b, "--to", c, d, "--report", tmp_path / "proof.json", status=status)

        found = tetwarp.certify([(points, ends[0], triangles), (other, ends[1], triangles)])

        assert found.verdict == verdict
        (step,) = json.loads((tmp_path / "proof.json").read_text())["steps"]
        assert (step["verdict"], step["near_pairs"]) == (verdict, found.near_pairs)
        assert [pair["triangles"] for pair in step["pairs"]] == found.triangles.tolist()
        assert [pair["surfaces"] for pair in step["pairs"]] == found.surfaces.tolist()
        assert [[pair["from"], pair["until"]] for pair in step["pairs"]] == found.times.tolist()
        assert bool(len(found.times)) == (verdict == "meets")
