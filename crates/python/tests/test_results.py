"""Results: fields, arrays, texts, pickles; batches."""

import copy
import json
import multiprocessing
import pickle
import re
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from xml.etree import ElementTree

import numpy as np
import palpate
import pytest
from conftest import SENSOR


def everything(rolls, glides, presses, ball):
    results = ball.run()
    calibration = palpate.calibrate(
        {"normal_displacement": [0.0, 0.5, 1.0, 1.5], "hue_turns": [0.0, 0.011, 0.019, 0.031]}
    )
    return [
        palpate.estimate_roll(*rolls, probe_radius=10, length_unit="mm"),
        palpate.estimate_roll(*rolls, probe_radius=10).mean_curvature,
        palpate.estimate_roll(rolls[0], np.stack([rolls[1], 0 * rolls[1]]), probe_radius=10),
        palpate.estimate_glide(*glides),
        palpate.estimate_glide(np.stack([glides[0], 0 * glides[0]]), None, glides[2]),
        palpate.estimate_press(*presses, **SENSOR),
        palpate.estimate_press(presses[0], np.stack([presses[1]] * 2), **SENSOR),
        calibration,
        palpate.Layout(20.0),
        palpate.Layout(20.0, discs={"magenta_diameter": 2.0, "yellow_diameter": 2.0}).pattern(),
        ball,
        results,
        results.cells,
        results.trace(),
        palpate.report(results),
        palpate.Figure("a", "b", "<svg/>"),
    ]


def assert_same(one, other):
    """Checks that dictionaries are equal, including arrays and tables."""
    if isinstance(other, dict):
        assert one.keys() == other.keys()
        for name, value in other.items():
            assert_same(one[name], value)
    elif isinstance(other, np.ndarray):
        np.testing.assert_array_equal(one, other)
    elif isinstance(other, palpate.Figure):
        assert one.svg == other.svg
    else:
        assert one == other


def test_all_results_can_be_printed_and_pickled(rolls, glides, presses, ball):
    for result in everything(rolls, glides, presses, ball):
        assert type(result).__name__ in repr(result) or isinstance(result, (palpate.Record, palpate.Calibration))
        if hasattr(result, "_repr_html_"):
            assert "<table" in result._repr_html_()
        for again in (pickle.loads(pickle.dumps(result)), copy.deepcopy(result)):
            assert type(again) is type(result)
            assert repr(again) == repr(result)
            if isinstance(result, palpate.Record):
                assert again == result and again.to_dict() == result.to_dict()
                assert_same(again.to_dict(arrays=True), result.to_dict(arrays=True))
            if hasattr(result, "to_csv"):
                assert again.to_csv() == result.to_csv()


def test_notebooks_show_a_figure_of_each_estimate(rolls, glides, presses):
    estimates = [
        palpate.estimate_roll(*rolls, probe_radius=10, pitch=0.5),
        palpate.estimate_glide(*glides),
        palpate.estimate_press(*presses, **SENSOR),
    ]
    for estimate in estimates:
        figure = re.search(r"<svg.*</svg>", estimate._repr_html_(), re.S)
        assert figure, type(estimate)
        parsed = ElementTree.fromstring(figure[0])
        assert len(list(parsed.iter())) > 5


def test_fields_match_the_dictionary(rolls, glides, presses):
    for estimate in (
        palpate.estimate_roll(*rolls, probe_radius=10),
        palpate.estimate_glide(*glides),
        palpate.estimate_press(*presses, **SENSOR),
    ):
        fields = estimate.to_dict()
        assert json.loads(json.dumps(fields)) == fields
        assert set(fields) <= set(dir(estimate))
        for name, value in fields.items():
            found = getattr(estimate, name)
            if isinstance(value, dict):
                assert isinstance(found, palpate.Record)
            elif isinstance(value, float):
                assert found == value
        arrays = estimate.to_dict(arrays=True)
        assert set(arrays) >= set(fields)
        with pytest.raises(AttributeError, match="no field .curvature"):
            estimate.curvature
        # Changing the dictionary does not change the estimate.
        fields["method"] = "another"
        assert estimate.method != "another"
    assert estimate.relative_curvature.interval95.shape == (2,)
    assert float(estimate.relative_curvature) == estimate.relative_curvature.value


def test_the_map_of_a_patch(glides):
    estimate = palpate.estimate_glide(*glides, grid=12)
    grid = estimate.map
    assert grid.mean_curvature.shape == (12, 12) and grid.position.shape == (12, 12, 3)
    assert grid.class_probabilities.shape == (12, 12, len(palpate.SHAPE_CLASSES))
    np.testing.assert_allclose(grid.class_probabilities.sum(axis=-1), 1, atol=1e-9)
    np.testing.assert_allclose(np.linalg.norm(grid.normal, axis=-1), 1)
    np.testing.assert_allclose(grid.k_min + grid.k_max, 2 * grid.mean_curvature)
    np.testing.assert_allclose(grid.k_min * grid.k_max, grid.gaussian_curvature, atol=1e-12)
    assert grid.class_index.dtype == np.int64 and set(np.unique(grid.region)) == set(
        range(len(estimate.regions))
    )
    assert estimate.class_ == getattr(estimate, "class")
    std = estimate.covariance.diagonal() ** 0.5
    assert std == pytest.approx([estimate.gaussian_curvature.std, estimate.mean_curvature.std])
    here = palpate.estimate_glide(*glides, at_contacts=True).map
    assert here.mean_curvature.shape == (30,) and (here.region == -1).all()
    assert np.isnan(palpate.estimate_glide(*glides, method="two-pass").covariance).all()


def test_fingers_have_numbers_or_names(glides):
    points, normals, fingers = glides
    numbered = palpate.estimate_glide(points, normals, fingers)
    names = np.array(["thumb", "index", "middle"])[fingers]
    for named in (names, names.tolist(), names.astype(object), fingers + 7):
        assert palpate.estimate_glide(points, normals, named) == numbered
    with pytest.raises(palpate.ArgumentError) as caught:
        palpate.estimate_glide(points, normals, names[:-1])
    assert caught.value.argument == "fingers"


def test_points_of_round_tips():
    """Estimates from the centres or the lowest points of tips on a ball match those from the contacts."""
    tip, ball = 4.0, 30.0
    along, across = np.meshgrid(np.linspace(-6, 6, 10), np.linspace(-4, 4, 3))
    out = np.stack([along.T.ravel(), across.T.ravel(), np.full(30, ball)], axis=1)
    normals = out / np.linalg.norm(out, axis=1, keepdims=True)
    centres = (ball + tip) * normals
    lowest = centres - [0, 0, tip]
    fingers = np.tile(np.arange(3), 10)
    of_contacts = palpate.estimate_glide(ball * normals, normals, fingers)
    for points, reports in ((centres, "centre"), (lowest, "lowest-point"), (lowest, None)):
        estimate = palpate.estimate_glide(points, normals, fingers, tip_radius=tip, reports=reports)
        assert estimate.mean_curvature.value == pytest.approx(of_contacts.mean_curvature.value, rel=1e-9)
    assert of_contacts.mean_curvature.value == pytest.approx(1 / ball, rel=1e-2)
    # If the tip radius is ignored, the estimated surface is a ball whose radius is larger by the tip radius.
    alone = palpate.estimate_glide(centres, normals, fingers).mean_curvature.value
    assert alone == pytest.approx(1 / (ball + tip), rel=1e-2)


def test_batches_of_glides_and_presses(glides, presses):
    points, normals, fingers = glides
    random = np.random.default_rng(1)
    many = points + random.normal(0, 0.1, (6, *points.shape))
    many[4] = 0
    batch = palpate.estimate_glide(many, np.stack([normals] * 6), fingers, grid=5)
    assert len(batch) == 6 and list(batch.errors) == [4]
    for place in (0, 3, -1):
        one = palpate.estimate_glide(many[place], normals, fingers, grid=5)
        assert batch[place] == one
        assert batch.mean_curvature.value[place] == one.mean_curvature.value
        np.testing.assert_array_equal(batch.normal[place], one.normal)
        assert batch.to_dict()["class"][place] == one.class_
    assert np.isnan(batch.mean_curvature.value[4]) and np.isnan(batch.normal[4]).all()
    with pytest.raises(palpate.ReadingsError, match="one point"):
        batch[4]
    with pytest.raises(IndexError):
        batch[6]
    positions, displacements = presses
    pressed = displacements * np.linspace(0.8, 1.2, 4)[:, None, None]
    batch = palpate.estimate_press(positions, pressed, threads=2, **SENSOR)
    for place in range(4):
        one = palpate.estimate_press(positions, pressed[place], **SENSOR)
        assert batch[place] == one
        assert batch.object_curvature.value[place] == one.object_curvature.value
        np.testing.assert_array_equal(
            batch.object_curvature.interval95[place], one.object_curvature.interval95
        )
    assert batch.errors == {}


def test_a_batch_of_rolls_reports_undetermined_sets(rolls):
    rotations, shifts = rolls
    many = np.stack([shifts] * 10_001)
    many[[0, 7, 10_000]] = [0 * shifts, -shifts, 1e3 * shifts]
    for threads in (1, 2, None):
        batch = palpate.estimate_roll(rotations, many, probe_radius=10, threads=threads)
        assert sorted(batch.errors) == [0, 7, 10_000]
        assert np.isnan(batch.mean_curvature.value).sum() == 3
        assert "half of the probe's circumference" in batch.errors[10_000]
        with pytest.raises(palpate.ReadingsError, match="did not move"):
            batch[0]
        assert batch[1] == palpate.estimate_roll(rotations, shifts, probe_radius=10)
    batch = palpate.estimate_roll(rotations, many[:9], probe_radius=10, pitch=0.5)
    again = pickle.loads(pickle.dumps(batch))
    for name, value in batch[1].to_dict().items():
        fresh, restored = getattr(batch, name), getattr(again, name)
        if isinstance(value, dict):
            fresh, restored = fresh.to_dict(), restored.to_dict()
            assert fresh.keys() == value.keys() and fresh.get("unit") == value.get("unit")
        np.testing.assert_equal(restored, fresh)
    assert batch.p_value.shape == (9,) and batch.arc_length.std is None
    many[5000, 3, 1] = np.nan
    many[9000, 0, 0] = np.nan
    with pytest.raises(palpate.ArgumentError) as caught:
        palpate.estimate_roll(rotations, many, probe_radius=10)
    assert caught.value.index == (5000, 3, 1)
    assert len(palpate.estimate_roll(rotations, many[:0], probe_radius=10)) == 0
    with pytest.raises(palpate.ArgumentError, match="threads is 0"):
        palpate.estimate_roll(rotations, shifts[None], probe_radius=10, threads=0)


def test_many_python_threads_have_the_same_estimate(glides):
    points, normals, fingers = glides
    alone = palpate.estimate_glide(points, normals, fingers)
    with ThreadPoolExecutor(8) as pool:
        found = list(pool.map(lambda _: palpate.estimate_glide(points, normals, fingers), range(64)))
    assert all(one == alone for one in found)


def test_data_frames_accept_tables(ball):
    import pandas
    import polars

    results = ball.run(trials_out=True)
    for table in (results.cells, results.trials_out):
        frame = pandas.DataFrame(table)
        assert list(frame) == list(table) and len(frame) == table.height
        for name, values in table.items():
            np.testing.assert_array_equal(frame[name].to_numpy(), values)
        frame = polars.DataFrame(table)
        assert frame.columns == list(table) and frame.height == table.height
        for name, values in table.items():
            assert frame[name].dtype == (polars.String if values.dtype.kind == "U" else polars.Float64)
            np.testing.assert_array_equal(frame[name].to_numpy(), values)
    empty = ball.run(cells=[]).cells
    assert polars.DataFrame(empty).shape == pandas.DataFrame(empty).shape == (0, len(empty))


def worker(shifts):
    rotations = [[0, -0.3], [0.3, 0]]
    return palpate.estimate_roll(rotations, shifts, probe_radius=10)


def test_spawned_processes_return_estimates():
    shifts = [[[2, 0], [0, scale]] for scale in (1.5, 2.0, 2.5)]
    with multiprocessing.get_context("spawn").Pool(2) as pool:
        found = pool.map(worker, shifts)
    assert [one.mean_curvature.value for one in found] == [
        worker(one).mean_curvature.value for one in shifts
    ]


def memory_growth(work):
    """Memory growth of the process over 100 runs, MB, after 20 runs that fill the caches."""

    def resident():
        with open("/proc/self/statm") as statm:
            return int(statm.read().split()[1]) * 4096 / 1e6

    for _ in range(20):
        work()
    before = resident()
    for _ in range(100):
        work()
    return resident() - before


@pytest.fixture
def once(rolls, glides, presses, ball):
    """Every kind of estimate, a study and an error."""

    def once():
        palpate.estimate_roll(*rolls, probe_radius=10).to_dict()
        palpate.estimate_roll(rolls[0], np.stack([rolls[1]] * 100), probe_radius=10).to_dict()
        palpate.estimate_press(*presses, **SENSOR).to_dict()
        ball.run(trials=20, threads=1).cells.items()
        with pytest.raises(palpate.ArgumentError):
            palpate.estimate_roll(*rolls, probe_radius=-1)
        palpate.estimate_glide(*glides).map.mean_curvature.sum()

    return once


def test_memory_does_not_grow(once):
    assert memory_growth(once) < MAX_GROWTH


def test_a_memory_leak_is_detected(once):
    leaked = []

    def leak():
        once()
        leaked.append(bytearray(200_000))

    assert memory_growth(leak) > MAX_GROWTH


# Largest growth of memory in 100 runs, MB. The allocator may hide a leak of about 20 kB per run.
MAX_GROWTH = 1

MEMORY = '''
import sys
import numpy as np, palpate

def peak():
    """Largest memory of this process so far, MB."""
    with open("/proc/self/status") as status:
        return next(int(line.split()[1]) for line in status if line.startswith("VmHWM")) / 1e3

shifts = np.empty((50_000, 50, 2), order=sys.argv[1])
shifts[:] = np.random.default_rng(1).normal(0, 1, (50, 2))
rotations = np.random.default_rng(2).normal(0, 0.1, (50, 2))
before = peak()
palpate.estimate_roll(rotations, shifts, probe_radius=10, shift_std=1.0, threads=1)
print(peak() - before)
'''


def test_arrays_are_copied_only_if_their_layout_differs():
    grown = {}
    for order in "CF":
        done = subprocess.run([sys.executable, "-c", MEMORY, order], capture_output=True, text=True, check=True)
        grown[order] = float(done.stdout)
    # The array needs 40 MB of memory. The estimates keep a copy of their readings, which needs 80 MB.
    assert grown["F"] > grown["C"] + 30, grown
