//! Tables of the measurements.

use std::fs;
use std::path::Path;

use anyhow::{Context, Result};

use super::front::{Worth, answer, pareto};
use super::ladder::{Ease, Erring};
use crate::measured::Spread;

/// Errors that users may allow, in words and as numbers; for each the tables name the cheapest rung.
const TARGETS: [(&str, f64); 4] = [
    ("10 %", 0.1),
    ("1 %", 0.01),
    ("0.1 %", 0.001),
    ("1e-6", 1e-6),
];

/// Measurements of a ladder on one scene.
pub(super) struct Measured {
    pub(super) ladder: &'static str,
    pub(super) title: &'static str,
    pub(super) error: &'static str,
    pub(super) evaluation: &'static str,
    pub(super) ease: Ease,
    pub(super) scene: String,
    pub(super) rungs: Vec<MeasuredRung>,
}

/// Measurements of one rung.
pub(super) struct MeasuredRung {
    pub(super) name: String,
    pub(super) setting: Option<f64>,
    pub(super) error: Erring,
    pub(super) ns: Spread,
    pub(super) instructions: Option<u64>,
}

impl MeasuredRung {
    fn worth(&self) -> Worth {
        let cost = self
            .instructions
            .map_or(self.ns.median, |count| count as f64);
        Worth {
            cost,
            error: self.error.error,
        }
    }
}

/// Writes `ladders.csv` (what the ladders are, and on which machine they were measured), `rungs.csv` and `answers.csv`
/// to a folder.
pub(super) fn write(measured: &[Measured], machine: &str, folder: &Path) -> Result<()> {
    write_ladders(measured, machine, folder)?;
    write_rungs(measured, folder)?;
    write_answers(measured, folder)
}

fn write_ladders(measured: &[Measured], machine: &str, folder: &Path) -> Result<()> {
    let header = [
        "ladder",
        "title",
        "error_of",
        "evaluation",
        "scene",
        "what",
        "machine",
    ];
    let rows = measured.iter().map(|it| {
        [
            it.ladder,
            it.title,
            it.error,
            it.evaluation,
            it.ease.name(),
            it.scene.as_str(),
            machine,
        ]
        .map(str::to_owned)
    });
    table(&folder.join("ladders.csv"), &header, rows)
}

fn write_rungs(measured: &[Measured], folder: &Path) -> Result<()> {
    let header = [
        "ladder",
        "scene",
        "rung",
        "setting",
        "error",
        "error_std",
        "median_ns",
        "q25_ns",
        "q75_ns",
        "instructions",
        "pareto",
    ];
    let rows = measured.iter().flat_map(|it| {
        let worths: Vec<Worth> = it.rungs.iter().map(MeasuredRung::worth).collect();
        let rungs = it.rungs.iter().zip(pareto(&worths));
        rungs.map(|(rung, on_front)| {
            let [median, q25, q75] = nanoseconds(&rung.ns);
            [
                it.ladder.to_owned(),
                it.ease.name().to_owned(),
                rung.name.clone(),
                rung.setting.map_or_else(String::new, |it| it.to_string()),
                format!("{:.3e}", rung.error.error),
                rung.error
                    .std
                    .map_or_else(String::new, |std| format!("{std:.3e}")),
                median,
                q25,
                q75,
                count(rung.instructions),
                on_front.to_string(),
            ]
        })
    });
    table(&folder.join("rungs.csv"), &header, rows)
}

fn write_answers(measured: &[Measured], folder: &Path) -> Result<()> {
    let header = [
        "ladder",
        "scene",
        "target",
        "rung",
        "error",
        "median_ns",
        "instructions",
    ];
    let rows = measured.iter().flat_map(|it| {
        let worths: Vec<Worth> = it.rungs.iter().map(MeasuredRung::worth).collect();
        TARGETS.map(|(words, target)| {
            let [name, error, ns, instructions] = match answer(&worths, target) {
                None => ["none", "", "", ""].map(str::to_owned),
                Some(at) => {
                    let rung = &it.rungs[at];
                    let [median, ..] = nanoseconds(&rung.ns);
                    [
                        rung.name.clone(),
                        format!("{:.3e}", rung.error.error),
                        median,
                        count(rung.instructions),
                    ]
                }
            };
            [
                it.ladder.to_owned(),
                it.ease.name().to_owned(),
                words.to_owned(),
                name,
                error,
                ns,
                instructions,
            ]
        })
    });
    table(&folder.join("answers.csv"), &header, rows)
}

/// Median and quartiles, with the digits that they deserve.
pub(super) fn nanoseconds(spread: &Spread) -> [String; 3] {
    let digits = if spread.median < 100.0 { 1 } else { 0 };
    [spread.median, spread.q25, spread.q75].map(|ns| format!("{ns:.digits$}"))
}

pub(super) fn count(instructions: Option<u64>) -> String {
    instructions.map_or_else(String::new, |count| count.to_string())
}

/// Writes a table; every row is as long as the header.
pub(super) fn table(
    path: &Path,
    header: &[&str],
    rows: impl Iterator<Item = impl AsRef<[String]>>,
) -> Result<()> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    writer.write_record(header)?;
    for row in rows {
        writer.write_record(row.as_ref())?;
    }
    let bytes = writer.into_inner().context("the table is not whole")?;
    fs::write(path, bytes).with_context(|| format!("cannot write {}", path.display()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tables_end_with_what_answers_each_target() {
        let rung = |name: &str, error: f64, instructions: u64| MeasuredRung {
            name: name.to_owned(),
            setting: None,
            error: Erring {
                error,
                std: Some(1e-3),
            },
            ns: Spread {
                q25: 1.0,
                median: 2.0,
                q75: 3.0,
            },
            instructions: Some(instructions),
        };
        let measured = [Measured {
            ladder: "l",
            title: "",
            error: "",
            evaluation: "",
            ease: Ease::Hard,
            scene: String::new(),
            rungs: vec![rung("coarse", 0.05, 10), rung("fine", 5e-4, 100)],
        }];
        let folder = tempfile::tempdir().unwrap();
        write(&measured, "a machine", folder.path()).unwrap();
        let answers = fs::read_to_string(folder.path().join("answers.csv")).unwrap();
        let rows: Vec<&str> = answers.lines().skip(1).collect();
        assert_eq!(
            rows,
            [
                "l,hard,10 %,coarse,5.000e-2,2.0,10",
                "l,hard,1 %,fine,5.000e-4,2.0,100",
                "l,hard,0.1 %,fine,5.000e-4,2.0,100",
                "l,hard,1e-6,none,,,",
            ]
        );
        let rungs = fs::read_to_string(folder.path().join("rungs.csv")).unwrap();
        assert!(
            rungs.contains("l,hard,fine,,5.000e-4,1.000e-3,2.0,1.0,3.0,100,true"),
            "{rungs}"
        );
    }
}
