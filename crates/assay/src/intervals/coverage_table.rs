//! Table of the measured coverage of each family of random scenes. `palpate check` reads it.

use std::collections::BTreeMap;
use std::path::Path;

use anyhow::{Context, Result};
use serde::{Deserialize, Serialize};

use super::camera_case::{self, coverage_family};
use super::{press_case, roll_case};

/// Row of the table.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CoverageRow {
    scene: &'static str,
    family: String,
    scenes: usize,
    coverage95: f64,
    lowest: f64,
}

#[derive(Deserialize)]
struct Glide {
    case: String,
    on: String,
    surfaces: usize,
    coverage95: f64,
    lowest: f64,
}

/// Row of the tables of rolls and presses.
#[derive(Deserialize)]
struct Score {
    family: String,
    scenes: usize,
    coverage95: f64,
    lowest: f64,
}

#[derive(Deserialize)]
struct Camera {
    family: String,
    fits_indentation: bool,
    coverage95: f64,
}

/// Coverage of each sound family in the tables of the harnesses in a folder. Of glides it is that of the quantity with the
/// lower coverage.
///
/// # Errors
/// If a table cannot be read.
pub fn coverage_table(results: &Path) -> Result<Vec<CoverageRow>> {
    let mut all: BTreeMap<(&str, String), CoverageRow> = BTreeMap::new();
    let mut add = |row: CoverageRow| {
        let known = all.entry((row.scene, row.family.clone()));
        let known = known.or_insert_with(|| row.clone());
        known.coverage95 = known.coverage95.min(row.coverage95);
        known.lowest = known.lowest.min(row.lowest);
    };
    for row in rows::<Glide>(&results.join("intervals.csv"))? {
        if row.on != "all" {
            add(CoverageRow {
                scene: "glide",
                family: format!("{}; {}", row.case, row.on),
                scenes: row.surfaces,
                coverage95: row.coverage95,
                lowest: row.lowest,
            });
        }
    }
    let tables = [
        ("press", "press-intervals.csv", press_case::sound_families()),
        ("roll", "roll-intervals.csv", roll_case::sound_families()),
    ];
    for (scene, table, sound) in tables {
        for row in rows::<Score>(&results.join(table))? {
            if sound.contains(&row.family) {
                add(CoverageRow {
                    scene,
                    family: row.family,
                    scenes: row.scenes,
                    coverage95: row.coverage95,
                    lowest: row.lowest,
                });
            }
        }
    }
    let camera = rows::<Camera>(&results.join("camera-intervals.csv"))?;
    for fits_indentation in [false, true] {
        let shares = camera.iter().filter(|row| {
            row.family == camera_case::Family::Sound.name()
                && row.fits_indentation == fits_indentation
        });
        let shares: Vec<f64> = shares.map(|row| row.coverage95).collect();
        add(CoverageRow {
            scene: "press",
            family: coverage_family(fits_indentation),
            scenes: shares.len(),
            coverage95: shares.iter().sum::<f64>() / shares.len() as f64,
            lowest: shares.iter().copied().fold(1.0, f64::min),
        });
    }
    let thousandths = |share: f64| (1e3 * share).round() / 1e3;
    Ok(all
        .into_values()
        .map(|row| CoverageRow {
            coverage95: thousandths(row.coverage95),
            lowest: thousandths(row.lowest),
            ..row
        })
        .collect())
}

fn rows<R: for<'a> Deserialize<'a>>(path: &Path) -> Result<Vec<R>> {
    let name = || path.display().to_string();
    let reader = csv::Reader::from_path(path).with_context(name)?;
    reader
        .into_deserialize()
        .collect::<Result<_, _>>()
        .with_context(name)
}

#[cfg(test)]
mod tests {
    use palpate::config::parse;

    use super::*;
    use crate::csv_table::text;
    use crate::intervals::{camera, glide_contacts, press, roll};

    /// Family that `palpate check` assigns to a scene, or the reason why there is none.
    fn family_of(text: &str) -> Result<String, String> {
        let study = parse("a-scene.toml", text).map_err(|error| error.to_string())?;
        let config = study.cell(0).map_err(|error| error.to_string())?.config;
        match palpate::coverage(&config.scene, config.length_unit) {
            palpate::Coverage::Measured(family) => Ok(family.name.clone()),
            palpate::Coverage::Outside(_, why) | palpate::Coverage::NotMeasured(why) => Err(why),
        }
    }

    #[test]
    fn the_table_of_the_program_is_that_of_the_committed_results() {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
        let made = text(&coverage_table(&root.join("results")).unwrap()).unwrap();
        let committed = root.join("crates/palpate/src/coverage/families.csv");
        assert_eq!(made, std::fs::read_to_string(committed).unwrap());
    }

    #[test]
    fn scenes_are_assigned_to_their_family() {
        for (name, text) in [press::configs(1.0), camera::configs(), roll::configs(1.0)].concat() {
            assert_eq!(family_of(&text), Ok(name), "{text}");
        }
        for case in glide_contacts::cases() {
            for (on, text) in case.configs() {
                let name = format!("{}; {on}", case.name());
                assert_eq!(family_of(&text), Ok(name), "{text}");
            }
        }
    }

    #[test]
    fn scenes_beyond_the_limits_have_no_family() {
        for (name, text) in [press::configs(1.01), roll::configs(1.01)].concat() {
            let why = family_of(&text).expect_err(&name);
            assert!(
                why.contains("curvature of ") || why.contains("rotation of "),
                "{why}"
            );
        }
    }
}
