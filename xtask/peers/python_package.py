"""Compares palpate for Python with NumPy and SciPy, in one process on the same arrays.

Reads DIRECTORY/few.csv, patches of 30 contacts of a sphere of radius 5, and many.csv. The second argument is the group
of tasks.

Error: rms relative error of the mean curvature over sets, or over all points of all maps.
"""

import sys
import warnings

import numpy as np
import palpate
import scipy
from figure import median_us, medians_us, print_figure

RADIUS, SPHERE, PROBES, SETS, SHIFT_STD = 1.0, 5.0, 8, 100_000, 1e-4
# `cargo xtask peers` recognises the figures of palpate by this name.
OURS = "palpate for Python"

random = np.random.default_rng(1)
direction = 2 * np.pi * np.arange(PROBES) / PROBES
drive = 0.1 * np.stack([np.cos(direction), np.sin(direction)], axis=1)
rotations = np.stack([drive[:, 1], -drive[:, 0]], axis=1)
shifts = drive / (1 / RADIUS + 1 / SPHERE) + random.normal(0, SHIFT_STD, (SETS, PROBES, 2))


def error_of(mean):
    return np.sqrt(np.mean((np.asarray(mean) * SPHERE - 1) ** 2))


def curvatures(uu, uv, vv):
    """Normal, Gaussian and mean curvatures of the object, from the mobility of the contact."""
    determinant = uu * vv - uv * uv
    k_u, k_v, twist = vv / determinant - 1 / RADIUS, uu / determinant - 1 / RADIUS, -uv / determinant
    return k_u, k_v, k_u * k_v - twist * twist, (k_u + k_v) / 2


def of_drives(drives):
    """Equations for the three components of a symmetric mobility: two per probe."""
    equations = np.zeros((2 * PROBES, 3))
    equations[0::2, 0], equations[0::2, 1] = drives.T
    equations[1::2, 1], equations[1::2, 2] = drives.T
    return equations


def one_by_numpy(turned, moved):
    drives = np.stack([-turned[:, 1], turned[:, 0]], axis=1)
    mobility, *_ = np.linalg.lstsq(of_drives(drives), moved.ravel(), rcond=None)
    return curvatures(*mobility)


def roll():
    def estimate(turned, moved):
        return palpate.estimate_roll(turned, moved, probe_radius=RADIUS, shift_std=SHIFT_STD)

    few = shifts[:200]
    task = "estimate_roll of 8 probes"
    theirs = [one_by_numpy(rotations, moved)[3] for moved in few]
    ours = [estimate(rotations, moved).mean_curvature.value for moved in few]
    one = few[0].copy()
    turned, moved = rotations.tolist(), one.tolist()
    numpy_us, arrays_us, lists_us = medians_us([
        lambda: one_by_numpy(rotations, one),
        lambda: estimate(rotations, one).p_value,
        lambda: estimate(turned, moved).p_value,
    ])
    print_figure(task, "NumPy lstsq", np.__version__, numpy_us, error_of(theirs))
    print_figure(task, f"{OURS}, arrays", palpate.__version__, arrays_us, error_of(ours))
    print_figure(task, f"{OURS}, lists", palpate.__version__, lists_us, error_of(ours))


def all_by_numpy(turned, moved):
    """Solves the normal equations [[a, b, 0], [b, a + c, b], [0, b, c]] of every set by elimination from both ends."""
    x, y = -turned[..., 1], turned[..., 0]
    u, v = moved[..., 0], moved[..., 1]
    a, b, c = (np.einsum("...i,...i", one, other) for one, other in ((x, x), (x, y), (y, y)))
    r1, r3 = np.einsum("...i,...i", x, u), np.einsum("...i,...i", y, v)
    r2 = np.einsum("...i,...i", y, u) + np.einsum("...i,...i", x, v)
    uv = (r2 - b * r1 / a - b * r3 / c) / (a + c - b * b / a - b * b / c)
    return (r1 - b * uv) / a, uv, (r3 - b * uv) / c, (a, b, c)


def with_errors_by_numpy(turned, moved):
    """Curvatures, the standard deviations of all but the twist, and the root mean square of the residuals."""
    uu, uv, vv, (a, b, c) = all_by_numpy(turned, moved)
    found = curvatures(uu, uv, vv)
    k_u, k_v, gaussian, _ = found
    determinant = uu * vv - uv * uv
    w_u, w_v, w = vv / determinant, uu / determinant, -uv / determinant
    # Covariance of the mobility, and gradients of the curvatures with respect to the mobility.
    middle = a + c
    scale = SHIFT_STD**2 / (a * (middle * c - b * b) - b * b * c)
    c11, c12, c13 = scale * (middle * c - b * b), -scale * b * c, scale * b * b
    c22, c23, c33 = scale * a * c, -scale * a * b, scale * (a * middle - b * b)
    of_u = (w_u * w_u, 2 * w_u * w, w * w)
    of_v = (w * w, 2 * w * w_v, w_v * w_v)
    of_twist = (w_u * w, w_u * w_v + w * w, w * w_v)

    def std(gradient):
        g, h, i = gradient
        variance = c11 * g * g + c22 * h * h + c33 * i * i + 2 * (c12 * g * h + c13 * g * i + c23 * h * i)
        return np.sqrt(variance)

    of_gaussian = [k_v * one + k_u * other - 2 * w * both for one, other, both in zip(of_u, of_v, of_twist, strict=True)]
    of_mean = [(one + other) / 2 for one, other in zip(of_u, of_v, strict=True)]
    stds = [std(gradient) for gradient in (of_u, of_v, of_gaussian, of_mean)]
    x, y = -turned[..., 1], turned[..., 0]
    left_u = moved[..., 0] - (uu[:, None] * x + uv[:, None] * y)
    left_v = moved[..., 1] - (uv[:, None] * x + vv[:, None] * y)
    squares = np.einsum("...i,...i", left_u, left_u) + np.einsum("...i,...i", left_v, left_v)
    return found, stds, np.sqrt(squares / (2 * PROBES - 3))


def batch():
    solve = np.linalg.pinv(of_drives(drive))

    def alike(moved):
        return curvatures(*(solve @ moved.reshape(len(moved), -1).T))

    each = np.broadcast_to(rotations, shifts.shape).copy()
    for task, theirs, turned in (
        ("EP1 estimates, 100 000 sets of 8 probes turned alike", lambda: alike(shifts), rotations),
        ("EP1 estimates, 100 000 sets of 8 probes", lambda: curvatures(*all_by_numpy(each, shifts)[:3]), each),
        (
            "EP1 estimates with standard deviations and residuals, 100 000 sets of 8 probes",
            lambda: with_errors_by_numpy(each, shifts)[0],
            each,
        ),
    ):

        def ours(turned=turned):
            batch = palpate.estimate_roll(turned, shifts, probe_radius=RADIUS, shift_std=SHIFT_STD, threads=1)
            batch.mean_curvature
            return batch

        theirs_us, ours_us = medians_us([theirs, ours], SETS)
        print_figure(task, "NumPy, vectorised", np.__version__, theirs_us, error_of(theirs()[3]))
        print_figure(task, OURS, palpate.__version__, ours_us, error_of(ours().mean_curvature.value))
    # Both programs must state the same standard errors. NumPy's standard errors are first-order approximations.
    _, stds, residual = with_errors_by_numpy(each, shifts)
    estimate = ours()
    names = ("normal_curvature_u", "normal_curvature_v", "gaussian_curvature", "mean_curvature")
    for name, std in zip(names, stds, strict=True):
        np.testing.assert_allclose(getattr(estimate, name).std, std, rtol=1e-5)
    np.testing.assert_allclose(estimate.residual_rms.value, residual, rtol=1e-6)


def patches():
    table = np.loadtxt(f"{sys.argv[1]}/few.csv", delimiter=",", skiprows=1)
    return [np.ascontiguousarray(table[table[:, 0] == patch, 1:]) for patch in np.unique(table[:, 0])]


def of_all(work, everything):
    for one in everything:
        work(one)


def glide():
    few = patches()
    task = "estimate_glide of 30 contacts, map of 30 x 30"

    def ours(points):
        return palpate.estimate_glide(points).map.mean_curvature

    error = error_of([ours(points) for points in few])
    print_figure(task, OURS, palpate.__version__, median_us(lambda: of_all(ours, few), len(few)), error)
    many = np.loadtxt(f"{sys.argv[1]}/many.csv", delimiter=",", skiprows=1)
    # These points are not on a sphere, so this number only shows that palpate for Python and in Rust agree.
    error = error_of(ours(many))
    task = "estimate_glide of 100 000 contacts, map of 30 x 30"
    print_figure(task, OURS, palpate.__version__, median_us(lambda: ours(many), batches=5), error)


def two_pass():
    from scipy.interpolate import BSpline, bisplrep

    warnings.simplefilter("ignore")
    few = patches()
    weight, smoothing, step = 100.0, 1000.0, 0.05

    class Spline:
        """Smoothing spline of one degree in both directions, and its derivatives anywhere."""

        def __init__(self, x, y, z, degree):
            weights = np.full(len(x), weight)
            knots_x, knots_y, found = bisplrep(x, y, z, w=weights, kx=degree, ky=degree, s=smoothing)[:3]
            rows, columns = len(knots_x) - degree - 1, len(knots_y) - degree - 1
            self.found = np.asarray(found).reshape(rows, columns)
            self.along = BSpline(knots_x, np.eye(rows), degree), BSpline(knots_y, np.eye(columns), degree)

        def at(self, x, y, order):
            return np.einsum("ni,ij,nj->n", self.along[0](x), self.found, self.along[1](y, order))

        def mean_curvature(self, grid_x, grid_y):
            x0, x1, x2 = (self.along[0](grid_x, order) for order in range(3))
            y0, y1, y2 = (self.along[1](grid_y, order).T for order in range(3))
            p, q = x1 @ self.found @ y0, x0 @ self.found @ y1
            r, s, t = x2 @ self.found @ y0, x1 @ self.found @ y1, x0 @ self.found @ y2
            return -((1 + q * q) * r - 2 * p * q * s + (1 + p * p) * t) / (2 * (1 + p * p + q * q) ** 1.5)

    def theirs(points, passes):
        """Mean curvature on a grid over the contacts; the fingers glide along x."""
        x, y, z = points.T
        grid_x, grid_y = (np.linspace(one.min(), one.max(), 30) for one in (x, y))
        spline = Spline(x, y, z, 2)
        if passes == 2:
            height, slope = spline.at(x, y, 0), spline.at(x, y, 1)
            across = step / np.hypot(slope, 1)
            steps = [(0 * across), across, -across]
            x = np.tile(x, 3)
            z = np.concatenate([height + one * slope for one in steps])
            y = np.concatenate([y + one for one in steps])
            spline = Spline(x, y, z, 3)
        return spline.mean_curvature(grid_x, grid_y)

    fingers = np.repeat(np.arange(3), 10)

    def ours(points, passes):
        estimate = palpate.estimate_glide(
            points, None, fingers, method="two-pass", passes=passes, inter_finger_distance=1.0
        )
        return estimate.map.mean_curvature

    for passes, words in ((1, "first pass alone"), (2, "both passes")):
        task = f"two-pass of 30 contacts, {words}, map of 30 x 30"

        def all_theirs(passes=passes):
            return [theirs(points, passes) for points in few]

        def all_ours(passes=passes):
            return [ours(points, passes) for points in few]

        theirs_us, ours_us = medians_us([all_theirs, all_ours], len(few))
        print_figure(task, "FITPACK bisplrep", scipy.__version__, theirs_us, error_of(all_theirs()))
        print_figure(task, OURS, palpate.__version__, ours_us, error_of(all_ours()))


{"python-roll": roll, "python-batch": batch, "python-glide": glide, "python-two-pass": two_pass}[sys.argv[2]]()
