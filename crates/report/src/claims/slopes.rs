//! Claim 22: how far a marker's picture follows its displacement (2020 paper, Fig. 6).

use super::evidence::{percent, short};
use super::finding::Finding;
use super::hue::{Lines, PUBLISHED_SLOPE, centroid_lines, hue_lines};
use super::presses::millimetres;
use super::straight_line::StraightLine;
use crate::Study;

/// Slope of the line through the readings of the paper's Fig. 6c, px/mm: what `palpate sensor calibrate` tells of
/// `examples/chromatouch-2020/calibration-tangential.csv`.
const PUBLISHED_CENTROID: f64 = 7.0;

/// Largest difference from a published slope: by as much the paper's own slopes of the hue differ between objects.
const LIKE: f64 = 0.2;

/// Setting whose labels tell the sensors apart.
const SENSOR: &str = "scene.sensor";

/// Claim 22.
pub(super) fn are_the_published(study: &Study) -> Result<Finding, String> {
    let unit =
        millimetres(study).ok_or("the study's unit of length has no length in millimetres")?;
    let hue = shares(&hue_lines(study, SENSOR)?, PUBLISHED_SLOPE * unit);
    let centroid = shares(&centroid_lines(study, SENSOR)?, PUBLISHED_CENTROID * unit);
    let is_like = |share: f64| (share - 1.0).abs() <= LIKE;
    let both = hue.iter().filter(|(name, share)| {
        let other = centroid.iter().find(|(other, _)| other == name);
        is_like(*share) && other.is_some_and(|(_, share)| is_like(*share))
    });
    Ok(Finding {
        holds: both.count() > 0,
        measured: format!(
            "Of the hue's {PUBLISHED_SLOPE} turns/mm: {}. Of the centroid's {} px/mm: {}.",
            told(&hue),
            short(PUBLISHED_CENTROID),
            told(&centroid)
        ),
        why: format!(
            "Holds if a sensor has both slopes within {} of the published ones, by as much as the paper's slopes of the hue differ between objects. The steepest reach {} of the hue's and {} of the centroid's.",
            percent(LIKE),
            steepest(&hue),
            steepest(&centroid)
        ),
    })
}

/// Slopes over a published one.
fn shares(lines: &Lines, published: f64) -> Vec<(String, f64)> {
    let share = |(name, line): &(String, StraightLine)| (name.clone(), line.slope / published);
    lines.iter().map(share).collect()
}

/// The largest share, and whose it is.
fn steepest(shares: &[(String, f64)]) -> String {
    let largest = shares.iter().max_by(|one, other| one.1.total_cmp(&other.1));
    let told = largest.map(|(name, share)| format!("{} ({name})", percent(*share)));
    told.unwrap_or_else(|| "none".to_owned())
}

fn told(shares: &[(String, f64)]) -> String {
    let told: Vec<String> = shares
        .iter()
        .map(|(name, share)| format!("{} ({name})", percent(*share)))
        .collect();
    told.join(", ")
}
