//! Claim 14: how a marker's picture follows its displacement (2020 paper, section IV.A, Fig. 6).

use super::evidence::{groups, near, range, short, span};
use super::finding::Finding;
use super::presses::{label, millimetres, number, rows_of};
use super::straight_line::{Reading, StraightLine};
use crate::Study;
use crate::group::distinct;

/// The paper's own R² of its lines through the hue and through the centroid.
const HUE: f64 = 0.89;
const CENTROID: f64 = 0.99;

/// Slope of the line through all 39 readings of the paper's Fig. 6b, turns/mm: what `palpate sensor calibrate` tells of
/// `examples/chromatouch-2020/calibration-normal.csv`.
pub(super) const PUBLISHED_SLOPE: f64 = 0.02583;

const MOTION: &str = "scene.motion";
const OBJECT: &str = "scene.object";

/// Claim 14.
pub(super) fn and_centroid_are_linear(study: &Study) -> Result<Finding, String> {
    let hue = hue_lines(study, OBJECT)?;
    let centroid = centroid_lines(study, OBJECT)?;
    let least = |lines: &Lines| range(lines.iter().map(|(_, line)| line.r_squared));
    let reaches = |lines: &Lines, r_squared| least(lines).is_some_and(|(low, _)| low >= r_squared);
    let length = match study.setting("length_unit").and_then(toml::Value::as_str) {
        Some(unit) if unit != "unit" => unit,
        _ => "unit of length",
    };
    Ok(Finding {
        holds: reaches(&hue, HUE) && reaches(&centroid, CENTROID),
        measured: format!(
            "Hue against indentation: {}{}. Centroid against shift: {}.",
            told(&hue, &format!("turns/{length}")),
            beside_the_published(&hue, millimetres(study)),
            told(&centroid, &format!("px/{length}"))
        ),
        why: format!(
            "Holds if R² is at least {HUE} of every line through the hue and {CENTROID} of every one through the centroid: the paper's own. The scatter of single readings counts against it. Per object the slopes of the paper's hues differ by ±20 %."
        ),
    })
}

/// Lines, each with the label of what it is of.
pub(super) type Lines = Vec<(String, StraightLine)>;

/// Hue against indentation without shift, whatever else is swept; labelled by the setting at a path.
pub(super) fn hue_lines(study: &Study, path: &str) -> Result<Lines, String> {
    let unmoved = |row: &usize| shift(study, *row) == 0.0;
    let rows: Vec<usize> = rows_of(study, "hue_change")
        .into_iter()
        .filter(unmoved)
        .collect();
    let along = |row| number(study, row, MOTION, "indentation");
    let missing = "the table has no hue_change without shift at three indentations of one object";
    lines(study, path, groups(study, &rows, &[MOTION]), along, missing)
}

/// Centroid against shift, per indentation and whatever else is swept; labelled by the setting at a path.
pub(super) fn centroid_lines(study: &Study, path: &str) -> Result<Lines, String> {
    let indentation = |row: usize| number(study, row, MOTION, "indentation").unwrap_or(0.0);
    let mut pressed: Vec<Vec<usize>> = Vec::new();
    for group in groups(study, &rows_of(study, "centroid_shift"), &[MOTION]) {
        let first = pressed.len();
        for row in group {
            let alike = |known: &&mut Vec<usize>| near(indentation(known[0]), indentation(row));
            match pressed[first..].iter_mut().find(alike) {
                Some(known) => known.push(row),
                None => pressed.push(vec![row]),
            }
        }
    }
    let along = |row| Some(shift(study, row));
    let missing = "the table has no centroid_shift at three shifts of one object and indentation";
    lines(study, path, pressed, along, missing)
}

/// The shift along the skin in `row`: none where neither the table nor the config has one.
fn shift(study: &Study, row: usize) -> f64 {
    number(study, row, MOTION, "shift").unwrap_or(0.0)
}

/// The lines through those of the groups of rows that have one; what is missing, if none has.
fn lines(
    study: &Study,
    path: &str,
    groups: Vec<Vec<usize>>,
    along: impl Fn(usize) -> Option<f64>,
    missing: &str,
) -> Result<Lines, String> {
    let reading = |row: usize| {
        let table = study.cells();
        Some(Reading {
            x: along(row)?,
            mean: table.statistic(row, "mean")?,
            std: table.statistic(row, "std").unwrap_or(0.0),
        })
    };
    let line = |rows: Vec<usize>| {
        let readings: Vec<Reading> = rows.iter().filter_map(|row| reading(*row)).collect();
        let alone = path.rsplit('.').next().unwrap_or(path);
        let known = label(study, *rows.first()?, path).map(str::to_owned);
        let object = known.unwrap_or_else(|| format!("the only {alone}"));
        Some((object, StraightLine::through(&readings)?))
    };
    let lines: Lines = groups.into_iter().filter_map(line).collect();
    if lines.is_empty() {
        Err(missing.to_owned())
    } else {
        Ok(lines)
    }
}

/// How far the mean slope of the hue is from the published one; a unit is so many millimetres.
fn beside_the_published(hue: &Lines, millimetres: Option<f64>) -> String {
    let Some(unit) = millimetres else {
        return String::new();
    };
    let slopes: f64 = hue.iter().map(|(_, line)| line.slope).sum();
    let ratio = PUBLISHED_SLOPE * unit * hue.len() as f64 / slopes;
    let said = match ratio {
        ratio if ratio.is_finite() && ratio >= 1.0 => format!("{} times below", short(ratio)),
        ratio if ratio > 0.0 => format!("{} times", short(1.0 / ratio)),
        _ => return String::new(),
    };
    format!("; the slope is {said} the published one of {PUBLISHED_SLOPE} turns/mm")
}

/// R², the slopes per object and by how much they differ.
fn told(lines: &Lines, unit: &str) -> String {
    let r_squared = range(lines.iter().map(|(_, line)| line.r_squared));
    let r_squared = r_squared.map_or(String::new(), |range| span(range, short));
    let objects = distinct(lines.iter().map(|(object, _)| object.as_str()));
    let slope = |object: &&str| {
        let of_it = lines.iter().filter(|(name, _)| name == object);
        let slopes = range(of_it.map(|(_, line)| line.slope))?;
        Some(format!("{} ({object})", span(slopes, short)))
    };
    let slopes: Vec<String> = objects.iter().filter_map(slope).collect();
    let differ = match range(lines.iter().map(|(_, line)| line.slope)) {
        Some((low, high)) if lines.len() > 1 && low + high != 0.0 => {
            let half = ((high - low) / (high + low)).abs();
            format!(", which differ by ±{} %", short(100.0 * half))
        }
        _ => String::new(),
    };
    format!("R² {r_squared}, slope {} {unit}{differ}", slopes.join(", "))
}
