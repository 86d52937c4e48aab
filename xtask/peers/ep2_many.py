"""EP2 of 100 000 points on z = 0.2 sin 2x cos 2y: a least-squares spline, and its curvatures on 30 x 30 points.

Reads DIRECTORY/many.csv: x, y and z. The error of z is at most 0.02.

Error: rms error of the mean curvature over the points of the map.
"""

import sys

import numpy as np
import scipy
from figure import median_us, print_figure
from scipy.interpolate import LSQBivariateSpline

GRID_X, GRID_Y = np.linspace(-1.5, 1.5, 30), np.linspace(-1.0, 1.0, 30)
KNOTS = np.linspace(-1.5, 1.5, 8)[1:-1]


def mean_curvature(p, q, r, s, t):
    """Mean curvature of a graph with these first and second derivatives."""
    return ((1 + q * q) * r - 2 * p * q * s + (1 + p * p) * t) / (2 * (1 + p * p + q * q) ** 1.5)


def gaussian_curvature(p, q, r, s, t):
    """Gaussian curvature of a graph with these first and second derivatives."""
    return (r * t - s * s) / (1 + p * p + q * q) ** 2


def whole(x, y, z):
    """Fits the spline and computes its curvatures on the grid."""
    spline = LSQBivariateSpline(x, y, z, KNOTS, KNOTS)
    jet = [spline(GRID_X, GRID_Y, dx=dx, dy=dy) for dx, dy in ((1, 0), (0, 1), (2, 0), (1, 1), (0, 2))]
    return gaussian_curvature(*jet), mean_curvature(*jet)


x, y, z = np.ascontiguousarray(np.loadtxt(f"{sys.argv[1]}/many.csv", delimiter=",", skiprows=1).T)
at_x, at_y = np.meshgrid(2 * GRID_X, 2 * GRID_Y, indexing="ij")
height = 0.2 * np.sin(at_x) * np.cos(at_y)
slopes = (0.4 * np.cos(at_x) * np.cos(at_y), -0.4 * np.sin(at_x) * np.sin(at_y))
truth = mean_curvature(*slopes, -4 * height, -0.8 * np.cos(at_x) * np.sin(at_y), -4 * height)
error = np.sqrt(np.mean((whole(x, y, z)[1] - truth) ** 2))
time_us = median_us(lambda: whole(x, y, z))
task, peer = "EP2, 100 000 contacts, map of 30 x 30", "LSQBivariateSpline, 6 x 6 knots"
print_figure(task, peer, scipy.__version__, time_us, error)
