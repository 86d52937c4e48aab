//! Defines the arguments of all commands.

mod answers;
mod estimate_args;
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
    EstimateForceArgs, EstimateGlideArgs, EstimatePressArgs, EstimateRollArgs, Estimator, FormArgs,
    LikeArgs,
};
pub(crate) use sensor_args::{CalibrateArgs, PatternArgs, SensorCommand, TrackArgs};

/// Simulate a fingertip that explores a surface, model the readings of its sensors, and estimate the surface's
/// curvature from these readings.
#[derive(Debug, Parser)]
#[command(name = "palpate", version, about, max_term_width = 100)]
#[command(after_help = "Example:
  palpate check my.toml && palpate run my.toml && palpate report out/my-study")]
pub(crate) struct Cli {
    #[command(subcommand)]
    pub(crate) command: Command,
    /// Format of the error messages on stderr. With json, an error is one line with its kind (usage, work or stopped),
    /// its exit status and its message; file, line and field are added if the error has them.
    #[arg(
        long,
        global = true,
        value_enum,
        value_name = "FORMAT",
        default_value = "text"
    )]
    pub(crate) error_format: ErrorFormat,
}

/// Format of error messages.
#[derive(Clone, Copy, Debug, ValueEnum)]
pub(crate) enum ErrorFormat {
    /// One line for people.
    Text,
    /// One line of JSON for programs.
    Json,
}

#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Run a study: all trials of all cells of a config. Writes cells.csv, failures.csv and run.toml.
    #[command(after_help = "Examples:
  palpate run sim-configs/ep1-angular-velocity-error.toml
  palpate run my.toml --trials 200 --out out/quick-look
  palpate run my.toml --budget 30s
  palpate run my.toml --target-error 0.01
  palpate run my.toml --target-error 0.001 --budget 1.5h
  palpate run my.toml --shard 3/16 --out out/shards/3

--budget and --target-error choose a number of trials and, if all cells use the same model, this model. The
choice is written to run.toml before the first trial. A later `palpate run` of this run.toml repeats the
run without planning, and gives the same bytes.

If a run is interrupted, the same command resumes it: journal.palpate stores the finished cells, and the
tables have the same bytes as those of an undisturbed run. If the journal belongs to another config, the run
is refused, and the message shows the difference; --restart deletes the journal. A shard writes only a
journal, which `palpate merge` reads. If the directory has tables of another config, these tables and their
run.toml stay until the run is finished; until then, the config of the run is next-run.toml. Then the files
that palpate wrote for another study are removed. Files that palpate did not write, or that were edited since,
are not overwritten without --force. Warnings are written to warnings.txt and warnings.json. A run in which
every trial fails ends with status 1.")]
    Run(RunArgs),
    /// Merge the shards of a run: writes exactly the files that one run of the whole study would have written.
    #[command(after_help = "Examples:
  palpate run my.toml --shard 1/2 --out out/a && palpate run my.toml --shard 2/2 --out out/b
  palpate merge out/a out/b --out out/my-study

If a shard is missing, unfinished or damaged, or belongs to another config, seed or version of palpate, the
message lists it, and nothing is written. The shards stay, so the merge can be repeated.")]
    Merge(MergeArgs),
    /// Print the progress of a run or of its shards: done, running, failed and missing shards, cells per second,
    /// and remaining time.
    #[command(after_help = "Example:
  palpate status out/my-study")]
    Status(StatusArgs),
    /// Run the shards of a study on a cluster.
    #[command(subcommand)]
    Submit(Scheduler),
    /// Trace one trial of a scene: writes trace.csv (true values) and readings.csv (readings that `estimate` accepts).
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
    /// Find the values of a field that meet a target, for example which pad pitch, roll length or camera gives a
    /// required accuracy.
    #[command(after_help = "Examples:
  palpate design examples/pads-for-a-ball.toml --set scene.motion.arc_length=4 \\
    --target 'relative_rms_error(mean_curvature) <= 5 %' --vary scene.sensor.pitch=0.05..2
  palpate design my.toml --target 'coverage95(object_curvature) >= 0.9' \\
    --vary scene.sensor.normal_from=hue,both --set scene.object.radius=42 --out out/which-reading
  palpate design examples/pads-for-a-ball.toml \\
    --target 'relative_rms_error(mean_curvature) <= 5 %' --vary scene.sensor.pitch=0.05..2 \\
    --vary scene.motion.arc_length=0.5..8 --maximise scene.sensor.pitch

The target must be met in every cell of the config; --set fixes a swept field at one value. The search tries
at least 16 values. If one of two neighbouring values meets the target and the other misses it, more values
between them are tried until the gap is small. New trials verify the answer. The whole answer is right with a
probability of 95 %. Values between the tried values are not tested.

If several fields are varied, one field is searched in this way for each of several values of the other fields:
the field of --maximise or --minimise, otherwise the last field with a range. Near the best value, the values
of the other fields are closer together.")]
    Design(DesignArgs),
    /// Compute how often the estimates from single trials put the swept objects in the right order, for example by
    /// curvature. Also compute how many trials must be averaged for a reliable order.
    #[command(after_help = "Examples:
  palpate distinguish examples/press-a-ball.toml --vary scene.object.radius=20,25,30
  palpate distinguish my.toml --quantity class --confidence 0.99 --out out/which-shapes

The answer states how often one trial of each of two objects puts their estimates in the right order. For the
quantity `class` of a glide, two trials are right if most points of both are classified correctly. A trial that
fails counts as wrong.")]
    Distinguish(DistinguishArgs),
    /// Find which numeric field of a scene changes the error of an estimate most.
    #[command(after_help = "Examples:
  palpate sensitivity examples/pads-for-a-ball.toml --set arc_length=4 --set pitch=0.2
  palpate sensitivity my.toml --quantity gaussian_curvature --trials 5000 --out out/what-matters

Each field is changed alone, by --step in both directions, with the same random numbers. A change of +1 % per
1 % means that the error is proportional to the field. If the config sweeps fields, its first cell is used.
Fields that are 0, and lists of more than three numbers, are skipped.")]
    Sensitivity(SensitivityArgs),
    /// Check a config; prints the cells, the trials, the chosen models and the expected run time.
    #[command(after_help = "Example:
  palpate check sim-configs/ep1-roll-length.toml")]
    Check(CheckArgs),
    /// Draw the plots of a study's results, as SVG and PNG beside its tables.
    #[command(after_help = "Example:
  palpate plot out/my-study")]
    Plot(PlotArgs),
    /// Test the papers' claims with the results of studies, and write a self-contained HTML page.
    #[command(
        after_help = "The scores of each study are written to claims.csv in its directory.

Example:
  palpate report results/ep1-roll-length results/ep1-pad-resolution --out report.html"
    )]
    Report(ReportArgs),
    /// Print the JSON Schema of configs, which editors use to check a config. With --quantities, print the quantities
    /// and statistics that a plot may use.
    #[command(after_help = "Examples:
  palpate schema > palpate.schema.json
  palpate schema --quantities")]
    Schema(SchemaArgs),
    /// Explain a word: a failure, a status, an estimator, a quantity, a key of configs, or a term of contact mechanics.
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
    /// Use this seed instead of the seed in the config.
    #[arg(long, value_name = "S")]
    pub(crate) seed: Option<u64>,
    /// Run this many trials per cell, instead of the number in the config.
    #[arg(long, value_name = "N")]
    pub(crate) trials: Option<NonZeroU64>,
    /// Choose the number of trials per cell so that planning and run together need about this time on the given number
    /// of threads: 30s, 5m, 1.5h, or a plain number of seconds.
    #[arg(long, value_name = "DURATION", value_parser = duration::parse, allow_hyphen_values = true, conflicts_with = "trials")]
    pub(crate) budget: Option<Duration>,
    /// Choose the number of trials per cell so that every rms error has a relative standard error of at most E. Also
    /// choose the tolerance of an `auto` model so that the model's error shifts every estimate by at most E/10 of its
    /// rms error. With --budget, run at most as many trials as fit into the budget.
    #[arg(long, value_name = "E", value_parser = share, allow_negative_numbers = true, conflicts_with = "trials")]
    pub(crate) target_error: Option<f64>,
    /// Use this many threads instead of all cores; the results do not depend on the number of threads.
    #[arg(long, value_name = "N")]
    pub(crate) threads: Option<NonZeroUsize>,
    /// Run only every N-th cell, beginning with the first; the rows of the tables keep the cell numbers of the study.
    #[arg(long, value_name = "N", default_value = "1")]
    pub(crate) every_nth_cell: NonZeroUsize,
    /// Run only shard K of N: every N-th cell, beginning with the K-th.
    #[arg(long, value_name = "K/N", value_parser = shard)]
    pub(crate) shard: Option<Shard>,
    /// Format of the tables; with --shard, choose the format in `palpate merge`.
    #[arg(long, value_enum, value_name = "FORMAT", default_value = "csv")]
    pub(crate) format: Format,
    /// Also write a table of all trials to this file, or to standard output (-). The table has one row per trial and
    /// quantity; a failed trial has one row with its kind of failure. A name that ends in .csv or .parquet sets the
    /// format of the table, otherwise --format does. With --shard, the journal stores the rows, and `palpate merge`
    /// writes the table.
    #[arg(long, value_name = "FILE")]
    pub(crate) trials_out: Option<PathBuf>,
    /// Do not print the warnings of cells. The warnings are still written to warnings.txt or, with --shard, to the
    /// journal.
    #[arg(long)]
    pub(crate) quiet: bool,
    /// Delete the journal of an unfinished run, and start from the first cell.
    #[arg(long)]
    pub(crate) restart: bool,
    /// Also overwrite files that palpate did not write, files that were edited after palpate wrote them, and input
    /// files of this command.
    #[arg(long)]
    pub(crate) force: bool,
}

#[derive(Debug, Args)]
pub(crate) struct MergeArgs {
    /// Directories of the shards, or directories that contain the directories of the shards.
    #[arg(required = true, value_name = "DIR")]
    pub(crate) dirs: Vec<PathBuf>,
    /// Where to write the results [default: DIR, if only one DIR is given and it contains the directories of the
    /// shards; otherwise out/ and the name of the study].
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
    /// Format of the tables.
    #[arg(long, value_enum, value_name = "FORMAT", default_value = "csv")]
    pub(crate) format: Format,
    /// Also write the table of trials, if the shards were run with --trials-out. A name that ends in .csv or .parquet
    /// sets the format of the table, otherwise --format does.
    #[arg(long, value_name = "FILE")]
    pub(crate) trials_out: Option<PathBuf>,
    /// Also overwrite files that palpate did not write, and files that were edited after palpate wrote them.
    #[arg(long)]
    pub(crate) force: bool,
}

#[derive(Debug, Args)]
pub(crate) struct StatusArgs {
    /// A directory that `palpate run` writes, or a directory that contains its shards.
    pub(crate) dir: PathBuf,
}

#[derive(Debug, Subcommand)]
pub(crate) enum Scheduler {
    /// Submit an array of shards to Slurm, and a job that merges them. If the same study is submitted again, only
    /// unfinished shards run.
    #[command(after_help = "Examples:
  palpate submit slurm my.toml --shards 16 --dry-run
  palpate submit slurm my.toml --shards 200 --cpus-per-task 8 --time 2:00:00 --partition short

The scripts, the config with all defaults and the shards are written into the output directory. If the node of
a shard fails, if a signal kills the shard or if its time is up, the shard is queued again and resumes after its
last finished cell. A shard that fails for another reason is not queued again. The merge runs when all shards
have ended, and fails if a shard is missing.")]
    Slurm(SlurmArgs),
}

#[derive(Debug, Args)]
pub(crate) struct SlurmArgs {
    /// The study's config, a TOML file.
    pub(crate) config: PathBuf,
    /// Number of shards into which the study is divided.
    #[arg(long, value_name = "N", value_parser = shards)]
    pub(crate) shards: NonZeroU64,
    /// Where to write the scripts, the shards and the results [default: out/ and the name of the study].
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
    /// Time limit of a shard in Slurm's format: minutes, or 2:00:00, or 1-12:00. A shard that needs more time continues
    /// in another job.
    #[arg(long, value_name = "TIME", value_parser = slurm_time)]
    pub(crate) time: Option<SlurmTime>,
    /// Partition of the cluster.
    #[arg(long, value_name = "NAME", value_parser = slurm_word)]
    pub(crate) partition: Option<String>,
    /// Account that the computing time is charged to.
    #[arg(long, value_name = "NAME", value_parser = slurm_word)]
    pub(crate) account: Option<String>,
    /// Memory that a shard needs, in Slurm's format: 500M, 2G.
    #[arg(long, value_name = "SIZE", value_parser = slurm_size)]
    pub(crate) mem: Option<String>,
    /// Number of processors of a shard, which is also its number of threads.
    #[arg(long, value_name = "N", default_value = "1", value_parser = processors)]
    pub(crate) cpus_per_task: NonZeroU64,
    /// Largest number of times that a failed shard is queued again.
    #[arg(long, value_name = "N", default_value_t = 5)]
    pub(crate) max_restarts: u32,
    /// Use this seed instead of the seed in the config.
    #[arg(long, value_name = "S")]
    pub(crate) seed: Option<u64>,
    /// Run this many trials per cell, instead of the number in the config.
    #[arg(long, value_name = "N")]
    pub(crate) trials: Option<NonZeroU64>,
    /// Format of the tables that the merge writes.
    #[arg(long, value_enum, value_name = "FORMAT", default_value = "csv")]
    pub(crate) format: Format,
    /// Print the scripts, but do not write or submit anything.
    #[arg(long)]
    pub(crate) dry_run: bool,
    /// Also overwrite files that palpate did not write, files that were edited after palpate wrote them, and input
    /// files of this command.
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
    /// Number of the cell to trace, counted from 0.
    #[arg(long, value_name = "I", default_value_t = 0)]
    pub(crate) cell: usize,
    /// Replay this trial with its noise [default: a trial without noise].
    #[arg(long, value_name = "J")]
    pub(crate) trial: Option<u64>,
    /// Also overwrite files that palpate did not write, files that were edited after palpate wrote them, and input
    /// files of this command.
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
    /// Print the quantities and statistics with their units and meanings instead of the schema. In a plot, the keys
    /// `quantity`, `x` and `y` name one of these quantities or statistics; `x` and `y` may also name a swept field.
    #[arg(long)]
    pub(crate) quantities: bool,
}

#[derive(Debug, Args)]
pub(crate) struct ExplainArgs {
    /// The word or words to explain; without a word, all words are listed.
    pub(crate) term: Vec<String>,
    /// Print all words with their meanings as Markdown: the glossary of the book.
    #[arg(long, conflicts_with = "term")]
    pub(crate) markdown: bool,
}

#[derive(Debug, Args)]
pub(crate) struct PlotArgs {
    /// A directory that `palpate run` wrote.
    pub(crate) dir: PathBuf,
    /// Also overwrite files that palpate did not write, files that were edited after palpate wrote them, and input
    /// files of this command.
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
    /// Also overwrite files that palpate did not write, files that were edited after palpate wrote them, and input
    /// files of this command.
    #[arg(long)]
    pub(crate) force: bool,
}

/// Smallest target error that `--target-error` accepts. A smaller target error would need more trials than a 64-bit
/// number can count.
const MIN_TARGET_ERROR: f64 = 1e-9;

fn share(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(number) if (MIN_TARGET_ERROR..1.0).contains(&number) => Ok(number),
        Ok(_) => Err(format!(
            "must be >= {MIN_TARGET_ERROR:e} and < 1, is {text}"
        )),
        Err(_) => Err("is not a number".to_owned()),
    }
}

/// Largest number of shards into which a run may be divided.
const MAX_SHARDS: u64 = 1_000_000;

fn shard(text: &str) -> Result<Shard, String> {
    let numbers = text.split_once('/').and_then(|(number, of)| {
        let parsed = (number.parse::<u64>().ok()?, of.parse::<u64>().ok()?);
        Some(parsed)
    });
    match numbers {
        Some((number, of)) if (1..=of).contains(&number) && of <= MAX_SHARDS => {
            Ok(Shard { number, of })
        }
        Some((0, _)) => Err("shards are counted from 1: the first of 4 is 1/4".to_owned()),
        Some((_, of)) if of > MAX_SHARDS => {
            Err(format!("at most {MAX_SHARDS} shards are possible"))
        }
        Some((number, of)) => Err(format!("there is no shard {number} of {of}")),
        None => Err("is not a shard; the first of 4 shards is written 1/4".to_owned()),
    }
}

/// Accepts a word if a line of a Slurm script may contain it without quotation marks; rejects other words.
fn slurm_word(text: &str) -> Result<String, String> {
    let is_plain = |c: char| c.is_ascii_alphanumeric() || "._-+:,/@".contains(c);
    match !text.is_empty() && text.chars().all(is_plain) {
        true => Ok(text.to_owned()),
        false => Err("may have letters, digits and ._-+:,/@ only".to_owned()),
    }
}

fn shards(text: &str) -> Result<NonZeroU64, String> {
    within(text, MAX_SHARDS)
}

const MAX_PROCESSORS: u64 = 255;

fn processors(text: &str) -> Result<NonZeroU64, String> {
    within(text, MAX_PROCESSORS)
}

fn within(text: &str, most: u64) -> Result<NonZeroU64, String> {
    let number = text.parse().ok().filter(|&number| number <= most);
    let number = number.and_then(NonZeroU64::new);
    number.ok_or_else(|| format!("must be a whole number from 1 to {most}"))
}

/// Time limit of a job, in Slurm's format and in minutes.
#[derive(Clone, Debug)]
pub(crate) struct SlurmTime {
    pub(crate) text: String,
    pub(crate) minutes: u64,
}

/// Parses a time in Slurm's format: minutes, minutes:seconds, hours:minutes:seconds, days-hours, days-hours:minutes, or
/// days-hours:minutes:seconds.
fn slurm_time(text: &str) -> Result<SlurmTime, String> {
    let wrong = || "is not a time in Slurm's format; write minutes, 2:00:00 or 1-12:00".to_owned();
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

fn slurm_size(text: &str) -> Result<String, String> {
    let digits = text.trim_end_matches(['K', 'M', 'G', 'T']);
    let is_size =
        digits.parse::<u64>().is_ok_and(|size| size > 0) && text.len() <= digits.len() + 1;
    match is_size {
        true => Ok(text.to_owned()),
        false => Err("is not a size in Slurm's format; write 500M or 2G".to_owned()),
    }
}
