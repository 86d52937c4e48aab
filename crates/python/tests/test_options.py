"""Every option of the command line is also an argument of a function."""

import inspect
import re

import palpate
import pytest

# Command-line options that concern only files and the terminal, so Python has no such arguments.
OF_FILES = {
    "columns", "decimal", "delimiter", "error-format", "force", "format", "json", "map", "markdown", "out", "quiet", "restart",
    "rotation-frame", "shard",
}

# Options with another name in Python: Python reserves the name, or another name is clearer in a call.
RENAMED = {
    ("estimate glide", "normals"): "tangent_normals",
    ("sensor calibrate", "from"): "source",
    ("sensor calibrate", "layout"): "study",
    ("run", "every-nth-cell"): "cells",
}

COMMANDS = {
    "estimate roll": [palpate.estimate_roll],
    "estimate glide": [palpate.estimate_glide],
    "estimate press": [palpate.estimate_press],
    # `track` passes the settings of an estimate on to `estimate_press`.
    "sensor track": [palpate.track, palpate.estimate_press],
    "sensor calibrate": [palpate.calibrate, palpate.calibrate_frames, palpate.calibrate_camera],
    "sensor pattern": [palpate.pattern],
    "design": [palpate.design],
    "distinguish": [palpate.distinguish],
    "sensitivity": [palpate.sensitivity],
    "explain": [palpate.explain],
    "check": [palpate.Study.check],
    "run": [palpate.Study.run, palpate.Study.plan],
    "trace": [palpate.Study.trace],
    "report": [palpate.report],
}


def options(cli, command):
    text = cli(*command.split(), "--help", is_json=False)
    return set(re.findall(r"^ {6}--([a-z0-9-]+)", text, re.M)) - {"help"}


@pytest.mark.parametrize("command", COMMANDS)
def test_every_option_is_an_argument(cli, command):
    arguments = {name for function in COMMANDS[command] for name in inspect.signature(function).parameters}
    found = options(cli, command)
    assert found, "the help lists no option"
    missing = {
        option for option in found - OF_FILES
        if RENAMED.get((command, option), option.replace("-", "_")) not in arguments
    }
    assert not missing


def test_every_exception_is_still_needed(cli):
    found = {command: options(cli, command) for command in COMMANDS}
    assert OF_FILES <= set().union(*found.values())
    assert all(option in found[command] for command, option in RENAMED)


def test_every_other_command_has_no_function(cli):
    """Only commands for files, queues and schemas have no function."""
    text = cli("--help", is_json=False)
    names = set(re.findall(r"^  ([a-z]+) {2,}", text.split("Commands:")[1].split("Options:")[0], re.M))
    known = {command.split()[0] for command in COMMANDS}
    assert known <= names
    # These commands are not in `COMMANDS`: figures belong to results, the schema is a dictionary, and the other
    # commands manage runs in files.
    assert names - known <= {"plot", "schema", "merge", "status", "submit", "help"}
