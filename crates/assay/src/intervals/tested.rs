//! Table of the families of random scenes, from which `palpate check` tells whether intervals were tested.

use std::collections::BTreeMap;
use std::path::Path;

use anyhow::{Context, Result};
use serde::{Deserialize, Serialize};

use super::{camera, press, roll};

/// Row of the table.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Tested {
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

/// Families of the tables of the harnesses in a folder; of glides the quantity that is held less often.
///
/// # Errors
/// A table that cannot be read.
pub fn tested(results: &Path) -> Result<Vec<Tested>> {
    let mut all: BTreeMap<(&str, String), Tested> = BTreeMap::new();
    let mut add = |one: Tested| {
        let known = all.entry((one.scene, one.family.clone()));
        let known = known.or_insert_with(|| one.clone());
        known.coverage95 = known.coverage95.min(one.coverage95);
        known.lowest = known.lowest.min(one.lowest);
    };
    for row in rows::<Glide>(&results.join("intervals.csv"))? {
        if row.on != "all" {
            add(Tested {
                scene: "glide",
                family: format!("{}; {}", row.case, row.on),
                scenes: row.surfaces,
                coverage95: row.coverage95,
                lowest: row.lowest,
            });
        }
    }
    let tables = [
        ("press", "press-intervals.csv", press::sound_families()),
        ("roll", "roll-intervals.csv", roll::sound_families()),
    ];
    for (scene, table, sound) in tables {
        for row in rows::<Score>(&results.join(table))? {
            if sound.contains(&row.family) {
                add(Tested {
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
        let shares = camera
            .iter()
            .filter(|row| row.family == camera::SOUND && row.fits_indentation == fits_indentation);
        let shares: Vec<f64> = shares.map(|row| row.coverage95).collect();
        let indentation = if fits_indentation { "fitted" } else { "known" };
        add(Tested {
            scene: "press",
            family: format!("pictures of layers, indentation {indentation}"),
            scenes: shares.len(),
            coverage95: shares.iter().sum::<f64>() / shares.len() as f64,
            lowest: shares.iter().copied().fold(1.0, f64::min),
        });
    }
    let thousandths = |share: f64| (1e3 * share).round() / 1e3;
    Ok(all
        .into_values()
        .map(|one| Tested {
            coverage95: thousandths(one.coverage95),
            lowest: thousandths(one.lowest),
            ..one
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
    use crate::intervals::case;

    /// Name of the family that a scene is taken to be of, else why there is none.
    fn family_of(text: &str) -> Result<String, String> {
        let study = parse("a-scene.toml", text).map_err(|error| error.to_string())?;
        let config = study.cell(0).map_err(|error| error.to_string())?.config;
        match palpate::tested(&config.scene, config.length_unit) {
            palpate::Tested::On(family) => Ok(family.name.clone()),
            palpate::Tested::Beyond(_, why) | palpate::Tested::Not(why) => Err(why),
        }
    }

    /// The program tells what the tables say.
    #[test]
    fn the_table_of_the_program_is_made_from_those_of_the_harnesses() {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
        let made = super::super::table(&tested(&root.join("results")).unwrap()).unwrap();
        let kept = root.join("crates/palpate/src/tested/table.csv");
        assert_eq!(made, std::fs::read_to_string(kept).unwrap());
    }

    #[test]
    fn scenes_of_a_family_are_taken_to_be_of_it() {
        for (name, text) in [press::texts(1.0), camera::texts(), roll::texts(1.0)].concat() {
            assert_eq!(family_of(&text), Ok(name), "{text}");
        }
        for case in case::cases() {
            for (on, text) in case.texts() {
                let name = format!("{}; {on}", case.name());
                assert_eq!(family_of(&text), Ok(name), "{text}");
            }
        }
    }

    #[test]
    fn what_lies_beyond_the_draws_is_not_taken_to_be_tested() {
        for (name, text) in [press::texts(1.01), roll::texts(1.01)].concat() {
            let why = family_of(&text).expect_err(&name);
            assert!(
                why.contains("curvature of ") || why.contains("rotation of "),
                "{why}"
            );
        }
    }
}
