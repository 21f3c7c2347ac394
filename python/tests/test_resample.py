"""Resampling by matrices and fields."""

import numpy as np
import pytest

import tetwarp

FILTERS = ["nearest", "linear", "cubic", "bspline", "lanczos"]


@pytest.fixture
def field(volume, mesh, twisted):
    return tetwarp.displacement_field(*mesh, twisted, reference=volume)


@pytest.mark.parametrize("interpolator", FILTERS)
def test_a_shift_by_whole_voxels_shifts(interpolator, volume):
    steps = np.array((3, -2, 1))
    matrix = np.eye(4)
    matrix[:3, 3] = steps * volume.grid.spacing

    moved = tetwarp.resample(volume, matrix, interpolator=interpolator, default_value=-7)

    expected = np.full_like(volume.array, -7)
    expected[:-1, 2:, :-3] = volume.array[1:, :-2, 3:]
    assert np.abs(moved.array - expected).max() < 1e-4 and moved.grid == volume.grid
    assert interpolator != "nearest" or np.array_equal(moved.array, expected)


@pytest.mark.parametrize("seed", range(3))
def test_linear_functions_are_kept_by_any_matrix(seed):
    """Of a sample that is linear in the world every transform gives that function of its place."""
    random = np.random.default_rng(seed)
    grid = tetwarp.Grid((9, 10, 11), (1, 1.5, 2), (3, 4, 5), ((0, -1, 0), (1, 0, 0), (0, 0, 1)))
    slope, center = random.standard_normal(3), grid.points().reshape(-1, 3).mean(axis=0)
    matrix = np.eye(4)
    matrix[:3, :3] += 0.2 * random.standard_normal((3, 3))
    matrix[:3, 3] = center - matrix[:3, :3] @ center
    target = tetwarp.Grid((4, 5, 6), (0.5, 0.6, 0.7), center - 1)

    result = tetwarp.resample(tetwarp.Volume(grid.points() @ slope, grid), matrix, reference=target)

    places = target.points() @ matrix[:3, :3].T + matrix[:3, 3]
    assert result.grid == target and np.allclose(result.array, places @ slope, rtol=1e-5, atol=1e-5)


def test_a_field_resamples_as_the_warp_that_it_is_of(volume, mesh, twisted, field):
    result = tetwarp.warp(volume, *mesh, twisted)

    resampled = tetwarp.resample(volume, field)
    as_volume = tetwarp.resample(volume, tetwarp.Volume(field.values, field.grid))

    error = np.abs(resampled.array - result.volume)[field.mask]
    assert field.mask.mean() > 0.2 and error.max() < 1e-4 * np.ptp(volume.array)
    assert np.array_equal(as_volume.array, resampled.array)
    one, three = (tetwarp.resample(volume, field, interpolator="cubic", threads=n) for n in (1, 3))
    assert np.array_equal(one.array, three.array)


def test_a_chain_moves_by_its_first_link_first(volume, field):
    turn = np.array([(0.9, -0.1, 0, 3), (0.1, 0.9, 0, -4), (0, 0, 1.1, 5), (0, 0, 0, 1.0)])
    shift = np.eye(4)
    shift[:3, 3] = (7, -5, 3)

    both = tetwarp.resample(volume, [shift, turn])
    assert np.allclose(both.array, tetwarp.resample(volume, turn @ shift).array, atol=1e-5)
    assert not np.allclose(both.array, tetwarp.resample(volume, shift @ turn).array, atol=1e-3)
    one = tetwarp.resample(volume, [field])
    assert np.array_equal(one.array, tetwarp.resample(volume, field).array)
    rows = turn.tolist()  # a matrix, no chain
    assert np.array_equal(tetwarp.resample(volume, rows).array,
                          tetwarp.resample(volume, turn).array)


def test_the_command_has_the_same_bits(volume, field, command, tmp_path):
    tetwarp.write(tmp_path / "volume.nii", volume)
    tetwarp.write(tmp_path / "field.nii", field)
    command("warp", tmp_path / "volume.nii", tmp_path / "field.nii",
            "--filter", "cubic", "--background", -3, "-o", tmp_path / "warped.nii")

    read = tetwarp.read(tmp_path / "field.nii", axes="lps")  # as ITK has it
    ours = tetwarp.resample(tetwarp.read(tmp_path / "volume.nii"), read, interpolator="cubic",
                            default_value=-3)

    assert np.array_equal(read.array, field.values)
    assert np.array_equal(ours.array, tetwarp.read(tmp_path / "warped.nii").array)


def test_several_volumes_outputs_and_what_is_beyond(volume, field):
    labels = tetwarp.Volume((volume.array > 0.2).astype(np.uint8), volume.grid, "labels")
    small = tetwarp.Grid((4, 4, 4), volume.grid.spacing, volume.grid.origin)
    part = tetwarp.Field(np.zeros((4, 4, 4, 3), np.float32), np.ones((4, 4, 4), bool), small, "part")
    outs = [np.empty_like(volume.array), np.empty_like(labels.array)]

    results = tetwarp.resample([volume, labels], part, interpolator="nearest", out=outs, threads=2)
    inside, _ = tetwarp.resample([volume, labels], part, only_in_field=True, default_value=9)

    assert all(result.array is out for result, out in zip(results, outs))
    assert [result.name for result in results] == [volume.name, "labels"]
    assert np.array_equal(outs[0], volume.array) and np.array_equal(outs[1], labels.array)
    assert np.array_equal(inside.array[:4, :4, :4], volume.array[:4, :4, :4])
    assert (inside.array[5:] == 9).all() and (inside.array[:, :, 5:] == 9).all()


def test_labels_by_the_gaussian_rule_are_those_of_the_warp(volume, mesh):
    labels = tetwarp.Volume(np.digitize(volume.array, (0.1, 0.3, 0.6)).astype(np.uint8), volume.grid)
    words = {"interpolator": "labels", "label_rule": "gaussian"}
    way, matrix = (1.3, -0.7, 2.1), np.eye(4)
    matrix[:3, 3] = way

    moved = tetwarp.resample(labels, matrix, label_gaussian=(1.4, 2.5), **words)

    warped = tetwarp.warp(labels, *mesh, mesh.points - way, label_gaussian=(1.4, 2.5),
                          outputs="mask", **words)
    covered = warped.mask > 0
    assert covered.mean() > 0.5 and np.array_equal(moved.array[covered], warped.volume[covered])
    assert (moved.array != tetwarp.resample(labels, matrix, **words).array).any()


@pytest.mark.parametrize("interpolator", ["cubic", "bspline", "lanczos"])
def test_clamped_samples_stay_in_the_range(interpolator, volume):
    step = tetwarp.Volume((volume.array > 0.2).astype(np.float32), volume.grid)
    matrix = np.eye(4)
    matrix[:3, 3] = 0.5 * np.array(volume.grid.spacing)

    keep, clamp = (tetwarp.resample(step, matrix, interpolator=interpolator, overshoot=word).array
                   for word in ("keep", "clamp"))

    assert keep.min() < -0.01 and keep.max() > 1.01
    assert np.array_equal(clamp, np.clip(keep, 0, 1))


def test_wrong_arguments_are_named(volume, mesh, twisted, field):
    forward = tetwarp.displacement_field(*mesh, twisted, reference=volume, convention="modeling")
    shared = volume.array
    for keywords, message in (
            ({"transform": np.eye(3)}, "transform: expected a Field .* got shape"),
            ({"transform": 2 * np.eye(4)}, "transform: expected 0 0 0 1 as the last row, got 0 0 0 2"),
            ({"transform": [[1, 0, 0, 0], [0, 1]]}, "transform: expected an array: "),
            ({"transform": [field, [[1, 0], [0]]]}, r"transform\[1\]: expected an array: "),
            ({"transform": [field, np.eye(3)]}, r"transform\[1\]: expected a Field"),
            ({"transform": volume}, r"transform: expected displacements, \(z, y, x, 3\)"),
            ({"transform": forward}, 'transform: .* use convention="resampling"'),
            ({"transform": np.full((4, 4), np.nan)}, "transform: expected 0 0 0 1 .* got nan nan"),
            ({"label_gaussian": (3, 2)}, '^label_gaussian: is for label_rule="gaussian", got label_r'),
            ({"label_gaussian": 2, "label_rule": "gaussian"}, "label_gaussian: expected 2 numbers"),
            ({"interpolator": "cube"}, "interpolator: "), ({"label_rule": "volume"}, "label_rule: "),
            ({"only_in_field": 1}, "only_in_field: expected True or False"),
            ({"out": shared}, "out: shares memory with a source"),
            ({"out": shared.astype(float)}, r"out: expected shape \(20, 24, 32\) of float32")):
        with pytest.raises(ValueError, match=message):
            tetwarp.resample(volume, **{"transform": np.eye(4), **keywords})
    apart = np.empty_like(shared)
    for outs, name in (([apart, apart], r"out\[1\]"), ([shared, apart], r"out\[0\]")):
        with pytest.raises(ValueError, match=name + ": shares memory with a source or another out"):
            tetwarp.resample([volume, volume], np.eye(4), out=outs)
    with pytest.raises(ZeroDivisionError):
        tetwarp.resample(volume, field, progress=lambda fraction: 1 / 0)
    with pytest.raises(tetwarp.Cancelled):
        tetwarp.resample(volume, field, progress=lambda fraction: False)
    with pytest.warns(RuntimeWarning, match="default_value: 300 does not fit uint8"):
        tetwarp.resample(np.zeros((2, 2, 2), np.uint8), np.eye(4), default_value=300)
