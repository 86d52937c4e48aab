//! The arguments of the commands.

mod answers;
mod estimate_args;
mod form;
mod number;
mod sensor_args;
mod settings;

use std::num::{NonZeroU64, NonZeroUsize};
use std::path::PathBuf;
use std::time::Duration;

use clap::{Args, Parser, Subcommand, ValueEnum};

use palpate::Shard;

use crate::duration;
use crate::output::Format;

pub(crate) use answers::{AnswerArgs, DesignArgs, DistinguishArgs, SensitivityArgs};
pub(crate) use estimate_args::{
    EstimateForceArgs, EstimateGlideArgs, EstimatePressArgs, EstimateRollArgs, Estimator, LikeArgs,
};
pub(crate) use form::FormArgs;
pub(crate) use sensor_args::{CalibrateArgs, PatternArgs, SensorCommand, TrackArgs};

/// Simulate a fingertip exploring a surface, model what its sensors really deliver, and estimate
/// the surface's curvature from that.
#[derive(Debug, Parser)]
#[command(name = "palpate", version, about, max_term_width = 100)]
#[command(after_help = "Example:
  palpate check my.toml && palpate run my.toml && palpate report out/my-study")]
pub(crate) struct Cli {
    #[command(subcommand)]
    pub(crate) command: Command,
    /// How an error is told on standard error: json is one line with kind (usage, work, stopped), status,
    /// message and, where they are known, file, line and field.
    #[arg(
        long,
        global = true,
        value_enum,
        value_name = "FORMAT",
        default_value = "text"
    )]
    pub(crate) error_format: ErrorFormat,
}

/// Form of an error.
#[derive(Clone, Copy, Debug, ValueEnum)]
pub(crate) enum ErrorFormat {
    /// A line for people.
    Text,
    /// A line of JSON for programs.
    Json,
}

#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Run a study: all cells of a config, all trials; writes cells.csv, failures.csv and run.toml.
    #[command(after_help = "Examples:
  palpate run sim-configs/ep1-angular-velocity-error.toml
  palpate run my.toml --trials 200 --out out/quick-look
  palpate run my.toml --budget 30s
  palpate run my.toml --target-error 0.01
  palpate run my.toml --target-error 0.001 --budget 1.5h
  palpate run my.toml --shard 3/16 --out out/shards/3

A budget or a target error becomes a number of trials and, where all cells take the same, a rung of the
model. They are written to run.toml before the first trial: `palpate run` of that file needs neither a
clock nor a pilot, and gives the same bytes.

A run that is interrupted, however it was, goes on with the same command: journal.palpate has what is done
of it, and the tables are those of an undisturbed run. Another config is refused there, with the
difference; --restart drops the journal. A shard leaves its journal, which `palpate merge` reads. Where the directory has tables of another
config, they and their run.toml stay until the run is done; meanwhile its config is next-run.toml.
What palpate wrote there of another study is removed; what it did not write, or what was changed since,
is not replaced without --force. Warnings are in warnings.txt and warnings.json. A run in which every trial
fails has status 1.")]
    Run(RunArgs),
    /// Put the shards of a run together: writes what one run of all would have written, to the byte.
    #[command(after_help = "Examples:
  palpate run my.toml --shard 1/2 --out out/a && palpate run my.toml --shard 2/2 --out out/b
  palpate merge out/a out/b --out out/my-study

A shard that is missing, has not ended, is damaged, or is of another config, seed or version of palpate
is named, and nothing is written. The shards stay; merging again gives the same.")]
    Merge(MergeArgs),
    /// Tell how far a run or its shards have come: done, running, failed, missing, rate and time left.
    #[command(after_help = "Example:
  palpate status out/my-study")]
    Status(StatusArgs),
    /// Give the shards of a run to a cluster.
    #[command(subcommand)]
    Submit(Scheduler),
    /// Follow one pass of a scene: writes trace.csv (truth) and readings.csv (what `estimate` accepts).
    #[command(after_help = "Examples:
  palpate trace my.toml --out out/trace
  palpate trace my.toml --out out/trace --cell 3 --trial 17")]
    Trace(TraceArgs),
    /// Estimate curvature from recorded readings; prints JSON.
    #[command(subcommand)]
    #[command(after_help = "Examples:
  palpate estimate roll examples/roll-readings.csv --probe-radius 10 --pitch 0.2
  palpate estimate glide examples/glide-readings.csv --map map.csv
  palpate estimate press examples/press-readings.csv --sensor-radius 20 --depth 2")]
    Estimate(Estimator),
    /// Design, calibrate and read a camera sensor with colour markers.
    #[command(subcommand)]
    #[command(after_help = "Example:
  palpate sensor pattern examples/press-with-a-camera.toml --out out/pattern
  palpate sensor calibrate examples/chromatouch-2020/calibration-normal.csv \\
    --out calibration.toml
  palpate sensor track rest.png pressed.png --out out/track")]
    Sensor(SensorCommand),
    /// Find the values of a field that meet a target: which pads, which roll, which camera will do.
    #[command(after_help = "Examples:
  palpate design examples/pads-for-a-ball.toml --set scene.motion.arc_length=4 \\
    --target 'relative_rms_error(mean_curvature) <= 5 %' --vary scene.sensor.pitch=0.05..2
  palpate design my.toml --target 'coverage95(object_curvature) >= 0.9' \\
    --vary scene.sensor.normal_from=hue,both --set scene.object.radius=42 --out out/which-reading
  palpate design examples/pads-for-a-ball.toml \\
    --target 'relative_rms_error(mean_curvature) <= 5 %' --vary scene.sensor.pitch=0.05..2 \\
    --vary scene.motion.arc_length=0.5..8 --maximise scene.sensor.pitch

The target is to hold in every cell of the config at once; a field that is swept can be --set to one value.
At least 16 values are scanned, and every crossing is bracketed ever more closely; fresh trials verify the
answer, all of which is right with 95 %. Between values that were looked at, nothing is known.

Of several fields, the last that has a range, or what is sought, is searched so at each of some values of the
others; about the largest or smallest value that is sought, these values stand closer.")]
    Design(DesignArgs),
    /// Tell how surely one trial tells the swept objects apart, and how many trials do.
    #[command(after_help = "Examples:
  palpate distinguish examples/press-a-ball.toml --vary scene.object.radius=20,25,30
  palpate distinguish my.toml --quantity class --confidence 0.99 --out out/which-shapes

Two objects are told apart where a trial of each puts their estimates in the right order; by the quantity class
of a glide, where most places of both are classified right. A trial that fails does not tell.")]
    Distinguish(DistinguishArgs),
    /// Find which numeric field of a scene changes the error of an estimate most.
    #[command(after_help = "Examples:
  palpate sensitivity examples/pads-for-a-ball.toml --set arc_length=4 --set pitch=0.2
  palpate sensitivity my.toml --quantity gaussian_curvature --trials 5000 --out out/what-matters

Each field is changed alone, by --step in both directions, with the same random numbers. A change of +1 % per
1 % means that the error is proportional to the field. If the config sweeps fields, its first cell is used.
Fields that are 0, and lists of more than three numbers, are skipped.")]
    Sensitivity(SensitivityArgs),
    /// Validate a config; prints cells, trials, the models that it needs and an estimate of the time.
    #[command(after_help = "Example:
  palpate check sim-configs/ep1-roll-length.toml")]
    Check(CheckArgs),
    /// Draw the plots of a study's results, as SVG and PNG beside its tables.
    #[command(after_help = "Example:
  palpate plot out/my-study")]
    Plot(PlotArgs),
    /// Score the papers' claims on the results of studies and write a self-contained page.
    #[command(
        after_help = "The scores of each study are written to claims.csv in its directory.

Example:
  palpate report results/ep1-roll-length results/ep1-pad-resolution --out report.html"
    )]
    Report(ReportArgs),
    /// Print the JSON Schema of configs, for editors; or the quantities that a plot may name.
    #[command(after_help = "Examples:
  palpate schema > palpate.schema.json
  palpate schema --quantities")]
    Schema(SchemaArgs),
    /// Explain a word: a failure, a status, an estimator, a quantity, a key of configs, a term of the field.
    #[command(after_help = "Examples:
  palpate explain not-rolling
  palpate explain relative curvature
  palpate explain radius
  palpate explain")]
    Explain(ExplainArgs),
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
    /// Choose the number of trials per cell so that planning and run together take about this long on
    /// the given threads: 30s, 5m, 1.5h, or a plain number of seconds.
    #[arg(long, value_name = "DURATION", value_parser = duration::parse, allow_hyphen_values = true, conflicts_with = "trials")]
    pub(crate) budget: Option<Duration>,
    /// Choose the number of trials per cell so that every rms error has a relative standard error of at
    /// most E, and the tolerance of an `auto` model so that it shifts no estimate by more than E/10 of
    /// its rms error. With --budget, take no more trials than fit into it.
    #[arg(long, value_name = "E", value_parser = share, allow_negative_numbers = true, conflicts_with = "trials")]
    pub(crate) target_error: Option<f64>,
    /// Use this many threads instead of all cores; results do not depend on it.
    #[arg(long, value_name = "N")]
    pub(crate) threads: Option<NonZeroUsize>,
    /// Run only every N-th cell, from the first; the rows keep their cell numbers.
    #[arg(long, value_name = "N", default_value = "1")]
    pub(crate) every_nth_cell: NonZeroUsize,
    /// Run only shard K of N: every N-th cell, beginning with the K-th.
    #[arg(long, value_name = "K/N", value_parser = shard)]
    pub(crate) shard: Option<Shard>,
    /// Format of the tables; with --shard, `palpate merge` has it.
    #[arg(long, value_enum, value_name = "FORMAT", default_value = "csv")]
    pub(crate) format: Format,
    /// Also write a table with a row per observation of every trial, or the kind of its failure; - is standard
    /// output. A name that ends with .csv or .parquet tells its format, else --format does. With --shard the rows
    /// are in the journal, and `palpate merge` writes the table.
    #[arg(long, value_name = "FILE")]
    pub(crate) trials_out: Option<PathBuf>,
    /// Do not print the warnings of cells. They are in warnings.txt or, with --shard, in the journal.
    #[arg(long)]
    pub(crate) quiet: bool,
    /// Begin anew where a run that has not ended left its journal.
    #[arg(long)]
    pub(crate) restart: bool,
    /// Replace also files that palpate did not write, that were changed since, or that are read.
    #[arg(long)]
    pub(crate) force: bool,
}

#[derive(Debug, Args)]
pub(crate) struct MergeArgs {
    /// Directories of the shards, or directories in which those are.
    #[arg(required = true, value_name = "DIR")]
    pub(crate) dirs: Vec<PathBuf>,
    /// Where to write the results [default: the only directory, if the shards are in it; else out/ and the
    /// name of the study].
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
    /// Format of the tables.
    #[arg(long, value_enum, value_name = "FORMAT", default_value = "csv")]
    pub(crate) format: Format,
    /// Also write the table of trials, of shards that were run with --trials-out. A name that ends with .csv or
    /// .parquet tells its format, else --format does.
    #[arg(long, value_name = "FILE")]
    pub(crate) trials_out: Option<PathBuf>,
    /// Replace also files that palpate did not write, or that were changed since.
    #[arg(long)]
    pub(crate) force: bool,
}

#[derive(Debug, Args)]
pub(crate) struct StatusArgs {
    /// A directory that `palpate run` writes, or one in which its shards are.
    pub(crate) dir: PathBuf,
}

#[derive(Debug, Subcommand)]
pub(crate) enum Scheduler {
    /// Submit an array of shards to Slurm, and a job that merges them; run again, only shards that are not done.
    #[command(after_help = "Examples:
  palpate submit slurm my.toml --shards 16 --dry-run
  palpate submit slurm my.toml --shards 200 --cpus-per-task 8 --time 2:00:00 --partition short

The scripts, the config with all defaults and the shards are in the output directory. An element whose node
fails, that a signal kills, or whose time is up, is queued again and goes on behind its last finished cell; one that fails
otherwise is not. The merge runs when all elements have ended, and fails where a shard is missing.")]
    Slurm(SlurmArgs),
}

#[derive(Debug, Args)]
pub(crate) struct SlurmArgs {
    /// The study's config, a TOML file.
    pub(crate) config: PathBuf,
    /// Number of shards.
    #[arg(long, value_name = "N", value_parser = shards)]
    pub(crate) shards: NonZeroU64,
    /// Where to write the scripts, the shards and the results [default: out/ and the name of the study].
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
    /// Longest time of a shard, as Slurm has it: minutes, or 2:00:00, or 1-12:00. A shard that needs longer
    /// goes on in another job.
    #[arg(long, value_name = "TIME", value_parser = slurm_time)]
    pub(crate) time: Option<SlurmTime>,
    /// Partition of the cluster.
    #[arg(long, value_name = "NAME", value_parser = slurm_word)]
    pub(crate) partition: Option<String>,
    /// Account that the time is charged to.
    #[arg(long, value_name = "NAME", value_parser = slurm_word)]
    pub(crate) account: Option<String>,
    /// Memory of a shard, as Slurm has it: 500M, 2G.
    #[arg(long, value_name = "SIZE", value_parser = slurm_size)]
    pub(crate) mem: Option<String>,
    /// Processors, and so threads, of a shard.
    #[arg(long, value_name = "N", default_value = "1", value_parser = processors)]
    pub(crate) cpus_per_task: NonZeroU64,
    /// Most times that a shard is queued again.
    #[arg(long, value_name = "N", default_value_t = 5)]
    pub(crate) max_restarts: u32,
    /// Use this seed instead of the config's.
    #[arg(long, value_name = "S")]
    pub(crate) seed: Option<u64>,
    /// Run this many trials per cell instead of the config's.
    #[arg(long, value_name = "N")]
    pub(crate) trials: Option<NonZeroU64>,
    /// Format of the tables that the merge writes.
    #[arg(long, value_enum, value_name = "FORMAT", default_value = "csv")]
    pub(crate) format: Format,
    /// Print the scripts, and neither write nor submit anything.
    #[arg(long)]
    pub(crate) dry_run: bool,
    /// Replace also files that palpate did not write, that were changed since, or that are read.
    #[arg(long)]
    pub(crate) force: bool,
}

#[derive(Debug, Args)]
pub(crate) struct TraceArgs {
    /// The study's config, a TOML file.
    pub(crate) config: PathBuf,
    /// Where to write the tables.
    #[arg(long, value_name = "DIR")]
    pub(crate) out: PathBuf,
    /// Number of the cell to follow, counted from 0.
    #[arg(long, value_name = "I", default_value_t = 0)]
    pub(crate) cell: usize,
    /// Replay this trial with its noise [default: a pass without noise].
    #[arg(long, value_name = "J")]
    pub(crate) trial: Option<u64>,
    /// Replace also files that palpate did not write, that were changed since, or that are read.
    #[arg(long)]
    pub(crate) force: bool,
}

#[derive(Debug, Args)]
pub(crate) struct CheckArgs {
    /// The study's config, a TOML file.
    pub(crate) config: PathBuf,
}

#[derive(Debug, Args)]
pub(crate) struct SchemaArgs {
    /// Print quantities and statistics with their units and meanings instead: what `quantity`, `x` and `y` of a plot
    /// may be, besides the swept fields.
    #[arg(long)]
    pub(crate) quantities: bool,
}

#[derive(Debug, Args)]
pub(crate) struct ExplainArgs {
    /// The word or words; none to list all.
    pub(crate) term: Vec<String>,
    /// Print all words with their meanings as Markdown: the glossary of the book.
    #[arg(long, conflicts_with = "term")]
    pub(crate) markdown: bool,
}

#[derive(Debug, Args)]
pub(crate) struct PlotArgs {
    /// A directory that `palpate run` wrote.
    pub(crate) dir: PathBuf,
    /// Replace also files that palpate did not write, that were changed since, or that are read.
    #[arg(long)]
    pub(crate) force: bool,
}

#[derive(Debug, Args)]
pub(crate) struct ReportArgs {
    /// Directories that `palpate run` wrote.
    #[arg(required = true)]
    pub(crate) dirs: Vec<PathBuf>,
    /// The page to write; - is standard output.
    #[arg(long, value_name = "FILE", default_value = "report.html")]
    pub(crate) out: PathBuf,
    /// Replace also files that palpate did not write, that were changed since, or that are read.
    #[arg(long)]
    pub(crate) force: bool,
}

/// Smallest target error that is accepted; a smaller one would need more trials than can be counted.
const SMALLEST_SHARE: f64 = 1e-9;

fn share(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(number) if (SMALLEST_SHARE..1.0).contains(&number) => Ok(number),
        Ok(_) => Err(format!("must be >= {SMALLEST_SHARE:e} and < 1, is {text}")),
        Err(_) => Err("is not a number".to_owned()),
    }
}

/// Most shards of a run.
const MOST_SHARDS: u64 = 1_000_000;

fn shard(text: &str) -> Result<Shard, String> {
    let numbers = text.split_once('/').and_then(|(number, of)| {
        let parsed = (number.parse::<u64>().ok()?, of.parse::<u64>().ok()?);
        Some(parsed)
    });
    match numbers {
        Some((number, of)) if (1..=of).contains(&number) && of <= MOST_SHARDS => {
            Ok(Shard { number, of })
        }
        Some((0, _)) => Err("shards are counted from 1: the first of 4 is 1/4".to_owned()),
        Some((_, of)) if of > MOST_SHARDS => {
            Err(format!("at most {MOST_SHARDS} shards are possible"))
        }
        Some((number, of)) => Err(format!("there is no shard {number} of {of}")),
        None => Err("is no shard; the first of 4 is written 1/4".to_owned()),
    }
}

/// A word that stands in a line for Slurm as it is.
fn slurm_word(text: &str) -> Result<String, String> {
    let is_plain = |c: char| c.is_ascii_alphanumeric() || "._-+:,/@".contains(c);
    match !text.is_empty() && text.chars().all(is_plain) {
        true => Ok(text.to_owned()),
        false => Err("may have letters, digits and ._-+:,/@ only".to_owned()),
    }
}

fn shards(text: &str) -> Result<NonZeroU64, String> {
    within(text, MOST_SHARDS)
}

/// Most processors of a shard.
const MOST_PROCESSORS: u64 = 255;

fn processors(text: &str) -> Result<NonZeroU64, String> {
    within(text, MOST_PROCESSORS)
}

fn within(text: &str, most: u64) -> Result<NonZeroU64, String> {
    let number = text.parse().ok().filter(|&number| number <= most);
    let number = number.and_then(NonZeroU64::new);
    number.ok_or_else(|| format!("must be a whole number from 1 to {most}"))
}

/// Time as Slurm has it.
#[derive(Clone, Debug)]
pub(crate) struct SlurmTime {
    pub(crate) text: String,
    pub(crate) minutes: u64,
}

/// Minutes, minutes:seconds, hours:minutes:seconds, or days-hours with :minutes and :seconds.
fn slurm_time(text: &str) -> Result<SlurmTime, String> {
    let wrong = || "is no time that Slurm knows; write minutes, 2:00:00 or 1-12:00".to_owned();
    let (days, rest) = match text.split_once('-') {
        Some((days, rest)) => (days.parse::<u64>().map_err(|_| wrong())?, rest),
        None => (0, text),
    };
    let parts: Result<Vec<u64>, _> = rest.split(':').map(str::parse::<u64>).collect();
    let parts = parts.map_err(|_| wrong())?;
    if parts.iter().chain([&days]).any(|&part| part > 1_000_000) {
        return Err(wrong());
    }
    let seconds = match (text.contains('-'), parts.as_slice()) {
        (true, [hours]) => hours * 3600,
        (true, [hours, minutes]) => hours * 3600 + minutes * 60,
        (false, [minutes]) => minutes * 60,
        (false, [minutes, seconds]) => minutes * 60 + seconds,
        (_, [hours, minutes, seconds]) => hours * 3600 + minutes * 60 + seconds,
        _ => return Err(wrong()),
    };
    let minutes = days * 1440 + seconds.div_ceil(60);
    match minutes > 0 {
        true => Ok(SlurmTime {
            text: text.to_owned(),
            minutes,
        }),
        false => Err("must be at least a minute".to_owned()),
    }
}

/// Size of memory as Slurm has it.
fn slurm_size(text: &str) -> Result<String, String> {
    let digits = text.trim_end_matches(['K', 'M', 'G', 'T']);
    let is_size =
        digits.parse::<u64>().is_ok_and(|size| size > 0) && text.len() <= digits.len() + 1;
    match is_size {
        true => Ok(text.to_owned()),
        false => Err("is no size that Slurm knows; write 500M or 2G".to_owned()),
    }
}
