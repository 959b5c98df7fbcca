"""Soft-DTW, goals, flows and metrics against plain definitions in numpy."""

import numpy as np
import pytest
from ddl_forecast import dynamics, goals, metrics, soft_dtw


def plain(x, y, gamma):
    """The recursion as in its definition."""
    costs = ((x[:, None] - y[None]) ** 2).sum(-1)
    table = np.full((len(x) + 1, len(y) + 1), np.inf)
    table[0, 0] = 0
    for i in range(1, len(x) + 1):
        for j in range(1, len(y) + 1):
            before = np.array([table[i - 1, j - 1], table[i - 1, j], table[i, j - 1]])
            least = before.min()
            if gamma > 0 and np.isfinite(least):
                least = least - gamma * np.log(np.exp(-(before - least) / gamma).sum())
            table[i, j] = costs[i - 1, j - 1] + least
    return table[-1, -1]


@pytest.mark.parametrize("components", [1, 2, 3, 5, 7, 20, 40, 128])
@pytest.mark.parametrize("gamma", [0.0, 0.1, 1.0])
def test_soft_dtw_is_its_definition(components, gamma):
    rng = np.random.default_rng(components)
    x, y = rng.normal(size=(9, components)), rng.normal(size=(12, components))
    value = soft_dtw.value(x, y, gamma)
    assert value == pytest.approx(plain(x, y, gamma), rel=1e-12, abs=1e-12)
    again, gradient = soft_dtw.value_and_gradient(x, y, gamma)
    assert again == value and gradient.shape == x.shape
    step = np.zeros_like(x)
    step[4, components - 1] = 1e-6
    slope = (soft_dtw.value(x + step, y, gamma) - soft_dtw.value(x - step, y, gamma)) / 2e-6
    assert gradient[4, components - 1] == pytest.approx(slope, rel=1e-5, abs=1e-6)


def test_soft_dtw_takes_any_array():
    x, y = np.arange(12.0).reshape(6, 2), np.arange(8.0).reshape(4, 2)
    expected = soft_dtw.value(x, y)
    for same in (np.asfortranarray(x), x.tolist(), x.astype(np.float32), x.astype(int), np.repeat(x, 2, axis=0)[::2]):
        assert soft_dtw.value(same, y) == expected
    assert soft_dtw.value(x[:, 0], y[:, 0]) == soft_dtw.value(x[:, :1], y[:, :1])
    with pytest.raises(ValueError, match="x has masked values"):
        soft_dtw.value(np.ma.masked_greater(x, 0), y)
    with pytest.raises(ValueError, match="P has masked values"):
        dynamics.Flow((0, 0), [np.ma.masked_equal(row, 0) for row in np.eye(2)])
    with pytest.raises(ValueError, match="P has masked values"):
        dynamics.Flow((0, 0), np.ma.masked_equal(np.eye(2), 0))
    assert soft_dtw.value(x, x, normalised=True) == pytest.approx(0, abs=1e-12)
    for wrong in (np.empty((0, 2)), np.full((3, 2), np.nan), np.zeros((2, 3)), np.zeros((2, 2, 2)), "text"):
        with pytest.raises(ValueError, match=r"."):
            soft_dtw.value(x, wrong)
    with pytest.raises(ValueError, match="gamma"):
        soft_dtw.value(x, y, -1)


@pytest.mark.parametrize("components", [1, 2, 5])
def test_a_search_is_exact(components):
    rng = np.random.default_rng(3)
    walks = [np.cumsum(rng.normal(size=(int(length), components)), axis=0) for length in rng.integers(20, 30, 60)]
    query = walks[17][:20] + rng.normal(0, 0.1, (20, components))
    index = soft_dtw.SearchIndex(walks)
    indices, distances = index.nearest(query, 5)
    everything = [soft_dtw.value(query, walk, normalised=True) for walk in walks]
    assert indices.tolist() == np.argsort(everything)[:5].tolist() and len(index) == 60
    assert np.allclose(distances, np.sort(everything)[:5])


def test_goals_of_similar_tracks():
    left, right = np.linspace([0, 0], [7, 3], 20), np.linspace([0, 0], [7, -3], 20)
    bent = np.concatenate([np.linspace([0, 0], [3, 0], 10), np.linspace([3.2, 0.4], [5, 4], 10)])
    rng = np.random.default_rng(1)
    experts = np.stack([track + rng.normal(0, 0.01, (20, 2)) for track in (left, right, bent) for _ in range(30)])
    estimator = goals.GoalEstimator(experts, similar=30, goals=2)
    ends, weights = estimator.estimate(bent[None, :8])
    assert len(estimator) == 90 and np.allclose(weights.sum(axis=1), 1)
    # mirror images of similar tracks count as well
    assert np.linalg.norm(np.abs(ends[0]) - bent[-1], axis=1).max() < 1.5
    with pytest.raises(ValueError, match="20"):
        goals.GoalEstimator(experts[:, :19])


def test_flows_approach_the_goal():
    P = np.array([[1.3, 0.4], [0.4, 0.7]])
    flow = dynamics.Flow([6, 0], P)
    start = np.array([0.0, 1.0])
    gradient = (start - [6, 0]) / np.linalg.norm(start - [6, 0])
    assert np.allclose(flow.velocity(start), -P @ gradient)
    path = flow.rollout(start, dt=0.4, steps=12)
    distances = np.linalg.norm(path - [6, 0], axis=1)
    evidence = flow.certificate(path)
    assert (np.diff(distances) < 0).all() and evidence.holds and np.allclose(evidence.potentials, distances)
    assert evidence.min_eigenvalue == pytest.approx(np.linalg.eigvalsh(P)[0])
    backwards = flow.certificate(path[::-1].copy())
    assert not backwards.holds and backwards.violation
    assert flow.rollout([[0.0, 0.0], [0.0, 0.2]], steps=30).shape == (2, 31, 2)
    for wrong in ([[1, 2], [2, 1]], [[1, 0.5], [0, 1]], [[np.nan, 0], [0, 1]]):
        with pytest.raises(ValueError, match=r"P\[0\]"):
            dynamics.Flow([0, 0], wrong)


def test_metrics_are_their_definitions():
    rng = np.random.default_rng(5)
    truth = np.cumsum(rng.normal(0, 0.3, (6, 12, 2)), axis=1)
    paths = truth[:, None] + np.cumsum(rng.normal(0, 0.2, (6, 20, 12, 2)), axis=2)
    errors = np.linalg.norm(paths - truth[:, None], axis=-1)
    assert np.allclose(metrics.ade(paths, truth), errors.mean(-1)) and np.allclose(
        metrics.fde(paths, truth), errors[..., -1]
    )
    assert np.allclose(metrics.min_ade(paths, truth), errors.mean(-1).min(1))
    assert metrics.joint_fde(paths, truth) == pytest.approx(errors[..., -1].mean(0).min())
    assert metrics.miss(paths, truth, distance=0.5).tolist() == (errors[..., -1].min(1) > 0.5).tolist()
    pairs = np.linalg.norm(paths[:, :, None] - paths[:, None], axis=-1)
    upper = np.triu_indices(20, 1)
    assert np.allclose(metrics.end_diversity(paths), pairs[:, upper[0], upper[1], -1].mean(1))
    assert np.allclose(metrics.diversity(paths), pairs[:, upper[0], upper[1]].mean((1, 2)))
    scipy = pytest.importorskip("scipy.stats")
    density = [[scipy.gaussian_kde(paths[i, :, t].T).logpdf(truth[i, t])[0] for t in range(12)] for i in range(6)]
    assert np.allclose(metrics.kde_nll(paths, truth), -np.maximum(density, -20).mean(1), rtol=1e-6)
    assert (metrics.amd(paths, truth) > 0).all() and metrics.amv(paths) > 0
    for wrong in (np.nan, -1):
        with pytest.raises(ValueError, match="0 or more"):
            metrics.collides(np.zeros((2, 12, 2)), radius=wrong)
        with pytest.raises(ValueError, match="0 or more"):
            metrics.miss(np.zeros((1, 1, 12, 2)), np.zeros((1, 12, 2)), distance=wrong)
    assert metrics.collides(np.array([[[0.0, 0], [2, 0]], [[2.0, 0], [0, 0]], [[9.0, 9], [9, 9]]])).tolist() == [
        True,
        True,
        False,
    ]
    past = np.zeros((6, 8, 2))
    everything = metrics.scores(paths, truth, past)
    assert everything["min_ade"] == pytest.approx(errors.mean(-1).min(1).mean()) and everything["pedestrians"] == 6
    both = metrics.scores([paths, paths], [truth, truth], [past, past])
    assert both["windows"] == 2 and both["min_ade"] == pytest.approx(everything["min_ade"])
    with pytest.raises(ValueError, match="weights"):
        metrics.kde_nll(paths, truth, np.full((6, 20), 0.2))
