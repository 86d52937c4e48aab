"""Curvature from touch.

Estimates of an object's curvature from arrays of readings, and simulated studies of the errors of such estimates.

====================================  ==========================================================
to                                    call
====================================  ==========================================================
estimate from small rolls             estimate_roll(rotations, shifts, probe_radius=…)
estimate from gliding fingers         estimate_glide(points, normals, fingers)
estimate from a press                 estimate_press(positions, displacements, sensor_radius=…)
find markers in camera frames         track(rest, pressed), calibrate(table), calibrate_frames(…)
find the camera of a sensor           calibrate_camera(rest, study)
fit the images of the markers         track(rest, pressed, method="image", like=study, calibration=…)
lay out a skin, and cut it            Layout(radius), pattern(layout)
simulate                              Study(toml or dict).run()
find a sensor or motion that suffices design(study, target, vary)
find distinguishable objects          distinguish(study, vary=…)
find what to change first             sensitivity(study, quantity=…)
score the papers' claims, on a page   report(results, …)
explain a word                        explain(word)
====================================  ==========================================================

Lengths have the unit of the caller. Angles are in radians, or in degrees if the name ends in ``_deg``. The curvature of a
convex object is positive. Every error is a PalpateError, which is a ValueError.
"""

from . import _native
from ._native import *
from ._scenes import scene, surface
from ._table import Table

__all__ = ["Table", "scene", "surface"]
__all__ += _native.__all__
