"""EP1 by Monte Carlo: many trials at once in NumPy arrays.

Eight probes of radius 1 roll by 0.1 rad on a sphere of radius 5, in eight directions. The error of each rotation
component is uniform and at most 1 % of the rotation. The relative curvature is the least-squares map from the shifts to
the rotations; the probe's curvature is subtracted from it.

Error: rms relative error of the normal curvature over the trials.
"""

import numpy as np
from figure import median_us, print_figure

TRIALS, PROBES = 100_000, 8
RATE, SPHERE, NOISE = 0.1, 5.0, 0.01

direction = 2 * np.pi * np.arange(PROBES) / PROBES
rotation = RATE * np.stack([np.cos(direction), np.sin(direction)])
shift = rotation / (1 + 1 / SPHERE)
# The unknowns are the three components of the relative curvature, a symmetric matrix. Each probe adds two equations.
design = np.zeros((2 * PROBES, 3))
design[0::2, 0], design[0::2, 1] = shift
design[1::2, 1], design[1::2, 2] = shift
solve = np.linalg.pinv(design)
along_u, along_v = solve[:, 0::2], solve[:, 1::2]


def best_batch(random):
    """Number of trials per array that is fastest: arrays that fit into the cache are faster than one for all trials."""
    sizes = (1_000, 4_000, 16_000, TRIALS)
    return min(sizes, key=lambda size: median_us(lambda: trials(random, size), size, batches=3))


def trials(random, count):
    """Normal curvatures and twist, estimated in count trials."""
    bound = NOISE * RATE
    u = rotation[0][:, None] + random.uniform(-bound, bound, (PROBES, count))
    v = rotation[1][:, None] + random.uniform(-bound, bound, (PROBES, count))
    relative = along_u @ u + along_v @ v
    return relative[0] - 1, relative[1], relative[2] - 1


random = np.random.default_rng(1)
found, _, _ = trials(random, TRIALS)
error = np.sqrt(np.mean((found * SPHERE - 1) ** 2))
for peer, size in (("one array", TRIALS), ("arrays that fit the cache", best_batch(random))):
    time_us = median_us(lambda: trials(random, size), size)
    print_figure("EP1 trial, 8 probes", f"NumPy, {peer}", np.__version__, time_us, error)
