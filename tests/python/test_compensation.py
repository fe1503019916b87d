# SPDX-License-Identifier: MIT
"""Compensation at the edge: SciPy's solvers find no place inside the array that is felt nearer."""
import numpy as np
import pytest

import tactor

pytestmark = pytest.mark.unsanitized
optimize = pytest.importorskip("scipy.optimize")

SIGMA, SIGMA_V = 5.0, 100.0
TRIANGLE = "".join(f"[[tactor]]\nx_mm = {x}\ny_mm = {y}\n" for x, y in ((0, 0), (40, 0), (12, 34)))


def felt_places(onsets):
    """Returns the matrix by which the observer makes felt places of played ones."""
    n = len(onsets)
    stiff = np.eye(n)
    for i, k in enumerate((SIGMA / (SIGMA_V * np.diff(onsets))) ** 2):
        stiff[i:i + 2, i:i + 2] += k * np.array([[1.0, -1.0], [-1.0, 1.0]])
    return np.linalg.inv(stiff)


def both(array, points, **more):
    """Returns onsets, targets and the played places for them."""
    stroke = tactor.Stroke.timed(*np.array(points).T)
    asked = tactor.plan(array, stroke, phantom="barycentric", **more)
    moved = tactor.plan(array, stroke, phantom="barycentric", compensate="low-speed", **more)
    return asked.onsets, asked.positions, moved.positions


def cost(felt, targets, places):
    return float(((felt @ places - targets) ** 2).sum())


@pytest.mark.parametrize("seed", range(6))
def test_in_a_rectangle(seed):
    random = np.random.default_rng(seed)
    points = [(0.25 * i, *random.choice((0.0, 5.0, 35.0, 40.0), 2)) for i in range(6)]
    onsets, targets, played = both(tactor.Array.preset("palm-3x3"), points)
    assert played.min() >= -1e-9 and played.max() <= 40 + 1e-9
    felt = felt_places(onsets)
    # A box separates the axes: two problems of least squares with bounds.
    best = np.stack([optimize.lsq_linear(felt, targets[:, axis], (0, 40), method="bvls", tol=1e-14).x for axis in (0, 1)], axis=1)
    assert np.abs(best - targets).max() > 1.0 and np.minimum(best, 40 - best).min() < 1e-6
    assert cost(felt, targets, played) <= cost(felt, targets, best) + 1e-6


@pytest.mark.parametrize("seed", range(4))
def test_in_a_triangle(tmp_path, seed):
    file = tmp_path / "triangle.toml"
    file.write_text('[array]\nname = "triangle"\n' + TRIANGLE)
    random = np.random.default_rng(seed)
    corners = np.array([(0.0, 0.0), (40.0, 0.0), (12.0, 34.0)])
    points = [(0.2 * i, *(random.dirichlet((0.4, 0.4, 0.4)) @ corners)) for i in range(6)]
    onsets, targets, played = both(tactor.Array.from_file(file), points)
    edges = np.roll(corners, -1, axis=0) - corners
    normals = np.stack([-edges[:, 1], edges[:, 0]], axis=1)
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)  # inwards
    offsets = (normals * corners).sum(axis=1)
    assert (played @ normals.T - offsets).min() > -1e-7
    felt = felt_places(onsets)

    def slack(flat):
        return (flat.reshape(-1, 2) @ normals.T - offsets).ravel()

    best = optimize.minimize(
        lambda flat: cost(felt, targets, flat.reshape(-1, 2)), targets.ravel(), method="SLSQP",
        jac=lambda flat: (2 * felt.T @ (felt @ flat.reshape(-1, 2) - targets)).ravel(),
        constraints={"type": "ineq", "fun": slack, "jac": lambda flat: np.kron(np.eye(len(targets)), normals)},
        options={"ftol": 1e-13, "maxiter": 1000})
    assert best.success and slack(best.x).min() > -1e-7
    assert cost(felt, targets, played) <= best.fun + 1e-6
    assert best.fun > 1e-4
