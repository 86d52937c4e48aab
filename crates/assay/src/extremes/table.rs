//! The table of all cases: `entry,input,outcome,value,truth,error,condition,bound,verdict`.

use std::collections::BTreeMap;
use std::path::Path;

use anyhow::{Context, Result};

use super::{Judged, Outcome, Truth, Verdict};

const COLUMNS: [&str; 9] = [
    "entry",
    "input",
    "outcome",
    "value",
    "truth",
    "error",
    "condition",
    "bound",
    "verdict",
];

/// Writes the table, whole or not at all.
pub(super) fn write(rows: &[Judged], out: &Path) -> Result<()> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    writer.write_record(COLUMNS)?;
    for row in rows {
        writer.write_record(record(row))?;
    }
    let bytes = writer.into_inner().context("the table is not whole")?;
    let folder = out.parent().filter(|folder| !folder.as_os_str().is_empty());
    let folder = folder.unwrap_or(Path::new("."));
    std::fs::create_dir_all(folder)?;
    let mut file = tempfile::NamedTempFile::new_in(folder)?;
    std::io::Write::write_all(&mut file, &bytes)?;
    file.persist(out)
        .with_context(|| format!("cannot write {}", out.display()))?;
    Ok(())
}

fn record(row: &Judged) -> [String; 9] {
    let number = |value: f64| format!("{value:e}");
    let [mut value, mut truth, mut condition, mut bound] = [const { String::new() }; 4];
    let outcome = match &row.outcome {
        None => "none",
        Some(Outcome::Refused(name)) => name,
        Some(Outcome::Value(answer)) => {
            value = answer.values.first().copied().map_or(String::new(), number);
            condition = number(answer.condition);
            bound = number(answer.bound);
            truth = match answer.truth {
                Truth::Relative(truth) | Truth::OfScale { value: truth, .. } => number(truth),
                Truth::Finite | Truth::NoDigits => String::new(),
            };
            "value"
        }
    };
    let error = row
        .error
        .map_or(String::new(), |error| format!("{error:.1e}"));
    [
        row.entry.to_owned(),
        row.input.clone(),
        outcome.to_owned(),
        value,
        truth,
        error,
        condition,
        bound,
        row.verdict.name().to_owned(),
    ]
}

/// How many cases there are, and how many of each verdict.
pub(super) fn summary(rows: &[Judged]) -> String {
    let mut verdicts = BTreeMap::<Verdict, usize>::new();
    for row in rows {
        *verdicts.entry(row.verdict).or_default() += 1;
    }
    let counts = verdicts
        .iter()
        .map(|(verdict, count)| format!("{count} {}", verdict.name()));
    let counts = counts.collect::<Vec<_>>().join(", ");
    format!("{} cases: {counts}", rows.len())
}
