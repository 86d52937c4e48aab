"""Functions and the command line return the same numbers and the same bytes."""

import palpate
import pytest
from conftest import EXAMPLES, SENSOR


def test_estimates_of_rolls_match(cli, rolls):
    found = palpate.estimate_roll(*rolls, probe_radius=10, pitch=0.5, length_unit="mm")
    file = EXAMPLES / "roll-readings.csv"
    assert found.to_dict() == cli("estimate", "roll", file, "--probe-radius", 10, "--pitch", 0.5)
    study = palpate.Study(EXAMPLES / "pads-for-a-ball.toml")
    found = palpate.estimate_roll(*rolls, like=study, cell=3, length_unit="mm")
    said = cli("estimate", "roll", file, "--like", EXAMPLES / "pads-for-a-ball.toml", "--cell", 3)
    assert found.to_dict() == said


@pytest.mark.parametrize(
    "settings",
    [
        {},
        {"criterion": "gcv", "intervals": 6},
        {"method": "two-pass", "smoothing": 500.0},
        {"method": "quadric"},
        {"gaussian_threshold": 5e-4, "mean_threshold": 1e-2, "grid": 7},
        {"tip_radius": 4.0, "reports": "centre"},
    ],
)
def test_estimates_of_glides_match(cli, glides, tmp_path, settings):
    found = palpate.estimate_glide(*glides, length_unit="mm", **settings)
    flags = [
        word for key, value in settings.items() for word in (f"--{key.replace('_', '-')}", value)
    ]
    file = EXAMPLES / "glide-readings.csv"
    said = cli("estimate", "glide", file, "--map", tmp_path / "map.csv", *flags)
    assert found.to_dict() == said
    assert found.map_csv == (tmp_path / "map.csv").read_text()


@pytest.mark.parametrize(
    "settings",
    [
        {"indentation": 1.5, "indentation_std": 0.02},
        {"method": "bonded-layer", "thickness": 5.0},
        {"young": 2.0, "baseline": "fitted"},
    ],
)
def test_estimates_of_presses_match(cli, presses, settings):
    found = palpate.estimate_press(*presses, **SENSOR, **settings).to_dict()
    flags = [
        word for key, value in settings.items() for word in (f"--{key.replace('_', '-')}", value)
    ]
    file = EXAMPLES / "press-readings.csv"
    said = cli("estimate", "press", file, "--sensor-radius", 20, "--depth", 2, *flags)
    # Warnings about files contain line numbers, which arrays do not have.
    for one in (found, said):
        one["warnings"] = len(one["warnings"])
    assert found == said


@pytest.mark.parametrize(
    "name", ["pads-for-a-ball", "fingers-over-a-mug", "press-a-ball", "press-with-a-camera"]
)
def test_tables_have_the_same_bytes(cli, tmp_path, name):
    config = EXAMPLES / f"{name}.toml"
    trials = 2 if "camera" in name else 20
    results = palpate.Study(config).run(trials=trials, threads=2)
    cli("run", config, "--trials", trials, "--out", tmp_path, is_json=False)
    for file, text in results.files().items():
        assert text == (tmp_path / file).read_text(), file
    written = {path.name for path in tmp_path.iterdir()}
    assert written >= results.files().keys()


def test_traces_are_the_same(cli, tmp_path):
    config = EXAMPLES / "press-with-a-camera.toml"
    cli("trace", config, "--cell", 3, "--trial", 0, "--out", tmp_path, is_json=False)
    trace = palpate.Study(config).trace(3, 0)
    assert trace.contacts.to_csv() == (tmp_path / "trace.csv").read_text()
    assert trace.readings.to_csv() == (tmp_path / "readings.csv").read_text()
    assert trace.markers.to_csv() == (tmp_path / "markers.csv").read_text()
    for figure in trace.figures:
        assert figure.svg == (tmp_path / f"{figure.name}.svg").read_text()


def test_figures_are_the_same(cli, tmp_path):
    config = EXAMPLES / "pads-for-a-ball.toml"
    cli("run", config, "--trials", 50, "--out", tmp_path, is_json=False)
    cli("plot", tmp_path, is_json=False)
    results = palpate.Study(config).run(trials=50)
    for name in results.plots:
        assert results.plot(name).svg == (tmp_path / f"{name}.svg").read_text()


def test_patterns_are_the_same(cli, tmp_path):
    config = EXAMPLES / "press-with-a-camera.toml"
    cli("sensor", "pattern", config, "--out", tmp_path, is_json=False)
    study = palpate.Study(config)
    assert palpate.pattern(study) == (tmp_path / "pattern.svg").read_text()
    pattern = study.pattern()
    assert pattern.dxf == (tmp_path / "pattern.dxf").read_text()
    assert pattern.strain.to_csv() == (tmp_path / "strain.csv").read_text()
    assert pattern.strain_by_gores.to_csv() == (tmp_path / "strain-by-gores.csv").read_text()


def test_calibrations_are_the_same(cli, tmp_path):
    from conftest import table

    folder = EXAMPLES / "chromatouch-2020"
    names = ["calibration-normal.csv", "calibration-tangential.csv"]
    out = tmp_path / "calibration.toml"
    cli("sensor", "calibrate", *(folder / name for name in names), "--out", out, is_json=False)
    tables = []
    for name in names:
        rows = table(f"chromatouch-2020/{name}")
        tables.append({column: rows[column] for column in rows.dtype.names})
    calibration = palpate.calibrate(*tables)
    assert calibration.to_toml() == out.read_text()
    assert palpate.Calibration(out.read_text()) == calibration
    assert calibration.to_dict()["normal"]["from"] == "hue"
