//! Claim 19: how large a marker is in the image, over the field (2020 paper, section III.C).

use super::evidence::{range, short, span};
use super::finding::Finding;
use super::presses::{number, rows_of, word};
use crate::Study;

/// A similar area: the largest over the field is at most this many times the smallest.
const SIMILAR: f64 = 1.25;

/// Claim 19.
pub(super) fn keeps_the_area(study: &Study) -> Result<Finding, String> {
    let fisheye = Field::of(study, "fisheye")?;
    let pinhole = Field::of(study, "pinhole")?;
    let told = |field: &Field| {
        let Field { ratio, polar } = field;
        let polar = span(*polar, short);
        format!("{} over polar angles of {polar}°", short(*ratio))
    };
    Ok(Finding {
        holds: fisheye.ratio <= SIMILAR && pinhole.ratio > SIMILAR,
        measured: format!(
            "The largest image area of a marker over the smallest: fisheye {}; pinhole {}.",
            told(&fisheye),
            told(&pinhole)
        ),
        why: format!(
            "Holds if the ratio is at most {SIMILAR} for the fisheye and more for the pinhole, each over all angles at which it sees a marker."
        ),
    })
}

/// Image areas of a marker under one lens, over the angles at which the lens sees it.
struct Field {
    /// The largest image area over the smallest.
    ratio: f64,
    /// Least and greatest polar angle at which the marker is seen, degrees.
    polar: (f64, f64),
}

impl Field {
    fn of(study: &Study, lens: &str) -> Result<Self, String> {
        let here = |row: &usize| word(study, *row, "scene.sensor", "lens") == Some(lens);
        let seen = |row: usize| {
            let polar = number(study, row, "scene.view", "polar_deg")?;
            let area = study.cells().statistic(row, "mean")?;
            (area > 0.0).then_some((polar, area))
        };
        let rows = rows_of(study, "marker_area").into_iter().filter(here);
        let seen: Vec<(f64, f64)> = rows.filter_map(seen).collect();
        let missing =
            || format!("the table has no marker_area of a {lens} at several polar angles");
        let polar = range(seen.iter().map(|(polar, _)| *polar)).ok_or_else(missing)?;
        let (smallest, largest) = range(seen.iter().map(|(_, area)| *area)).ok_or_else(missing)?;
        if polar.0 == polar.1 {
            return Err(missing());
        }
        Ok(Self {
            ratio: largest / smallest,
            polar,
        })
    }
}
