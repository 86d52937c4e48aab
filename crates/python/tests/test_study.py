"""Studies: creation, changes, checks, runs, interruption, figures."""

import importlib
import signal
import threading
import time

import numpy as np
import palpate
import pytest
from conftest import BALL, EXAMPLES, SENSOR


def test_studies_are_created_from_text_dictionary_and_file(ball):
    assert palpate.Study(ball.toml) == ball
    assert palpate.Study(ball.resolved) == ball
    assert palpate.Study(ball.to_dict()) == ball
    file = EXAMPLES / "pads-for-a-ball.toml"
    assert palpate.Study(file) == palpate.Study(file.read_text())
    scene = palpate.scene(
        "roll",
        probe=palpate.surface("sphere", radius=np.float64(10)),
        object=palpate.surface("sphere", radius=np.int64(30)),
        motion={"rate_rad_per_s": 0.1, "duration_s": 1.0, "directions_deg": np.array([0.0, 90.0])},
    )
    study = palpate.Study({"name": "balls", "scene": scene})
    assert (study.name, study.cell_count, study.length_unit) == ("balls", 1, "unit")
    assert palpate.schema()["properties"]["trials"]["minimum"] == 1


def test_errors_name_the_wrong_field():
    def refused(change, path, says):
        with pytest.raises(palpate.ConfigError) as caught:
            palpate.Study(BALL).with_(change)
        assert caught.value.path == path
        assert says in str(caught.value)

    refused({"scene.object.radius": -5}, "scene.object.radius", "must be > 0, is -5")
    refused({"scene.sensr.pitch": 0.2}, "scene.sensr", "unknown")
    refused({"name.first": 1}, "name.first", "which has no `first`")
    refused({"seed": -1}, "seed", "")
    for source, says in [("name = [", "study"), ({}, "empty"), ({"name": "x"}, "scene")]:
        with pytest.raises(palpate.ConfigError, match=says):
            palpate.Study(source)
    with pytest.raises(palpate.ConfigError, match="no such file"):
        palpate.Study(EXAMPLES / "none.toml")
    for source in (3, None, {"name": object()}, {"name": float("nan")}):
        with pytest.raises(TypeError):
            palpate.Study(source)
    with pytest.raises(palpate.ConfigError, match="9"):
        palpate.Study(BALL).trace(9)
    with pytest.raises(palpate.ConfigError, match="trials"):
        palpate.Study(BALL).run(trials=0)


def test_changes_and_sweeps(ball):
    finer = ball.with_(**{"scene.sensor.kind": "pads", "scene.sensor.pitch": 0.2}, trials=7)
    assert finer.to_dict()["scene"]["sensor"]["pitch"] == 0.2 and finer.trials == 7
    assert ball.trials == 200
    assert finer.with_({"scene.sensor": None}, trials=200) == ball
    swept = ball.sweep(**{"scene.object.radius": [20.0, 40.0, 80.0]}).sweep({"seed": np.arange(2)})
    assert swept.cell_count == 6
    assert swept.cell(5) == {"scene.object.radius": 80, "seed": 1}
    with pytest.raises(palpate.ConfigError):
        ball.sweep(**{"scene.object.radius": 20.0})
    one = ball.sweep(**{"scene.object.radius": [60.0]}).run()
    other = ball.with_(**{"scene.object.radius": 60.0}).run()
    np.testing.assert_array_equal(one.cells["mean"], other.cells["mean"])


def test_check_and_plan(ball):
    check = ball.check(threads=1)
    assert sum(group.cells for group in check.intervals) == check.set_up
    assert (check.cells, check.trials, check.threads) == (1, 200, 1)
    assert "closed form" in check.groups[0].needs[0]
    planned = ball.plan(target_error=0.05)
    assert 150 < planned.trials < 400
    assert ball.plan(budget=2).trials > 200
    for goal in ({}, {"budget": -1}, {"target_error": float("nan")}):
        with pytest.raises(palpate.ArgumentError):
            ball.plan(**goal)
    counts = []
    EXAMPLE.check(progress=counts.append)
    assert 0 < sum(counts) <= EXAMPLE.cell_count


EXAMPLE = palpate.Study(EXAMPLES / "pads-for-a-ball.toml")


def test_tables_are_mappings_of_arrays():
    cells = EXAMPLE.run(trials=10).cells
    assert isinstance(cells, dict) and "scene.sensor.pitch" in cells
    assert cells["mean"].shape == (cells.height,) and cells["mean"].dtype == float
    assert cells["quantity"].dtype.kind == "U" and cells == cells and not cells != cells
    assert cells.units["scene.sensor.pitch"] == "mm" and cells.units["mean"] is None
    with pytest.raises(KeyError, match="no column .nothing"):
        cells["nothing"]
    lines = cells.to_csv().splitlines()
    assert [name.removesuffix("_mm") for name in lines[0].split(",")] == list(cells)
    first = dict(zip(cells, lines[1].split(","), strict=True))
    assert float(first["truth"]) == cells["truth"][0]
    for name in ("pandas", "polars"):
        frame = importlib.import_module(name).DataFrame(cells)
        assert list(frame.columns) == list(cells) and len(frame) == cells.height


def test_threads_and_order_do_not_change_the_bytes(ball):
    study = ball.sweep(**{"scene.object.radius": [20.0, 40.0, 80.0]})
    alone = study.run(threads=1)
    assert study.run(threads=3).files() == alone.files() == study.run().files()
    assert study.run(seed=5).files() != alone.files()
    assert alone.study.run() == alone


def test_progress_receives_the_number_of_trials(ball):
    counts = []
    ball.run(trials=300_000, progress=counts.append)
    assert sum(counts) == 300_000 and all(one > 0 for one in counts)

    class Bar:
        done = 0

        def update(self, count):
            self.done += count

    bar = Bar()
    ball.run(progress=bar.update)
    assert bar.done == ball.trials

    def fails(_):
        raise RuntimeError("enough")

    with pytest.raises(RuntimeError, match="enough"):
        ball.run(trials=50_000_000, progress=fails)


def test_other_threads_continue_while_trials_run(ball):
    ticks = 0
    stop = threading.Event()

    def tick():
        nonlocal ticks
        while not stop.is_set():
            ticks += 1
            time.sleep(0.001)

    thread = threading.Thread(target=tick)
    thread.start()
    ball.run(trials=2_000_000, threads=1)
    stop.set()
    thread.join()
    assert ticks > 10


@pytest.mark.parametrize("what", ["run", "rolls", "rolls in turn", "glides", "presses", "distinguish"])
def test_ctrl_c_ends_the_work(ball, rolls, glides, presses, what):
    many = np.stack([rolls[1]] * 400_000)
    patches, pressed = np.stack([glides[0]] * 5_000), np.stack([presses[1]] * 500)
    work = {
        "run": lambda: ball.run(trials=10**9, threads=1),
        "rolls": lambda: palpate.estimate_roll(rolls[0], many, probe_radius=10, threads=2),
        "rolls in turn": lambda: palpate.estimate_roll(rolls[0], many, probe_radius=10, threads=1),
        "glides": lambda: palpate.estimate_glide(patches, threads=2),
        "presses": lambda: palpate.estimate_press(presses[0], pressed, threads=2, **SENSOR),
        "distinguish": lambda: palpate.distinguish(
            ball, vary={"scene.object.radius": [20.0, 30.0]}, trials=10**7, threads=1
        ),
    }
    late = []

    def interrupt():
        late.append(time.perf_counter())
        signal.raise_signal(signal.SIGINT)

    timer = threading.Timer(0.15, interrupt)
    timer.start()
    try:
        with pytest.raises(KeyboardInterrupt):
            while True:
                work[what]()
    finally:
        timer.join()
    # Ctrl-C must stop the run within 0.1 s. Allow another 0.2 s, because the machine may be busy.
    assert time.perf_counter() - late[0] < 0.3


def test_figures():
    results = EXAMPLE.run(trials=20)
    figure = results.plot()
    assert figure.name == results.plots[0] and figure._repr_svg_().startswith("<svg")
    own = results.plot(
        "mine", x="scene.sensor.pitch", y="relative_rms_error", quantity="mean_curvature",
        series="scene.motion.arc_length",
    )
    assert own.name == "mine" and "<svg" in own.svg
    with pytest.raises(palpate.ArgumentError, match="no plot nothing"):
        results.plot("nothing")
    with pytest.raises(palpate.PalpateError):
        results.plot(x="nothing", y="mean")
    assert figure.svg in results._repr_html_()


def test_maps_and_passes():
    study = palpate.Study(EXAMPLES / "fingers-over-a-mug.toml")
    results = study.run(trials=2)
    assert results.map["x"].shape == (results.map.height,)
    trace = results.trace(0, trial=1)
    assert "contacts" in trace.what
    readings = trace.readings
    points = np.stack([readings[axis] for axis in "xyz"], axis=1)
    estimate = palpate.estimate_glide(points, None, readings["finger"], like=study)
    assert estimate.contacts == len(points)
    assert trace.figures == []
