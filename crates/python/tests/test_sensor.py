"""Camera sensors: frames, calibrations, layouts, patterns."""

import pickle

import numpy as np
import palpate
import pytest
from conftest import EXAMPLES

CAMERA = palpate.Study(EXAMPLES / "press-with-a-camera.toml")


@pytest.fixture(scope="module")
def trace():
    return CAMERA.trace(3, 0)


def test_frames_are_tracked(trace):
    assert trace.rest.dtype == np.uint8 and trace.rest.shape == trace.pressed.shape
    tracked = palpate.track(trace.rest, trace.pressed)
    assert tracked.fates.tracked >= 0.9 * tracked.fates.at_rest > 50
    assert tracked.markers.height == len(tracked.markers["status"])
    assert tracked.difference.shape == trace.rest.shape
    assert tracked.overlay.shape[2] == 3 and tracked.estimate is None
    strided = np.repeat(trace.rest, 2, axis=1)[:, ::2]
    again = palpate.track(strided, np.asfortranarray(trace.pressed))
    assert again.markers.to_csv() == tracked.markers.to_csv()


def test_invalid_frames_are_refused(trace):
    for frame in (trace.rest[..., 0], trace.rest[..., :2], trace.rest / 255, trace.rest.astype(int), "frame"):
        with pytest.raises(palpate.ArgumentError) as caught:
            palpate.track(frame, trace.pressed)
        assert caught.value.argument == "rest"
    with pytest.raises(palpate.ReadingsError, match="px"):
        palpate.track(trace.rest, trace.pressed[:-1])
    with pytest.raises(palpate.ReadingsError):
        palpate.track(np.full_like(trace.rest, 90), trace.pressed)
    with pytest.raises(palpate.ArgumentError, match="depth has an effect only with calibration"):
        palpate.track(trace.rest, trace.pressed, depth=2.0)


def test_two_frames_determine_the_object():
    """Presses of known depth calibrate the sensor. Then a press on a ball determines its radius."""
    plane = CAMERA.with_({"sweep": None, "plot": None, "scene.object": {"kind": "plane"}})
    scene = plane.to_dict()["scene"]
    probe = scene["probe"]
    frames, depths = [], [0.3, 0.6, 0.9, 1.2]
    for depth in depths:
        frames.append(plane.with_(**{"scene.motion.indentation": depth}).trace(0, 0))
    # Displacement of the marker under the contact. Because of the marker's depth, it is smaller than the indentation.
    inward = [float(np.max(one.contacts["normal_displacement"])) for one in frames]
    focal = 0.5 * scene["sensor"]["size_px"] / np.radians(scene["sensor"]["field_deg"])
    calibration = palpate.calibrate_frames(
        frames[0].rest, [one.pressed for one in frames], normal=inward, source="size",
        length_unit="mm", px_per_rad=focal,
    )
    assert "normal" in calibration.to_dict() and repr(calibration)
    ball = CAMERA.with_({"sweep": None, "plot": None, "scene.object": {"kind": "sphere", "radius": 30.0}})
    seen = ball.with_(**{"scene.motion.indentation": 1.2}).trace(0, 0)
    settings = {"sensor_radius": probe["radius"], "depth": probe["marker_depth"]}
    model = scene["model"]
    if model["kind"] == "bonded-layer":
        settings |= {"method": "bonded-layer", "thickness": model["thickness"]}
    tracked = palpate.track(
        seen.rest, seen.pressed, calibration=calibration, px_per_rad=focal, indentation=1.2,
        indentation_std=0.05, **settings,
    )
    low, high = tracked.estimate.object_curvature.interval95
    assert tracked.estimate.verdict == "convex" and low < 1 / 30 < high < 1 / 25
    assert tracked.readings.height == tracked.fates.tracked and tracked.field.height > 0
    assert "Tracked" in repr(tracked) and "PressEstimate" in repr(tracked.estimate)
    with pytest.raises(palpate.ArgumentError, match="sensor_radius"):
        palpate.track(seen.rest, seen.pressed, calibration=calibration)
    with pytest.raises(TypeError, match="thicknes"):
        palpate.track(seen.rest, seen.pressed, calibration=calibration, thicknes=1)
    with pytest.raises(palpate.ArgumentError, match="grid"):
        palpate.track(seen.rest, seen.pressed, calibration=calibration, grid=0, **settings)


MISALIGNED = {"magenta_diameter": 2.0, "yellow_diameter": 2.0, "separation": 2.0, "misalignment": 0.2}
BALL = CAMERA.with_(**{
    "sweep": None, "plot": None, "scene.object": {"kind": "sphere", "radius": 30.0},
    "scene.sensor": {"kind": "rendered", "size_px": 300, "calibration": {"presses": 2, "rest_frames": 1}},
    "scene.probe.discs": MISALIGNED,
})


def contains(estimate, truth):
    low, high = estimate.interval95
    return low < truth < high


def test_a_press_is_fitted_to_frames():
    seen = BALL.trace(0, 0)
    known = {"method": "image", "like": BALL, "indentation": 1.0, "indentation_std": 0.02}
    tracked = palpate.track(seen.rest, seen.pressed, **known)
    estimate = tracked.estimate
    assert estimate.method == "image" and estimate.verdict == "convex"
    assert contains(estimate.object_curvature, 1 / 30) and contains(estimate.indentation, 1.0)
    assert tracked.readings.height == tracked.fates.tracked and tracked.field.height > 0
    with pytest.raises(palpate.ReadingsError, match="all pixels are those of rest"):
        palpate.track(seen.rest, seen.rest, **known)
    with pytest.raises(palpate.ReadingsError, match="the layout's camera takes 265"):
        palpate.track(seen.rest, seen.pressed, method="image", like=CAMERA)
    with pytest.raises(palpate.ArgumentError, match="like is missing") as caught:
        palpate.track(seen.rest, seen.pressed, method="image")
    assert caught.value.argument == "like"
    with pytest.raises(palpate.ConfigError, match="must have a camera"):
        palpate.track(seen.rest, seen.pressed, method="image", like=palpate.Study(EXAMPLES / "press-a-ball.toml"))
    for argument, value in (("depth", 2.0), ("px_per_rad", 200.0), ("normal_std", 0.1), ("shift_std", -1.0)):
        with pytest.raises(palpate.ArgumentError, match=argument) as caught:
            palpate.track(seen.rest, seen.pressed, **known, **{argument: value})
        assert caught.value.argument == argument


def test_one_frame_at_rest_locates_the_camera():
    place = [0.5, 0.0, -0.4]
    seen = BALL.with_(**{"scene.sensor.place": place}).trace(0, 0)
    known = {"method": "image", "like": BALL}
    with pytest.raises(palpate.ReadingsError, match="contradicts"):
        palpate.track(seen.rest, seen.pressed, **known)
    camera = palpate.calibrate_camera(seen.rest, BALL)
    swept = BALL.with_(sweep=[{"path": "scene.motion.indentation", "values": [0.5, 1.0]}])
    assert palpate.calibrate_camera(seen.rest, swept, cell=1) == camera
    with pytest.raises(palpate.ConfigError, match="no cell 2"):
        palpate.calibrate_camera(seen.rest, swept, cell=2)
    fields = camera.to_dict()
    assert np.all(np.abs(np.array(fields["place"]) - place) < 4 * np.array(fields["place_std"]))
    assert camera.length_unit == "mm" and camera.warnings == [] and "px per rad" in camera.summary
    again = palpate.CameraCalibration(camera.to_toml())
    assert again == camera == pickle.loads(pickle.dumps(camera)) and repr(again) == camera.summary
    tracked = palpate.track(seen.rest, seen.pressed, calibration=again, **known)
    assert contains(tracked.estimate.object_curvature, 1 / 30) and tracked.estimate.warnings == []
    away = camera.to_toml().replace(f"place = [{fields['place'][0]}", "place = [3.0")
    with pytest.raises(palpate.ReadingsError, match=r"calibration: contradicts .* `place\[0\]` is 3"):
        palpate.track(seen.rest, seen.pressed, calibration=palpate.CameraCalibration(away), **known)
    of_displacements = palpate.calibrate({"normal_displacement": [0.5, 1.0], "hue_turns": [0.01, 0.02]})
    for calibration, settings in (
        (of_displacements, known), (camera, {"sensor_radius": 20.0, "depth": 2.0}), (camera.to_toml(), known),
    ):
        with pytest.raises(palpate.ArgumentError) as caught:
            palpate.track(seen.rest, seen.pressed, calibration=calibration, **settings)
        assert caught.value.argument == "calibration"
    with pytest.raises(palpate.ReadingsError, match="calibration of displacements"):
        palpate.CameraCalibration(of_displacements.to_toml())
    with pytest.raises(palpate.ReadingsError, match="camera"):
        palpate.Calibration(camera.to_toml())
    with pytest.raises(palpate.ArgumentError):
        palpate.calibrate_camera(seen.rest[..., 0], BALL)
    with pytest.raises(palpate.ReadingsError, match="must have a camera"):
        palpate.calibrate_camera(seen.rest, palpate.Study(EXAMPLES / "press-a-ball.toml"))


def test_invalid_calibrations_are_refused(trace):
    good = {"normal_displacement": [0.0, 0.5, 1.0], "hue_turns": [0.0, 0.01, 0.02]}
    assert palpate.calibrate(good, length_unit="mm").length_unit == "mm"
    for other in ([1, 2, 3], ["red", "green", "blue"]):
        assert palpate.calibrate({**good, "colour": other}) == palpate.calibrate(good)
    many = {f"column{number}": [0.0] for number in range(40)}
    with pytest.raises(palpate.ReadingsError) as caught:
        palpate.calibrate(many)
    assert all(f"`{name}`" in str(caught.value) for name in many)
    for table in (
        {**good, "hue_turns": [0.0, 0.01]},
        {**good, "hue_turns": [0.0, np.nan, 0.02]},
        {**good, "hue_turns": np.zeros((3, 1))},
    ):
        with pytest.raises(palpate.ArgumentError):
            palpate.calibrate(table)
    for table in (
        {"normal_displacement": [0.0, 1.0]},
        {**good, "hue_turns": [0.0, 0.0, 0.0]},
    ):
        with pytest.raises(palpate.ReadingsError):
            palpate.calibrate(table)
    with pytest.raises(palpate.ReadingsError, match="growth"):
        palpate.calibrate(good, source="size")
    with pytest.raises(palpate.ArgumentError, match="hue, size or both"):
        palpate.calibrate(good, source="shape")
    with pytest.raises(palpate.ReadingsError):
        palpate.calibrate()
    with pytest.raises(palpate.ArgumentError, match="normal or tangential"):
        palpate.calibrate_frames(trace.rest, [trace.pressed])
    with pytest.raises(palpate.ArgumentError, match="one per pressed frame"):
        palpate.calibrate_frames(trace.rest, [trace.pressed], normal=[1, 2])
    with pytest.raises(palpate.ReadingsError, match="calibration"):
        palpate.Calibration("no = 1")


def test_layouts_and_patterns():
    layout = palpate.Layout(20.0, marker_depth=2.0, discs={"magenta_diameter": 2.0, "yellow_diameter": 2.0})
    assert len(layout) == 77 and layout.positions.shape == (77, 2)
    away = np.hypot(*layout.positions.T)
    assert sorted(set(np.round(np.degrees(away / 20.0), 6))) == pytest.approx(11.9 * np.arange(6), abs=1e-6)
    pattern = layout.pattern()
    assert (pattern.gores, pattern.markers) == (4, 77)
    assert pattern.strain_by_gores.height == 10 and "strain" in pattern.strain
    assert palpate.pattern(layout) == pattern.svg and pattern.svg.startswith("<")
    row = palpate.Layout(10.0, {"kind": "line", "markers": 5, "length": 8.0})
    np.testing.assert_allclose(row.positions[:, 0], [-4, -2, 0, 2, 4], atol=1e-12)
    for arguments in ({"radius": -1.0}, {"radius": 1.0, "layout": "none"}, {"radius": 1.0, "layout": {"kind": "line"}}):
        with pytest.raises(palpate.ConfigError):
            palpate.Layout(**arguments)
    with pytest.raises(palpate.ConfigError, match="gores"):
        row.pattern()
    with pytest.raises(palpate.ConfigError, match="markers"):
        palpate.Layout.of(palpate.Study(EXAMPLES / "pads-for-a-ball.toml"))
