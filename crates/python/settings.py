"""Writes texts about the settings of estimators: `palpate schema | python crates/python/settings.py`."""

import json
import re
import sys
import textwrap
from pathlib import Path

PACKAGE = Path(__file__).parent
STUBS = PACKAGE / "python" / "palpate" / "_native.pyi"

# Settings whose arguments in Python have another name than the key of the setting.
ARGUMENTS = {"kind": "method", "normals": "tangent_normals"}
TYPES = {"integer": "int", "number": "float"}
LIMITS = {"exclusiveMinimum": "above", "minimum": "at least", "maximum": "at most"}


def settings(schema, scene):
    """The settings of a scene's estimator by argument: the schema of each, and the kinds of estimators that have it."""
    scenes = (scene["properties"] for scene in schema["properties"]["scene"]["oneOf"])
    estimator = next(parts for parts in scenes if parts["kind"]["const"] == scene)["estimator"]
    words = [{**kind["properties"]["kind"], "description": kind["description"]} for kind in estimator["oneOf"]]
    names = [word["const"] for word in words]
    kind = {"description": estimator["description"], "oneOf": words, "default": estimator["default"]["kind"]}
    found = {"method": (kind, names)}
    for name, kind in zip(names, estimator["oneOf"]):
        for key, setting in kind["properties"].items():
            # Leave out the indentation of a press, because it is stated together with the readings.
            if key != "kind" and not key.startswith("indentation"):
                found.setdefault(ARGUMENTS.get(key, key), (setting, []))[1].append(name)
    return found


def described(name, setting, kinds, all_kinds):
    """The entry of a setting in the list of parameters of a docstring."""
    words = [f'"{word["const"]}" ({word["description"].split(". ")[0].rstrip(".")})' for word in setting.get("oneOf", [])]
    facts = ["of method " + " or ".join(kinds)] if kinds != all_kinds else []
    facts += ["length"] if setting.get("x-unit") == "length" else []
    facts += [", ".join(words)] if words else []
    facts += [f"{limit} {setting[key]:g}" for key, limit in LIMITS.items() if setting.get(key, 1e9) < 1e9]
    default = setting.get("default")
    facts += [f"{default} by default" if isinstance(default, str) else f"{default:g} by default"] if default is not None else []
    text = " ".join([setting["description"], *[f"{fact[0].upper()}{fact[1:]}" for fact in ["; ".join(facts)] if fact]])
    text = textwrap.fill(" ".join(text.split()), 116, initial_indent="    ", subsequent_indent="    ", break_on_hyphens=False)
    return f"{name} : {TYPES.get(setting.get('type'), 'str')}, optional\n{text}."


def texts(schema):
    """The new content of each file, by its path."""
    stubs = STUBS.read_text()
    files = {}
    for scene in ("glide", "press"):
        found = settings(schema, scene)
        all_kinds = found["method"][1]
        entries = [described(name, setting, kinds, all_kinds) for name, (setting, kinds) in found.items()]
        files[PACKAGE / "src" / "estimate" / f"{scene}_settings.txt"] = "\n".join(entries)
        lines = [f"    {name}: {TYPES.get(setting.get('type'), 'str')} | None = None,\n" for name, (setting, _) in found.items()]
        block = rf"(    # Settings of the estimator of a {scene}, by settings.py\.\n).*?(    # Others\.\n)"
        stubs = re.sub(block, lambda ends: ends[1] + "".join(lines) + ends[2], stubs, flags=re.S)
        stub = re.search(rf"def estimate_{scene}\((.*?)\) ->", stubs, re.S)[1]
        parameters = re.findall(r"^    (\w+|\*)(?:: [^=]*?)?((?: = \w+)?),$", stub, re.M)
        signature = ", ".join(name + default.replace(" ", "") for name, default in parameters)
        files[PACKAGE / "src" / "estimate" / f"{scene}_signature.txt"] = f"estimate_{scene}({signature})\n--\n"
    files[STUBS] = stubs
    return files


if __name__ == "__main__":
    for path, text in texts(json.load(sys.stdin)).items():
        path.write_text(text)
