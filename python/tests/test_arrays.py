"""Arrays are used in place, live as long as they are needed, and wrong ones are named."""

import gc
import pickle
import warnings

import numpy as np
import pytest

import tetwarp


def test_outputs_are_written_into_the_callers_arrays(volume, mesh, twisted):
    out = np.full(volume.shape, 5, np.float32)
    address = out.ctypes.data

    result = tetwarp.warp(volume, *mesh, twisted, out=out)

    assert result.volume is out and out.ctypes.data == address
    assert np.array_equal(out, tetwarp.warp(volume, *mesh, twisted).volume)


def test_sources_are_read_in_place(mesh, twisted):
    samples = np.random.default_rng(5).random((20, 24, 32), np.float32)
    grid = tetwarp.phantom(shape=samples.shape).grid
    with tetwarp.Warper(tetwarp.Volume(samples, grid), *mesh) as warper:
        assert warper._arrays[0] is samples
        samples *= 2  # not allowed to callers; shows that the Warper has no copy

        result = warper(twisted)

    expected = tetwarp.warp(tetwarp.Volume(samples, grid), *mesh, twisted)
    assert np.array_equal(result.volume, expected.volume)


def test_strides_only_decide_whether_a_copy_is_made(volume, mesh, twisted):
    expected = tetwarp.warp(volume, *mesh, twisted).volume
    fortran = np.asfortranarray(volume.array)
    spread = np.zeros(tuple(2 * n for n in volume.shape), np.float32)[::2, ::2, ::2]
    spread[...] = volume.array
    swapped = volume.array.astype(volume.dtype.newbyteorder())
    read_only = volume.array.view()
    read_only.flags.writeable = False
    rows = np.zeros((len(mesh.points), 6))[:, ::2]
    rows[...] = twisted

    for samples in (fortran, spread, swapped, read_only):
        result = tetwarp.warp(tetwarp.Volume(samples, volume.grid), *mesh, rows)
        assert np.array_equal(result.volume, expected)


@pytest.mark.parametrize("dtype", ["u1", "i1", "u2", "i2", "u4", "i4", "u8", "i8", "f4", "f8"])
def test_every_pixel_type_keeps_its_type(dtype, volume, mesh):
    samples = (100 * volume.array).astype(dtype)
    source = tetwarp.Volume(samples, volume.grid)

    result = tetwarp.warp(source, *mesh, mesh.points, interpolator="nearest")

    assert result.volume.dtype == samples.dtype
    assert np.array_equal(result.volume, samples)  # at rest every voxel is itself


def test_components_are_kept(volume, mesh, twisted):
    samples = np.stack([volume.array, 2 * volume.array], axis=-1)

    result = tetwarp.warp(tetwarp.Volume(samples, volume.grid), *mesh, twisted)

    assert np.array_equal(result.volume[..., 0],
                          tetwarp.warp(volume, *mesh, twisted).volume)


def test_several_volumes_are_warped_together(volume, mesh, twisted):
    labels = tetwarp.Volume((volume.array > 0.3).astype(np.uint8), volume.grid)

    result = tetwarp.warp([volume, labels], *mesh, twisted, interpolator="nearest")

    assert [array.dtype for array in result.volumes] == [np.float32, np.uint8]
    alone = tetwarp.warp(labels, *mesh, twisted, interpolator="nearest")
    assert np.array_equal(result.volumes[1], alone.volume)


def test_results_outlive_what_made_them(volume, mesh, twisted):
    warper = tetwarp.Warper(volume.array.copy(), *mesh, affine=volume.affine)
    gc.collect()  # the caller keeps no reference to the samples
    result = warper(twisted)
    expected = result.volume.copy()
    del warper
    gc.collect()
    assert np.array_equal(result.volume, expected)

    samples = tetwarp.phantom(shape=(20, 24, 32)).array
    gc.collect()
    assert np.array_equal(samples, volume.array)


@pytest.mark.skipif(np.lib.NumpyVersion(np.__version__) < "2.0.0", reason="NumPy 1 asks otherwise")
def test_volumes_and_fields_are_arrays_without_a_copy(volume, mesh):
    field = tetwarp.jacobian_determinant(*mesh, mesh.points, reference=volume)
    for value, array in ((volume, volume.array), (field, field.values)):
        assert np.shares_memory(np.asarray(value), array)
        assert np.shares_memory(np.asarray(value, array.dtype, copy=False), array)
        assert not np.shares_memory(np.array(value, copy=True), array)
        assert np.asarray(value, np.float64).dtype == np.float64
        with pytest.raises(ValueError, match="copy: a conversion from float32"):
            np.asarray(value, np.float64, copy=False)


def test_arrays_of_the_library_are_not_copied():
    samples = tetwarp.phantom(shape=(20, 24, 32)).array

    assert not samples.flags.owndata and samples.flags.writeable


def test_plain_results_are_pickled(volume, mesh, twisted):
    result = tetwarp.warp(volume, *mesh, twisted, outputs=("mask", "jacobian"))

    again = pickle.loads(pickle.dumps(result))

    assert np.array_equal(again.volume, result.volume) and again.grid == result.grid
    assert np.array_equal(again.jacobian, result.jacobian)
    assert again.report == result.report
    assert pickle.loads(pickle.dumps(mesh)).points.shape == mesh.points.shape
    assert np.array_equal(pickle.loads(pickle.dumps(volume)).array, volume.array)
    with pytest.raises(TypeError):
        pickle.dumps(tetwarp.Warper(volume, *mesh))


def _warp(source, mesh, **changes):
    arguments = dict(volume=source, rest=mesh.points, cells=mesh.cells, deformed=mesh.points)
    return tetwarp.warp(**{**arguments, **changes})


@pytest.mark.parametrize("name, change, text", [
    ("volume", np.zeros((4, 4)), r"volume: expected shape \(z, y, x\).*got \(4, 4\)"),
    ("volume", np.zeros((4, 4, 4), bool), r"volume: .*got bool; use .view\(numpy.uint8\)"),
    ("volume", np.zeros((4, 4, 4), complex), "volume: .*got complex128"),
    ("volume", np.zeros((4, 4, 4), np.float16), "volume: .*got float16"),
    ("volume", np.zeros((4, 4, 4, 10)), "volume: expected 1 to 9 components"),
    ("volume", np.zeros((4, 0, 4)), "volume: expected at least one voxel"),
    ("volume", [], "volume: expected at least one volume"),
    ("rest", np.zeros((5, 2)), r"rest: expected shape \(n, 3\).*got \(5, 2\)"),
    ("volume", "head.nii", "volume: expected samples, got the name 'head.nii'; tetwarp.read"),
    ("rest", "text", "rest: expected an array of numbers"),
    ("rest", tetwarp.Mesh(np.eye(4, 3), [(0, 1, 2, 3)]), r"rest: .*; \*mesh gives nodes and cells"),
    ("cells", [(0, 1, 2)], r"cells: expected shape \(m, 4\).*got \(1, 3\)"),
    ("cells", [(0.0, 1, 2, 3)], "cells: expected integers.*got float64"),
    ("cells", [(0, 1, 2, -1)], "cells: expected numbers of nodes from 0 to .*found -1"),
    ("cells", [(0, 1, 2, 2**40)], f"cells: expected numbers .*found {2**40}"),
    ("cells", np.zeros((0, 4), int), "cells: expected at least one cell"),
    ("deformed", np.zeros((3, 3)), "deformed: expected .* rows, one per node, got 3"),
    ("interpolator", "spline", "interpolator: 'spline' is not one of linear, nearest"),
    ("interpolator", 3, "interpolator: expected a word, got 3"),
    ("interpolator", "labels", "volume: float32 holds no labels"),
    ("outside", "zero", "outside: 'zero' is not one of background, identity"),
    ("outside", None, "outside: expected a word, got None"),
    ("falloff", 3, 'falloff: is for outside="falloff", got outside=\'background\''),
    ("progress", 3, "progress: expected a function, got 3"),
    ("quantity", "rotate", "quantity: a vector has 3 components, the source 1"),
    ("backend", "gpu", "backend: 'gpu' is not one of auto, cuda, cpu"),
    ("quantity", ["rotate", "rotate"], "quantity: expected 1 words, one per volume, got 2"),
    ("reference", "grid", "reference: expected a tetwarp.Grid.*got str"),
    ("outputs", ("mask", "hull"), "outputs: 'hull' is not one of mask, owner"),
    ("out", np.zeros((3, 3, 3), np.float32), r"out: expected shape \(20, 24, 32\) of float32"),
    ("out", np.zeros((20, 24, 32)), "out: expected .* of float32, got .* of float64"),
    ("out", [1], "out: expected an array of float32 to write to"),
    ("out", np.zeros(4 * 15360 + 1, np.uint8)[1:].view(np.float32).reshape(20, 24, 32),
     "out: expected an array whose numbers are aligned"),
    ("out", np.zeros((20, 24, 64), np.float32)[..., ::2], "out: expected an array in C order"),
    ("spacing", (1, 1, 1), "volume: a Volume has a grid; leave out spacing"),
    ("threads", -1, "threads"),
    ("default_value", "x", "default_value: expected a number, got 'x'"),
    ("deformed", np.full((1, 3), np.nan), "deformed: expected .* rows"),
])
def test_errors_name_the_argument(name, change, text, volume, mesh):
    with pytest.raises(ValueError, match=text):
        _warp(volume, mesh, **{name: change})


@pytest.mark.parametrize("call, text", [
    (lambda m: tetwarp.lattice_mesh(np.ones((3, 3, 3)), threshold="high"), "threshold: expected a"),
    (lambda m: tetwarp.deform(*m, amount="much"), "amount: expected a number, got 'much'"),
    (lambda m: tetwarp.deform(*m, seed="x"), "seed: expected a whole number, got 'x'"),
    (lambda m: tetwarp.deform(*m, kind=1), "kind: expected a word, got 1"),
    (lambda m: tetwarp.phantom("fish", spacing="wide"), "spacing: expected an array of numbers"),
    (lambda m: tetwarp.phantom(3), "kind: expected a word, got 3"),
    (lambda m: tetwarp.isosurface(np.ones((3, 3, 3)), "x"), "value: expected a number, got 'x'"),
    (lambda m: tetwarp.isosurface(np.ones((3, 3, 3)), 1, triangles="x"), "triangles: expected a"),
    (lambda m: tetwarp.solve_contacts(delassus=np.eye(3), free_velocity=np.ones(3), friction=[0],
                                      tolerance="small"), "tolerance: expected a number"),
    (lambda m: tetwarp.Simulator(tetwarp.shipped_scene("top")).step("ten"), "count: expected a w"),
    (lambda m: tetwarp.WarpOperator("x", *m, m[0]), "source: expected a tetwarp.Grid"),
    (lambda m: tetwarp.WarpOperator(tetwarp.Grid((3, 3, 3)), *m, m[0], interpolator="labels"),
     "interpolator: labels is not linear in the samples; choose"),
    (lambda m: tetwarp.mesh_from(3), "mesh: expected a mesh of meshio .* got int"),
    (lambda m: tetwarp.write("mesh.nii.gz", m), "path: mesh.nii.gz: .* which ends in .vtkhdf"),
    (lambda m: tetwarp.write("a.png", tetwarp.phantom(shape=(3, 3, 3))), r"path: a.png: .*\.nrrd"),
])
def test_errors_of_other_calls_name_the_argument(call, text, mesh):
    with pytest.raises(ValueError, match=text):
        call(mesh)


def test_positions_must_be_finite(volume, mesh):
    broken = mesh.points.copy()
    broken[3, 1] = np.inf
    for name in ("rest", "deformed"):
        with pytest.raises(ValueError, match=f"{name}: expected finite positions, row 3 is not"):
            _warp(volume, mesh, **{name: broken})


def test_a_default_value_is_not_rounded(volume, mesh):
    labels = np.zeros(volume.shape, np.int64)
    for value in (2**53, -2**53, 2**63 - 1, -2**63, np.int64(7)):
        result = tetwarp.warp(labels, *mesh, mesh.points + 1e4, interpolator="nearest",
                              default_value=value)
        assert (result.volume == value).all()
    with pytest.raises(ValueError, match="default_value: expected a number that float64 holds"):
        _warp(labels, mesh, interpolator="nearest", default_value=2**53 + 1)


def test_forward_fields_are_on_the_grid_of_the_source(volume, mesh):
    with pytest.raises(ValueError, match="outputs: 'forward' is on the grid of the source"):
        _warp(volume, mesh, outputs="forward", reference=tetwarp.Grid((3, 3, 3)))


def test_outputs_must_be_writable_and_apart_from_sources(volume, mesh):
    out = np.zeros(volume.shape, np.float32)
    out.flags.writeable = False
    with pytest.raises(ValueError, match="out: expected a writable array"):
        _warp(volume, mesh, out=out)
    with pytest.raises(ValueError, match="out: shares memory with a source"):
        _warp(volume, mesh, out=volume.array)
    memory = np.concatenate([mesh.points.ravel(), np.zeros(20 * 24 * 32)])
    with pytest.raises(ValueError, match="out: shares memory with deformed"):
        _warp(np.ones(volume.shape), mesh, deformed=memory[:mesh.points.size].reshape(-1, 3),
              out=memory[5:5 + volume.array.size].reshape(volume.shape))


@pytest.mark.parametrize("keywords, text", [
    (dict(spacing=(1, 0, 1)), "spacing"),
    (dict(spacing=(1, 1)), "spacing: expected three numbers x, y, z, got 2"),
    (dict(origin=(0, 0, float("nan"))), "origin"),
    (dict(direction=np.zeros((3, 3))), "direction"),
    (dict(direction=np.eye(2)), "direction: expected 3 x 3 numbers, got 4"),
    (dict(shape=(4, 0, 6)), "shape: expected 1 to .* voxels along each axis"),
    (dict(shape=(4, 6)), "shape: expected three numbers"),
    (dict(shape=(4, 5.5, 6)), "shape: expected a whole number, got .*5.5"),
])
def test_grids_are_checked(keywords, text):
    with pytest.raises(ValueError, match=text):
        tetwarp.Grid(**{"shape": (4, 5, 6), **keywords})


def test_grids_have_the_affine_matrix_of_nibabel():
    affine = np.array([(-2, 0, 0, 90), (0, 0, 3, -126), (0, 2.5, 0, -72), (0, 0, 0, 1.0)])

    grid = tetwarp.Grid.from_affine((4, 5, 6), affine)

    assert np.allclose(grid.affine, affine)
    assert np.allclose(grid.points()[2, 3, 4], (affine @ (4, 3, 2, 1))[:3])
    with pytest.raises(ValueError, match="affine: give either affine"):
        tetwarp.warp(np.zeros((4, 5, 6)), np.eye(4, 3), [(0, 1, 2, 3)], np.eye(4, 3),
                     affine=affine, origin=(0, 0, 0))


def test_images_of_nibabel_are_references(volume, mesh, twisted):
    nibabel = pytest.importorskip("nibabel")
    image = nibabel.Nifti1Image(np.zeros((16, 12, 10), np.uint8), np.diag([20.0, 20, 30, 1]))

    result = tetwarp.warp(volume, *mesh, twisted, reference=image)

    assert result.volume.shape == (10, 12, 16)
    assert np.allclose(result.grid.affine, image.affine)


@pytest.mark.parametrize("dtype", [
    "uint8", "int8", "uint16", "int16", "uint32", "int32", "uint64", "int64", "float32", "float64"])
def test_a_default_value_that_is_stored_as_another_one_is_told(dtype, single_tet):
    points, cells = single_tet
    samples = np.zeros((2, 2, 2), dtype)
    options = dict(interpolator="nearest", threads=1)
    limits = np.iinfo(dtype) if np.dtype(dtype).kind in "iu" else np.finfo(dtype)
    values = [0, -1, 1, 0.5, 1.5, 200, 300.5, -40000, 2**24 + 1, 2**40, 1e300, float(limits.min), float(limits.max)]

    for value in values:
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            stored = tetwarp.warp(
                samples, points, cells, points + 90, default_value=value, **options).volume[0, 0, 0]
        is_exact = np.dtype(dtype).kind in "iu" or float(value).is_integer()
        kept = float(stored) == value if is_exact else bool(np.isfinite(stored))
        assert len(caught) == (not kept), (value, stored)
        for warning in caught:
            assert warning.filename == __file__ and warning.category is RuntimeWarning
            assert str(warning.message).endswith(f"does not fit {dtype}, {float(stored):.15g} is stored")
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        tetwarp.warp(samples, points, cells, points, outside="identity", default_value=0.5, **options)


@pytest.mark.parametrize("dtype", ["int64", "uint64"])
@pytest.mark.parametrize("shift", [2**53, 2**60, 2**62])
def test_thresholds_see_all_digits_of_64_bit_samples(dtype, shift):
    """Samples and threshold that are shifted alike have the same surface and the same lattice."""
    small = np.random.default_rng(3).integers(0, 1025, (7, 8, 9)).astype(dtype)
    shifted = small + np.array(shift, dtype)

    small[3, 4, 5] = 2047
    shifted[3, 4, 5] = shift + 2047
    expected = tetwarp.isosurface(small, 1024)
    surface = tetwarp.isosurface(shifted, shift + 1024)
    assert np.array_equal(surface.points, expected.points)
    assert np.array_equal(surface.triangles, expected.triangles)
    one = np.zeros((6, 6, 6), dtype)
    one[2, 3, 4] = 1
    expected = tetwarp.lattice_mesh(one, cells=1, threshold=0)
    mesh = tetwarp.lattice_mesh(one + np.array(shift, dtype), cells=1, threshold=shift)
    assert np.array_equal(mesh.points, expected.points)
    for call in (tetwarp.isosurface, lambda a, t: tetwarp.lattice_mesh(a, threshold=t)):
        for wrong in (shift + 1, np.int64(shift + 1)):
            with pytest.raises(ValueError, match="expected a number that float64 holds"):
                call(shifted, wrong)


@pytest.mark.parametrize("kind", ["twist", "bend", "swim", "random", "rotate", "translate"])
def test_arguments_of_other_deformations_are_refused(kind, mesh):
    """An argument changes the positions, or is refused."""
    given = {"amount": 0.5, "axis": "x", "seed": 7, "offset": (1.0, 2, 3)}
    usual = tetwarp.deform(*mesh, kind=kind)
    refused = set()

    for name, value in given.items():
        try:
            moved = tetwarp.deform(*mesh, kind=kind, **{name: value})
        except ValueError as error:
            assert str(error) == f"{name}: has no effect on kind {kind!r}; leave it out"
            refused.add(name)
        else:
            assert not np.array_equal(moved, usual), name
    assert refused and refused != set(given)


def test_masks_are_found_at_any_depth_of_lists():
    hidden = np.ma.array([1.0, 2, 3], mask=[0, 1, 0])
    shown = np.ma.array([1.0, 2, 3], mask=[0, 0, 0])
    is_masked = tetwarp._values.is_masked
    for plain in ([], [[]], "ab", ["ab", b"c"], [range(3), (1, 2.5)], [shown, [shown, None]], [None],
                  [[[1], 2], 3, np.arange(3)], [hidden.data], np.ma.array([1, 2])):
        assert not is_masked(plain), plain
    for masked in (hidden, np.ma.masked, [hidden], (1, [2, (shown, hidden)]), [[1, 2, np.ma.masked]],
                   ["ab", [None, [range(2), [hidden]]]]):
        assert is_masked(masked), masked
    endless: list = []
    endless.append(endless)
    assert not is_masked(endless)
    with pytest.raises(ValueError, match="rest: has masked elements"):
        tetwarp.transform_points([(0, 0, 0)], [[0, 0, 0], [1, 0, np.ma.masked]], [(0, 1, 2, 3)], [])
