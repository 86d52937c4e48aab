//! Finds the numeric field of a scene that changes the error of an estimate most.

use palpate_report::{AnswerChart, AnswerFigure, Figure, ReportError, answer_figure};
use palpate_scene::{Scene, Scenes, SharedModels, quantities_of};
use palpate_study::config::{ConfigError, Study, Takes};
use palpate_study::{Label, Quantity, Table, number};
use palpate_sweep::Runner;
use serde_json::{Value, json};

use crate::Answer;
use crate::distinguish::place_of;
use crate::error::AnswerError;

/// Number of trials in a block. All trials of a block run on the same thread.
const BLOCK: u64 = 32;
/// Lists in the config with more than this number of entries are skipped, because a designer does not choose each of
/// their numbers separately. The numbers in shorter lists are changed one by one.
const LONGEST_LIST: usize = 3;
/// An rms error counts as a rounding error if it is at most this share of the true value.
const ROUNDING: f64 = 1e-10;
const MAX_BARS: usize = 12;

/// Effect of the numeric fields of a scene on the rms error of a quantity.
#[derive(Clone, Debug, PartialEq)]
pub struct Sensitivity {
    /// The estimated quantity whose rms error is examined.
    pub quantity: Quantity,
    /// Unit of the estimated quantity, as in `cells.csv`.
    pub unit: &'static str,
    /// Number of trials for each value of a field.
    pub trials: u64,
    /// Rms error of the quantity with the values that the config states for all fields.
    pub rms_error: f64,
    /// Fields with their effects on the rms error. The field with the largest effect is first.
    pub effects: Vec<FieldEffect>,
    /// Paths of the fields whose effect cannot be measured, each with the reason.
    pub skipped: Vec<(String, String)>,
}

/// Effect of one field on the rms error.
#[derive(Clone, Debug, PartialEq)]
pub struct FieldEffect {
    /// Column of the field in tables: its path with its unit.
    pub column: String,
    /// Value of the field in the config.
    pub value: f64,
    /// The two compared values of the field: usually a smaller and a larger value than in the config.
    pub values: [f64; 2],
    /// Rms errors of the quantity for the two values of the field.
    pub rms_errors: [f64; 2],
    /// Change of the logarithm of the rms error between the two values of the field, divided by the change of the
    /// logarithm of the value. It is 1 if the rms error is proportional to the value.
    pub effect: f64,
    /// Standard error of `effect`.
    pub effect_std: f64,
    /// Number of trials that failed at one or both of the two values. These trials are ignored at both values.
    pub failures: u64,
}

/// Squared error of the quantity in each trial, for one value of a field; `None` if the trial failed. If a trial
/// estimates the quantity at several points of a patch, the squared error is averaged over these points.
type SquaredErrors = Vec<Option<f64>>;

/// Finds the numeric field of the study's scene that changes the rms error of a quantity most.
///
/// Only one field is changed at a time, once upwards and once downwards by the relative `step`; whole numbers change by
/// at least 1. If only one direction is possible, the changed value is compared with the value in the config. Trials
/// with the same number draw the same random numbers for every value. Most of the noise therefore cancels in the
/// comparison, and a few trials suffice to measure small effects. If the study sweeps fields, each swept field has its
/// first value.
///
/// If `quantity` is `None`, the curvature of the object is used: `object_curvature` for a press, otherwise
/// `mean_curvature`.
///
/// ```
/// use palpate_answers::sensitivity;
/// use palpate_study::config::parse;
/// use palpate_sweep::{RunOptions, Runner};
///
/// let text = r#"
/// name = "a-ball"
/// length_unit = "mm"
/// [scene]
/// kind = "roll"
/// probe = { kind = "sphere", radius = 10.0 }
/// object = { kind = "sphere", radius = 30.0 }
/// motion = { arc_length = 4.0 }
/// sensor = { kind = "wrist", std = 0.01 }
/// "#;
/// let study = parse("a-ball.toml", text)?;
/// let runner = Runner::new(&RunOptions::default())?;
/// let found = sensitivity(&study, None, 500, 0.05, &runner, &|_, _| ())?;
/// // The error is proportional to the noise of the sensor.
/// let noise = found.effects.iter().find(|one| one.column == "scene.sensor.std_mm");
/// assert!(noise.is_some_and(|noise| (noise.effect - 1.0).abs() < 0.01));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`AnswerError`].
pub fn sensitivity(
    study: &Study,
    quantity: Option<&str>,
    trials: u64,
    step: f64,
    runner: &Runner,
    progress: &dyn Fn(usize, usize),
) -> Result<Sensitivity, AnswerError> {
    let expected = "above 0 and at most 0.5";
    AnswerError::unless(step > 0.0 && step <= 0.5, "step", step, expected)?;
    AnswerError::unless(trials > 0, "trials", 0.0, "at least 1")?;
    let scene = study.cell(0)?.config.scene;
    let (_, quantity) = place_of(quantities_of(&scene), scene.kind(), quantity)?;
    let models = SharedModels::default();
    let runs = ErrorRuns {
        study,
        quantity,
        trials,
        runner,
        models: &models,
    };
    let base = runs.at(&[])?;
    let rms_error = base.1.iter().flatten().sum::<f64>() / base.1.iter().flatten().count() as f64;
    let mut found = Sensitivity {
        quantity,
        unit: quantity.unit.of(study.config.length_unit),
        trials: base.1.len() as u64,
        rms_error: rms_error.sqrt(),
        effects: Vec::new(),
        skipped: Vec::new(),
    };
    if !rms_error.is_finite() {
        return Err(AnswerError::NoError(
            "every trial fails, or no trial has a value of the quantity",
        ));
    }
    if found.rms_error <= ROUNDING * base.0 {
        return Err(AnswerError::NoError(
            "the estimate is exact except for rounding errors",
        ));
    }
    let scene = serde_json::to_value(&scene).unwrap_or_default();
    let mut fields = Vec::new();
    numbers(&scene, "scene", &mut fields);
    for (done, (path, value)) in fields.iter().enumerate() {
        progress(done, fields.len());
        match runs.effect(path, *value, step, &base.1) {
            Ok(effect) => found.effects.push(effect),
            Err(why) => found.skipped.push((path.clone(), why)),
        }
    }
    let size = |one: &FieldEffect| one.effect.abs();
    found
        .effects
        .sort_by(|one, other| size(other).total_cmp(&size(one)));
    Ok(found)
}

/// Collects the path and the value of each numeric field in a table and its subtables.
fn numbers(node: &Value, path: &str, fields: &mut Vec<(String, f64)>) {
    let mut child = |key: &str, node: &Value| numbers(node, &format!("{path}.{key}"), fields);
    match node {
        Value::Object(table) => table.iter().for_each(|(key, node)| child(key, node)),
        Value::Array(items) if items.len() <= LONGEST_LIST => {
            let items = items.iter().enumerate();
            items.for_each(|(place, node)| child(&place.to_string(), node));
        }
        Value::Number(number) => {
            fields.extend(number.as_f64().map(|value| (path.to_owned(), value)))
        }
        _ => {}
    }
}

struct ErrorRuns<'a> {
    study: &'a Study,
    quantity: Quantity,
    trials: u64,
    runner: &'a Runner,
    models: &'a SharedModels,
}

impl ErrorRuns<'_> {
    /// Sets some fields of the config to the values in `fields`, and runs the trials. Returns the root mean square of
    /// the true values, and the squared error of the quantity in each trial.
    fn at(
        &self,
        fields: &[(String, Vec<toml::Value>)],
    ) -> Result<(f64, SquaredErrors), ConfigError> {
        let varied;
        let study = match fields.is_empty() {
            true => self.study,
            false => {
                varied = self.study.varied(fields)?;
                &varied
            }
        };
        let scene = study.estimable_scene_of(0, &study.cell(0)?, self.models)?;
        let place = scene
            .quantities()
            .iter()
            .position(|one| *one == self.quantity)
            .unwrap_or_default();
        let trials = scene.trials(self.trials);
        let blocks = self.runner.map(trials.div_ceil(BLOCK) as usize, |block| {
            let first = block as u64 * BLOCK;
            let numbers = first..(first + BLOCK).min(trials);
            numbers
                .map(|trial| squares(&scene, trial, place))
                .collect::<Vec<_>>()
        });
        let all: Vec<_> = blocks.into_iter().flatten().collect();
        let truths = all.iter().flatten().map(|(_, truth)| truth);
        let truth = truths.clone().sum::<f64>() / truths.count().max(1) as f64;
        let errors = all.iter().map(|one| one.map(|(error, _)| error)).collect();
        Ok((truth.sqrt(), errors))
    }

    /// Effect of the field at `path` on the rms error. `value` is the value of this field in the config. The error
    /// states why the effect cannot be measured.
    fn effect(
        &self,
        path: &str,
        value: f64,
        step: f64,
        base: &SquaredErrors,
    ) -> Result<FieldEffect, String> {
        if value == 0.0 {
            return Err("it is 0, so it has no relative change".to_owned());
        }
        let is_whole = self.study.takes(path) == Some(Takes::Whole);
        let step = match is_whole {
            true => (step * value.abs()).round().max(1.0),
            false => step * value.abs(),
        };
        let fixed = |value: f64| {
            let value = match is_whole {
                true => toml::Value::Integer(value as i64),
                false => toml::Value::Float(value),
            };
            [(path.to_owned(), vec![value])]
        };
        let column = self
            .study
            .varied(&fixed(value))
            .map_err(|error| error.message)?;
        let column = column.columns.last().cloned().unwrap_or_default();
        let mut why = String::new();
        let mut end = |value: f64| {
            let run = self.at(&fixed(value));
            run.map_err(|error| why = error.message).ok()
        };
        // The effect is a change per relative change of the value, so no end may be 0.
        let ends = [value - step, value + step]
            .map(|value| Some((value, end(value).filter(|_| value != 0.0)?.1)));
        let [low, high] = match ends {
            [None, None] => return Err(why),
            [low, high] => [low, high].map(|end| end.unwrap_or_else(|| (value, base.clone()))),
        };
        let pairs = low.1.iter().zip(&high.1);
        let pairs: Vec<[f64; 2]> = pairs
            .filter_map(|(one, other)| Some([(*one)?, (*other)?]))
            .collect();
        let count = pairs.len() as f64;
        let means = [0, 1].map(|end| pairs.iter().map(|pair| pair[end]).sum::<f64>() / count);
        let change = libm::log(high.0 / low.0);
        let effect = 0.5 * libm::log(means[1] / means[0]) / change;
        if !effect.is_finite() {
            return Err("no trial succeeds at both values, or one value has no error".to_owned());
        }
        // Trials with the same number draw the same random numbers at both values, so the two mean squared errors are
        // correlated. Therefore, compute the standard error of the effect from pairs of such trials.
        let influences = pairs
            .iter()
            .map(|pair| 0.5 * (pair[1] / means[1] - pair[0] / means[0]));
        let squares: f64 = influences.map(|influence| influence * influence).sum();
        let variance = squares / (count * (count - 1.0).max(1.0));
        Ok(FieldEffect {
            column,
            value,
            values: [low.0, high.0],
            rms_errors: means.map(f64::sqrt),
            effect,
            effect_std: variance.sqrt() / change.abs(),
            failures: (low.1.len().min(high.1.len()) - pairs.len()) as u64,
        })
    }
}

/// Squared error and squared true value of the quantity in a trial; `None` if the trial failed. If the trial estimates
/// the quantity at several points, both squares are averaged over these points.
fn squares(scene: &Scene, trial: u64, place: usize) -> Option<(f64, f64)> {
    let (mut errors, mut truths, mut count) = (0.0, 0.0, 0.0);
    let run = scene.trial(trial, |quantity, observed| {
        if quantity == place {
            errors += (observed.estimate - observed.truth).powi(2);
            truths += observed.truth * observed.truth;
            count += 1.0;
        }
    });
    let is_finite = f64::is_finite(errors + truths) && count > 0.0;
    (run.is_ok() && is_finite).then(|| (errors / count, truths / count))
}

impl Answer for Sensitivity {
    /// Table with one row per field. The field with the largest effect comes first.
    fn table(&self) -> Table {
        let columns = "field value low high rms_error_low rms_error_high effect effect_std failures trials quantity unit";
        let mut table = Table::new(columns.split(' ').map(str::to_owned));
        table.rows.extend(self.effects.iter().map(|one| {
            let ([low, high], [low_error, high_error]) = (one.values, one.rms_errors);
            let of_errors = [low_error, high_error, one.effect, one.effect_std];
            let values = [one.value, low, high].into_iter().chain(of_errors);
            let counts = [one.failures, self.trials].map(|count| count.to_string());
            let words = [self.quantity.name, self.unit].map(str::to_owned);
            let values = [one.column.clone()]
                .into_iter()
                .chain(values.map(number::shortest));
            values.chain(counts).chain(words).collect()
        }));
        table
    }

    /// Lines for a terminal: the rms error, one line per field, and the fields whose effect cannot be measured.
    fn lines(&self) -> Vec<String> {
        let size = number::significant(self.rms_error, 3);
        let mut lines = vec![
            format!(
                "rms error of {}: {size} {} in {} trials",
                self.quantity.words,
                self.unit,
                number::grouped(self.trials)
            ),
            "1 % more of a field changes this error by (with its standard error):".to_owned(),
        ];
        let widest = self.effects.iter().map(|one| one.column.len()).max();
        for one in &self.effects {
            let [low, high] = one.values.map(|value| number::significant(value, 4));
            let failures = match one.failures {
                0 => String::new(),
                count => format!("; {} trials failed", number::grouped(count)),
            };
            lines.push(format!(
                "  {:width$}  {:+.3} % ± {:.3}  (from {low} to {high}{failures})",
                one.column,
                one.effect,
                one.effect_std,
                width = widest.unwrap_or(0)
            ));
        }
        let skipped = self.skipped.iter();
        lines.extend(skipped.map(|(path, why)| format!("not measured: {path}: {why}")));
        lines
    }

    /// The effects of all config fields on the rms error, as JSON.
    fn to_json(&self, study: &Study) -> Value {
        let effects = self.effects.iter().map(|one| {
            json!({
                "field": one.column,
                "value": one.value,
                "values": one.values,
                "rms_errors": one.rms_errors,
                "effect": one.effect,
                "effect_std": one.effect_std,
                "failures": one.failures,
            })
        });
        let skipped = self.skipped.iter();
        json!({
            "format_version": 1,
            "study": study.config.name,
            "quantity": self.quantity.name,
            "unit": self.unit,
            "trials": self.trials,
            "rms_error": self.rms_error,
            "effects": effects.collect::<Value>(),
            "skipped": skipped.map(|(path, why)| json!({ "field": path, "why": why })).collect::<Value>(),
        })
    }

    /// Bar chart of the largest effects on the rms error. `name` is the name of the chart's files.
    fn figure(&self, name: &str, title: &str) -> Result<Figure, ReportError> {
        let bars = self.effects.iter().take(MAX_BARS).map(|one| {
            let words = Label::of_field(&one.column).words;
            (words, one.effect, one.effect_std)
        });
        answer_figure(&AnswerFigure {
            name: name.to_owned(),
            title: title.to_owned(),
            subtitle: format!(
                "Change of the rms error of the {} if a field is 1 % larger; {} trials of each value.",
                self.quantity.words,
                number::grouped(self.trials)
            ),
            chart: AnswerChart::Bars {
                axis: "change of the error per 1 % of the field (%)".to_owned(),
                bars: bars.collect(),
            },
            notes: vec!["Lines: 95 % intervals of the Monte Carlo error.".to_owned()],
        })
    }
}
