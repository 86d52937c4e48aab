//! Study configs, from text to cells.

mod alternatives;
mod cells;
mod edited;
mod every_field;
mod many;
mod refused;
mod refused_plots;
mod refused_sweeps;
mod round_trip;
mod sampled;
mod schema;
mod text;
mod varied;

use palpate_study::config::{Study, parse};

/// A valid study without a sweep, eight lines long.
const BASE: &str = r#"name = "a-study"
length_unit = "cm"

[scene]
kind = "roll"
probe = { kind = "sphere", radius = 1.0 }
object = { kind = "sphere", radius = 5.0 }
motion = { rate_rad_per_s = 0.1, duration_s = 1.0 }
"#;

/// The valid study with more sections.
fn study(sections: &str) -> Study {
    parse("study.toml", &format!("{BASE}{sections}")).unwrap_or_else(|error| panic!("{error}"))
}

/// The valid study with one piece of its text replaced.
fn edited(from: &str, to: &str) -> String {
    assert!(BASE.contains(from), "{from:?} is not in the base");
    BASE.replacen(from, to, 1)
}

/// Message about a bad config.
fn message(text: &str) -> String {
    match parse("study.toml", text) {
        Ok(_) => panic!("accepted:\n{text}"),
        Err(error) => error.to_string(),
    }
}
