"""Accepted arguments, and the errors of invalid ones."""

import importlib

import numpy as np
import palpate
import pytest
from conftest import SENSOR


def equal(one, other):
    return one.to_dict() == other.to_dict()


def in_layouts(array):
    """The same array in several memory layouts."""
    wide = np.zeros((*array.shape[:-1], 2 * array.shape[-1]))
    wide[..., ::2] = array
    fixed = array.copy()
    fixed.flags.writeable = False
    flipped = np.ascontiguousarray(array[::-1])[::-1]
    return {
        "strided": wide[..., ::2],
        "fortran": np.asfortranarray(array),
        "read-only": fixed,
        "reversed": flipped,
        "list": array.tolist(),
        "big-endian": array.astype(">f8"),
        "long double": array.astype(np.longdouble),
    }


@pytest.mark.parametrize("layout", in_layouts(np.zeros((2, 2))))
def test_arrays_in_any_layout_are_accepted(rolls, glides, presses, layout):
    def of(array):
        return in_layouts(array)[layout]

    whole = palpate.estimate_roll(*rolls, probe_radius=10)
    assert equal(whole, palpate.estimate_roll(*map(of, rolls), probe_radius=10))
    points, normals, fingers = glides
    whole = palpate.estimate_glide(points, normals, fingers)
    assert equal(whole, palpate.estimate_glide(of(points), of(normals), list(fingers)))
    whole = palpate.estimate_press(*presses, **SENSOR)
    assert equal(whole, palpate.estimate_press(*map(of, presses), **SENSOR))


def test_single_precision_and_whole_numbers_are_accepted(rolls):
    single = [array.astype(np.float32) for array in rolls]
    double = [array.astype(float) for array in single]
    assert equal(
        palpate.estimate_roll(*single, probe_radius=10), palpate.estimate_roll(*double, probe_radius=10)
    )
    whole = palpate.estimate_press(
        np.array([[0, 0], [3, 0], [0, 3], [-3, 0], [0, -3], [9, 9]], dtype=np.int8),
        [4, 3, 3, 3, 3, 0], sensor_radius=np.float32(20), depth=np.int64(0),
    )
    assert whole.markers == 6


@pytest.mark.parametrize("name", ["pandas", "polars"])
def test_columns_of_data_frames_are_accepted(presses, name):
    frames = importlib.import_module(name)
    positions, displacements = presses
    frame = frames.DataFrame({"x": positions[:, 0], "y": positions[:, 1], "inward": displacements[:, 0]})
    found = palpate.estimate_press(frame[["x", "y"]], frame["inward"], **SENSOR)
    assert equal(found, palpate.estimate_press(positions, displacements[:, 0], **SENSOR))


def test_a_rotation_about_the_normal_does_not_change_the_estimate(rolls):
    rotations, shifts = rolls
    spun = np.column_stack([rotations, np.linspace(-1, 1, len(rotations))])
    assert equal(
        palpate.estimate_roll(spun, shifts, probe_radius=10),
        palpate.estimate_roll(rotations, shifts, probe_radius=10),
    )
    many = palpate.estimate_roll(np.stack([spun] * 3), shifts, probe_radius=10)
    assert many.mean_curvature.value == pytest.approx(
        [palpate.estimate_roll(*rolls, probe_radius=10).mean_curvature.value] * 3
    )


def refused(call, argument, index=(), value=None, says="", kind=palpate.ArgumentError):
    with pytest.raises(kind) as caught:
        call()
    error = caught.value
    assert isinstance(error, ValueError) and isinstance(error, palpate.PalpateError)
    assert (error.argument, error.index) == (argument, index)
    if value is not None:
        assert error.value == value or (np.isnan(value) and np.isnan(error.value))
    assert says in str(error), str(error)


def with_bad(array, index, bad):
    array = np.array(array, dtype=float)
    array[index] = bad
    return array


@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf])
def test_errors_name_non_finite_numbers(rolls, glides, presses, bad):
    rotations, shifts = rolls
    points, normals, fingers = glides
    positions, displacements = presses

    def roll(turned, moved):
        return lambda: palpate.estimate_roll(turned, moved, probe_radius=10)

    refused(roll(with_bad(rotations, (3, 1), bad), shifts), "rotations", (3, 1), bad, "rotations[3, 1]")
    refused(roll(rotations, with_bad(shifts, (7, 0), bad)), "shifts", (7, 0), bad, "must be finite")
    many = np.stack([shifts] * 9)
    refused(roll(rotations, with_bad(many, (5, 2, 1), bad)), "shifts", (5, 2, 1), bad)
    refused(roll(with_bad(rotations, (2, 0), bad), many), "rotations", (2, 0), bad)

    def glide(places, out):
        return lambda: palpate.estimate_glide(places, out, fingers)

    refused(glide(with_bad(points, (17, 2), bad), normals), "points", (17, 2), bad)
    refused(glide(points, with_bad(normals, (0, 0), bad)), "normals", (0, 0), bad)
    refused(glide(with_bad(np.stack([points] * 2), (1, 4, 0), bad), None), "points", (1, 4, 0), bad)

    def press(places, moved):
        return lambda: palpate.estimate_press(places, moved, **SENSOR)

    refused(press(with_bad(positions, (5, 1), bad), displacements), "positions", (5, 1), bad)
    refused(press(positions, with_bad(displacements[:, 0], 9, bad)), "displacements", (9,), bad)


def test_errors_name_wrong_shapes(rolls, glides, presses):
    rotations, shifts = rolls
    points, normals, fingers = glides
    positions, displacements = presses
    for turned, moved, argument in [
        (rotations.ravel(), shifts, "rotations"),
        (rotations[:, :1], shifts, "rotations"),
        (rotations, shifts[:-1], "shifts"),
        (rotations, np.column_stack([shifts, shifts]), "shifts"),
        (np.stack([rotations] * 3), np.stack([shifts] * 2), "shifts"),
        (rotations[None, None], shifts, "rotations"),
        ("rotations", shifts, "rotations"),
        ([[1, 2], [3]], shifts, "rotations"),
        (rotations + 1j, shifts, "rotations"),
        (None, shifts, "rotations"),
    ]:
        refused(lambda: palpate.estimate_roll(turned, moved, probe_radius=10), argument)
    for places, out, who, argument in [
        (points[:, :2], None, None, "points"),
        (points, normals[:-1], None, "normals"),
        (points, None, fingers[:-1], "fingers"),
        (points, None, fingers - 1, "fingers"),
        (points, None, fingers + 0.5, "fingers"),
    ]:
        with pytest.raises(palpate.ArgumentError) as caught:
            palpate.estimate_glide(places, out, who)
        assert caught.value.argument == argument
    for places, moved, argument in [
        (positions[:, :1], displacements, "positions"),
        (positions, displacements[:-1], "displacements"),
        (positions, displacements[:, :2], "displacements"),
    ]:
        refused(lambda: palpate.estimate_press(places, moved, **SENSOR), argument)


@pytest.mark.parametrize(
    ("settings", "argument", "says"),
    [
        ({}, "probe_radius", "probe_radius is needed"),
        ({"probe_radius": 0}, "probe_radius", "is 0; it must be finite and > 0"),
        ({"probe_radius": np.nan}, "probe_radius", "NaN"),
        ({"probe_radius": 10, "pitch": -1}, "pitch", "pitch is -1"),
        ({"probe_radius": 10, "pitch": 11}, "pitch", "pitch is 11"),
        ({"probe_radius": 10, "pitch": 1, "shift_std": 1}, "shift_std", "only without pitch"),
        ({"probe_radius": 10, "rotation_std_rad": 4}, "rotation_std_rad", "from 0 to"),
        ({"probe_radius": 10, "relative_rotation_std": 2}, "relative_rotation_std", "from 0 to 1"),
        ({"probe_radius": 10, "method": "magic"}, "method", "it must be least-squares"),
        ({"probe_radius": 10, "length_unit": "inch"}, "length_unit", "one of m, cm, mm, um, unit"),
    ],
)
def test_invalid_settings_of_rolls_are_refused(rolls, settings, argument, says):
    with pytest.raises(palpate.ArgumentError) as caught:
        palpate.estimate_roll(*rolls, **settings)
    assert caught.value.argument == argument
    assert says in str(caught.value)


@pytest.mark.parametrize(
    ("settings", "says"),
    [
        ({"method": "magic"}, "it must be penalised, two-pass, quadric, plane, sphere, cylinder or shape"),
        ({"intervals": 99}, "intervals is 99; it must be a whole number from 1 to 24"),
        ({"gamma": 0.5}, "gamma is 0.5; it must be from 1 to 100"),
        ({"gamma": 2.0, "criterion": "gcv"}, "gamma"),
        ({"smoothing": 1.0}, "smoothing has an effect only with method two-pass"),
        ({"inter_finger_distance": 1.0}, "inter_finger_distance has an effect only with method two-pass"),
        ({"grid": 0}, "grid is 0; it must be a whole number from 1 to 1000"),
        ({"outward": (0, 0, 1)}, "outward has an effect only with readings without normals"),
        ({"gaussian_threshold": 1.0}, "gaussian_threshold has an effect only with mean_threshold"),
        ({"gaussian_threshold": 0.0, "mean_threshold": 1.0}, "threshold"),
        ({"tip_radius": -1.0}, "tip_radius is -1; it must be"),
        ({"tip_radius": 1.0, "reports": "top"}, 'reports is "top"; it must be lowest-point or centre'),
        ({"reports": "centre"}, "reports has an effect only with readings of round tips; give tip_radius too"),
        ({"position_std": np.inf}, "position_std is inf; it must be finite"),
    ],
)
def test_invalid_settings_of_glides_are_refused(glides, settings, says):
    with pytest.raises(palpate.ArgumentError, match=".*") as caught:
        palpate.estimate_glide(*glides, **settings)
    assert says in str(caught.value)


@pytest.mark.parametrize(
    ("settings", "says"),
    [
        ({"sensor_radius": -1}, "sensor_radius is -1; it must be > 0, or inf"),
        ({"depth": 20}, "depth is 20; it must be less than sensor_radius, 20"),
        ({"method": "bonded-layer"}, "thickness is missing, but method bonded-layer requires it"),
        ({"thickness": 5.0}, "thickness has an effect only with method bonded-layer or image"),
        ({"indentation_std": 0.1}, "indentation_std has an effect only with a given indentation"),
        ({"indentation": 25}, "indentation is 25; it must be less than sensor_radius, 20"),
        ({"noise": "found", "normal_std": 0.1}, "normal_std has an effect only without noise found"),
        ({"baseline": "free"}, "it must be known or fitted"),
        ({"poisson": 0.6}, "poisson is 0.6; it must be from 0 to 0.5"),
        ({"method": "gaussian"}, "c is missing, but method gaussian requires it, or indentation"),
        ({"method": "gaussian", "c": 1.0, "young": 1.0}, "the Gaussian model computes no stress"),
    ],
)
def test_invalid_settings_of_presses_are_refused(presses, settings, says):
    with pytest.raises(palpate.ArgumentError) as caught:
        palpate.estimate_press(*presses, **{**SENSOR, **settings})
    assert says in str(caught.value)
    with pytest.raises(palpate.ArgumentError, match="tangential_std has an effect only"):
        palpate.estimate_press(presses[0], presses[1][:, 0], tangential_std=0.1, **SENSOR)


def test_unknown_arguments_are_refused(rolls):
    with pytest.raises(TypeError, match="probe_radios"):
        palpate.estimate_roll(*rolls, probe_radios=10)


def test_readings_without_information_are_refused(rolls, glides, presses):
    rotations, shifts = rolls
    for turned, moved, says in [
        (rotations[:1], shifts[:1], "at least 2"),
        (rotations, 0 * shifts, "did not move"),
        (rotations, -shifts, "against the direction of the roll"),
        (rotations, 100 * shifts, "half of the probe's circumference"),
        (0 * rotations, shifts, ""),
    ]:
        with pytest.raises(palpate.ReadingsError) as caught:
            palpate.estimate_roll(turned, moved, probe_radius=10)
        assert says in str(caught.value)
    points, _, fingers = glides
    for places in (points[:3], points * [1, 0, 0], 0 * points):
        with pytest.raises(palpate.ReadingsError):
            palpate.estimate_glide(places, None, fingers[: len(places)])
    with pytest.raises(palpate.ReadingsError):
        palpate.estimate_glide(points, method="two-pass")
    positions, displacements = presses
    for moved in (0 * displacements, -displacements[:, 0] * 1e-300):
        with pytest.raises(palpate.ReadingsError):
            palpate.estimate_press(positions, moved, normal_std=0.1, **SENSOR)
    with pytest.raises((palpate.ReadingsError, palpate.ArgumentError)):
        palpate.estimate_press(np.zeros((0, 2)), [], **SENSOR)
    with pytest.raises(palpate.ReadingsError):
        palpate.estimate_roll(np.zeros((0, 2)), np.zeros((0, 2)), probe_radius=10)


def test_extreme_numbers_return_results_or_errors(rolls, glides, presses):
    random = np.random.default_rng(11)
    for exponent in (-300, -160, -20, 20, 150, 160, 300):
        scale = 10.0**exponent
        for call in (
            lambda: palpate.estimate_roll(rolls[0], scale * rolls[1], probe_radius=10 * scale),
            lambda: palpate.estimate_roll(scale * rolls[0], rolls[1], probe_radius=10),
            lambda: palpate.estimate_roll(np.stack([rolls[0]] * 5), scale * rolls[1], probe_radius=10),
            lambda: palpate.estimate_glide(scale * glides[0], glides[1], glides[2], grid=3),
            lambda: palpate.estimate_press(
                scale * presses[0], scale * presses[1], sensor_radius=20 * scale, depth=2 * scale
            ),
        ):
            try:
                found = call()
            except palpate.PalpateError:
                continue
            if isinstance(found, palpate.Batch) and len(found) > len(found.errors):
                assert not np.isinf(found.mean_curvature.value).any()
            else:
                text = repr(found)
                assert "nan" not in text and " inf" not in text, text
    # Use numbers with arbitrary bit patterns.
    for _ in range(300):
        bits = random.integers(0, 2**64, (6, 2), dtype=np.uint64).view(float)
        try:
            palpate.estimate_roll(bits, bits[::-1], probe_radius=float(bits[0, 0]))
        except palpate.PalpateError:
            pass


def test_rolls_may_be_time_series():
    # A probe of radius 10 rolls on a ball of radius 40 from the middle of a pad. Pads are 1 apart.
    time = np.linspace(0, 1, 1001)
    angles = np.radians([10, 70, 130, 190, 250, 310])
    directions = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    turned = 0.5 * time[None, :, None] * directions[:, None, :]
    pads = np.round(turned / (1 / 10 + 1 / 40)).reshape(-1, 2)
    rotations = np.stack([turned[..., 1], -turned[..., 0]], axis=-1).reshape(-1, 2)
    options = {"times": np.tile(time, 6), "probe_radius": 10, "pitch": 1, "method": "pad-edge"}
    found = palpate.estimate_roll(rotations, pads, start=(0, 0), **options)
    assert found.mean_curvature.value == pytest.approx(1 / 40, rel=3e-3)
    assert found.method == "pad-edge" and found.terms == 1
    with pytest.raises(palpate.ArgumentError):
        palpate.estimate_roll(rotations[1:], pads, **options)
