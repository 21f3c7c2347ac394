"""Warps that PyTorch differentiates."""

from __future__ import annotations

from typing import Any

import numpy as np

from ._grid import make_grid
from ._mesh import Cells
from ._operator import WarpOperator


def autograd_warp(
    volume: Any,
    rest: Any,
    cells: Cells,
    deformed: Any,
    *,
    spacing: Any = None,
    origin: Any = None,
    direction: Any = None,
    affine: Any = None,
    **options: Any,
) -> Any:
    """A warp of a tensor of PyTorch that `backward` passes through, to the samples and to the
    positions of the nodes.

    It is computed by a WarpOperator on the CPU in float64; tensors of other types or devices are
    copied there and back. The derivative by the nodes is that of `WarpOperator.node_gradient`.

    Parameters
    ----------
    volume : tensor of floats of shape (z, y, x) or (z, y, x, c)
    rest, cells : as in `warp`; arrays
    deformed : (n, 3) tensor of floats, positions of the nodes
    spacing, origin, direction, affine : of the grid of `volume`, see Grid
    options : the other keywords of WarpOperator: interpolator, outside, intensity, reference, mask,
        threads; intensity ``"conservative"`` has a derivative by the samples only

    Returns
    -------
    tensor of the type and on the device of `volume`

    Raises
    ------
    ImportError
        PyTorch is not installed.
    ValueError
        naming the argument that is wrong and what it should be.

    >>> import torch, tetwarp
    >>> volume = torch.ones((8, 8, 8), dtype=torch.float64, requires_grad=True)
    >>> rest, cells = tetwarp.lattice_mesh(volume.detach(), cells=2)
    >>> nodes = torch.tensor(0.5 * rest, requires_grad=True)
    >>> autograd_warp(volume, rest, cells, nodes).sum().backward()
    >>> volume.grad.shape, nodes.grad.shape == rest.shape
    (torch.Size([8, 8, 8]), True)
    """
    try:
        import torch
        from torch.autograd.function import once_differentiable
    except ImportError:
        raise ImportError(
            "autograd_warp: expected PyTorch; python3 -m pip install torch"
        ) from None
    for name, value in (("volume", volume), ("deformed", deformed)):
        if not hasattr(value, "detach"):
            raise ValueError(f"{name}: expected a tensor of PyTorch, got {type(value).__name__}")
        if not value.is_floating_point():
            raise ValueError(f"{name}: expected a tensor of floats, which have derivatives, got "
                             f"{value.dtype}; use .double(), or warp")
    grid = make_grid(tuple(volume.shape[:3]), spacing, origin, direction, affine)

    def numbers(tensor: Any) -> np.ndarray:
        return tensor.detach().to("cpu", torch.float64).contiguous().numpy()

    class Warp(torch.autograd.Function):
        @staticmethod
        def forward(ctx: Any, samples: Any, nodes: Any) -> Any:
            ctx.save_for_backward(samples, nodes)
            ctx.operator = WarpOperator(grid, rest, cells, numbers(nodes), **options)
            return torch.from_numpy(ctx.operator.forward(numbers(samples))).to(samples)

        @staticmethod
        @once_differentiable
        def backward(ctx: Any, by_output: Any) -> Any:
            samples, nodes = ctx.saved_tensors
            by_samples = by_nodes = None
            if ctx.needs_input_grad[0]:
                by_samples = torch.from_numpy(ctx.operator.adjoint(numbers(by_output))).to(samples)
            if ctx.needs_input_grad[1]:
                gradient = ctx.operator.node_gradient(numbers(samples), numbers(by_output))
                by_nodes = torch.from_numpy(gradient).to(nodes)
            return by_samples, by_nodes

    return Warp.apply(volume, deformed)
