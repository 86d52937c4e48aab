"""The package: documents, stubs, metadata."""

import importlib.metadata
import inspect
import re
import runpy
import subprocess
import sys

import palpate
import pytest
from conftest import EXAMPLES


def test_everything_is_documented():
    for name in palpate.__all__:
        thing = getattr(palpate, name)
        if isinstance(thing, (str, tuple)):
            continue
        assert inspect.getdoc(thing), name
        if inspect.isclass(thing):
            for member, value in vars(thing).items():
                if not member.startswith("_") and callable(value):
                    assert inspect.getdoc(value), f"{name}.{member}"


def test_every_argument_is_described():
    for name in ("estimate_roll", "estimate_glide", "estimate_press", "track", "calibrate", "calibrate_frames", "calibrate_camera"):
        function = getattr(palpate, name)
        document = inspect.getdoc(function)
        for argument in inspect.signature(function).parameters:
            assert re.search(rf"^[^\n]*\b{argument}\b[^\n]* :|\b{argument}\b", document, re.M), f"{name}: {argument}"
        for section in ("Parameters", "Returns", "Raises"):
            assert section in document, f"{name}: {section}"


def test_texts_of_settings_match_the_schema():
    texts = runpy.run_path(str(EXAMPLES.parent / "crates/python/settings.py"))["texts"]
    for path, text in texts(palpate.schema()).items():
        assert path.read_text() == text, f"{path.name} is old: palpate schema | python crates/python/settings.py"


def test_settings_of_estimators_are_arguments():
    """Every estimator setting of a config is also an argument."""
    settings = runpy.run_path(str(EXAMPLES.parent / "crates/python/settings.py"))["settings"]
    for scene, function in [("glide", palpate.estimate_glide), ("press", palpate.estimate_press)]:
        for name in settings(palpate.schema(), scene):
            with pytest.raises(TypeError, match=f"argument '{name}'"):
                function([[0.0, 0.0, 0.0]], [[0.0, 0.0, 1.0]], **{name: object()})


def test_metadata():
    data = importlib.metadata.metadata("palpate")
    assert data["Version"] == palpate.__version__
    assert data["License-Expression"] == "MIT OR Apache-2.0"
    files = {path.name for path in importlib.metadata.files("palpate")}
    assert {"LICENSE-MIT", "LICENSE-APACHE", "py.typed", "_native.pyi"} <= files


def test_errors_are_value_errors_that_pickle():
    import pickle

    try:
        palpate.estimate_roll([[0, 1]], [[0, float("nan")]], probe_radius=1)
    except ValueError as error:
        again = pickle.loads(pickle.dumps(error))
        assert type(again) is palpate.ArgumentError and str(again) == str(error)
        assert (again.argument, again.index) == ("shifts", (0, 1))


def test_examples_in_the_docstrings():
    """The examples in the docstrings run and have the stated results."""
    import doctest

    for name in palpate.__all__:
        thing = getattr(palpate, name)
        text = inspect.getdoc(thing) if not isinstance(thing, (str, tuple)) else None
        examples = doctest.DocTestParser().get_doctest(text or "", {"palpate": palpate}, name, None, 0)
        runner = doctest.DocTestRunner(optionflags=doctest.ELLIPSIS)
        runner.run(examples)
        assert runner.summarize().failed == 0, name


def test_the_examples_of_the_documents_run(monkeypatch, capsys):
    root = EXAMPLES.parent
    monkeypatch.chdir(root)
    for page in [root / "README.md", *sorted((root / "docs").glob("*.md"))]:
        for block in re.findall(r"```python\n(.*?)```", page.read_text(), re.S):
            assert page.name != "README.md" or block.count("\n") <= 12
            exec(compile(block, page.name, "exec"), {})
    assert "1/mm" in capsys.readouterr().out


def test_import_loads_only_numpy():
    """Only NumPy and the package itself are imported."""
    script = (
        "import sys, numpy; before = set(sys.modules); import palpate;"
        "print(*sorted({name.split('.')[0] for name in set(sys.modules) - before}))"
    )
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    assert set(done.stdout.split()) <= {"__future__", "palpate"}


def test_import_takes_at_most_15_ms():
    # Measure processor time instead of elapsed time, because the machine may be busy.
    script = "import time, numpy; start = time.process_time(); import palpate; print(time.process_time() - start)"
    runs = (subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True) for _ in range(5))
    assert min(float(run.stdout) for run in runs) < 0.015
