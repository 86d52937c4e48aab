"""EP2 of 30 contacts: a smoothing spline of FITPACK, and its curvatures on 30 x 30 points.

Reads DIRECTORY/few.csv: patches of 30 contacts of a sphere of radius 5. Degree 2, weight 100 and smoothing 1000: the
settings of the 1996 paper.

Error: rms relative error of the mean curvature over all points of all maps.
"""

import sys
import warnings

import numpy as np
import scipy
from figure import median_us, print_figure
from scipy.interpolate import BSpline, bisplrep

DEGREE, WEIGHT, SMOOTHING, SPHERE = 2, 100.0, 1000.0, 5.0
GRID_X, GRID_Y = np.linspace(-1.5, 1.5, 30), np.linspace(-1.0, 1.0, 30)


def fit(x, y, z):
    """Fits the spline; returns its knots along x and y, and its coefficients."""
    weights = np.full(len(x), WEIGHT)
    return bisplrep(x, y, z, w=weights, kx=DEGREE, ky=DEGREE, s=SMOOTHING)[:3]


def curvatures(knots_x, knots_y, coefficients):
    """Gaussian and mean curvature on the grid, by B-spline bases: bisplev has no second derivative of degree 2."""
    rows, columns = len(knots_x) - DEGREE - 1, len(knots_y) - DEGREE - 1
    coefficients = np.asarray(coefficients).reshape(rows, columns)
    along_x, along_y = BSpline(knots_x, np.eye(rows), DEGREE), BSpline(knots_y, np.eye(columns), DEGREE)
    x0, x1, x2 = (along_x(GRID_X, order) for order in range(3))
    y0, y1, y2 = (along_y(GRID_Y, order).T for order in range(3))
    p, q = x1 @ coefficients @ y0, x0 @ coefficients @ y1
    r, s, t = x2 @ coefficients @ y0, x1 @ coefficients @ y1, x0 @ coefficients @ y2
    square = 1 + p * p + q * q
    gaussian = (r * t - s * s) / square**2
    mean = ((1 + q * q) * r - 2 * p * q * s + (1 + p * p) * t) / (2 * square**1.5)
    return gaussian, mean


def all_maps(patches):
    """The maps of all patches, one after the other."""
    for patch in patches:
        yield curvatures(*fit(*patch))


def exhaust(maps):
    """Computes all maps and discards them."""
    for _ in maps:
        pass


warnings.simplefilter("ignore")
table = np.loadtxt(f"{sys.argv[1]}/few.csv", delimiter=",", skiprows=1)
patches = [np.ascontiguousarray(table[table[:, 0] == patch, 1:].T) for patch in np.unique(table[:, 0])]
means = np.array([mean for _, mean in all_maps(patches)])
error = np.sqrt(np.mean((means * SPHERE + 1) ** 2))
time_us = median_us(lambda: exhaust(all_maps(patches)), len(patches))
print_figure("EP2, 30 contacts, map of 30 x 30", "FITPACK bisplrep", scipy.__version__, time_us, error)
