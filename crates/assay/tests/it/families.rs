//! Tests whether a scene is assigned to the right family, that is, to the right group of similar scenes. The coverage
//! of intervals is measured for each family.

use palpate::config::parse;
use palpate::{Coverage, FAMILY_TABLES, coverage, family_scene};

/// Rows of a CSV table. Each row is a list of pairs: the name of the column, and the text.
fn rows(table: &str) -> Vec<Vec<(String, String)>> {
    let mut reader = csv::Reader::from_reader(table.as_bytes());
    let header = reader.headers().unwrap().clone();
    let pairs = |row: csv::StringRecord| {
        let cells = header.iter().zip(&row);
        cells
            .map(|(name, cell)| (name.to_owned(), cell.to_owned()))
            .collect()
    };
    reader.records().map(|row| pairs(row.unwrap())).collect()
}

#[test]
fn scenes_are_assigned_to_their_family() {
    for (_, table) in FAMILY_TABLES {
        for row in rows(table) {
            let cells = || {
                row.iter()
                    .map(|(name, cell)| (name.as_str(), cell.as_str()))
            };
            let cell = |name: &str| cells().find(|one| one.0 == name).unwrap().1;
            if !cell("flaw").is_empty() {
                continue;
            }
            let inside = |_: &str, [low, high]: [f64; 2]| match low {
                0.0 => low,
                _ => 0.5 * (low + high),
            };
            let text = family_scene(cells(), inside).unwrap();
            let study = parse("a-scene.toml", &text).unwrap();
            let config = study.cell(0).unwrap().config;
            match coverage(&config.scene, config.length_unit) {
                Coverage::Measured(family) => assert_eq!(family.name, cell("family")),
                other => panic!("{text}: {other:?}"),
            }
        }
    }
}
