//! The arguments of `palpate estimate`.

use std::path::PathBuf;

use clap::{Args, Subcommand};
use palpate_recorded::{GlideOptions, PressOptions, RollSettings};
use palpate_study::config::{GlideEstimatorConfig, PressEstimatorConfig, RollEstimatorConfig};

use super::form::FormArgs;
use super::number::positive;
use super::settings::Settings;

/// Paragraph on tables that every help of them has.
macro_rules! tables {
    () => {
        "The table may be CSV with commas, semicolons or tabs, with decimal points or commas, in UTF-8, or
JSON with one object per line, whose keys are the columns (those within others joined by points). Columns stand in
any order, in any case of letters; units stand behind names, x_mm or x [mm]: m, cm, mm, um, nm, in; rad, mrad,
deg. Inches are read as mm and nm as um, unless --length-unit says otherwise. Columns that are called otherwise
are named by --columns, or by a table [columns] in the study of --like.
"
    };
}
pub(super) use tables;

#[derive(Debug, Subcommand)]
pub(crate) enum Estimator {
    /// Curvature at a point from small rolls (EP1).
    #[command(after_help = concat!("The readings have one row per probe,
  probe,rotation_x_rad,rotation_y_rad,shift_u_mm,shift_v_mm
or, with the rotation from start to end as a unit quaternion,
  probe,qx,qy,qz,qw,shift_u_mm,shift_v_mm
or a time series per probe, whose last row counts,
  probe,t_s,rotation_x_rad,rotation_y_rad,pad_u_mm,pad_v_mm
with rotations summed in the probe's contact frame (z out of the probe; a contact moving to +u has
rotation_y < 0) and shifts as great-circle displacements on the probe from its first contact. Without a column
probe each row is one; of time series, each that a blank line or a time that does not rise ends.

", tables!(), "Other columns are ignored, but those of rolls whose contact did not move stand in
`unresolved_probes`, as `columns`.

`p_value` is the probability that noise of the stated size leaves residuals at least as large; null if no noise is
stated. The errors of pads are not independent: their p-value is rather too large. `warnings`, which standard error
repeats, have a `code`, a `text` and `numbers`; `palpate explain CODE` explains one. Readings contradict the model by
poor-fit (the p-value is below 0.02 and the residuals are at least 1.65 times the stated noise, or it is below 1e-6: the
stated noise is too small, the rolls are too long, frames are turned or probes slip) and outlier (one roll contradicts the others). Stated values contradict the readings by stated-noise (a noise of
shifts that is at least four times too large) and stated-pitch. `units` warns of rotations in degrees, and of shifts in
another unit than the probe's radius. Sound readings get a warning in fewer than 5 of 100 estimates. Readings do not show a
gain of all shifts or rotations, nor a wrong radius in the right unit: it errs the curvature by the error of 1/R.

`interval95` is 1.96 standard deviations to either side where noise is stated. Where none is, they follow from the residuals,
of 2n - 3 degrees of freedom with n probes, and it is as many as Student's t says: 2.57 with 4 probes, 2.16 with 8.

The JSON has `format_version` 2, which rises when a key goes or changes its meaning.

With --like STUDY.toml probe, noise and estimator are those of a study of kind roll, in the readings'
unit; flags override them.

Examples:
  palpate estimate roll examples/roll-readings.csv --probe-radius 10 --pitch 0.2
  palpate estimate roll examples/roll-readings.csv \\
    --like examples/pads-for-a-ball.toml --pitch 0.2"))]
    Roll(EstimateRollArgs),
    /// Curvature over a patch from sliding fingers (EP2).
    #[command(
        after_help = concat!("The readings have one row per contact, the contacts of a finger in the order in which it made them,
  finger,x_mm,y_mm,z_mm,normal_x,normal_y,normal_z
or without normals,
  finger,x_mm,y_mm,z_mm
Without a column finger, blank lines part the fingers; where there are none, the steps that are more than three
times as long as most, and longer by half than all others. A warning tells which.

", tables!(), "Other columns are ignored, but a map at the contacts has them behind its own columns.

The JSON tells the curvature in the middle of the patch and the regions of one shape class; --map
writes the curvature all over the patch, with standard deviations and the probability of each class; with --at-contacts at the readings.

`p_value` is the probability that noise of the stated size takes the contacts at least as far from the surface; null
if the noise is estimated, and for two-pass. `warnings`, which standard error repeats, have a `code`, a `text` and
`numbers`; `palpate explain CODE` explains one. Contacts contradict the model by poor-fit (the p-value is below 0.005:
the stated noise is too small, a finger is displaced, or a quadric does not fit the surface) and outlier (one contact
contradicts the others). Stated values contradict the readings by stated-noise (of positions or normals, compared with the
noise that the same method estimates) and stated-scale (the distance between fingers). `units` and `signs` warn of normals
that are not of length 1, point to -z, or fit the positions better with a sign reversed or components swapped. Contacts do
not show a wrong tip radius, whether all normals point inward, or the unit of all lengths.

The JSON has `format_version` 2, which rises when a key goes or changes its meaning.

Fingertips are points unless --tip-radius says otherwise. Where positions are of a round tip's lowest point or of its
centre, contacts are found from the normals; without, from those of a first fit to the centres, whose error the
stated deviations leave out.

With --like STUDY.toml the estimator, the distance between fingers, the thresholds and, where the sensor reports lowest
points, the tip are those of a study of kind glide, in the readings' unit; flags override them.

Examples:
  palpate estimate glide examples/glide-readings.csv --map map.csv
  palpate estimate glide examples/glide-readings.csv --map map.csv --at-contacts
  palpate estimate glide examples/glide-readings.csv --method two-pass --smoothing 500
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
}

const PRESS_HELP: &str = concat!("The readings have one row per marker,
  x_mm,y_mm,normal_displacement_mm,tangential_x_mm,tangential_y_mm
or without the last two; or one row per marker of a row of them through the apex, along x,
  radial_position_mm,normal_displacement_mm
A place (x, y) lies sqrt(x^2 + y^2) along the skin from its apex, in the direction (x, y); normal
displacements are positive inward, tangential ones count along the axes of the apex, carried along
the meridian. Of a row of markers the contact is sought along the row.

", tables!(), "Other columns are ignored, but those of markers that are left out stand in `wrong_markers`, as
`columns`.

The JSON tells curvatures, radii and the indentation, each with its 95 % interval (an end that is
null: no bound); object_radius is negative for a dish and null for a plane, and has one interval of
radii in case the object is convex and one in case it is concave, in which null is flat. `verdict`
is what the interval leaves open: convex, concave, flat-within-noise or not-resolved.
`wrong_markers` are the rows that contradict the others and were left out. `contact_seen` is false where
only the stated indentation says that there is a contact: the interval is then that of all objects that the readings
leave; where one marker alone shows it, a warning names that marker. `warnings` have a `code`,
a `text` and `numbers`. Those with a `p_value` are ways in which the readings contradict the model: poor-fit,
stated-noise, stated-indentation, outlier (the interval then also contains the estimate without this marker), other-body
and not-round. If the model holds, 1 press in 200 has each of them by chance, and 1 in 80 stated-indentation.

The JSON has `format_version` 2, which rises when a key goes or changes its meaning. `warnings`, which
standard error repeats, tell where the readings contradict what is stated: the indentation, by
the one that they tell without it; the noise, by the residuals; the body, the depth of its markers and the shape of
what presses, by how residuals depend on distance and direction; units and signs, where displacements and places would
be absurd. The readings do not tell how exact a stated indentation is, nor Poisson's ratio, nor Young's modulus, nor an
error of scale common to all lengths, and of the sensor's radius R they tell little: a wrong one errs the object's
curvature by the error of 1/R.

With --like STUDY.toml the sensor, the noise of its readings and the estimator are those of a study of
kind press, in the readings' unit; flags override them. The indentation of the study's presses is not
taken over: it is fitted unless --indentation tells it.

Examples:
  palpate estimate press examples/press-readings.csv --sensor-radius 20 --depth 2 \\
    --indentation 1.5 --indentation-std 0.02
  palpate estimate press examples/press-readings.csv --sensor-radius 20 --depth 2 \\
    --method bonded-layer --thickness 5
  palpate estimate press examples/chromatouch-2020/profile-dish.csv \\
    --sensor-radius 20 --depth 2 --radial-scale 2.19
  palpate estimate press examples/press-readings.csv \\
    --like examples/press-a-ball.toml --indentation 1.5");

/// Study whose settings stand for those that are not given.
#[derive(Debug, Args)]
pub(crate) struct LikeArgs {
    /// Take the settings below from this study; a flag overrides them.
    #[arg(long, value_name = "STUDY.toml")]
    pub(crate) like: Option<PathBuf>,
    /// Number of the study's cell whose settings are taken, counted from 0.
    #[arg(long, value_name = "I", default_value_t = 0, requires = "like")]
    pub(crate) cell: usize,
}

#[derive(Debug, Args)]
pub(crate) struct EstimateRollArgs {
    /// The recorded readings, a CSV file or JSON with one object per line; - is standard input.
    pub(crate) readings: PathBuf,
    #[command(flatten)]
    pub(crate) form: FormArgs,
    #[command(flatten)]
    pub(crate) like: LikeArgs,
    #[command(flatten)]
    pub(crate) rolls: Settings<RollSettings>,
    #[command(flatten)]
    pub(crate) estimator: Settings<RollEstimatorConfig>,
}

#[derive(Debug, Args)]
pub(crate) struct EstimateGlideArgs {
    /// The recorded readings, a CSV file or JSON with one object per line; - is standard input.
    pub(crate) readings: PathBuf,
    #[command(flatten)]
    pub(crate) form: FormArgs,
    #[command(flatten)]
    pub(crate) like: LikeArgs,
    #[command(flatten)]
    pub(crate) estimator: Settings<GlideEstimatorConfig>,
    /// Write the curvature all over the patch to this CSV file; to - is to standard output, and the JSON to
    /// standard error.
    #[arg(long, value_name = "FILE")]
    pub(crate) map: Option<PathBuf>,
    /// Give the map one row per reading, in their order, instead of a grid; it then has no regions.
    #[arg(long, requires = "map")]
    pub(crate) at_contacts: bool,
    #[command(flatten)]
    pub(crate) glides: Settings<GlideOptions>,
    /// Replace also files that palpate did not write, that were changed since, or that are read.
    #[arg(long)]
    pub(crate) force: bool,
}

#[derive(Debug, Args)]
pub(crate) struct EstimatePressArgs {
    /// The recorded readings, a CSV file or JSON with one object per line; - is standard input.
    pub(crate) readings: PathBuf,
    #[command(flatten)]
    pub(crate) form: FormArgs,
    #[command(flatten)]
    pub(crate) sensor: SensorArgs,
    /// Multiply the positions of the markers by this factor.
    #[arg(long, value_name = "F", default_value_t = 1.0, value_parser = positive, allow_negative_numbers = true)]
    pub(crate) radial_scale: f64,
}

/// A soft sensor with markers, and the estimator of what is pressed on it.
#[derive(Debug, Args)]
pub(crate) struct SensorArgs {
    #[command(flatten)]
    pub(crate) like: LikeArgs,
    #[command(flatten)]
    pub(crate) presses: Settings<PressOptions>,
    /// Thickness and Poisson's ratio among them are those of the body that a Gaussian is calibrated on.
    #[command(flatten)]
    pub(crate) estimator: Settings<PressEstimatorConfig>,
}
