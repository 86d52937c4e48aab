//! The arguments of the commands.

mod press;
mod sensor;

use std::num::{NonZeroU64, NonZeroUsize};
use std::path::PathBuf;
use std::time::Duration;

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use clap::{Args, Parser, Subcommand, ValueEnum};
use palpate_scene::recorded::GlideMethod;
use palpate_study::config::LengthUnit;

use crate::duration;

pub(crate) use press::{BaselineIs, EstimatePressArgs, PressMethodName};
pub(crate) use sensor::{CalibrateArgs, PatternArgs, SensorCommand, TrackArgs};

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
  palpate run my.toml --trials 200 --out out/quick-look
  palpate run my.toml --budget 30s
  palpate run my.toml --target-error 0.01
  palpate run my.toml --target-error 0.001 --budget 1.5h

A budget or a target error becomes a number of trials and, where all cells take the same, a rung of the
model. They are written to run.toml before the first trial: `palpate run` of that file needs neither a
clock nor a pilot, and gives the same bytes.

A run that is interrupted leaves run.toml and no tables. Where the directory has tables of another
config, they and their run.toml stay until the run is done; meanwhile its config is next-run.toml.
What palpate did not write is not replaced: where the directory has a run.toml by hand, or tables
without one, the run is refused.")]
    Run(RunArgs),
    /// Follow one pass of a scene: writes trace.csv (truth) and readings.csv (what `estimate` accepts).
    #[command(after_help = "Examples:
  palpate trace my.toml --out out/trace
  palpate trace my.toml --out out/trace --cell 3 --trial 17")]
    Trace(TraceArgs),
    /// Estimate curvature from recorded readings; prints JSON.
    #[command(subcommand)]
    #[command(after_help = "Examples:
  palpate estimate roll examples/roll-readings.csv --probe-radius 10 --pitch 0.5
  palpate estimate glide examples/glide-readings.csv --map map.csv
  palpate estimate press examples/press-readings.csv --sensor-radius 20 --depth 2 --indentation 1.5")]
    Estimate(Estimator),
    /// Design, calibrate and read a camera sensor with colour markers.
    #[command(subcommand)]
    #[command(after_help = "Example:
  palpate sensor pattern examples/press-with-a-camera.toml --out out/pattern
  palpate sensor calibrate examples/chromatouch-2020/calibration-normal.csv --out calibration.toml
  palpate sensor track rest.png pressed.png --out out/track")]
    Sensor(SensorCommand),
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
    /// Curvature over a patch from sliding fingers (EP2).
    #[command(
        after_help = "The readings have one row per contact, the contacts of a finger in the order in which it made them,
  finger,x_mm,y_mm,z_mm,normal_x,normal_y,normal_z
or without normals,
  finger,x_mm,y_mm,z_mm

The JSON tells the curvature in the middle of the patch and the regions of one shape class; --map
writes the curvature all over the patch, with standard deviations and the probability of each class; with --at-contacts at the readings.

Examples:
  palpate estimate glide examples/glide-readings.csv --map map.csv
  palpate estimate glide examples/glide-readings.csv --map map.csv --at-contacts
  palpate estimate glide examples/glide-readings.csv --method two-pass
  palpate estimate glide examples/glide-readings.csv --gaussian-threshold 0.0005 --mean-threshold 0.01"
    )]
    Glide(EstimateGlideArgs),
    /// Curvature of an object from one press of a soft sphere with markers.
    #[command(after_help = press::HELP)]
    Press(EstimatePressArgs),
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
    /// Pitch of the pads, in the readings' length unit. With it the estimates have standard deviations,
    /// and a roll whose contact did not move bounds the object's radius from above.
    #[arg(long, value_name = "P", value_parser = positive, allow_negative_numbers = true)]
    pub(crate) pitch: Option<f64>,
    /// The unit of lengths, if the header does not state it (shift_u_mm).
    #[arg(long, value_name = "UNIT", value_parser = length_unit)]
    pub(crate) length_unit: Option<LengthUnit>,
}

#[derive(Debug, Args)]
pub(crate) struct EstimateGlideArgs {
    /// The recorded readings, a CSV file.
    pub(crate) readings: PathBuf,
    /// The estimator.
    #[arg(long, default_value = GlideMethod::default().name(), value_parser = glide_methods())]
    pub(crate) method: GlideMethod,
    /// Points along each side of the map's grid.
    #[arg(long, value_name = "N", default_value_t = 30, value_parser = clap::value_parser!(u32).range(1..=1000))]
    pub(crate) grid: u32,
    /// Write the curvature all over the patch to this CSV file.
    #[arg(long, value_name = "FILE")]
    pub(crate) map: Option<PathBuf>,
    /// Give the map one row per reading, in their order, instead of a grid; it then has no regions.
    #[arg(long, requires = "map")]
    pub(crate) at_contacts: bool,
    /// The direction out of the object, for readings without normals [default: 0,0,1].
    #[arg(long, value_name = "X,Y,Z", value_parser = direction, allow_hyphen_values = true)]
    pub(crate) outward: Option<Direction>,
    /// The unit of lengths, if the header does not state it (x_mm).
    #[arg(long, value_name = "UNIT", value_parser = length_unit)]
    pub(crate) length_unit: Option<LengthUnit>,
    /// Magnitude of the Gaussian curvature below which it counts as zero, 1/length²; at least the square
    /// of the mean threshold [default: from the patch's size].
    #[arg(long, value_name = "T", value_parser = not_negative, allow_negative_numbers = true, requires = "mean_threshold")]
    pub(crate) gaussian_threshold: Option<f64>,
    /// Magnitude of the mean curvature below which it counts as zero, 1/length [default: from the
    /// patch's size].
    #[arg(long, value_name = "T", value_parser = not_negative, allow_negative_numbers = true, requires = "gaussian_threshold")]
    pub(crate) mean_threshold: Option<f64>,
    /// Standard deviation of each coordinate, in the readings' length unit [default: found from the
    /// readings].
    #[arg(long, value_name = "S", value_parser = positive, allow_negative_numbers = true)]
    pub(crate) position_std: Option<f64>,
    /// Standard deviation of a normal's tilt about each tangent, in degrees [default: found from the
    /// readings].
    #[arg(long, value_name = "D", value_parser = positive, allow_negative_numbers = true)]
    pub(crate) normal_std_deg: Option<f64>,
    /// Distance between fingers, in the readings' length unit; the unit of length of the settings of
    /// two-pass [default: the mean distance between neighbouring fingers].
    #[arg(long, value_name = "D", value_parser = positive, allow_negative_numbers = true)]
    pub(crate) inter_finger_distance: Option<f64>,
}

/// Components of a direction.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Direction(pub(crate) [f64; 3]);

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

fn glide_methods() -> impl TypedValueParser<Value = GlideMethod> {
    let described = GlideMethod::ALL.map(|method| {
        PossibleValue::new(method.name()).help(match method {
            GlideMethod::Penalised => {
                "One penalised spline through heights and slopes, with standard deviations"
            }
            GlideMethod::TwoPass => "The two smoothing splines of the 1996 paper",
            GlideMethod::Quadric => "A least-squares quadric",
        })
    });
    PossibleValuesParser::new(described).try_map(|name| {
        let mut methods = GlideMethod::ALL.into_iter();
        methods
            .find(|method| method.name() == name)
            .ok_or("is no method")
    })
}

fn positive(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(number) if number > 0.0 && number.is_finite() => Ok(number),
        Ok(_) => Err(format!("must be finite and > 0, is {text}")),
        Err(_) => Err("is not a number".to_owned()),
    }
}

fn not_negative(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(number) if number >= 0.0 && number.is_finite() => Ok(number),
        Ok(_) => Err(format!("must be finite and >= 0, is {text}")),
        Err(_) => Err("is not a number".to_owned()),
    }
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

fn direction(text: &str) -> Result<Direction, String> {
    let numbers: Vec<f64> = text
        .split(',')
        .map(|part| {
            part.trim()
                .parse()
                .map_err(|_| format!("`{part}` is not a number"))
        })
        .collect::<Result<_, _>>()?;
    let components: [f64; 3] = numbers
        .try_into()
        .map_err(|numbers: Vec<f64>| format!("needs 3 numbers, X,Y,Z; has {}", numbers.len()))?;
    let largest = components
        .iter()
        .fold(0.0, |largest: f64, one| largest.max(one.abs()));
    if components.iter().all(|one| one.is_finite()) && largest > 0.0 {
        Ok(Direction(components.map(|one| one / largest)))
    } else {
        Err("must be finite and not zero".to_owned())
    }
}

fn length_unit(text: &str) -> Result<LengthUnit, String> {
    use LengthUnit::{Cm, M, Mm, Um, Unit};
    [M, Cm, Mm, Um, Unit]
        .into_iter()
        .find(|unit| unit.as_str() == text)
        .ok_or_else(|| "must be one of m, cm, mm, um, unit".to_owned())
}
