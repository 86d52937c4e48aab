//! Arguments of the commands that answer questions.

use std::num::{NonZeroU64, NonZeroUsize};
use std::path::PathBuf;
use std::time::Duration;

use clap::Args;
use palpate::Target;
use palpate::config::{Varied, Vary};

use crate::duration;

/// Arguments of every command that answers a question.
#[derive(Debug, Args)]
pub(crate) struct AnswerArgs {
    /// The study's config, a TOML file.
    pub(crate) config: PathBuf,
    /// Field that gets one value, in place of what the config and its sweeps say of it: scene.object.radius=42,
    /// or radius=4.2cm if only one field has this name.
    #[arg(long = "set", value_name = "PATH=VALUE", value_parser = set)]
    pub(crate) set: Vec<(String, toml::Value)>,
    /// Use this seed instead of the config's.
    #[arg(long, value_name = "S")]
    pub(crate) seed: Option<u64>,
    /// Use this many threads instead of all cores.
    #[arg(long, value_name = "N")]
    pub(crate) threads: Option<NonZeroUsize>,
    /// Also write the tables behind the answer, a figure and the answer into this directory.
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
    /// Print the answer as JSON.
    #[arg(long)]
    pub(crate) json: bool,
    /// Replace also files that palpate did not write, that were changed since, or that are read.
    #[arg(long)]
    pub(crate) force: bool,
}

#[derive(Debug, Args)]
pub(crate) struct DesignArgs {
    #[command(flatten)]
    pub(crate) answer: AnswerArgs,
    /// Target to meet: STATISTIC(QUANTITY) <= LIMIT, or >= LIMIT, with the names of cells.csv; the limit may
    /// be in percent. Without a quantity the first of the scene is meant.
    #[arg(long, value_name = "TARGET")]
    pub(crate) target: Target,
    /// The field that is varied, and its values: scene.sensor.pitch=0.05..2 or scene.sensor.normal_from=hue,both.
    /// Ranges are spaced by ratios where both ends are positive and far apart, else by differences.
    /// Several fields give the region in which they meet the target together.
    #[arg(long, value_name = "PATH=VALUES", required = true)]
    pub(crate) vary: Vec<Vary>,
    /// Varied field whose largest value that meets the target is asked for, whatever the others.
    #[arg(long, value_name = "PATH", conflicts_with = "minimise")]
    pub(crate) maximise: Option<String>,
    /// Varied field whose smallest value that meets the target is asked for, whatever the others.
    #[arg(long, value_name = "PATH")]
    pub(crate) minimise: Option<String>,
    /// Largest share of the trials that may fail; 1: however many.
    #[arg(
        long,
        value_name = "SHARE",
        default_value = "0.05",
        allow_negative_numbers = true
    )]
    pub(crate) max_failures: f64,
    /// Largest gap that is to stay between what meets the target and what misses it: a share of the value where
    /// ratios count, else of half the range.
    #[arg(
        long,
        value_name = "SHARE",
        default_value = "0.05",
        allow_negative_numbers = true
    )]
    pub(crate) gap: f64,
    /// Most trials of a cell at one value.
    #[arg(long, value_name = "N", default_value = "4194304")]
    pub(crate) most_trials: NonZeroU64,
    /// Time after which nothing more is explored: 30s, 5m, 1.5h, or a plain number of seconds. The scan and the
    /// verification are always done.
    #[arg(long, value_name = "DURATION", value_parser = duration::parse, allow_hyphen_values = true, default_value = "60s")]
    pub(crate) budget: Duration,
}

#[derive(Debug, Args)]
pub(crate) struct DistinguishArgs {
    #[command(flatten)]
    pub(crate) answer: AnswerArgs,
    /// Quantity by which objects are told apart [default: object_curvature of a press, else mean_curvature].
    #[arg(long, value_name = "NAME")]
    pub(crate) quantity: Option<String>,
    /// Probability that the mean of several trials is to reach.
    #[arg(
        long,
        value_name = "SHARE",
        default_value = "0.95",
        allow_negative_numbers = true
    )]
    pub(crate) confidence: f64,
    /// Field of the object with its values, in place of what the config says of it: scene.object.radius=20,25,30.
    #[arg(long, value_name = "PATH=VALUES", value_parser = list)]
    pub(crate) vary: Vec<(String, Vec<toml::Value>)>,
    /// Run this many trials of each object instead of the config's.
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
    /// Relative change of each field in both directions; whole numbers change by at least 1.
    #[arg(
        long,
        value_name = "SHARE",
        default_value = "0.05",
        allow_negative_numbers = true
    )]
    pub(crate) step: f64,
    /// Number of trials at each value.
    #[arg(long, value_name = "N", default_value = "1000")]
    pub(crate) trials: NonZeroU64,
}

/// Reads a field with listed values.
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
            "objects are told apart one by one: list the values of {path}"
        )),
    }
}

/// Reads a field with one value.
fn set(text: &str) -> Result<(String, toml::Value), String> {
    let Vary { path, values } = text
        .parse()
        .map_err(|_| format!("{text:?} is no PATH=VALUE"))?;
    match values {
        Varied::Listed(values) => match <[toml::Value; 1]>::try_from(values) {
            Ok([value]) => Ok((path, value)),
            Err(values) => Err(format!(
                "{path} is set to one value, and here are {}",
                values.len()
            )),
        },
        Varied::Range { .. } => Err(format!(
            "{path} is set to one value, and this is a range; --vary takes one"
        )),
    }
}
