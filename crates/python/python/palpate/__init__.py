"""Curvature from touch.

Estimates of an object's curvature from arrays of readings, and simulated studies of how well such estimates do.

====================================  ==========================================================
to                                    call
====================================  ==========================================================
estimate from small rolls             estimate_roll(rotations, shifts, probe_radius=…)
estimate from gliding fingers         estimate_glide(points, normals, fingers)
estimate from a press                 estimate_press(positions, displacements, sensor_radius=…)
find markers in camera frames         track(rest, pressed), calibrate(table), calibrate_frames(…)
find the camera of a sensor           calibrate_camera(rest, study)
fit what that camera sees             track(rest, pressed, method="image", like=study, calibration=…)
lay out a skin, and cut it            Layout(radius), pattern(layout)
simulate                              Study(toml or dict).run()
find what sensor or motion will do    design(study, target, vary)
know which objects can be told apart  distinguish(study, vary=…)
score the papers' claims, on a page   report(results, …)
know what a word means                explain(word)
====================================  ==========================================================

Lengths are in whatever unit the caller has, angles in radians where a name does not end in ``_deg``; a curvature is
positive where the object is convex. All errors are a PalpateError, which is a ValueError.
"""

from . import _native
from ._native import *
from ._scenes import scene, surface
from ._table import Table

__all__ = ["Table", "scene", "surface"]
__all__ += _native.__all__
