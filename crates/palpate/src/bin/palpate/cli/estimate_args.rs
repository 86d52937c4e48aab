//! Defines the arguments of `palpate estimate`.

use std::collections::BTreeMap;
use std::path::PathBuf;

use clap::{Args, Subcommand};
use palpate_recorded::{
    Decimal, Delimiter, Form, GlideOptions, PressOptions, RollSettings, RotationFrame, column_names,
};
use palpate_study::config::{
    GlideEstimatorConfig, LengthUnit, PressEstimatorConfig, RollEstimatorConfig,
};

use super::settings::{Settings, length_unit, not_negative, positive, radius};

/// Paragraph about the format of tables. Every help text of `palpate estimate` contains this paragraph.
macro_rules! tables {
    () => {
        "The table may be CSV with commas, semicolons, tabs or spaces, with decimal points or commas, in UTF-8. It may also
be JSON with one object per line or a list of objects, whose keys are the columns (nested keys are joined by points),
or a NumPy array, .npy or .npz. Columns may have any order, and their names any case of letters. A unit follows the
name of its column, as in x_mm or x [mm]: m, cm, mm, um, nm, in; rad, mrad, deg. Inches are converted to mm and nm to
um, unless --length-unit states another unit. If the file has other column names, assign them by --columns, or by a
table [columns] in the study of --like.
"
    };
}
pub(super) use tables;

#[derive(Debug, Subcommand)]
pub(crate) enum Estimator {
    /// Curvature at a point from small rolls (exploratory procedure 1, EP1).
    #[command(after_help = concat!("The readings have one row per probe:
  probe,rotation_x_rad,rotation_y_rad,shift_u_mm,shift_v_mm
The rotation from start to end may be a unit quaternion:
  probe,qx,qy,qz,qw,shift_u_mm,shift_v_mm
Or there is a time series per probe with the centre of the active pad. The method least-squares uses its last row:
  probe,t_s,rotation_x_rad,rotation_y_rad,pad_u_mm,pad_v_mm
Or the time series has the position of the contact on the probe. The method least-squares uses its last row relative to
its first row:
  probe,time_s,rotation_x_rad,rotation_y_rad,contact_u_mm,contact_v_mm
In all these tables, a quaternion qx,qy,qz,qw, a matrix r11,r12,r13,r21 to r33, or axis_x,axis_y,axis_z,angle_rad may
replace rotation_x_rad and rotation_y_rad. A time series may also have a column rotation_z_rad, the component about the
normal; without it, the probe is assumed to roll without spin.

Rotations are integrals of the angular velocity in the probe's contact frame, whose z axis points out of the probe. If a
contact moves to +u, then rotation_y < 0. Shifts are great-circle displacements on the probe from its first contact.
Without a column probe, each row is a probe. A new time series starts after a blank line, or where the time does not
increase.

", tables!(), "Other columns are not used. In the output, `unresolved_probes` lists the rolls whose contact did not move, with
their values of the other columns as `columns`.

`p_value` is the probability that noise of the stated size causes residuals at least as large. It is null if no noise is
stated. The errors of pads are not independent, so their p-value tends to be too large.

`warnings` are also printed on standard error. Each has a `code`, a `text` and `numbers`; `palpate explain CODE` explains
a code:
  poor-fit      the p-value is below 0.02: the stated noise is too small, the rolls are too long, frames are turned, or
                probes slip
  outlier       one roll contradicts the others
  stated-noise  the stated noise of the shifts is at least four times too large
  stated-pitch  the stated pitch contradicts the readings
  units         rotations are in degrees, or shifts in another unit than the probe's radius
Fewer than 5 of 100 estimates from sound readings have a warning. The readings do not show whether all shifts or
rotations have a gain error, or whether the probe's radius R is wrong. A wrong R changes the curvature by the error of 1/R.

If noise is stated, `interval95` extends 1.96 standard deviations to both sides. Otherwise, the standard deviations follow
from the residuals. The half-width then follows from Student's t with 2n - 3 degrees of freedom for n probes: 2.57
standard deviations with 4 probes, 2.16 with 8.

The JSON has `format_version` 2, which increases when a key is removed or changes its meaning.

With --like STUDY.toml, the probe, the noise and the estimator come from a study of kind roll, and are converted to the
readings' unit. Flags override them.

Examples:
  palpate estimate roll examples/roll-readings.csv --probe-radius 10 --pitch 0.2
  palpate estimate roll examples/roll-readings.csv \\
    --like examples/pads-for-a-ball.toml --pitch 0.2"))]
    Roll(EstimateRollArgs),
    /// Curvature over a patch from sliding fingers (exploratory procedure 2, EP2).
    #[command(
        after_help = concat!("The readings have one row per contact. The contacts of each finger are in the order of the finger's path:
  finger,x_mm,y_mm,z_mm,normal_x,normal_y,normal_z
Normals may be missing:
  finger,x_mm,y_mm,z_mm
Without a column finger, blank lines separate the fingers. Without blank lines, a new finger starts after a long step
between contacts: more than three times the median step and 1.5 times all other steps. A warning states how the fingers
were separated.

", tables!(), "Other columns are not used, but a map with --at-contacts has them after its own columns.

The JSON has the curvature in the middle of the patch, and the regions of one shape class. Lost readings are left out
and listed in `left_out`. `effective_contacts` is the number of independent contacts: repeated rows and rests count
once, and correlated noise reduces the number. The methods plane, sphere, cylinder and shape also state `radius`,
`shape` and `rms_misfit`. For a single stroke, `stroke` has the curvature along the stroke. --map writes the curvature
all over the patch, with standard deviations and the probability of each class. With --at-contacts, the map has the
positions of the readings.

`p_value` is the probability that noise of the stated size causes residuals at least as large. It is null if the noise is
estimated, and for the method two-pass.

`warnings` are also printed on standard error. Each has a `code`, a `text` and `numbers`; `palpate explain CODE` explains
a code:
  poor-fit      the p-value is below 0.005: the stated noise is too small, a finger is displaced, or a quadric does not fit
                the surface
  outlier       one contact contradicts the others
  stated-noise  the stated noise of positions or normals contradicts the noise that the same method estimates
  stated-scale  the stated distance between fingers, or the stated tip radius, contradicts the readings
  units, signs  normals do not have the length 1, point to -z, or fit the positions better with a sign reversed or with
                components swapped
The positions and normals do not show whether the tip radius is wrong, whether all normals point inward, or whether all lengths are in
a wrong unit.

The JSON has `format_version` 2, which increases when a key is removed or changes its meaning.

Fingertips are points unless --tip-radius states a radius. If the positions are those of a round tip's lowest point or
centre, the contacts are computed from the normals. Without normals, the contacts are computed from a first fit to the
centres. The stated standard deviations do not contain the error of this first fit.

With --like STUDY.toml, the estimator, the distance between fingers and the thresholds come from a study of kind glide,
and are converted to the readings' unit. If the study's sensor reports lowest points, the tip comes from the study, too.
Flags override them.

Examples:
  palpate estimate glide examples/glide-readings.csv --map map.csv
  palpate estimate glide examples/glide-readings.csv --map map.csv --at-contacts
  palpate estimate glide examples/glide-readings.csv --method two-pass --smoothing 500
  palpate estimate glide examples/glide-log.csv --method shape
  palpate estimate glide examples/glide-readings.csv --criterion gcv --intervals 6
  palpate estimate glide examples/glide-readings.csv --like examples/fingers-over-a-mug.toml
  palpate estimate glide examples/glide-readings.csv --tip-radius 4 --reports centre
  palpate estimate glide examples/foreign-glide.csv --length-unit mm \\
    --columns 'x=Finger X [m],y=Finger Y [m],z=Finger Z [m]'
  palpate estimate glide examples/glide-readings.csv \\
    --gaussian-threshold 0.0005 --mean-threshold 0.01")
    )]
    Glide(EstimateGlideArgs),
    /// Curvature of an object from one press of a soft sphere with markers.
    #[command(after_help = PRESS_HELP)]
    Press(EstimatePressArgs),
    /// Effective radius of a contact from a load curve: force against indentation.
    #[command(after_help = FORCE_HELP)]
    Force(EstimateForceArgs),
}

const FORCE_HELP: &str = concat!("The readings have one row per indentation, with the columns
  indentation_mm,force_N
A force that presses the two bodies together is positive. Indentations are measured from the first touch.

", tables!(), "
By Hertz's law, the force is 4/3 E* sqrt(R) d^1.5, with the indentation d, the effective radius
R = 1/(1/R_sensor + 1/R_object) and E* = E/(1 - nu^2). Without the modulus E, the curve determines only
`stiffness` = E* sqrt(R), not the radius. The intervals include the effects of the noise of the forces and of the
standard deviation of the modulus. `exponent` is the power of the indentation that fits the forces best. The warning
other-body reports that this power is not 1.5, so that the radius is wrong. Possible causes: a wrong point of first
touch, a thin layer, or an edge.

The JSON has `format_version` 2, which increases when a key is removed or changes its meaning.

Examples:
  palpate estimate force examples/load-curve.csv
  palpate estimate force examples/load-curve.csv --modulus-kpa 500 --modulus-std-kpa 25 --sensor-radius 20");

const PRESS_HELP: &str = concat!("The readings have one row per marker:
  x_mm,y_mm,normal_displacement_mm,tangential_x_mm,tangential_y_mm
The last two columns may be missing. For markers in a row through the apex along x, the columns are:
  radial_position_mm,normal_displacement_mm
A position (x, y) lies at the distance sqrt(x^2 + y^2) from the apex along the skin, in the direction (x, y). Normal
displacements are positive inward. Tangential displacements are along the axes at the apex, transported along the
meridian to the marker. For markers in a row, the contact is assumed to lie on the row.

", tables!(), "Other columns are not used. In the output, `wrong_markers` lists the markers that are left out, with their
values of the other columns as `columns`.

The JSON has curvatures, radii and the indentation, each with its 95 % interval. If an end of an interval is null, the
interval is unbounded on this side. object_radius is negative for a dish and null for a plane. It has one interval for a
convex object and one for a concave object; in these intervals, null is a plane. `verdict` is the shape that follows
from the interval of the curvature: convex, concave, flat-within-noise or not-resolved. `wrong_markers` are the rows
that contradict the others and were left out. `contact_seen` is false if only the stated indentation implies a contact.
The interval then contains all objects that the readings do not exclude. If only one marker shows the contact, a warning
names this marker.

`warnings` are also printed on standard error. Each has a `code`, a `text` and `numbers`. Warnings with a `p_value` report
that the readings contradict the model: poor-fit, stated-noise, stated-indentation, outlier (the interval then also
contains the estimate without this marker), other-body and not-round. If the model holds, each of them appears by chance in
1 of 200 presses.

The JSON has `format_version` 2, which increases when a key is removed or changes its meaning.

The stated indentation is compared with the indentation that follows from the readings alone, and the stated noise with
the residuals. If the residuals depend on the distance or the direction from the contact, the body, the depth of the
markers or the shape of the object differs from the model. Implausible displacements or positions cause a warning about
units or signs. The readings do not show whether a stated indentation, Poisson's ratio or Young's modulus is right, or
whether all lengths are wrong by a common factor. They hardly show whether the sensor's radius R is right: a wrong R
changes the object's curvature by the error of 1/R.

With --like STUDY.toml, the sensor, the noise of its readings and the estimator come from a study of kind press, and are
converted to the readings' unit. Flags override them. The indentation of the study's presses is not used: the indentation
is fitted unless --indentation states it.

Examples:
  palpate estimate press examples/press-readings.csv --sensor-radius 20 --depth 2 \\
    --indentation 1.5 --indentation-std 0.02
  palpate estimate press examples/press-readings.csv --sensor-radius 20 --depth 2 \\
    --method bonded-layer --thickness 5
  palpate estimate press examples/chromatouch-2020/profile-dish.csv \\
    --sensor-radius 20 --depth 2 --radial-scale 2.19
  palpate estimate press examples/press-readings.csv \\
    --like examples/press-a-ball.toml --indentation 1.5");

/// Options that name a study. The study supplies every setting that no flag states.
#[derive(Debug, Args)]
pub(crate) struct LikeArgs {
    /// Read the settings below from this study; a flag overrides the setting of the study.
    #[arg(long, value_name = "STUDY.toml")]
    pub(crate) like: Option<PathBuf>,
    /// Number of the cell of this study whose settings are used, counted from 0.
    #[arg(long, value_name = "I", default_value_t = 0, requires = "like")]
    pub(crate) cell: usize,
}

#[derive(Debug, Args)]
pub(crate) struct EstimateRollArgs {
    /// The recorded readings: CSV, JSON, .npy or .npz; - is standard input.
    pub(crate) readings: PathBuf,
    #[command(flatten)]
    pub(crate) form: FormArgs,
    /// Print JSON even if the output is a terminal; by default, a terminal shows a summary of a few lines.
    #[arg(long)]
    pub(crate) json: bool,
    #[command(flatten)]
    pub(crate) like: LikeArgs,
    /// Axes of the rotations, if each roll is a series of orientations over time. Choose probe for the probe's own
    /// axes at the start of the roll, or world for the axes in which the orientations are stated. The axes u and v of
    /// the contact lie along x and y of this frame [default: probe].
    #[arg(long, value_name = "FRAME")]
    pub(crate) rotation_frame: Option<RotationFrame>,
    #[command(flatten)]
    pub(crate) rolls: Settings<RollSettings>,
    #[command(flatten)]
    pub(crate) estimator: Settings<RollEstimatorConfig>,
}

#[derive(Debug, Args)]
pub(crate) struct EstimateGlideArgs {
    /// The recorded readings: CSV, JSON, .npy or .npz; - is standard input.
    pub(crate) readings: PathBuf,
    #[command(flatten)]
    pub(crate) form: FormArgs,
    /// Print JSON even if the output is a terminal; by default, a terminal shows a summary of a few lines.
    #[arg(long)]
    pub(crate) json: bool,
    #[command(flatten)]
    pub(crate) like: LikeArgs,
    #[command(flatten)]
    pub(crate) estimator: Settings<GlideEstimatorConfig>,
    /// Write the map of the curvature over the patch to this CSV file; - is standard output, and the JSON then goes to
    /// stderr.
    #[arg(long, value_name = "FILE")]
    pub(crate) map: Option<PathBuf>,
    /// Write the map with one row per reading, in the order of the readings, instead of a grid; the map then has no
    /// regions.
    #[arg(long, requires = "map")]
    pub(crate) at_contacts: bool,
    #[command(flatten)]
    pub(crate) glides: Settings<GlideOptions>,
    /// Also overwrite files that palpate did not write, files that were edited after palpate wrote them, and input
    /// files of this command.
    #[arg(long)]
    pub(crate) force: bool,
}

#[derive(Debug, Args)]
pub(crate) struct EstimatePressArgs {
    /// The recorded readings: CSV, JSON, .npy or .npz; - is standard input.
    pub(crate) readings: PathBuf,
    #[command(flatten)]
    pub(crate) form: FormArgs,
    /// Print JSON even if the output is a terminal; by default, a terminal shows a summary of a few lines.
    #[arg(long)]
    pub(crate) json: bool,
    #[command(flatten)]
    pub(crate) sensor: SensorArgs,
    /// Multiply the positions of the markers by this factor.
    #[arg(long, value_name = "F", default_value_t = 1.0, value_parser = positive, allow_negative_numbers = true)]
    pub(crate) radial_scale: f64,
}

#[derive(Debug, Args)]
pub(crate) struct EstimateForceArgs {
    /// The recorded load curve, a CSV file or JSON with one object per line; - is standard input.
    pub(crate) readings: PathBuf,
    #[command(flatten)]
    pub(crate) form: FormArgs,
    /// Young's modulus of the soft body, kPa; required to estimate the radius.
    #[arg(
        long,
        visible_alias = "modulus",
        value_name = "E",
        value_parser = positive, allow_negative_numbers = true
    )]
    pub(crate) modulus_kpa: Option<f64>,
    /// Standard deviation of Young's modulus, kPa; by default 0.
    #[arg(long, value_name = "S", value_parser = positive, allow_negative_numbers = true)]
    pub(crate) modulus_std_kpa: Option<f64>,
    /// Poisson's ratio of the soft body.
    #[arg(
        long,
        value_name = "X",
        default_value_t = 0.5, value_parser = not_negative, allow_negative_numbers = true
    )]
    pub(crate) poisson: f64,
    /// Radius of the sensor, in the readings' length unit; `inf` for a flat pad. With this option, the output also
    /// contains the curvature of the object.
    #[arg(long, value_name = "R", value_parser = radius, allow_negative_numbers = true)]
    pub(crate) sensor_radius: Option<f64>,
    /// Standard deviation of each force, N; by default estimated from the residuals.
    #[arg(long, value_name = "S", value_parser = positive, allow_negative_numbers = true)]
    pub(crate) force_std_n: Option<f64>,
}

/// Arguments that describe a soft sensor with markers and choose the estimator of a press.
#[derive(Debug, Args)]
pub(crate) struct SensorArgs {
    #[command(flatten)]
    pub(crate) like: LikeArgs,
    #[command(flatten)]
    pub(crate) presses: Settings<PressOptions>,
    /// Settings of the estimator. For the estimator `gaussian`, the thickness and Poisson's ratio describe the soft
    /// body of the simulated presses that calibrate it.
    #[command(flatten)]
    pub(crate) estimator: Settings<PressEstimatorConfig>,
}

/// Options that state the format of a table of readings. They are needed if palpate cannot detect this format from the
/// table.
#[derive(Debug, Args)]
pub(crate) struct FormArgs {
    /// Names of columns in the file that differ from palpate's names, such as x=Finger X [m],y=Finger Y [m]. Put a pair
    /// that contains a comma in quotation marks. If the header of the file states no unit, the unit in palpate's name
    /// (x_mm) applies.
    #[arg(long, value_name = "NAME=COLUMN,...", value_parser = column_names)]
    pub(crate) columns: Option<BTreeMap<String, String>>,
    /// Character between fields: comma, semicolon, tab, pipe or space [default: detected from header and rows].
    #[arg(long, value_name = "NAME")]
    pub(crate) delimiter: Option<Delimiter>,
    /// Decimal sign: point or comma [default: detected from the numbers].
    #[arg(long, value_name = "NAME")]
    pub(crate) decimal: Option<Decimal>,
    /// Unit of lengths in options and output, and in a file whose header states no unit. Lengths in other units are
    /// converted to this unit [default: the header's unit].
    #[arg(long, value_name = "UNIT", value_parser = length_unit)]
    pub(crate) length_unit: Option<LengthUnit>,
}

impl FormArgs {
    /// Name of the first given flag that affects only tables (not camera frames); `None` if no such flag was given.
    pub(crate) fn given(&self) -> Option<&'static str> {
        match self {
            Self {
                columns: Some(_), ..
            } => Some("--columns"),
            Self {
                delimiter: Some(_), ..
            } => Some("--delimiter"),
            Self {
                decimal: Some(_), ..
            } => Some("--decimal"),
            _ => None,
        }
    }

    pub(crate) fn form(&self) -> Form {
        Form {
            columns: self.columns.clone().unwrap_or_default(),
            delimiter: self.delimiter,
            decimal: self.decimal,
            length_unit: self.length_unit,
            rotation_frame: None,
        }
    }
}
