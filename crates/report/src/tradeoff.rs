//! Measured speed and accuracy of models. They are in the tables `ladders.csv`, `rungs.csv` and `answers.csv` of one
//! folder. The model `auto` chooses a model for each scene; the optional table `promise.csv` states how good its choices
//! are.

use crate::records::Records;
use crate::{Files, ReportError};
use palpate_study::number::finite;

#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Tradeoff {
    pub(crate) ladders: Vec<Ladder>,
    pub(crate) auto_models: Vec<AutoModel>,
    /// Whether the table states, for every model, the number of processor instructions of one evaluation. If so, this
    /// number is the cost of the model; otherwise, the cost is a time.
    pub(crate) counted: bool,
    pub(crate) machine: String,
}

/// A comparison of several models, sensors or settings for the same task. Each model, sensor or setting is called a
/// rung. The costs and errors of the rungs were measured on several scenes.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Ladder {
    pub(crate) name: String,
    pub(crate) title: String,
    /// Definition of the error of the rungs, as text: the quantity whose error is computed, and the scale by which this
    /// error is divided.
    pub(crate) error_of: String,
    /// The computation whose cost was measured for each rung.
    pub(crate) evaluation: String,
    pub(crate) scenes: Vec<LadderScene>,
}

/// Errors and costs of all rungs on one scene.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct LadderScene {
    /// How easily accurate results are obtained on this scene: `easy`, `typical` or `hard`.
    pub(crate) ease: String,
    pub(crate) what: String,
    pub(crate) rungs: Vec<Rung>,
    pub(crate) answers: Vec<Answer>,
}

/// Measured error and cost of one rung: a model, sensor or setting.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Rung {
    pub(crate) name: String,
    pub(crate) error: f64,
    /// Standard error of `error`; 0 if the error was not estimated from trials.
    pub(crate) error_std: f64,
    /// Number of processor instructions, if they were counted; otherwise the median time in ns.
    pub(crate) cost: f64,
    /// Whether the rung is on the Pareto front: no other rung has both a smaller error and a smaller cost.
    pub(crate) on_front: bool,
}

/// The rung (model, sensor or setting) that is recommended for a target error.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Answer {
    pub(crate) target: String,
    pub(crate) rung: String,
    pub(crate) error: Option<f64>,
    pub(crate) ns: Option<f64>,
    pub(crate) instructions: Option<f64>,
}

impl Tradeoff {
    /// Reads the tables of a folder.
    ///
    /// # Errors
    /// [`ReportError`] if a table other than `promise.csv` is missing, if a table is malformed, or if a cost or an
    /// error is not positive.
    pub(crate) fn read(files: &Files) -> Result<Self, ReportError> {
        let auto_models = match files.contain("promise.csv") {
            true => read_auto_models(files)?,
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
            auto_models,
            counted,
            machine: text(0, 6),
        })
    }

    pub(crate) const fn unit(&self) -> &'static str {
        if self.counted { "instructions" } else { "ns" }
    }
}

type Key = (String, String);

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

/// Test results of the model `auto`, which chooses one of several models, on random scenes of one kind. A test succeeds
/// if the error of the chosen model is within the tolerance, and its cost is not much higher than that of the cheapest
/// model within the tolerance.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct AutoModel {
    pub(crate) kind: String,
    pub(crate) scenes: usize,
    /// Number of scenes on which the test succeeds.
    pub(crate) successes: usize,
    /// Number of scenes on which the error of at least one model besides the chosen model is within the tolerance.
    pub(crate) with_rivals: usize,
    /// Largest ratio over all scenes: number of instructions of the chosen model, divided by the number of instructions
    /// of the cheapest model whose error is within the tolerance. `None` if `promise.csv` does not state it.
    pub(crate) largest_ratio: Option<f64>,
}

/// Reads `promise.csv`. The kinds of scenes are in order of appearance.
///
/// # Errors
/// [`ReportError`] if the table is malformed.
fn read_auto_models(files: &Files) -> Result<Vec<AutoModel>, ReportError> {
    let columns = ["kind", "competitors", "ratio", "kept"];
    let table = Records::read(files, "promise.csv", &columns)?.filled()?;
    let is_kept = |row: usize| match table.text(row, 3) {
        "yes" => Ok(true),
        "no" => Ok(false),
        _ => Err(table.bad(row, 3, "yes or no")),
    };
    let model = |(kind, rows): (&str, Vec<usize>)| -> Result<AutoModel, ReportError> {
        let mut model = AutoModel {
            kind: kind.to_owned(),
            scenes: rows.len(),
            successes: 0,
            with_rivals: 0,
            largest_ratio: None,
        };
        for row in rows {
            model.with_rivals += usize::from(table.number(row, 1)? > 0.0);
            model.successes += usize::from(is_kept(row)?);
            let ratio = table.number_or_none(row, 2)?;
            model.largest_ratio = model
                .largest_ratio
                .into_iter()
                .chain(ratio)
                .reduce(f64::max);
        }
        Ok(model)
    };
    table.by_text(0).into_iter().map(model).collect()
}
