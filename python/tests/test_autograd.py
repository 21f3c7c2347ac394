"""The warp as a function that PyTorch differentiates. Without PyTorch a stand-in of the few names
that the function uses takes its place, which shows that gradients are those of the operator."""

import sys
import types

import numpy as np
import pytest

import tetwarp


class StandInTensor:
    def __init__(self, array):
        self.array = array
        self.shape, self.dtype = array.shape, array.dtype

    def is_floating_point(self):
        return self.array.dtype.kind == "f"

    def detach(self):
        return self

    def contiguous(self):
        return self

    def to(self, target, dtype=None):
        wanted = target.array.dtype if isinstance(target, StandInTensor) else dtype
        return StandInTensor(self.array.astype(wanted))

    def numpy(self):
        return self.array


class StandInFunction:
    @classmethod
    def apply(cls, *inputs):
        ctx = types.SimpleNamespace(needs_input_grad=(True,) * len(inputs))
        ctx.save_for_backward = lambda *saved: setattr(ctx, "saved_tensors", saved)
        result = cls.forward(ctx, *inputs)
        result.backward = lambda upstream: cls.backward(ctx, upstream)
        return result


@pytest.fixture
def stand_in(monkeypatch):
    torch = types.ModuleType("torch")
    torch.float64, torch.from_numpy = np.float64, StandInTensor
    torch.autograd = types.ModuleType("torch.autograd")
    torch.autograd.Function = StandInFunction
    torch.autograd.function = types.ModuleType("torch.autograd.function")
    torch.autograd.function.once_differentiable = lambda call: call
    for name in ("torch", "torch.autograd", "torch.autograd.function"):
        module = torch
        for part in name.split(".")[1:]:
            module = getattr(module, part)
        monkeypatch.setitem(sys.modules, name, module)


def test_gradients_are_those_of_the_operator(stand_in, volume, mesh, twisted):
    samples, nodes = StandInTensor(volume.array), StandInTensor(twisted)

    warped = tetwarp.autograd_warp(samples, *mesh, nodes, affine=volume.affine,
                                   interpolator="cubic")
    by_samples, by_nodes = warped.backward(warped)

    operator = tetwarp.WarpOperator(volume, *mesh, twisted, interpolator="cubic")
    y = operator.forward(volume)
    assert warped.array.dtype == np.float32 and np.array_equal(warped.array, y.astype(np.float32))
    y = warped.array.astype(float)
    assert np.array_equal(by_samples.array, operator.adjoint(y).astype(np.float32))
    assert np.array_equal(by_nodes.array, operator.node_gradient(volume, y))


def test_pytorch_agrees_with_differences(single_tet):
    torch = pytest.importorskip("torch")
    points, cells = single_tet
    samples = torch.rand((4, 4, 4), dtype=torch.float64, requires_grad=True)
    nodes = torch.tensor(points + (0.25, 0.125, 0.0625), requires_grad=True)

    def call(x, q):
        return tetwarp.autograd_warp(x, points, cells, q, interpolator="cubic")

    # Steps are many quanta of 2^-20 voxel long.
    assert torch.autograd.gradcheck(call, (samples, nodes), eps=1e-3, atol=1e-2)


def test_without_pytorch_it_says_so(monkeypatch, volume, mesh, twisted):
    monkeypatch.setitem(sys.modules, "torch", None)

    with pytest.raises(ImportError, match="python3 -m pip install torch"):
        tetwarp.autograd_warp(volume, *mesh, twisted)


def _tensors():
    """The stand-in's, and those of PyTorch where it is."""
    try:
        import torch
    except ImportError:
        return [StandInTensor]
    return [StandInTensor, torch.from_numpy]


@pytest.mark.parametrize("make", _tensors(), ids=["stand-in", "pytorch"][:len(_tensors())])
@pytest.mark.parametrize("dtype", ["u1", "i1", "i2", "i4", "i8", "?", "c8", "c16", "f2", "f4", "f8"])
def test_only_floats_are_differentiated(dtype, make, volume, mesh, twisted, request):
    """Integers would be cut and wrap around, complex numbers would lose their imaginary part."""
    if make is StandInTensor:
        request.getfixturevalue("stand_in")
    samples = np.ascontiguousarray(volume.array[:9, :9, :9] * 3 + 1).astype(dtype)
    given = {"volume": samples, "deformed": twisted.astype(dtype)}
    usual = {"volume": samples.real.astype(float), "deformed": twisted}

    for name, array in given.items():
        tensors = {key: make(value) for key, value in (usual | {name: array}).items()}
        call = lambda: tetwarp.autograd_warp(tensors["volume"], *mesh, tensors["deformed"])
        if np.dtype(dtype).kind == "f":
            call()
            continue
        with pytest.raises(ValueError, match=f"{name}: expected a tensor of floats"):
            call()
