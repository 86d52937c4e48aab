//! Implements `palpate explain` and `palpate schema --quantities`, which print the meanings of words.

use std::fmt::Write as _;

use anyhow::anyhow;
use palpate_study::config::schema;
use palpate_study::glossary::{SUBJECTS, meaning, related, similar};
use palpate_study::readings::spelt;
use palpate_study::{Quantity, Statistic, Unit};
use serde_json::Value;

use crate::failure::Failure;
use crate::output;

/// Width of a printed line, in characters.
const WIDTH: usize = 100;

/// Parts of a scene that have several kinds. For example, an object may be a sphere or a cylinder.
const PARTS: [&str; 6] = ["probe", "object", "model", "sensor", "noise", "estimator"];
/// The word for which `palpate explain` prints the table of kinds of scenes.
const SCENES: &str = "scenes";

pub(crate) fn explain(word: &str) -> Result<(), Failure> {
    if spelt(word) == SCENES {
        let scene = |(kind, parts): (String, Vec<(&str, String)>)| {
            let parts = parts.into_iter().map(|(part, kinds)| {
                let kinds = wrapped(&kinds, "            ");
                format!("  {part:10}{}", kinds.trim_start())
            });
            format!("{kind}\n{}", parts.collect::<Vec<_>>().join("\n"))
        };
        let scenes: Vec<String> = scenes().into_iter().map(scene).collect();
        return output::print(&scenes.join("\n\n"));
    }
    if word.trim().is_empty() {
        let subjects = SUBJECTS.iter().map(|subject| {
            let names: Vec<&str> = subject.terms.iter().map(|term| term.name).collect();
            let names = names.join(", ");
            format!("{}\n{}", subject.title, wrapped(&names, "  "))
        });
        let others = "`palpate explain WORD` explains one. It also explains the quantities and statistics that `palpate schema --quantities` lists, and every key of configs. `palpate explain scenes` lists the objects, sensors and noises of each kind of scene.";
        let all: Vec<String> = subjects.chain([wrapped(others, "")]).collect();
        return output::print(&all.join("\n\n"));
    }
    let keys = config_keys()
        .into_iter()
        .filter(|(path, _)| spelt(path.rsplit('.').next().unwrap_or_default()) == spelt(word));
    let keys: Vec<(String, String)> = keys.collect();
    let of_part = || related(word).filter(|_| keys.is_empty());
    let term = meaning(word).or_else(of_part).into_iter();
    let entries: Vec<String> = term
        .map(|term| (term.name.to_owned(), term.meaning.to_owned()))
        .chain(keys.iter().cloned())
        .map(|(name, meaning)| format!("{name}\n{}", wrapped(&meaning, "  ")))
        .collect();
    if entries.is_empty() {
        let similar = match similar(word) {
            similar if similar.is_empty() => "`palpate explain` lists all words".to_owned(),
            similar => format!("did you mean {}?", similar.join(", ")),
        };
        return Err(Failure::usage(anyhow!(
            "`{}` is not a word of palpate; {similar}",
            word.trim()
        )));
    }
    output::print(&entries.join("\n"))
}

pub(crate) fn glossary() -> Result<(), Failure> {
    let mut text = "# Glossary\n\n`palpate explain WORD` prints one entry. `cargo xtask book` writes this page from `palpate explain --markdown`.\n"
        .to_owned();
    for subject in SUBJECTS {
        let rows = subject
            .terms
            .iter()
            .map(|term| (term.name.to_owned(), term.meaning.to_owned()));
        text += &section(subject.title, ["word", "meaning"], rows);
    }
    let quantities = Quantity::ALL.iter().map(|quantity| {
        let unit = in_words(quantity.unit);
        let scenes = quantity.scenes.join(", ");
        let meaning = quantity.meaning.trim();
        (
            format!("`{}`", quantity.name),
            format!("{meaning} Unit: {unit}. Scenes: {scenes}."),
        )
    });
    text += &section("Quantities", ["quantity", "meaning"], quantities);
    let statistics = Statistic::ALL.into_iter().chain([Statistic::StdBound]);
    let statistics =
        statistics.map(|one| (format!("`{}`", one.name()), one.meaning().trim().to_owned()));
    text += &section(
        "Statistics of a grid point",
        ["statistic", "meaning"],
        statistics,
    );
    let parts = scenes().into_iter().flat_map(|(scene, parts)| {
        let row = move |(part, kinds)| (format!("`{part}` of a {scene}"), kinds);
        parts.into_iter().map(row)
    });
    text += &section("Kinds of scenes", ["part", "kinds, or keys"], parts);
    let keys = config_keys()
        .into_iter()
        .map(|(path, meaning)| (format!("`{path}`"), meaning));
    text += &section("Keys of configs", ["key", "meaning"], keys);
    output::print(text.trim_end())
}

/// Kinds of scenes, each with its parts, such as the object. The text of a part lists the kinds of this part or, if it
/// has no kinds, its keys.
fn scenes() -> Vec<(String, Vec<(&'static str, String)>)> {
    let schema = schema();
    let text = |value: &Value| value.as_str().map(str::to_owned);
    let kinds_of = |part: &Value| -> Vec<String> {
        let keys = part["properties"].as_object().into_iter().flatten();
        match part["oneOf"].as_array() {
            Some(kinds) => kinds
                .iter()
                .filter_map(|kind| text(&kind["properties"]["kind"]["const"]))
                .collect(),
            None => keys.map(|(key, _)| key.clone()).collect(),
        }
    };
    let scene = |scene: &Value| {
        let parts = PARTS.map(|part| (part, kinds_of(&scene["properties"][part]).join(", ")));
        let parts = parts.into_iter().filter(|(_, kinds)| !kinds.is_empty());
        Some((
            text(&scene["properties"]["kind"]["const"])?,
            parts.collect(),
        ))
    };
    let scenes = schema["properties"]["scene"]["oneOf"].as_array();
    scenes.into_iter().flatten().filter_map(scene).collect()
}

fn section(
    title: &str,
    [first, second]: [&str; 2],
    rows: impl Iterator<Item = (String, String)>,
) -> String {
    let cell = |text: String| text.replace('\n', " ").replace('|', "\\|");
    let rows: String = rows
        .map(|(name, meaning)| format!("| {} | {} |\n", cell(name), cell(meaning)))
        .collect();
    format!("\n## {title}\n\n| {first} | {second} |\n|---|---|\n{rows}")
}

/// Paths of all config keys, each with its meaning, unit and default. A key that has the same description in several
/// kinds of scenes appears once.
fn config_keys() -> Vec<(String, String)> {
    let mut keys = Vec::new();
    collect_keys(&schema(), "", &mut keys);
    keys
}

fn collect_keys(schema: &Value, path: &str, keys: &mut Vec<(String, String)>) {
    for (name, key) in schema["properties"].as_object().into_iter().flatten() {
        let path = match path {
            "" => name.clone(),
            _ => format!("{path}.{name}"),
        };
        let described = |key: &Value| key["description"].as_str().map(str::to_owned);
        let meaning = match key["const"].as_str() {
            Some(kind) => described(schema).map(|text| format!("`{kind}`: {text}")),
            None => described(key),
        };
        if let Some(mut meaning) = meaning {
            if let Some(unit) = key["x-unit"].as_str().filter(|unit| *unit != "1") {
                let _ = write!(meaning, " Unit: {unit}.");
            }
            let default = &key["default"];
            if default.is_number() || default.is_boolean() || default.is_string() {
                let _ = write!(meaning, " Default: {default}.");
            }
            let entry = (path.clone(), meaning);
            if !keys.contains(&entry) {
                keys.push(entry);
            }
        }
        collect_keys(key, &path, keys);
    }
    for variant in schema["oneOf"].as_array().into_iter().flatten() {
        collect_keys(variant, path, keys);
    }
    for part in ["items", "additionalProperties"] {
        if let Some(schema) = schema.get(part) {
            collect_keys(schema, path, keys);
        }
    }
}

pub(crate) fn quantities() -> Result<(), Failure> {
    let mut text =
        "Quantities (`quantity`), with their unit and the kinds of scenes that have them:\n"
            .to_owned();
    for quantity in Quantity::ALL {
        let scenes = quantity.scenes.join(", ");
        let unit = in_words(quantity.unit);
        text += &entry(
            quantity.name,
            &format!("{unit}; {scenes}"),
            quantity.meaning,
        );
    }
    text += "\nStatistics of them over the trials of a cell (`x`, `y`, `series`, `compare`):\n";
    for statistic in Statistic::ALL.into_iter().chain([Statistic::StdBound]) {
        let unit = match statistic.is_number() {
            true => "number",
            false => "unit of the quantity",
        };
        text += &entry(statistic.name(), unit, statistic.meaning());
    }
    text += "\nIn addition, `x`, `y`, `series`, `panel` and `where` may name any swept field by its path.";
    output::print(&text)
}

fn entry(name: &str, unit: &str, meaning: &str) -> String {
    format!("\n{name}  [{unit}]\n{}\n", wrapped(meaning.trim(), "  "))
}

fn in_words(unit: Unit) -> &'static str {
    match unit {
        Unit::Length => "length",
        Unit::PerLength => "1/length",
        Unit::PerLengthSquared => "1/length^2",
        Unit::LengthSquared => "length^2",
        Unit::One => "number",
        Unit::Degree => "deg",
        Unit::Newton => "N",
        Unit::Turn => "turn",
        Unit::Pixel => "px",
        Unit::PixelSquared => "px^2",
    }
}

/// Wraps a text into lines of at most [`WIDTH`] characters. Every line begins with `indent`.
fn wrapped(text: &str, indent: &str) -> String {
    let mut lines = String::new();
    let mut width = 0;
    for word in text.split_whitespace() {
        let length = word.chars().count();
        let is_first = width == 0;
        if !is_first && width + 1 + length > WIDTH {
            lines.push('\n');
            width = 0;
        }
        let before = if width == 0 { indent } else { " " };
        let _ = write!(lines, "{before}{word}");
        width += before.chars().count() + length;
    }
    lines
}
