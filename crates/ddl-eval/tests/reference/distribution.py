# Writes distribution.json: log densities of scipy.stats.gaussian_kde with weights (scipy 1.17.1), and
# Mahalanobis distances and largest eigenvalues with numpy 2.4.6. `python3 distribution.py` in this folder.
import json

import numpy as np
from scipy.special import logsumexp
from scipy.stats import gaussian_kde, multivariate_normal

FLOOR = 1e-4  # (1 cm)^2


def raised(matrix):
    values, vectors = np.linalg.eigh(matrix)
    return vectors @ np.diag(np.maximum(values, FLOOR)) @ vectors.T


def log_density(points, weights, at):
    points, weights = np.asarray(points, float), np.asarray(weights, float)
    try:
        kde = gaussian_kde(points.T, weights=weights)
        if np.linalg.eigvalsh(kde.covariance).min() >= FLOOR:
            return float(kde.logpdf(np.asarray(at, float))[0])
    except np.linalg.LinAlgError:
        pass
    # A singular bandwidth, which scipy refuses, or one below the floor.
    n_eff = 1 / (weights**2).sum()
    covariance = np.cov(points.T, aweights=weights, bias=False)
    bandwidth = raised(covariance * n_eff ** (-1 / 3))
    return float(logsumexp([np.log(w) + multivariate_normal(p, bandwidth).logpdf(at) for p, w in zip(points, weights)]))


def spread(points, weights, at):
    points, weights = np.asarray(points, float), np.asarray(weights, float)
    covariance = raised(np.cov(points.T, aweights=weights, bias=True))
    off = np.asarray(at, float) - weights @ points
    return float(np.sqrt(off @ np.linalg.solve(covariance, off))), covariance


def case(points, weights, at):
    distance, covariance = spread(points, weights, at)
    return dict(
        points=points,
        weights=weights,
        at=at,
        log_density=log_density(points, weights, at),
        mahalanobis=distance,
        eigenvalue=float(np.linalg.eigvalsh(covariance).max()),
    )


def cases():
    random = np.random.default_rng(20)
    for k in (2, 3, 5, 12, 20, 20):
        for scale in (0.05, 0.5, 4.0):
            points = (random.normal(size=(k, 2)) * [scale, 0.3 * scale] + random.normal(size=2) * 10).tolist()
            weights = random.dirichlet(np.full(k, 0.7 + scale)).tolist()
            at = (np.mean(points, axis=0) + random.normal(size=2) * scale).tolist()
            yield case(points, weights, at)
    line = [[0.0, 0.0], [0.3, 0.4], [0.6, 0.8], [1.5, 2.0]]
    yield case(line, [0.25, 0.25, 0.3, 0.2], [0.6, 0.79])
    yield case([[2.0, 1.0]] * 3, [0.5, 0.25, 0.25], [2.01, 1.0])
    yield case([[0.0, 0.0], [0.001, 0.0], [0.0, 0.002]], [0.2, 0.3, 0.5], [0.01, 0.02])


json.dump(dict(cases=list(cases())), open("distribution.json", "w"), indent=1)
