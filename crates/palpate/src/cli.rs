//! The arguments of the commands.

use std::num::{NonZeroU64, NonZeroUsize};
use std::path::PathBuf;

use clap::{Args, Parser, Subcommand, ValueEnum};
use palpate_scene::config::LengthUnit;

/// Simulate a fingertip exploring a surface, model what its sensors really deliver, and estimate
/// the surface's curvature from that.
#[derive(Debug, Parser)]
#[command(name = "palpate", version, about, max_term_width = 100)]
#[command(after_help = "Example:
  palpate check my.toml && palpate run my.toml && palpate report out/my-study")]
pub(crate) struct Cli {
    #[command(subcommand)]
    pub(crate) command: Command,
}

#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Run a study: all cells of a config, all trials; writes cells.csv, failures.csv and run.toml.
    #[command(after_help = "Examples:
  palpate run sim-configs/ep1-angular-velocity-error.toml
  palpate run my.toml --trials 200 --out out/quick-look")]
    Run(RunArgs),
    /// Follow one pass of a scene: writes trace.csv (truth) and readings.csv (what `estimate` accepts).
    #[command(after_help = "Examples:
  palpate trace my.toml --out out/trace
  palpate trace my.toml --out out/trace --cell 3 --trial 17")]
    Trace(TraceArgs),
    /// Estimate curvature from recorded readings; prints JSON.
    #[command(subcommand)]
    #[command(after_help = "Example:
  palpate estimate roll examples/roll-readings.csv --probe-radius 10 --pitch 0.5")]
    Estimate(Estimator),
    /// Validate a config; prints cells, trials, the models that it needs and an estimate of the time.
    #[command(after_help = "Example:
  palpate check sim-configs/ep1-roll-length.toml")]
    Check(CheckArgs),
    /// Draw the plots of a study's results, as SVG and PNG beside its tables.
    #[command(after_help = "Example:
  palpate plot out/my-study")]
    Plot(PlotArgs),
    /// Score the papers' claims on the results of studies and write a self-contained page.
    #[command(after_help = "Example:
  palpate report results/ep1-roll-length results/ep1-pad-resolution --out report.html")]
    Report(ReportArgs),
    /// Print the JSON Schema of configs, for editors.
    #[command(after_help = "Example:
  palpate schema > palpate.schema.json")]
    Schema,
}

#[derive(Debug, Args)]
pub(crate) struct RunArgs {
    /// The study's config, a TOML file.
    pub(crate) config: PathBuf,
    /// Where to write the results [default: out/ and the name of the study].
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
    /// Use this seed instead of the config's.
    #[arg(long, value_name = "S")]
    pub(crate) seed: Option<u64>,
    /// Run this many trials per cell instead of the config's.
    #[arg(long, value_name = "N")]
    pub(crate) trials: Option<NonZeroU64>,
    /// Use this many threads instead of all cores; results do not depend on it.
    #[arg(long, value_name = "N")]
    pub(crate) threads: Option<NonZeroUsize>,
    /// Run only every N-th cell, from the first; the rows keep their cell numbers.
    #[arg(long, value_name = "N", default_value = "1")]
    pub(crate) every_nth_cell: NonZeroUsize,
}

#[derive(Debug, Args)]
pub(crate) struct TraceArgs {
    /// The study's config, a TOML file.
    pub(crate) config: PathBuf,
    /// Where to write the tables.
    #[arg(long, value_name = "DIR")]
    pub(crate) out: PathBuf,
    /// Which cell, counted from 0.
    #[arg(long, value_name = "I", default_value_t = 0)]
    pub(crate) cell: usize,
    /// Replay this trial, with its noise; without it the pass is noiseless.
    #[arg(long, value_name = "J")]
    pub(crate) trial: Option<u64>,
}

#[derive(Debug, Subcommand)]
pub(crate) enum Estimator {
    /// Curvature at a point from small rolls (EP1).
    #[command(after_help = "The readings have one row per probe,
  probe,rotation_x_rad,rotation_y_rad,shift_u_mm,shift_v_mm
or a time series per probe, whose last row counts,
  probe,t_s,rotation_x_rad,rotation_y_rad,pad_u_mm,pad_v_mm
with rotations summed in the probe's contact frame (z out of the probe; a contact moving to +u has
rotation_y < 0) and shifts as great-circle displacements on the probe from its first contact.

Example:
  palpate estimate roll examples/roll-readings.csv --probe-radius 10 --pitch 0.5")]
    Roll(EstimateRollArgs),
}

#[derive(Debug, Args)]
pub(crate) struct EstimateRollArgs {
    /// The recorded readings, a CSV file.
    pub(crate) readings: PathBuf,
    /// The probe's radius, in the readings' length unit.
    #[arg(long, value_name = "R", value_parser = positive, allow_negative_numbers = true)]
    pub(crate) probe_radius: f64,
    /// The estimator.
    #[arg(long, default_value = "least-squares")]
    pub(crate) method: Method,
    /// Pitch of the pads, in the readings' length unit: gives standard deviations, and bounds where
    /// the contact did not move.
    #[arg(long, value_name = "P", value_parser = positive, allow_negative_numbers = true)]
    pub(crate) pitch: Option<f64>,
    /// The unit of lengths, if the header does not state it (shift_u_mm).
    #[arg(long, value_name = "UNIT", value_parser = length_unit)]
    pub(crate) length_unit: Option<LengthUnit>,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
pub(crate) enum Method {
    /// The least squares of the 1996 paper.
    LeastSquares,
}

#[derive(Debug, Args)]
pub(crate) struct CheckArgs {
    /// The study's config, a TOML file.
    pub(crate) config: PathBuf,
}

#[derive(Debug, Args)]
pub(crate) struct PlotArgs {
    /// A directory that `palpate run` wrote.
    pub(crate) dir: PathBuf,
}

#[derive(Debug, Args)]
pub(crate) struct ReportArgs {
    /// Directories that `palpate run` wrote.
    #[arg(required = true)]
    pub(crate) dirs: Vec<PathBuf>,
    /// The page to write.
    #[arg(long, value_name = "FILE", default_value = "report.html")]
    pub(crate) out: PathBuf,
}

fn positive(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(number) if number > 0.0 && number.is_finite() => Ok(number),
        Ok(number) => Err(format!("must be finite and > 0, is {number}")),
        Err(_) => Err("is not a number".to_owned()),
    }
}

fn length_unit(text: &str) -> Result<LengthUnit, String> {
    use LengthUnit::{Cm, M, Mm, Um, Unit};
    [M, Cm, Mm, Um, Unit]
        .into_iter()
        .find(|unit| unit.as_str() == text)
        .ok_or_else(|| "must be one of m, cm, mm, um, unit".to_owned())
}
