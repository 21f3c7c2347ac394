"""Arrays of other libraries by DLPack. A stand-in shows what any library must get, PyTorch, where
it is installed, that a real one does."""

import types

import numpy as np
import pytest

import tetwarp


class StandIn:
    """An array that only DLPack can read."""

    def __init__(self, array, device=(1, 0)):
        self.array, self.device = array, device

    shape = property(lambda self: self.array.shape)
    dtype = property(lambda self: self.array.dtype)

    def __dlpack__(self, **keywords):
        return self.array.__dlpack__(**keywords)

    def __dlpack_device__(self):
        return self.device

    def __array_namespace__(self):
        return types.SimpleNamespace(from_dlpack=lambda array: StandIn(np.from_dlpack(array)))


def address(array):
    return array.__array_interface__["data"][0]


def test_arrays_of_other_libraries_are_read_in_place(volume, mesh, twisted):
    samples = StandIn(volume.array)
    expected = tetwarp.warp(volume, *mesh, twisted, outputs=("mask",))

    with tetwarp.Warper(samples, *mesh, affine=volume.affine) as warper:
        result = warper(StandIn(twisted), outputs=("mask",))
        assert address(warper._arrays[0]) == address(volume.array)

    assert isinstance(result.volume, StandIn) and isinstance(result.mask, StandIn)
    assert np.array_equal(result.volume.array, expected.volume)
    assert np.array_equal(result.mask.array, expected.mask)
    assert "(20, 24, 32) of float32, with mask" in repr(result)


def test_results_are_written_into_arrays_of_other_libraries(volume, mesh, twisted):
    out = StandIn(np.full(volume.shape, 5, np.float32))

    result = tetwarp.warp(volume, *mesh, twisted, out=out)

    assert result.volume is out
    assert np.array_equal(out.array, tetwarp.warp(volume, *mesh, twisted).volume)


def test_strides_only_decide_whether_a_copy_is_made(volume, mesh, twisted):
    spread = np.zeros((20, 24, 64), np.float32)[..., ::2]
    spread[...] = volume.array

    result = tetwarp.warp(StandIn(spread), *mesh, twisted, affine=volume.affine)

    assert np.array_equal(result.volume.array, tetwarp.warp(volume, *mesh, twisted).volume)
    with pytest.raises(ValueError, match="out: expected an array in C order"):
        tetwarp.warp(volume, *mesh, twisted, out=StandIn(spread))


def test_points_and_operators_take_them(volume, mesh, twisted):
    points = mesh.points[:5] + 0.25

    moved = tetwarp.transform_points(StandIn(points), *mesh, StandIn(twisted))

    assert np.array_equal(moved.array, tetwarp.transform_points(points, *mesh, twisted),
                          equal_nan=True)
    operator = tetwarp.WarpOperator(volume, StandIn(mesh.points), mesh.cells, twisted)
    x = volume.array.astype(float)
    assert np.array_equal(operator.forward(StandIn(x)).array, operator.forward(x))
    out = StandIn(np.empty(volume.shape))
    assert operator.adjoint(x, out=out) is out
    assert np.array_equal(out.array, operator.adjoint(x))


#: Libraries that hold arrays in memory of the host, and what makes one of theirs.
LIBRARIES = {
    "numpy": lambda numpy, array: array,
    "torch": lambda torch, array: torch.from_numpy(array.copy()),
    "jax": lambda jax, array: jax.numpy.asarray(array),
    "warp": lambda warp, array: warp.array(array, device="cpu"),
}


@pytest.mark.parametrize("name", LIBRARIES)
def test_arrays_come_back_as_those_of_their_library(name, volume, mesh, twisted):
    library = pytest.importorskip(name)
    rounded = twisted.astype(np.float32)  # as JAX has them
    expected = tetwarp.warp(volume, *mesh, rounded, outputs=("owner", "displacement"))
    samples, moved = (LIBRARIES[name](library, array) for array in (volume.array, rounded))

    result = tetwarp.warp(samples, *mesh, moved, affine=volume.affine, outputs=("owner", "displacement"))
    there = tetwarp.transform_points(moved, *mesh, twisted, inverse=True)

    kind = type(samples)
    for mine, its in ((result.volume, expected.volume), (result.owner, expected.owner),
                      (result.displacement, expected.displacement),
                      (there, tetwarp.transform_points(rounded, *mesh, twisted, inverse=True))):
        assert isinstance(mine, kind)
        array = np.from_dlpack(mine)  # JAX has no float64 unless it is told to
        assert np.array_equal(array, its.astype(array.dtype), equal_nan=True)
    out = LIBRARIES[name](library, np.zeros_like(volume.array))
    if name == "jax":  # whose arrays never change
        with pytest.raises(ValueError, match="out: .* those of JAX never change"):
            tetwarp.warp(volume, *mesh, rounded, out=out)
    else:
        assert tetwarp.warp(volume, *mesh, rounded, out=out).volume is out
    assert np.array_equal(np.from_dlpack(out), expected.volume if name != "jax" else 0 * expected.volume)


@pytest.mark.parametrize("name", ["volume", "rest", "cells", "deformed", "out"])
def test_memory_of_a_device_is_refused(volume, mesh, twisted, name):
    arguments = dict(volume=volume.array, rest=mesh.points, cells=mesh.cells, deformed=twisted,
                     out=np.empty_like(volume.array))
    arguments[name] = StandIn(arguments[name], device=(2, 1))

    with pytest.raises(ValueError, match=rf"{name}: expected an array in memory of the host, got "
                                         r"one of device 1 \(DLPack type 2\); copy it"):
        tetwarp.warp(**arguments)


def test_outputs_must_be_writable(volume, mesh, twisted):
    array = np.empty_like(volume.array)
    array.flags.writeable = False

    with pytest.raises(ValueError, match="out: "):
        tetwarp.warp(volume, *mesh, twisted, out=StandIn(array))


def test_pytorch_shares_memory_both_ways(volume, mesh, twisted):
    torch = pytest.importorskip("torch")
    samples = torch.from_numpy(volume.array.copy())
    out = torch.empty_like(samples)
    expected = tetwarp.warp(volume, *mesh, twisted, outputs=("owner",))

    with tetwarp.Warper(samples, *mesh, affine=volume.affine) as warper:
        assert address(warper._arrays[0]) == samples.data_ptr()
        fresh = warper(torch.from_numpy(twisted), outputs=("owner",))
        into = warper(twisted, out=out)

    assert isinstance(fresh.volume, torch.Tensor) and fresh.volume.dtype == torch.float32
    assert into.volume is out
    for tensor in (fresh.volume, out):
        assert np.array_equal(tensor.numpy(), expected.volume)
    assert np.array_equal(fresh.owner.numpy(), expected.owner)
    assert isinstance(tetwarp.transform_points(torch.zeros((2, 3)), *mesh, twisted), torch.Tensor)
    for grid in (samples, samples[..., None].repeat(1, 1, 1, 2), samples.requires_grad_()):
        operator = tetwarp.WarpOperator(grid, *mesh, twisted, affine=volume.affine)
        assert operator.grid == volume.grid
    with pytest.raises(ValueError, match="volume: cannot be read by DLPack"):
        tetwarp.warp(samples, *mesh, twisted, affine=volume.affine)
    for call in (lambda out: tetwarp.warp(volume, *mesh, twisted, out=out),
                 lambda out: operator.forward(volume, out=out)):
        for dtype in (torch.float32, torch.float64):
            with pytest.raises(ValueError, match="out: expected a tensor that needs no gradient"):
                call(torch.zeros(volume.shape, dtype=dtype, requires_grad=True))
