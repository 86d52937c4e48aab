"""Curvature from touch.

Estimates of an object's curvature from arrays of readings, and simulated studies of how well such estimates do.

====================================  ==========================================================
to                                    call
====================================  ==========================================================
estimate from small rolls             estimate_roll(rotations, shifts, probe_radius=…)
estimate from gliding fingers         estimate_glide(points, normals, fingers)
estimate from a press                 estimate_press(positions, displacements, sensor_radius=…)
find markers in camera frames         track(rest, pressed), calibrate(table), calibrate_frames(…)
lay out a skin, and cut it            Layout(radius), pattern(layout)
simulate                              Study(toml or dict).run()
find what sensor or motion will do    design(study, target, vary)
know which objects can be told apart  distinguish(study, vary=…)
====================================  ==========================================================

Lengths are in whatever unit the caller has, angles in radians where a name does not end in ``_deg``; a curvature is
positive where the object is convex. All errors are a PalpateError, which is a ValueError.
"""

from ._native import (
    SHAPE_CLASSES,
    ArgumentError,
    Batch,
    Calibration,
    ConfigError,
    DesignAnswer,
    Figure,
    GlideEstimate,
    Layout,
    PalpateError,
    Pattern,
    PressEstimate,
    ReadingsError,
    Record,
    Results,
    RollBatch,
    RollEstimate,
    RunError,
    Study,
    Table,
    ToldApart,
    Trace,
    Tracked,
    __version__,
    calibrate,
    calibrate_frames,
    design,
    distinguish,
    estimate_glide,
    estimate_press,
    estimate_roll,
    pattern,
    schema,
    track,
)
from ._scenes import scene, surface

__all__ = [
    "SHAPE_CLASSES",
    "ArgumentError",
    "Batch",
    "Calibration",
    "ConfigError",
    "DesignAnswer",
    "Figure",
    "GlideEstimate",
    "Layout",
    "PalpateError",
    "Pattern",
    "PressEstimate",
    "ReadingsError",
    "Record",
    "Results",
    "RollBatch",
    "RollEstimate",
    "RunError",
    "Study",
    "Table",
    "ToldApart",
    "Trace",
    "Tracked",
    "__version__",
    "calibrate",
    "calibrate_frames",
    "design",
    "distinguish",
    "estimate_glide",
    "estimate_press",
    "estimate_roll",
    "pattern",
    "scene",
    "schema",
    "surface",
    "track",
]
