//! Defines the arguments of `palpate design`, `palpate distinguish` and `palpate sensitivity`.

use std::num::{NonZeroU64, NonZeroUsize};
use std::path::PathBuf;
use std::time::Duration;

use clap::Args;
use palpate::Target;
use palpate::config::{Varied, Vary};

use crate::duration;

/// Arguments that `palpate design`, `palpate distinguish` and `palpate sensitivity` share.
#[derive(Debug, Args)]
pub(crate) struct AnswerArgs {
    /// The study's config, a TOML file.
    pub(crate) config: PathBuf,
    /// Set a field to one value, which replaces its value or its sweep in the config: scene.object.radius=42, or
    /// radius=4.2cm if only one field has this name.
    #[arg(long = "set", value_name = "PATH=VALUE", value_parser = set)]
    pub(crate) set: Vec<(String, toml::Value)>,
    /// Use this seed instead of the seed in the config.
    #[arg(long, value_name = "S")]
    pub(crate) seed: Option<u64>,
    /// Use this many threads instead of all cores.
    #[arg(long, value_name = "N")]
    pub(crate) threads: Option<NonZeroUsize>,
    /// Also write the tables, a figure and the text of the answer into this directory.
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
    /// Print the answer as JSON.
    #[arg(long)]
    pub(crate) json: bool,
    /// Also overwrite files that palpate did not write, files that were edited after palpate wrote them, and input
    /// files of this command.
    #[arg(long)]
    pub(crate) force: bool,
}

#[derive(Debug, Args)]
pub(crate) struct DesignArgs {
    #[command(flatten)]
    pub(crate) answer: AnswerArgs,
    /// Target to meet: STATISTIC(QUANTITY) <= LIMIT, or >= LIMIT, with the names in cells.csv; the limit may be in
    /// percent. Without a quantity, the first quantity of the scene is used.
    #[arg(long, value_name = "TARGET")]
    pub(crate) target: Target,
    /// Field to vary, with its values: scene.sensor.pitch=0.05..2 or scene.sensor.normal_from=hue,both. A range is
    /// divided by equal ratios if both ends are positive and far apart, otherwise by equal differences. If several
    /// fields vary, the answer contains the combinations of their values that meet the target.
    #[arg(long, value_name = "PATH=VALUES", required = true)]
    pub(crate) vary: Vec<Vary>,
    /// Find the largest value of this varied field at which the target can be met. The other varied fields may have any
    /// of their values.
    #[arg(long, value_name = "PATH", conflicts_with = "minimise")]
    pub(crate) maximise: Option<String>,
    /// Find the smallest value of this varied field at which the target can be met. The other varied fields may have
    /// any of their values.
    #[arg(long, value_name = "PATH")]
    pub(crate) minimise: Option<String>,
    /// Largest share of the trials that may fail; 1 allows any number of failures.
    #[arg(
        long,
        value_name = "SHARE",
        default_value = "0.05",
        allow_negative_numbers = true
    )]
    pub(crate) max_failures: f64,
    /// Accuracy of the answer: largest gap between a value that meets the target and the next value that misses it. The
    /// gap is relative to the value if the range is divided by ratios, otherwise relative to half the width of the
    /// range.
    #[arg(
        long,
        value_name = "SHARE",
        default_value = "0.05",
        allow_negative_numbers = true
    )]
    pub(crate) gap: f64,
    /// Largest number of trials that each cell may run for one tried value of the varied fields.
    #[arg(long, value_name = "N", default_value = "4194304")]
    pub(crate) most_trials: NonZeroU64,
    /// Time after which the search tries no further values: 30s, 5m, 1.5h, or a plain number of seconds. The first
    /// values are always tried, and the answer is always verified.
    #[arg(long, value_name = "DURATION", value_parser = duration::parse, allow_hyphen_values = true, default_value = "60s")]
    pub(crate) budget: Duration,
}

#[derive(Debug, Args)]
pub(crate) struct DistinguishArgs {
    #[command(flatten)]
    pub(crate) answer: AnswerArgs,
    /// Quantity whose estimates put the objects in order [default: object_curvature of a press, otherwise
    /// mean_curvature].
    #[arg(long, value_name = "NAME")]
    pub(crate) quantity: Option<String>,
    /// Required probability of the right order if the estimates of several trials are averaged.
    #[arg(
        long,
        value_name = "SHARE",
        default_value = "0.95",
        allow_negative_numbers = true
    )]
    pub(crate) confidence: f64,
    /// Field of the object with the values to compare: scene.object.radius=20,25,30. It replaces the field's value in
    /// the config.
    #[arg(long, value_name = "PATH=VALUES", value_parser = list)]
    pub(crate) vary: Vec<(String, Vec<toml::Value>)>,
    /// Run this many trials of each object, instead of the number in the config.
    #[arg(long, value_name = "N")]
    pub(crate) trials: Option<NonZeroU64>,
}

#[derive(Debug, Args)]
pub(crate) struct SensitivityArgs {
    #[command(flatten)]
    pub(crate) answer: AnswerArgs,
    /// Quantity whose rms error is compared [default: object_curvature of a press, else mean_curvature].
    #[arg(long, value_name = "NAME")]
    pub(crate) quantity: Option<String>,
    /// Share by which each field is increased and decreased; whole numbers change by at least 1.
    #[arg(
        long,
        value_name = "SHARE",
        default_value = "0.05",
        allow_negative_numbers = true
    )]
    pub(crate) step: f64,
    /// Number of trials at each value of a changed field.
    #[arg(long, value_name = "N", default_value = "1000")]
    pub(crate) trials: NonZeroU64,
}

fn list(text: &str) -> Result<(String, Vec<toml::Value>), String> {
    match text
        .parse()
        .map_err(|error: palpate::config::VaryError| error.to_string())?
    {
        Vary {
            path,
            values: Varied::Listed(values),
        } => Ok((path, values)),
        Vary { path, .. } => Err(format!(
            "`distinguish` compares single objects: list the values of {path}"
        )),
    }
}

fn set(text: &str) -> Result<(String, toml::Value), String> {
    let Vary { path, values } = text
        .parse()
        .map_err(|_| format!("{text:?} is not of the form PATH=VALUE"))?;
    match values {
        Varied::Listed(values) => match <[toml::Value; 1]>::try_from(values) {
            Ok([value]) => Ok((path, value)),
            Err(values) => Err(format!(
                "--set sets {path} to a single value, but there are {}",
                values.len()
            )),
        },
        Varied::Range { .. } => Err(format!(
            "--set sets {path} to a single value, but this is a range; use --vary for a range"
        )),
    }
}
