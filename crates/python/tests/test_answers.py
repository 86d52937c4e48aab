"""Answers to questions, and errors of questions without an answer."""

import pickle
import signal
import threading
import time

import palpate
import pytest
from conftest import BALL, EXAMPLES

PADS = palpate.Study(EXAMPLES / "pads-for-a-ball.toml")
TARGET = "relative_rms_error(mean_curvature) <= 5 %"
SET = {"scene.motion.arc_length": 2.0}


def test_a_design_is_that_of_the_command_line(cli, tmp_path):
    # The time budget is so long that it does not end the search, so both searches test the same values.
    found = palpate.design(PADS, TARGET, {"scene.sensor.pitch": (0.05, 2.0)}, set=SET, gap=0.3, budget=3600.0)
    said = cli(
        "design", EXAMPLES / "pads-for-a-ball.toml", "--target", TARGET, "--vary", "scene.sensor.pitch=0.05..2",
        "--set", "scene.motion.arc_length=2.0", "--gap", 0.3, "--budget", "1h", "--json", "--out", tmp_path,
    )
    assert found.to_dict() == said
    assert found.table.to_csv() == (tmp_path / "design.csv").read_text()
    assert found.figure.svg == (tmp_path / "design.svg").read_text()
    assert f"{found.answer}\n{chr(10).join(found.lines)}\n" == (tmp_path / "design.txt").read_text()
    # The values that meet the target and the values that miss it are separated by at most the requested gap.
    (meets,), (misses,) = found.meets, found.misses
    assert 0.05 <= meets.from_ < meets.to < misses.from_ < 1.36 * meets.to
    again = pickle.loads(pickle.dumps(found))
    assert again == found and again.table == found.table and again.figure.svg == found.figure.svg
    assert found.answer in repr(found) and "<svg" in found._repr_html_()


def test_a_region_is_that_of_the_command_line(cli, tmp_path):
    fields = ["scene.sensor.pitch=0.1..1", "scene.object.radius=20,30"]
    settings = {"set": SET, "gap": 0.3, "most_trials": 20_000, "budget": 3600.0}
    found = palpate.design(PADS, TARGET, fields, maximise="scene.sensor.pitch", **settings)
    said = cli(
        "design", EXAMPLES / "pads-for-a-ball.toml", "--target", TARGET, "--vary", fields[0], "--vary", fields[1],
        "--maximise", "scene.sensor.pitch", "--set", "scene.motion.arc_length=2.0", "--gap", 0.3,
        "--most-trials", 20_000, "--budget", "1h", "--json", "--out", tmp_path,
    )
    assert found.to_dict() == said
    assert found.table.to_csv() == (tmp_path / "design.csv").read_text()
    assert found.runs.to_csv() == (tmp_path / "region.csv").read_text()
    assert found.figure.svg == (tmp_path / "design.svg").read_text()
    assert f"{found.answer}\n{chr(10).join(found.lines)}\n" == (tmp_path / "design.txt").read_text()
    # On the ball with the smaller radius, coarser pads meet the target.
    at = [column.at["scene.object.radius"] for column in found.columns]
    ends = [column.meets[-1].to for column in found.columns]
    assert at == ["20", "30"] and ends[0] > ends[1]
    assert found.best_that_meets["scene.object.radius"] == "20"
    assert found.best_that_meets["scene.sensor.pitch"] == ends[0]
    with pytest.raises(KeyError, match="no field"):
        found.best_that_meets["scene.sensor.kind"]
    again = pickle.loads(pickle.dumps(found))
    assert again == found and again.runs == found.runs
    least = palpate.design(
        PADS, TARGET, {"scene.sensor.pitch": (0.1, 1.0), "scene.object.radius": [20, 30]},
        minimise="scene.object.radius", **settings,
    )
    assert least.best_that_meets["scene.object.radius"] == "20"


def test_a_design_over_words_and_as_a_text():
    study = PADS.with_({"sweep": None, "plot": None, "scene.sensor.pitch": 0.5, "scene.motion.arc_length": 2.0})
    one = palpate.design(study, TARGET, "scene.sensor.layout=square,uniform", most_trials=4096)
    other = palpate.design(study, TARGET, {"scene.sensor.layout": ["square", "uniform"]}, most_trials=4096)
    assert one == other
    said = {run.from_ for run in one.meets + one.misses}
    assert said <= {"square", "uniform"} and said


@pytest.mark.parametrize(
    ("changes", "kind", "argument", "says"),
    [
        ({"target": "small"}, palpate.ArgumentError, "target", "target: "),
        ({"target": "rms_error(mean_curvature) <= -1"}, palpate.ArgumentError, "target", "the limit is -1"),
        ({"target": "rms_error(contact_radius) <= 1"}, palpate.ArgumentError, "target", "no quantity"),
        ({"vary": "scene.sensor.pitch=2..1"}, palpate.ArgumentError, "vary", "runs downwards"),
        ({"vary": {"scene.sensor.pitch": (2, 1)}}, palpate.ArgumentError, "vary", "run upwards"),
        ({"vary": {"scene.sensor.pitch": (0, float("inf"))}}, palpate.ArgumentError, "vary", "finite"),
        ({"vary": {"scene.sensor.pitch": 1.0}}, palpate.ArgumentError, "vary", "a tuple (from, to) or a list"),
        ({"vary": {}}, palpate.ArgumentError, "vary", "a dictionary of paths"),
        ({"vary": 3}, palpate.ArgumentError, "vary", "a dictionary of paths"),
        ({"vary": []}, palpate.ArgumentError, "vary", "a dictionary of paths"),
        ({"vary": ["scene.sensor.pitch=1..2", 3]}, palpate.ArgumentError, "vary", "a dictionary of paths"),
        ({"maximise": "scene.object.radius"}, palpate.ArgumentError, "maximise", "scene.object.radius"),
        ({"minimise": "scene.object.radius"}, palpate.ArgumentError, "minimise", "scene.object.radius"),
        ({"maximise": "a", "minimise": "b"}, palpate.ArgumentError, "minimise", "one of them"),
        ({"vary": {"scene.sensor.kind": (1, 2)}}, palpate.ArgumentError, "vary", "scene.sensor.kind"),
        ({"max_failures": 0.0}, palpate.ArgumentError, "max_failures", "above 0"),
        ({"gap": 2.0}, palpate.ArgumentError, "gap", "at most 1"),
        ({"most_trials": 0}, palpate.ArgumentError, "most_trials", "at least 1"),
        ({"budget": 0.0}, palpate.ArgumentError, "budget", "> 0"),
        ({"set": {"scene.sensor.pitch": 1.0}}, palpate.ArgumentError, "set", "given twice"),
        ({"threads": 0}, palpate.ArgumentError, "threads", "at least 1"),
        ({"vary": {"scene.sensor.pich": (1, 2)}}, palpate.ConfigError, None, "pich"),
        ({"vary": {"radius": (1, 2)}}, palpate.ConfigError, None, "may be `scene.object.radius` or `scene.probe.radius`"),
        ({"set": {"object.radius": "1s"}}, palpate.ConfigError, None, "its unit may be m, cm, mm, um"),
        ({"set": {"scene.object.radius": -1.0}}, palpate.ConfigError, None, "must be > 0"),
    ],
)
def test_designs_that_cannot_be(changes, kind, argument, says):
    arguments = {"target": TARGET, "vary": {"scene.sensor.pitch": (0.1, 1.0)}, "most_trials": 100, **changes}
    with pytest.raises(kind) as caught:
        palpate.design(PADS, **arguments)
    assert caught.value.argument == argument
    assert says in str(caught.value)


def test_distinctions_match_the_command_line(cli, tmp_path):
    radii = {"scene.object.radius": [20, 25, 30]}
    config = EXAMPLES / "press-a-ball.toml"
    found = palpate.distinguish(palpate.Study(config), vary=radii, trials=40, threads=2)
    said = cli(
        "distinguish", config, "--vary", "scene.object.radius=20,25,30", "--trials", 40, "--json", "--out", tmp_path,
    )
    assert found.to_dict() == said
    assert found.table.to_csv() == (tmp_path / "distinguish.csv").read_text()
    assert found.figure.svg == (tmp_path / "distinguish.svg").read_text()
    again = pickle.loads(pickle.dumps(found))
    assert again == found and again.table == found.table
    assert "<svg" in found._repr_html_()


def test_sensitivities_match_the_command_line(cli, tmp_path):
    config = EXAMPLES / "press-a-ball.toml"
    found = palpate.sensitivity(palpate.Study(config), trials=20, threads=2)
    said = cli("sensitivity", config, "--trials", 20, "--json", "--out", tmp_path)
    assert found.to_dict() == said
    assert found.table.to_csv() == (tmp_path / "sensitivity.csv").read_text()
    assert found.figure.svg == (tmp_path / "sensitivity.svg").read_text()
    with pytest.raises(palpate.ArgumentError) as caught:
        palpate.sensitivity(palpate.Study(config), step=0.0)
    assert caught.value.argument == "step"


def test_objects_that_cannot_be_distinguished(ball):
    balls = {"scene.object.radius": [20.0, 30.0]}
    for arguments, argument, says in [
        ({}, "vary", "no objects to compare"),
        ({"vary": balls, "quantity": "force"}, "quantity", "no quantity"),
        ({"vary": balls, "confidence": 1.0}, "confidence", "below 1"),
        ({"vary": {"scene.object.radius": 20.0}}, "vary", "list the values"),
    ]:
        with pytest.raises(palpate.ArgumentError) as caught:
            palpate.distinguish(ball, **arguments)
        assert caught.value.argument == argument and says in str(caught.value)
    with pytest.raises(palpate.ConfigError, match="trials"):
        palpate.distinguish(ball, vary=balls, trials=0)
    done = []
    palpate.distinguish(ball, vary=balls, progress=done.append)
    assert 0 <= sum(done) <= 2


def test_ctrl_c_ends_a_design():
    study = palpate.Study(BALL)
    late = []

    def interrupt():
        late.append(time.perf_counter())
        signal.raise_signal(signal.SIGINT)

    timer = threading.Timer(0.2, interrupt)
    timer.start()
    with pytest.raises(KeyboardInterrupt):
        while True:
            palpate.design(
                study, "relative_rms_error(mean_curvature) <= 2 %",
                {"scene.noise.angular_velocity.fraction": (0.001, 0.5)}, budget=None, gap=1e-4,
            )
    # Ctrl-C must stop the work within 0.1 s. Allow 0.3 s, because the machine may be busy.
    assert time.perf_counter() - late[0] < 0.3
