"""The warp as a linear operator, its transpose and its derivatives."""

import numpy as np
import pytest

import tetwarp

FILTERS = ["nearest", "linear", "cubic", "bspline", "lanczos"]


@pytest.fixture
def samples(volume):
    return volume.array.astype(float)


@pytest.mark.parametrize("interpolator", FILTERS)
def test_forward_is_the_warp(volume, mesh, twisted, samples, interpolator):
    operator = tetwarp.WarpOperator(volume, *mesh, twisted, interpolator=interpolator)

    y = operator.forward(samples)

    wide = tetwarp.Volume(samples, volume.grid)
    expected = tetwarp.warp(wide, *mesh, twisted, interpolator=interpolator, outputs="mask")
    assert np.allclose(y, expected.volume, rtol=0, atol=1e-12 * np.abs(samples).max())
    assert not (operator.support & (expected.mask == 0)).any()
    assert operator.support.mean() > 0.3 and not y[~operator.support].any()


@pytest.mark.parametrize("interpolator", FILTERS)
def test_the_transpose_gives_the_same_products(volume, mesh, twisted, interpolator):
    random = np.random.default_rng(1)
    reference = tetwarp.Grid((15, 17, 19), spacing=(18.0, 14.0, 19.0), origin=(-170, -100, -150))
    mask = random.random(reference.shape) < 0.5
    operator = tetwarp.WarpOperator(volume, *mesh, twisted, interpolator=interpolator,
                                    reference=reference, mask=mask)
    x = random.standard_normal((*volume.shape, 2))
    y = random.standard_normal((*reference.shape, 2))

    forward, adjoint = operator.forward(x), operator.adjoint(y)

    assert forward[mask].any() and not forward[~mask].any()
    scale = np.linalg.norm(forward) * np.linalg.norm(y)
    assert abs(np.vdot(forward, y) - np.vdot(x, adjoint)) < 1e-14 * scale


def test_conservative_shares_are_the_warp_and_keep_the_total(volume, mesh, twisted, samples):
    mask = np.random.default_rng(3).random(volume.shape) < 0.5
    all_of, part = (tetwarp.WarpOperator(volume, *mesh, twisted, intensity="conservative", mask=m)
                    for m in (None, mask))
    y = np.random.default_rng(4).standard_normal(volume.shape)

    forward, masked = all_of.forward(samples), part.forward(samples)

    wide = tetwarp.Volume(samples, volume.grid)
    expected = tetwarp.warp(wide, *mesh, twisted, intensity="conservative")
    assert np.allclose(forward, expected.volume, rtol=0, atol=2.0**-42 * np.abs(samples).max())
    assert forward.sum() == pytest.approx(expected.report["totals"]["after"][0]
                                          / np.prod(volume.grid.spacing), rel=1e-12)
    assert np.array_equal(masked, np.where(mask, forward, 0))
    for operator, values in ((all_of, forward), (part, masked)):
        scale = np.linalg.norm(values) * np.linalg.norm(y)
        products = np.vdot(values, y), np.vdot(samples, operator.adjoint(y))
        assert abs(products[0] - products[1]) < 1e-14 * scale


def test_bits_do_not_depend_on_threads(volume, mesh, twisted, samples):
    one, three = (tetwarp.WarpOperator(volume, *mesh, twisted, interpolator="cubic", threads=n)
                  for n in (1, 3))

    assert np.array_equal(one.adjoint(samples), three.adjoint(samples))
    assert np.array_equal(one.node_gradient(samples, samples),
                          three.node_gradient(samples, samples))


def test_the_gradient_is_that_of_differences(volume, mesh, twisted, samples):
    """Of a smooth source within the mesh, where the surface of the mesh has no part in it."""
    z, y, x = (np.linspace(-1, 1, n) for n in volume.shape)
    smooth = np.exp(-4 * (z[:, None, None] ** 2 + y[:, None] ** 2 + x**2))
    random = np.random.default_rng(2)
    direction = random.standard_normal(twisted.shape)
    target = random.standard_normal(volume.shape)
    target[tetwarp.rasterize(twisted * 1.01, mesh.cells, reference=volume) < 0] = 0
    target *= smooth

    def value(step):
        operator = tetwarp.WarpOperator(volume, *mesh, twisted + step * direction,
                                        interpolator="bspline")
        return np.vdot(operator.forward(smooth), target)

    operator = tetwarp.WarpOperator(volume, *mesh, twisted, interpolator="bspline")
    gradient = operator.node_gradient(smooth, target)

    step = 1e-3
    expected = (value(step) - value(-step)) / (2 * step)
    assert np.vdot(gradient, direction) == pytest.approx(expected, rel=0.02)


def test_scipy_takes_the_operator(volume, mesh, twisted, samples):
    linalg = pytest.importorskip("scipy.sparse.linalg")
    operator = tetwarp.WarpOperator(volume, *mesh, twisted)
    y = operator.forward(samples)

    found = linalg.lsqr(operator, y.ravel(), iter_lim=10)[0].reshape(volume.shape)

    linear = linalg.aslinearoperator(operator)
    assert linear.shape == operator.shape == (samples.size, samples.size)
    assert np.linalg.norm(operator.forward(found) - y) < 0.03 * np.linalg.norm(y)


def test_results_go_where_they_should(volume, mesh, twisted, samples):
    operator = tetwarp.WarpOperator(samples, *mesh, twisted, affine=volume.affine)
    out = np.empty(volume.shape)

    assert operator.forward(samples, out=out) is out
    assert np.array_equal(out, tetwarp.WarpOperator(volume, *mesh, twisted).forward(volume))
    assert "15360 x 15360" in repr(operator)


@pytest.mark.parametrize("change, message", [
    ({"interpolator": "labels"}, "interpolator: labels is not linear"),
    ({"interpolator": "sinc"}, "interpolator: "),
    ({"outside": "falloff"}, "outside: the operator has no displacements beyond the mesh"),
    ({"intensity": "density"}, "intensity: the operator has no densities; choose value or"),
    ({"intensity": "conservative", "outside": "identity"}, "intensity: to keep the total, outside"),
    ({"mask": np.ones((2, 3, 4), bool)}, r"mask: expected bool of shape \(20, 24, 32\)"),
    ({"spacing": (1, 1, 1)}, "source: it has a grid; leave out spacing"),
    ({"deformed": np.zeros((3, 3))}, "deformed: expected"),
])
def test_bad_arguments_are_named(volume, mesh, twisted, change, message):
    arguments = {"source": volume, "rest": mesh.points, "cells": mesh.cells, "deformed": twisted}

    with pytest.raises(ValueError, match=message):
        tetwarp.WarpOperator(**(arguments | change))


def test_bad_samples_are_named(volume, mesh, twisted, samples):
    operator = tetwarp.WarpOperator(volume, *mesh, twisted)

    with pytest.raises(ValueError, match=r"x: expected shape \(20, 24, 32\), or this and components"):
        operator.forward(samples[1:])
    with pytest.raises(ValueError, match="out: shares memory with y"):
        operator.adjoint(samples, out=samples)
    with pytest.raises(ValueError, match="node_gradient: filter nearest has no slope"):
        tetwarp.WarpOperator(volume, *mesh, twisted, interpolator="nearest").node_gradient(
            samples, samples)
    with pytest.raises(ValueError, match="node_gradient: conservative shares have no derivatives"):
        tetwarp.WarpOperator(volume, *mesh, twisted, intensity="conservative").node_gradient(
            samples, samples)


@pytest.mark.parametrize("keywords", [{}, {"spacing": (1, 2, 3)}, {"affine": np.diag([3, 4, 5, 1])}])
def test_any_array_gives_the_grid(keywords, volume, mesh, twisted):
    expected = tetwarp.WarpOperator(volume.array, *mesh, twisted, **keywords).source_grid

    for source in (volume.array.tolist(), list(volume.array), tuple(volume.array),
                   volume.array[..., None].repeat(2, axis=-1)):
        operator = tetwarp.WarpOperator(source, *mesh, twisted, **keywords)
        assert operator.source_grid == expected
    if keywords:
        with pytest.raises(ValueError, match="source: it has a grid"):
            tetwarp.WarpOperator(volume, *mesh, twisted, **keywords)
