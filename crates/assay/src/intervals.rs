//! Measures two properties of estimates on random scenes: the coverage of their 50, 80 and 95 % intervals, and the
//! share of estimates with a warning.
//!
//! Each row of a table in `crates/palpate/src/coverage/` defines a family of similar scenes. For each family, this
//! program draws random scenes and simulates noisy readings. It counts how often the intervals of the estimates contain
//! the true value, and how often an estimate has a warning.

mod coverage;
pub(crate) mod random_scene;

use anyhow::{Context, Result, bail};
use rayon::prelude::*;

use coverage::{SceneCoverage, Score};
use random_scene::RandomScene;

/// Largest allowed share of estimates with a warning, if the readings agree with the model and the intervals are
/// correct.
const MAX_FALSE_ALARMS: f64 = 0.05;
/// Intervals count as correct if at least this share of the 95 % intervals contains the true value.
const CORRECT_COVERAGE: f64 = 0.92;
/// Smallest allowed share of estimates with a warning, if the readings have a flaw.
const MIN_DETECTED: f64 = 0.9;
/// Name of the flaw of readings that were recorded without a contact. For such readings, the estimate must fail.
const NO_CONTACT: &str = "no contact";

/// Options for measuring the coverage of intervals and the share of warnings.
#[derive(Clone, Copy, Debug)]
pub struct Options<'a> {
    /// Seed of the scenes and the noise.
    pub seed: u64,
    /// Number of random scenes of each family of scenes; with `None`, the number in the family's row of the table.
    pub scenes: Option<u64>,
    /// Number of trials of each scene; with `None`, the number in the table row of the scene's family.
    pub trials: Option<u64>,
    /// Measure only families of scenes for which each of these words is in the name or in the flaw of the family. The
    /// rows of other families in the table are not changed.
    pub only: &'a str,
}

/// Measures the coverage and the warnings of the selected families. Returns the table with the measured columns, and a
/// line for each family that violates the limits on warnings. `report` is called with a line for each measured family.
///
/// # Errors
/// An error if no family is selected or a scene cannot be set up.
pub fn measure(
    table: &str,
    options: Options<'_>,
    report: impl Fn(&str),
) -> Result<(String, Vec<String>)> {
    let mut reader = csv::Reader::from_reader(table.as_bytes());
    let header = reader.headers()?.clone();
    let mut writer = csv::Writer::from_writer(Vec::new());
    writer.write_record(&header)?;
    let (mut misses, mut measured) = (Vec::new(), 0);
    for row in reader.records() {
        let mut row: Vec<String> = row?.iter().map(str::to_owned).collect();
        let [family, flaw] = ["family", "flaw"].map(|name| cell(&header, &row, name).to_owned());
        let name = format!("{family}; {flaw}");
        if options
            .only
            .split_whitespace()
            .all(|word| name.contains(word))
        {
            let score = score(&header, &row, options).with_context(|| name.clone())?;
            let mut words = vec![name.clone()];
            for (column, value) in score.columns() {
                let place = header.iter().position(|name| name == column);
                words.push(format!("{column} {value}"));
                row[place.with_context(|| format!("no column {column}"))?] = value;
            }
            report(&words.join(", "));
            misses.extend(miss(&flaw, &score).map(|miss| format!("{name}: {miss}")));
            measured += 1;
        }
        writer.write_record(&row)?;
    }
    if measured == 0 {
        bail!("no family has a name with each word of `{}`", options.only);
    }
    Ok((String::from_utf8(writer.into_inner()?)?, misses))
}

fn cell<'a>(header: &csv::StringRecord, row: &'a [String], name: &str) -> &'a str {
    let place = header.iter().position(|column| column == name);
    place
        .and_then(|place| row.get(place))
        .map_or("", String::as_str)
}

fn score(header: &csv::StringRecord, row: &[String], options: Options<'_>) -> Result<Score> {
    let cells: Vec<(&str, &str)> = header.iter().zip(row.iter().map(String::as_str)).collect();
    let count =
        |name: &str, given: Option<u64>| given.map_or_else(|| cell(header, row, name).parse(), Ok);
    let (scenes, trials) = (
        count("scenes", options.scenes)?,
        count("trials", options.trials)?,
    );
    let scenes = (0..scenes).into_par_iter().map(|number| {
        let scene = RandomScene::new(&cells, options.seed, number)?;
        let mut coverage = SceneCoverage::default();
        (0..trials).for_each(|trial| coverage.add(&scene, trial));
        Ok(coverage)
    });
    Ok(Score::new(&scenes.collect::<Result<Vec<_>>>()?))
}

/// Message that states which limit on the share of warnings a family of scenes violates; `None` if it violates no
/// limit. `score` is the result of the family.
fn miss(flaw: &str, score: &Score) -> Option<String> {
    match flaw {
        "" => (score.warned > MAX_FALSE_ALARMS && score.coverage[2] >= CORRECT_COVERAGE)
            .then(|| format!("the share of false alarms is too large: {}", score.warned)),
        NO_CONTACT => (score.failed < 1.0 - MAX_FALSE_ALARMS).then(|| {
            format!(
                "a contact is detected in this share of trials: {}",
                1.0 - score.failed
            )
        }),
        _ => (score.warned < MIN_DETECTED)
            .then(|| format!("the share of detected flaws is too small: {}", score.warned)),
    }
}
