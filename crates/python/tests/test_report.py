"""Scores, pages, explanations and tables of trials match the command line."""

import pickle

import palpate
import pytest
from conftest import BALL, EXAMPLES

STUDY = EXAMPLES.parent / "sim-configs" / "ep1-pad-resolution.toml"


@pytest.fixture(scope="module")
def written(cli, tmp_path_factory):
    folder = tmp_path_factory.mktemp("results") / "pads"
    trials = folder.parent / "trials.csv"
    cli("run", STUDY, "--trials", 40, "--out", folder, "--trials-out", trials, is_json=False)
    cli("plot", folder, is_json=False)
    cli("report", folder, "--out", folder.parent / "page.html", is_json=False)
    return folder


@pytest.fixture(scope="module")
def results():
    return palpate.Study(STUDY).run(trials=40, trials_out=True)


def test_the_page_matches_the_command_line(written, results):
    page = (written.parent / "page.html").read_text()
    for source in (results, written, str(written)):
        report = palpate.report(source)
        # Results in memory lack the empty lines for measurements that a directory may contain.
        assert report.html == page or source is results and report.html.split() == page.split()
        assert [score.claim for score in report.scores] == [5, 6, 7, 8, 20]
        assert {score.verdict for score in report.scores} <= {"holds", "differs", "not testable"}
        assert all(score.study == "ep1-pad-resolution" and score.paper_says for score in report.scores)
        assert report.text in repr(report) and report.text.count("\n") == 8
    assert results.claims.to_csv() == (written / "claims.csv").read_text()
    assert list(results.claims["claim"]) == [5, 6, 7, 8, 20]
    again = pickle.loads(pickle.dumps(report))
    assert (again.text, again.html, again.scores) == (report.text, report.html, report.scores)
    both = palpate.report(results, palpate.Study(BALL).run(trials=10))
    assert len(both.scores) == 5 and "a-ball" in both.html


def test_a_directory_is_read_without_changes(written, results):
    found = palpate.Results.read(written)
    assert found == results and found.files() == results.files()
    assert found.warnings == results.warnings and found.trials_out is None
    assert len(found.figures) == 3
    for figure in found.figures:
        assert figure.svg == (written / f"{figure.name}.svg").read_text()


def test_directories_without_results_are_refused(tmp_path):
    with pytest.raises(palpate.RunError, match="run.toml"):
        palpate.Results.read(tmp_path)
    with pytest.raises(palpate.RunError, match="run.toml"):
        palpate.report(tmp_path)
    for name in ("run.toml", "failures.csv"):
        (tmp_path / name).write_text(palpate.Study(BALL).run(trials=1).files()[name])
    (tmp_path / "cells.csv").write_text("cell,quantity\n0\n")
    with pytest.raises(palpate.RunError, match="no table"):
        palpate.Results.read(tmp_path)
    with pytest.raises(TypeError):
        palpate.report(3)
    empty = palpate.report()
    assert (empty.scores, empty.text) == ([], "") and empty.html.startswith("<!DOCTYPE html>")


def test_the_table_of_trials_matches_the_command_line(written, results):
    trials = results.trials_out
    assert trials.to_csv() == (written.parent / "trials.csv").read_text()
    assert trials.height == len(trials["estimate"]) and trials["failure"].dtype.kind == "U"
    assert pickle.loads(pickle.dumps(results)).trials_out == trials
    assert palpate.Study(BALL).run(trials=3).trials_out is None


def test_outputs_of_a_config_match_the_command_line(cli, tmp_path):
    config = EXAMPLES.parent / "sim-configs" / "ep2-three-fingers.toml"
    cli("run", config, "--trials", 2, "--out", tmp_path, is_json=False)
    results = palpate.Study(config).run(trials=2)
    assert {"trace.csv", "readings.csv"} <= results.files().keys()
    for name, text in results.files().items():
        assert text == (tmp_path / name).read_text(), name
    cli("plot", tmp_path, is_json=False)
    for figure in results.figures:
        assert figure.svg == (tmp_path / f"{figure.name}.svg").read_text()


def test_selected_cells_match_those_of_a_full_run():
    study = palpate.Study(EXAMPLES / "pads-for-a-ball.toml").with_(trials=20)
    every, some = study.run(), study.run(cells=[3, 1, 3])
    assert sorted(set(some.cells["cell"])) == [1, 3]
    for cell in (1, 3):
        of_cell = [line for line in every.cells.to_csv().splitlines() if line.startswith(f"{cell},")]
        assert of_cell == [line for line in some.cells.to_csv().splitlines() if line.startswith(f"{cell},")]
    with pytest.raises(palpate.ArgumentError) as caught:
        study.run(cells=[0, study.cell_count])
    assert (caught.value.argument, caught.value.index, caught.value.value) == ("cells", (1,), study.cell_count)
    assert study.run(cells=[]).cells.height == 0


def test_explanations_match_the_command_line(cli):
    for word in ("pitch", "Relative-Curvature", "coverage95", "mean_curvature", "ifd"):
        name, meaning = cli("explain", word, is_json=False).split("\n", 1)
        expected = palpate.explain(word).split()
        # The command line also lists the keys of configs that have this name.
        assert meaning.split()[: len(expected)] == expected
    every = palpate.explain()
    assert {"Studies", "Quantities", "Statistics"} <= every.keys()
    for words in every.values():
        for word, meaning in words.items():
            assert palpate.explain(word).strip() and meaning
    for word, says in (("pich", "did you mean pitch"), ("", "palpate.explain()"), ("xyzzy", "has all words")):
        with pytest.raises(palpate.ArgumentError, match=says.replace("(", r"\(").replace(")", r"\)")) as caught:
            palpate.explain(word)
        assert caught.value.argument == "word"
