//! `palpate explain` and `palpate schema --quantities`: what words mean.

use std::fmt::Write as _;

use anyhow::anyhow;
use palpate_study::glossary::{SUBJECTS, meaning, similar};
use palpate_study::{Quantity, Statistic, Unit};

use crate::failure::Failure;
use crate::output;

/// Columns of a line of text.
const WIDTH: usize = 100;

/// Prints what a word means; without one, all words.
pub(crate) fn explain(word: &str) -> Result<(), Failure> {
    if word.trim().is_empty() {
        let subjects = SUBJECTS.iter().map(|subject| {
            let names: Vec<&str> = subject.terms.iter().map(|term| term.name).collect();
            let names = names.join(", ");
            format!("{}\n{}", subject.title, wrapped(&names, "  "))
        });
        let others = "`palpate explain WORD` tells what it means; quantities and statistics, which it explains too, are \
                      listed by `palpate schema --quantities`.";
        let all: Vec<String> = subjects.chain([wrapped(others, "")]).collect();
        return output::print(&all.join("\n\n"));
    }
    let Some(term) = meaning(word) else {
        let known = similar(word);
        let known = match known.is_empty() {
            true => "`palpate explain` lists all words".to_owned(),
            false => format!("did you mean {}?", known.join(", ")),
        };
        return Err(Failure::usage(anyhow!(
            "`{}` is no word of palpate; {known}",
            word.trim()
        )));
    };
    output::print(&format!("{}\n{}", term.name, wrapped(term.meaning, "  ")))
}

/// Prints the quantities and statistics that plots may name.
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
    text +=
        "\nBesides, `x`, `y`, `series`, `panel` and `where` may name any swept field by its path.";
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
        Unit::Turn => "turn",
        Unit::Pixel => "px",
        Unit::PixelSquared => "px^2",
    }
}

/// Text in lines of at most [`WIDTH`], each after an indent.
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
