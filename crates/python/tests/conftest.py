"""Fixtures of all tests: the command line, and readings as arrays."""

import json
import os
import signal
import subprocess
from pathlib import Path

import numpy as np
import pytest

EXAMPLES = Path(os.environ.get("PALPATE_EXAMPLES", Path(__file__).parents[3] / "examples"))


@pytest.fixture(scope="session", autouse=True)
def enable_ctrl_c():
    """Enable Ctrl-C: a process that was started in the background ignores it."""
    signal.signal(signal.SIGINT, signal.default_int_handler)


@pytest.fixture(scope="session")
def cli():
    """Runs the command line and returns its JSON or its text."""
    program = os.environ.get("PALPATE")
    if program is None:
        pytest.skip("PALPATE does not name the program")

    def run(*arguments, is_json=True):
        done = subprocess.run(
            [program, *map(str, arguments)], capture_output=True, text=True, check=True
        )
        return json.loads(done.stdout) if is_json else done.stdout

    return run


def table(name):
    return np.genfromtxt(EXAMPLES / name, delimiter=",", names=True)


def columns(rows, *names):
    return np.stack([rows[name] for name in names], axis=1)


@pytest.fixture(scope="session")
def rolls():
    """Rotations and shifts of eight rolls, mm."""
    rows = table("roll-readings.csv")
    return (
        columns(rows, "rotation_x_rad", "rotation_y_rad"),
        columns(rows, "shift_u_mm", "shift_v_mm"),
    )


@pytest.fixture(scope="session")
def glides():
    """Points, normals and fingers of thirty contacts, mm."""
    rows = table("glide-readings.csv")
    return (
        columns(rows, "x_mm", "y_mm", "z_mm"),
        columns(rows, "normal_x", "normal_y", "normal_z"),
        rows["finger"].astype(int),
    )


@pytest.fixture(scope="session")
def presses():
    """Positions and displacements of 77 markers, mm."""
    rows = table("press-readings.csv")
    return (
        columns(rows, "x_mm", "y_mm"),
        columns(rows, "normal_displacement_mm", "tangential_x_mm", "tangential_y_mm"),
    )


SENSOR = {"sensor_radius": 20.0, "depth": 2.0, "length_unit": "mm"}

BALL = {
    "name": "a-ball",
    "length_unit": "mm",
    "trials": 200,
    "scene": {
        "kind": "roll",
        "probe": {"kind": "sphere", "radius": 10.0},
        "object": {"kind": "sphere", "radius": 30.0},
        "motion": {"rate_rad_per_s": 0.1, "duration_s": 1.0},
        "noise": {"angular_velocity": {"kind": "uniform", "fraction": 0.05}},
    },
}


@pytest.fixture
def ball():
    import palpate

    return palpate.Study(BALL)
