"""Estimates compared with programs that share no code with palpate: NumPy and SciPy."""

import numpy as np
import palpate
import pytest
from scipy.integrate import quad
from scipy.interpolate import bisplev, bisplrep
from scipy.special import j0


def test_rolls_match_least_squares_of_numpy():
    random = np.random.default_rng(3)
    radius, probes = 10.0, 9
    for _ in range(50):
        object_form = random.normal(0, 0.02, (2, 2))
        relative = np.eye(2) / radius + (object_form + object_form.T) / 2
        rotations = random.normal(0, 0.2, (probes, 2))
        drives = np.stack([-rotations[:, 1], rotations[:, 0]], axis=1)
        shifts = drives @ np.linalg.inv(relative) + random.normal(0, 0.01, (probes, 2))
        # The unknowns are the three entries of the symmetric mobility matrix, which maps rotations to shifts. Each
        # probe adds two equations.
        design = np.zeros((2 * probes, 3))
        design[0::2, 0], design[0::2, 1] = drives.T
        design[1::2, 1], design[1::2, 2] = drives.T
        (uu, uv, vv), (square,), *_ = np.linalg.lstsq(design, shifts.ravel(), rcond=None)
        mobility = np.array([[uu, uv], [uv, vv]])
        form = np.linalg.inv(mobility) - np.eye(2) / radius
        std = np.sqrt(square / (2 * probes - 3))
        of_mobility = np.linalg.inv(design.T @ design) * std**2
        # Derivatives of the entries (uu, vv, uv) of the inverse matrix with respect to the entries of the mobility
        # matrix.
        jacobian = []
        for step in ([[1, 0], [0, 0]], [[0, 1], [1, 0]], [[0, 0], [0, 1]]):
            inverse = np.linalg.inv(mobility)
            change = -inverse @ np.array(step) @ inverse
            jacobian.append([change[0, 0], change[1, 1], change[0, 1]])
        jacobian = np.array(jacobian).T
        covariance = jacobian @ of_mobility @ jacobian.T

        found = palpate.estimate_roll(rotations, shifts, probe_radius=radius)
        assert found.normal_curvature_u.value == pytest.approx(form[0, 0], abs=1e-12)
        assert found.normal_curvature_v.value == pytest.approx(form[1, 1], abs=1e-12)
        assert found.gaussian_curvature.value == pytest.approx(np.linalg.det(form), abs=1e-12)
        assert found.residual_rms.value == pytest.approx(std, rel=1e-9)
        np.testing.assert_allclose(found.covariance, covariance, rtol=1e-8, atol=1e-18)
        smallest, largest = np.linalg.eigvalsh(form)
        assert found.principal_curvature_min.value == pytest.approx(smallest, abs=1e-12)
        assert found.principal_curvature_max.value == pytest.approx(largest, abs=1e-12)


@pytest.mark.parametrize("smoothing", [0.3, 3.0, 30.0])
def test_the_first_pass_matches_fitpack(smoothing):
    random = np.random.default_rng(5)
    # The contacts are symmetric in x and in y, so the frame of the patch is the coordinate frame.
    quarter = [
        (x, y, 0.1 * x * x - 0.08 * y * y + random.normal(0, 0.03))
        for y in (0.5, 1.5)
        for x in (0.3, 0.9, 1.5, 2.1)
    ]
    rows = sorted({(sx * x, sy * y, z) for x, y, z in quarter for sx in (-1, 1) for sy in (-1, 1)},
                  key=lambda row: (row[1], row[0]))
    points = np.array(rows)
    fingers = np.repeat(np.arange(4), 8)
    found = palpate.estimate_glide(
        points, None, fingers, method="two-pass", passes=1, first_degree=3, weight=10.0,
        smoothing=smoothing, inter_finger_distance=1.0, grid=9,
    )
    x, y, z = points.T
    spline = bisplrep(x, y, z, w=np.full(len(x), 10.0), kx=3, ky=3, s=smoothing)
    place = found.map.position

    def at(across, along):
        values = [bisplev(a, b, spline, across, along) for a, b in place[..., :2].reshape(-1, 2)]
        return np.reshape(values, place.shape[:2])

    p, q, r, s, t = at(1, 0), at(0, 1), at(2, 0), at(1, 1), at(0, 2)
    d = 1 + p * p + q * q
    gaussian = (r * t - s * s) / d**2
    mean = -((1 + q * q) * r - 2 * p * q * s + (1 + p * p) * t) / (2 * d**1.5)
    np.testing.assert_allclose(place[..., 2], at(0, 0), atol=1e-7)
    np.testing.assert_allclose(found.map.gaussian_curvature, gaussian, atol=2e-6)
    np.testing.assert_allclose(found.map.mean_curvature, mean, atol=2e-6)


def displacement(radius, depth, contact, approach, poisson):
    """Inward displacement of an elastic half-space under a Hertz pressure, by a Hankel transform."""

    def integrand(t):
        k = t / contact
        transform = (np.sin(t) - t * np.cos(t)) / t**3 if t > 1e-3 else 1 / 3 - t * t / 30
        fading = (1 + k * depth / (2 * (1 - poisson))) * np.exp(-k * depth)
        return transform * fading * j0(k * radius)

    whole, _ = quad(integrand, 0, 60 * contact / depth, limit=2000, epsabs=1e-12)
    # At the centre of the surface the integral is pi/4.
    return approach * whole / (np.pi / 4)


@pytest.mark.parametrize("poisson", [0.5, 0.3])
def test_the_half_space_matches_a_hankel_integral(poisson):
    study = palpate.Study({
        "name": "press",
        "length_unit": "mm",
        "scene": {
            "kind": "press",
            "probe": {"kind": "marker-sphere", "radius": 20.0, "marker_depth": 2.0},
            "object": {"kind": "sphere", "radius": 30.0},
            "motion": {"indentation": 1.2},
            "model": {"kind": "half-space", "poisson": poisson},
        },
    })
    truth = study.trace().contacts
    relative = 1 / 20 + 1 / 30
    contact = np.sqrt(1.2 / relative)
    near = truth["radial_position"] < 15
    expected = [
        displacement(abs(radius), 2.0, contact, 1.2, poisson)
        for radius in truth["radial_position"][near]
    ]
    found = truth["normal_displacement"][near]
    np.testing.assert_allclose(found, expected, rtol=1e-6, atol=1e-9)
    # Solve the inverse problem: estimate the object from these displacements.
    layout = palpate.Layout(20.0)
    away = np.hypot(*layout.positions.T)
    moved = [displacement(radius, 2.0, contact, 1.2, poisson) for radius in away]
    estimate = palpate.estimate_press(
        layout.positions, moved, sensor_radius=20, depth=2, poisson=poisson
    )
    assert estimate.object_radius.value == pytest.approx(30, rel=1e-4)
    assert estimate.indentation.value == pytest.approx(1.2, rel=1e-5)


def test_a_batch_equals_single_estimates(rolls):
    random = np.random.default_rng(7)
    rotations, shifts = rolls
    many_rotations = rotations + random.normal(0, 0.01, (37, *rotations.shape))
    many_shifts = shifts + random.normal(0, 0.05, (37, *shifts.shape))
    settings = [
        {},
        {"pitch": 0.5},
        {"shift_std": 0.05},
        {"rotation_std_rad": 0.01, "relative_rotation_std": 0.02},
    ]
    for given in settings:
        for turned, moved in (
            (many_rotations, many_shifts), (rotations, many_shifts), (many_rotations, shifts)
        ):
            batch = palpate.estimate_roll(turned, moved, probe_radius=10, **given)
            assert len(batch) == 37 and batch.errors == {}
            for place in range(37):
                one = palpate.estimate_roll(
                    turned[place] if turned.ndim == 3 else turned,
                    moved[place] if moved.ndim == 3 else moved,
                    probe_radius=10,
                    **given,
                )
                # These fields must be equal to the last bit.
                for name in (
                    "normal_curvature_u", "normal_curvature_v", "gaussian_curvature", "mean_curvature"
                ):
                    ours, alone = getattr(batch, name), getattr(one, name)
                    assert (ours.value[place], ours.std[place]) == (alone.value, alone.std)
                assert batch.residual_rms.value[place] == one.residual_rms.value
                assert batch.arc_length.value[place] == one.arc_length.value
                assert batch.principal_curvature_max.value[place] == one.principal_curvature_max.value
                assert batch.principal_direction_max_deg[place] == one.principal_direction_max_deg
