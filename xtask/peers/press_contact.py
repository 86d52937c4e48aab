"""A ball of radius 20 pressed 1.4 deep into an elastic half-space: contact on 256 x 256 points by Tamaas.

Load control by conjugate gradients (Polonsky and Keer), without periodic images.

Error: relative error of the contact radius. The radius is computed from the contact area and from the second moment of
the pressure; the smaller of the two errors counts.
"""

import numpy as np
import tamaas
from figure import median_us, print_figure

SIDE, POINTS, TOLERANCE = 16.0, 256, 1e-4
RADIUS, DEPTH, MODULUS = 20.0, 1.4, 1.0

contact = np.sqrt(RADIUS * DEPTH)
force = 4 / 3 * MODULUS * np.sqrt(RADIUS) * DEPTH**1.5
along = (np.arange(POINTS) + 0.5) * SIDE / POINTS - SIDE / 2
square = along[:, None] ** 2 + along[None, :] ** 2
ball = np.ascontiguousarray(-square / (2 * RADIUS))


def press():
    """Solves the contact and returns the pressure."""
    model = tamaas.ModelFactory.createModel(tamaas.model_type.basic_2d, [SIDE, SIDE], [POINTS, POINTS])
    model.E, model.nu = MODULUS, 0.0
    solver = tamaas.PolonskyKeerRey(model, ball, TOLERANCE)
    tamaas.ModelFactory.registerNonPeriodic(model, "dcfft")
    solver.setIntegralOperator("dcfft")
    solver.solve(force / SIDE**2)
    return np.array(model.traction)


tamaas.set_log_level(tamaas.LogLevel.error)
tamaas.initialize(1)
pressure = press()
area = np.count_nonzero(pressure > 1e-9 * pressure.max()) * (SIDE / POINTS) ** 2
readings = np.sqrt(area / np.pi), np.sqrt(2.5 * (pressure * square).sum() / pressure.sum())
error = min(abs(reading / contact - 1) for reading in readings)
print_figure("press, contact and pressure", "Tamaas, 256 x 256", tamaas.__version__, median_us(press, batches=3), error)
