//! Measurements of speed against accuracy: `ladders.csv`, `rungs.csv`, `answers.csv` and `stages.csv` of one folder,
//! and `promise.csv`, the verdicts on `auto`, which may be absent.

mod promise;

pub(crate) use promise::Promise;

use crate::records::Records;
use crate::{Files, ReportError};
use palpate_study::number::finite;

/// Every ladder of a folder.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Tradeoff {
    pub(crate) ladders: Vec<Ladder>,
    /// Verdicts on `auto` for each kind of scene; none where there is no `promise.csv`.
    pub(crate) promises: Vec<Promise>,
    /// Whether instructions are known for every rung; if so they are the cost.
    pub(crate) counted: bool,
    /// Words for the machine on which the measurements were made.
    pub(crate) machine: String,
}

/// Models, sensors or settings that answer the same question, each at its own cost and error, on several scenes.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Ladder {
    pub(crate) name: String,
    pub(crate) title: String,
    /// Words for the quantity that errs and for the scale that its error is relative to.
    pub(crate) error_of: String,
    /// Words for one evaluation, whose cost is given.
    pub(crate) evaluation: String,
    pub(crate) scenes: Vec<LadderScene>,
}

/// Measurements of the rungs on one scene.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct LadderScene {
    /// `easy`, `typical`, `hard`.
    pub(crate) ease: String,
    pub(crate) what: String,
    pub(crate) rungs: Vec<Rung>,
    pub(crate) answers: Vec<Answer>,
}

/// Error and cost of one rung.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Rung {
    pub(crate) name: String,
    pub(crate) error: f64,
    /// Standard deviation of the error over sets of trials; 0 where no trials are drawn.
    pub(crate) error_std: f64,
    /// Instructions where they are counted, else the median of nanoseconds.
    pub(crate) cost: f64,
    /// Whether no other rung is both as exact and as cheap (Pareto front).
    pub(crate) on_front: bool,
}

/// Rung to take for a target.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Answer {
    pub(crate) target: String,
    /// `none` where no rung reaches it.
    pub(crate) rung: String,
    pub(crate) error: Option<f64>,
    pub(crate) ns: Option<f64>,
    pub(crate) instructions: Option<f64>,
}

impl Tradeoff {
    /// Reads the tables of a folder.
    ///
    /// # Errors
    /// A table but `promise.csv` is absent, or one is malformed, or a cost or an error is not positive.
    pub(crate) fn read(files: &Files) -> Result<Self, ReportError> {
        let promises = match files.contain("promise.csv") {
            true => promise::read(files)?,
            false => Vec::new(),
        };
        let (rungs, counted) = rungs(files)?;
        let answers = answers(files)?;
        let names = [
            "ladder",
            "title",
            "error_of",
            "evaluation",
            "scene",
            "what",
            "machine",
        ];
        let table = Records::read(files, "ladders.csv", &names)?.filled()?;
        let text = |row: usize, column: usize| table.text(row, column).to_owned();
        let scene = |row: usize| {
            let key = (text(row, 0), text(row, 4));
            LadderScene {
                ease: text(row, 4),
                what: text(row, 5),
                rungs: of(&key, &rungs),
                answers: of(&key, &answers),
            }
        };
        let ladder = |(name, rows): (&str, Vec<usize>)| Ladder {
            name: name.to_owned(),
            title: text(rows[0], 1),
            error_of: text(rows[0], 2),
            evaluation: text(rows[0], 3),
            scenes: rows.into_iter().map(scene).collect(),
        };
        let ladders = table.by_text(0).into_iter().map(ladder).collect();
        Ok(Self {
            ladders,
            promises,
            counted,
            machine: text(0, 6),
        })
    }

    /// Unit of the costs.
    pub(crate) const fn unit(&self) -> &'static str {
        if self.counted { "instructions" } else { "ns" }
    }
}

/// Ladder and scene.
type Key = (String, String);

/// Items of `all` that belong to a key.
fn of<T: Clone>(key: &Key, all: &[(Key, T)]) -> Vec<T> {
    let mine = all.iter().filter(|one| one.0 == *key);
    mine.map(|one| one.1.clone()).collect()
}

fn rungs(files: &Files) -> Result<(Vec<(Key, Rung)>, bool), ReportError> {
    let names = [
        "ladder",
        "scene",
        "rung",
        "error",
        "error_std",
        "median_ns",
        "instructions",
        "pareto",
    ];
    let table = Records::read(files, "rungs.csv", &names)?.filled()?;
    let counted = (0..table.rows()).all(|row| !table.text(row, 6).is_empty());
    let positive = |row: usize, column: usize| {
        let number = table.number(row, column)?;
        if number > 0.0 {
            Ok(number)
        } else {
            Err(table.bad(row, column, "more than 0"))
        }
    };
    let rung = |row: usize| {
        let key = (table.text(row, 0).to_owned(), table.text(row, 1).to_owned());
        let rung = Rung {
            name: table.text(row, 2).to_owned(),
            error: positive(row, 3)?,
            error_std: finite(table.text(row, 4)).unwrap_or(0.0),
            cost: positive(row, if counted { 6 } else { 5 })?,
            on_front: table.text(row, 7) == "true",
        };
        Ok((key, rung))
    };
    let rungs = (0..table.rows())
        .map(rung)
        .collect::<Result<_, ReportError>>()?;
    Ok((rungs, counted))
}

fn answers(files: &Files) -> Result<Vec<(Key, Answer)>, ReportError> {
    let names = [
        "ladder",
        "scene",
        "target",
        "rung",
        "error",
        "median_ns",
        "instructions",
    ];
    let table = Records::read(files, "answers.csv", &names)?.filled()?;
    let answer = |row: usize| {
        let [ladder, scene, target, rung] = [0, 1, 2, 3].map(|at| table.text(row, at).to_owned());
        let answer = Answer {
            target,
            rung,
            error: finite(table.text(row, 4)),
            ns: finite(table.text(row, 5)),
            instructions: finite(table.text(row, 6)),
        };
        ((ladder, scene), answer)
    };
    Ok((0..table.rows()).map(answer).collect())
}
