"""Rules of labels: the exact volume in a voxel, and Gaussian weights."""

import itertools

import numpy as np
import pytest

import tetwarp


@pytest.fixture
def box():
    """A volume of 12 x 10 x 8 random labels in pieces, and one cell around it, at rest."""
    random = np.random.default_rng(7)
    coarse = random.integers(0, 4, (4, 5, 6), dtype=np.uint8)
    labels = coarse.repeat(2, 0).repeat(2, 1).repeat(2, 2)
    corners = np.array(list(itertools.product((-0.5, 7.5), (-0.5, 9.5), (-0.5, 11.5))))
    nodes = corners[:, ::-1].copy()
    cells = np.array([[0, 1, 3, 2, 4, 5, 7, 6]])
    return labels, nodes, cells


def warp(box, **options):
    labels, nodes, cells = box
    return tetwarp.warp(labels, nodes, cells, nodes, interpolator="labels", **options).volume


def test_the_volume_rule_takes_the_majority_of_whole_voxels(box):
    coarse = tetwarp.Grid(shape=(2, 2, 3), spacing=(4, 4, 4), origin=(1.5, 1.5, 1.5))

    majority = warp(box, label_rule="volume", reference=coarse)

    labels = box[0]
    for k, j, i in np.ndindex(2, 2, 3):
        part = labels[4 * k:4 * k + 4, 4 * j:4 * j + 4, 4 * i:4 * i + 4]
        assert majority[k, j, i] == np.bincount(part.ravel()).argmax()


def erf(x):
    """The integral of 2 / sqrt(pi) exp(-t^2) by Simpson's rule, within 1e-12."""
    x = np.asarray(x, float)
    t = np.linspace(0, 1, 2001)
    weights = np.where(np.arange(2001) % 2 == 1, 4.0, 2.0)
    weights[[0, -1]] = 1
    return 2 / np.sqrt(np.pi) * x * (np.exp(-((x[..., None] * t) ** 2)) @ weights) / 6000


@pytest.mark.parametrize("sigma, cutoff", [(1.0, 1.0), (1.4, 2.5), (0.6, 3.0)])
def test_the_gaussian_rule_takes_the_largest_weight(box, sigma, cutoff):
    labels = box[0]
    result = warp(box, label_rule="gaussian", label_gaussian=(sigma, cutoff))

    def along(center, count):
        reach = sigma * cutoff
        first = int(max(np.floor(center + 0.5 - reach), 0))
        past = int(min(np.ceil(center + 0.5 + reach), count))
        edges = erf((np.arange(first, past + 1) - 0.5 - center) / (np.sqrt(2) * sigma))
        return slice(first, past), np.diff(edges)

    ties = 0
    for index in np.ndindex(labels.shape):
        (k, wk), (j, wj), (i, wi) = (along(c, n) for c, n in zip(index, labels.shape))
        weights = wk[:, None, None] * wj[:, None] * wi
        share = np.bincount(labels[k, j, i].ravel(), weights.ravel(), 4)
        best = np.sort(share)[::-1]
        ties += best[0] - best[1] < 1e-9
        if best[0] - best[1] >= 1e-9:
            assert result[index] == share.argmax(), index
    assert ties < 0.05 * labels.size


def test_rules_name_what_is_wrong(box):
    for options, message in [
        ({"label_rule": "most"}, "label_rule"),
        ({"label_rule": "gaussian", "label_gaussian": 2}, "label_gaussian: expected 2 numbers, got 1"),
        ({"label_rule": "gaussian", "label_gaussian": (1, "x")}, "label_gaussian"),
        ({"label_rule": "gaussian", "label_gaussian": (4, 3)},
         "^label_gaussian: .*at most 8 voxels"),
        ({"label_gaussian": (3, 2)}, "^label_gaussian: is for label_rule"),
        ({"label_rule": "volume", "outside": "identity"}, "set outside to background"),
        ({"label_rule": "volume", "interpolator": "nearest"}, "^label_rule: volume is for labels"),
    ]:
        labels, nodes, cells = box
        with pytest.raises(ValueError, match=message):
            tetwarp.warp(labels, nodes, cells, nodes, **{"interpolator": "labels", **options})
