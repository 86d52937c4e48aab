//! Tests the configs of studies, from the text to the cells.

mod alternatives;
mod arguments;
mod cells;
mod edited;
mod every_field;
mod many;
mod refused;
mod round_trip;
mod sampled;
mod schema;
mod text;

use palpate_study::config::{ConfigError, Study, parse};

/// A valid study without a sweep. Its text has eight lines, so sections that a test appends begin in line 9.
const BASE: &str = r#"name = "a-study"
length_unit = "cm"

[scene]
kind = "roll"
probe = { kind = "sphere", radius = 1.0 }
object = { kind = "sphere", radius = 5.0 }
motion = { rate_rad_per_s = 0.1, duration_s = 1.0 }
"#;

/// The valid study [`BASE`], with additional sections at its end.
fn study(sections: &str) -> Study {
    parse("study.toml", &format!("{BASE}{sections}")).unwrap_or_else(|error| panic!("{error}"))
}

/// The text of the valid study [`BASE`], in which the text `from` is replaced by `to`.
fn edited(from: &str, to: &str) -> String {
    replaced(BASE, from, to)
}

fn replaced(base: &str, from: &str, to: &str) -> String {
    assert!(base.contains(from), "{from:?} is not in the base");
    base.replacen(from, to, 1)
}

fn error(text: &str) -> ConfigError {
    match parse("study.toml", text) {
        Ok(_) => panic!("accepted:\n{text}"),
        Err(error) => error,
    }
}

/// Checks that edits of a base config are rejected. Each row of the table is `edit | line:column path | words of the
/// reason`. An edit is `text => replacement`, or consists of lines that are appended; `\n` ends a line. If
/// `line:column` is missing, the position is not checked.
fn refuses(base: &str, table: &str) {
    let mut wrong = Vec::new();
    for row in table.trim().lines() {
        let columns: Vec<&str> = row.split(" | ").map(str::trim).collect();
        let [edit, place, words] = columns[..] else {
            panic!("{row}")
        };
        let edit = edit.replace("\\n", "\n");
        let text = match edit.split_once(" =>") {
            Some((from, to)) => replaced(base, from, to.trim_start()),
            None => format!("{base}{edit}\n"),
        };
        let error = error(&text);
        let (place, path) = match place.split_once(' ') {
            Some((place, path)) => (format!("study.toml:{place}: "), path),
            None if place.contains(':') => (format!("study.toml:{place}: "), ""),
            None => ("study.toml".to_owned(), place),
        };
        let is_there = error.to_string().starts_with(&place) && error.path == path;
        if !is_there || !error.message.contains(words) {
            wrong.push(format!("{row}\n{error}"));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n\n"));
}
