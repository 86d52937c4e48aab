//! Measurements of speed against accuracy: `ladders.csv`, `rungs.csv`, `answers.csv` and `stages.csv` of one folder,
//! and `promise.csv`, the verdicts on `auto`, which may be absent.

mod promise;

pub(crate) use promise::Promise;

use crate::ReportError;
use crate::records::Columns;
use crate::table::finite;
use std::path::Path;

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
    /// Instructions where they are counted, else the median of nanoseconds.
    pub(crate) cost: f64,
    /// Whether no other rung is both as exact and as cheap (Pareto front).
    pub(crate) on_front: bool,
}

/// Which rung to take for a target.
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
    pub(crate) fn read(dir: &Path) -> Result<Self, ReportError> {
        let judged = Some(dir.join("promise.csv")).filter(|path| path.exists());
        let promises = judged.map_or(Ok(Vec::new()), |path| promise::read(&path))?;
        let (rungs, counted) = rungs(&dir.join("rungs.csv"))?;
        let answers = answers(&dir.join("answers.csv"))?;
        let of = |ladder: &str, ease: &str| {
            let mine = move |key: &(String, String)| key.0 == ladder && key.1 == ease;
            (
                rungs
                    .iter()
                    .filter(|one| mine(&one.0))
                    .map(|one| one.1.clone())
                    .collect(),
                answers
                    .iter()
                    .filter(|one| mine(&one.0))
                    .map(|one| one.1.clone())
                    .collect(),
            )
        };
        let names = [
            "ladder",
            "title",
            "error_of",
            "evaluation",
            "scene",
            "what",
            "machine",
        ];
        let table = Columns::read(&dir.join("ladders.csv"), &names)?;
        let mut ladders: Vec<Ladder> = Vec::new();
        for row in 0..table.rows() {
            let [name, title, error_of, evaluation, ease, what] =
                [0, 1, 2, 3, 4, 5].map(|column| table.text(row, column).to_owned());
            let (rungs, answers) = of(&name, &ease);
            let scene = LadderScene {
                ease,
                what,
                rungs,
                answers,
            };
            match ladders.iter_mut().find(|ladder| ladder.name == name) {
                Some(ladder) => ladder.scenes.push(scene),
                None => ladders.push(Ladder {
                    name,
                    title,
                    error_of,
                    evaluation,
                    scenes: vec![scene],
                }),
            }
        }
        let machine = match table.rows() {
            0 => String::new(),
            _ => table.text(0, 6).to_owned(),
        };
        Ok(Self {
            ladders,
            promises,
            counted,
            machine,
        })
    }

    /// Unit of the costs.
    pub(crate) const fn unit(&self) -> &'static str {
        if self.counted { "instructions" } else { "ns" }
    }
}

/// Ladder and scene.
type Key = (String, String);

fn rungs(path: &Path) -> Result<(Vec<(Key, Rung)>, bool), ReportError> {
    let names = [
        "ladder",
        "scene",
        "rung",
        "error",
        "median_ns",
        "instructions",
        "pareto",
    ];
    let table = Columns::read(path, &names)?;
    let counted = (0..table.rows()).all(|row| !table.text(row, 5).is_empty());
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
            cost: positive(row, if counted { 5 } else { 4 })?,
            on_front: table.text(row, 6) == "true",
        };
        Ok((key, rung))
    };
    let rungs = (0..table.rows())
        .map(rung)
        .collect::<Result<_, ReportError>>()?;
    Ok((rungs, counted))
}

fn answers(path: &Path) -> Result<Vec<(Key, Answer)>, ReportError> {
    let names = [
        "ladder",
        "scene",
        "target",
        "rung",
        "error",
        "median_ns",
        "instructions",
    ];
    let table = Columns::read(path, &names)?;
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
