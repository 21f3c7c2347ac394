"""Arrays in the memory of a device. A stand-in for CuPy shows memory of the host as that of device
0, which back end cuda on the emulated device takes; without a usable device all are refused."""

import ctypes
import sys
import types
from contextlib import nullcontext

import numpy as np
import pytest

import tetwarp

USABLE = any(b["backend"] == "cuda" and b["usable"] for b in tetwarp.available_backends())
EMULATED = any(b["device"] == "emulation" for b in tetwarp.available_backends())
needs_emulation = pytest.mark.skipif(not EMULATED, reason="not on the emulated device, which the test python_device has")


class DeviceArray:
    """An array whose memory is said to be that of a device."""

    __module__ = "cupy"
    array: np.ndarray
    number = 0

    shape = property(lambda self: self.array.shape)
    dtype = property(lambda self: self.array.dtype)
    flags = property(lambda self: self.array.flags)

    def __dlpack_device__(self):
        return 2, self.number

    def __dlpack__(self, **_):
        capsule = self.array.__dlpack__()
        pointer = ctypes.pythonapi.PyCapsule_GetPointer
        pointer.restype, pointer.argtypes = ctypes.c_void_p, (ctypes.py_object, ctypes.c_char_p)
        device = pointer(capsule, b"dltensor") + ctypes.sizeof(ctypes.c_void_p)
        ctypes.memmove(device, (ctypes.c_int32 * 2)(2, self.number), 8)
        return capsule


def put(array, number=0):
    result = DeviceArray()
    result.array, result.number = array.copy("K"), number
    return result


@pytest.fixture
def cupy(monkeypatch):
    """The stand-in, which works on the legacy stream."""
    stream = types.SimpleNamespace(ptr=1, waits=0)
    stream.synchronize = lambda: setattr(stream, "waits", stream.waits + 1)
    module = types.ModuleType("cupy")
    module.stream = stream
    module.cuda = types.SimpleNamespace(Device=lambda number: nullcontext(),
                                        get_current_stream=lambda: stream)
    module.empty = lambda shape, dtype: put(np.full(shape, 77, dtype))
    for name in ("uint8", "int32", "float32", "float64"):
        setattr(module, name, np.dtype(name))
    monkeypatch.setitem(sys.modules, "cupy", module)
    return module


@needs_emulation
@pytest.mark.parametrize("place", [np.array, put])
def test_a_warp_on_a_device_stays_there(cupy, volume, mesh, twisted, place):
    names = ("mask", "owner", "jacobian")
    expected = tetwarp.warp(volume, *mesh, twisted, outputs=names, backend="cpu")
    samples = put(volume.array)

    with tetwarp.Warper(samples, *mesh, affine=volume.affine) as warper:
        assert warper._arrays[0] is samples and cupy.stream.waits == 1
        result = warper(place(twisted), outputs=names)

    assert result.report["backend"] == "cuda" and "(20, 24, 32) of float32" in repr(result)
    assert isinstance(result.volume, DeviceArray)
    assert np.allclose(result.volume.array, expected.volume, rtol=0, atol=1e-5)
    assert np.array_equal(result.owner.array, expected.owner)
    assert np.array_equal(result.mask.array, expected.mask)
    assert np.allclose(result.jacobian.array, expected.jacobian, rtol=1e-5)


@needs_emulation
def test_device_results_are_written_where_they_should(cupy, volume, mesh, twisted):
    samples, other = put(volume.array), put(volume.array[..., None] * np.ones(3, np.float32))
    outs = [put(np.zeros_like(one.array)) for one in (samples, other)]

    result = tetwarp.warp([samples, other], *mesh, twisted, affine=volume.affine, out=outs)

    assert result.volume is outs[0] and result.volumes[1] is outs[1]
    expected = tetwarp.warp(volume, *mesh, twisted, backend="cpu").volume
    assert np.allclose(outs[0].array, expected, rtol=0, atol=1e-5)
    assert np.array_equal(outs[1].array[..., 2], outs[0].array)


@needs_emulation
def test_a_device_step_runs_on_the_stream_of_the_library(cupy, volume, mesh, twisted):
    """The emulated device has the legacy stream, 1, beside null, on which a Warper has its own."""
    given = []
    with tetwarp.Warper(put(volume.array), *mesh, affine=volume.affine) as warper:
        step = warper._warper.step
        warper._warper = types.SimpleNamespace(step=lambda *a: given.append(a) or step(*a))
        warper(twisted)

    assert given[0][3] == cupy.stream.ptr == 1


@needs_emulation
@pytest.mark.parametrize("place", [np.array, put])
def test_device_steps_in_flight_have_the_bits_of_single_ones(cupy, volume, mesh, place):
    steps = [tetwarp.deform(*mesh, kind="twist", amount=0.1 * n) for n in range(1, 5)]
    samples = volume.array if place is np.array else put(volume.array)
    with tetwarp.Warper(samples, *mesh, affine=volume.affine, backend="cuda") as warper:
        expected = [warper(place(step), outputs="owner") for step in steps]
        found = []
        for step in steps:
            warper.begin_step(place(step), outputs="owner")
            if warper.steps_in_flight == 2:
                found.append(warper.finish_step())
        found.append(warper.finish_step())

    for one, other in zip(expected, found):
        for pair in ((one.volume, other.volume), (one.owner, other.owner)):
            first, second = (getattr(array, "array", array) for array in pair)
            assert np.array_equal(first, second)


@needs_emulation
def test_what_a_device_step_in_flight_reads_is_no_output(cupy, volume, mesh, twisted):
    """Of positions in memory of the host the step has a copy."""
    memory = np.zeros(volume.shape, np.float32)
    moved = memory.reshape(-1)[:2 * twisted.size].view(np.float64).reshape(-1, 3)
    moved[:] = twisted
    read, out = DeviceArray(), DeviceArray()
    read.array, out.array = moved, memory
    with tetwarp.Warper(put(volume.array), *mesh, affine=volume.affine) as warper:
        warper.begin_step(read)
        with pytest.raises(ValueError, match="out: shares memory with deformed of a step in flight"):
            warper.begin_step(twisted, out=out)
        warper.finish_step()
        warper.begin_step(moved)
        warper.begin_step(twisted, out=out)
        first, second = warper.finish_step(), warper.finish_step()
    assert np.array_equal(first.volume.array, second.volume.array)


SHARED = put(np.zeros((20, 24, 32), np.float32))


@needs_emulation
@pytest.mark.parametrize("change, message", [
    ({"backend": "cpu"}, 'backend: expected "cuda" or "auto" for a volume in the memory'),
    ({"volume": lambda a: put(a[..., 0])}, "volume: expected shape"),
    ({"volume": lambda a: put(a.astype(complex))}, "volume: expected samples of uint8"),
    ({"volume": lambda a: [put(a), a]}, r"volume\[1\]: expected an array on device 0"),
    ({"volume": lambda a: [put(a), put(a[1:])]}, r"volume\[1\]: expected the grid of volume\[0\]"),
    ({"volume": lambda a: put(np.asfortranarray(a))}, "volume: expected an array in C order"),
    ({"deformed": lambda a: put(a, 1)}, "deformed: expected an array on device 0"),
    ({"deformed": lambda a: put(a[1:])}, r"deformed: expected shape \(\d+, 3\) of float64"),
    ({"volume": lambda a: SHARED, "out": lambda a: SHARED}, "out: shares memory with a source"),
    ({"volume": lambda a: [put(a), put(a)], "out": lambda a: [SHARED, SHARED]},
     r"out\[1\]: shares memory with a source or another output"),
    ({"out": lambda a: np.empty_like(a)}, "out: expected an array on device 0"),
    ({"out": lambda a: put(a.astype(int))}, r"out: expected shape \(20, 24, 32\) of float32"),
])
def test_wrong_device_arrays_are_named(cupy, volume, mesh, twisted, change, message):
    arguments = {"volume": put(volume.array), "deformed": twisted, "rest": mesh.points,
                 "cells": mesh.cells}
    for name, value in change.items():
        given = twisted if name == "deformed" else volume.array
        arguments[name] = value(given) if callable(value) else value

    with pytest.raises(ValueError, match=message):
        tetwarp.warp(**arguments)


@needs_emulation
def test_tensors_are_known_by_their_class_and_refused_with_a_gradient(
        cupy, volume, mesh, twisted, monkeypatch):
    class Tensor(DeviceArray):
        __module__ = "torch"
        requires_grad = False
        is_contiguous = property(lambda self: lambda: self.flags.c_contiguous)

    class MetaTensor(Tensor):
        __module__ = "of_others"

    stream = types.SimpleNamespace(cuda_stream=1, synchronize=lambda: None)
    module = types.ModuleType("torch")
    module.Tensor, module.float32 = Tensor, np.dtype(np.float32)
    module.cuda = types.SimpleNamespace(current_stream=lambda number: stream)
    module.empty = lambda shape, dtype, device: put(np.empty(shape, dtype))
    monkeypatch.setitem(sys.modules, "torch", module)
    samples, moved = MetaTensor(), MetaTensor()
    samples.array, moved.array = volume.array.copy(), twisted.copy()

    result = tetwarp.warp(samples, *mesh, moved, affine=volume.affine)
    expected = tetwarp.warp(volume, *mesh, twisted, backend="cpu")
    assert np.allclose(result.volume.array, expected.volume, rtol=0, atol=1e-5)

    for name, tensor in (("volume", samples), ("deformed", moved)):
        tensor.requires_grad = True
        with pytest.raises(ValueError, match=name + r": .* use \.detach\(\) or autograd_warp"):
            tetwarp.warp(samples, *mesh, moved, affine=volume.affine)
        tensor.requires_grad = False


@pytest.mark.skipif(USABLE, reason="there is a usable device")
def test_without_a_device_the_refusal_says_why(cupy, volume, mesh, twisted):
    with pytest.raises(ValueError, match=r"volume: .* copy it to the host, such as .* \(.+\)"):
        tetwarp.warp(put(volume.array), *mesh, twisted)
