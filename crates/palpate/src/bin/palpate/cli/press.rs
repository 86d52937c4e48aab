//! The arguments of `palpate estimate press`.

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use palpate_study::config::LengthUnit;

use super::{length_unit, not_negative, positive};

pub(super) const HELP: &str = "The readings have one row per marker,
  x_mm,y_mm,normal_displacement_mm,tangential_x_mm,tangential_y_mm
or without the last two; or one row per marker of a row of them through the apex, along x,
  radial_position_mm,normal_displacement_mm
A place (x, y) lies sqrt(x^2 + y^2) along the skin from its apex, in the direction (x, y); normal
displacements are positive inward, tangential ones count along the axes of the apex, carried along
the meridian. Of a row of markers the contact is sought along the row.

The JSON tells curvatures, radii and the indentation, each with its 95 % interval (an end that is
null: no bound); object_radius is negative for a dish and null for a plane, and has one interval of
radii in case the object is convex and one in case it is concave, in which null is flat. `verdict`
is what the interval leaves open: convex, concave, flat-within-noise or not-resolved.
`wrong_markers` are the rows that contradict the others and were left out.

Examples:
  palpate estimate press examples/press-readings.csv --sensor-radius 20 --depth 2 --indentation 1.5 --indentation-std 0.02
  palpate estimate press examples/press-readings.csv --sensor-radius 20 --depth 2 --method bonded-layer --thickness 5
  palpate estimate press examples/chromatouch-2020/profile-dish.csv --sensor-radius 20 --depth 2 --radial-scale 2.19";

#[derive(Debug, Args)]
pub(crate) struct EstimatePressArgs {
    /// The recorded readings, a CSV file.
    pub(crate) readings: PathBuf,
    /// Radius of the sensor's skin, in the readings' length unit.
    #[arg(long, value_name = "R", value_parser = positive, allow_negative_numbers = true)]
    pub(crate) sensor_radius: f64,
    /// The estimator.
    #[arg(long, default_value = "half-space")]
    pub(crate) method: PressMethodName,
    /// Depth of the markers under the skin.
    #[arg(long, value_name = "Z", default_value_t = 0.0, value_parser = not_negative, allow_negative_numbers = true)]
    pub(crate) depth: f64,
    /// Thickness of the soft layer; bonded-layer needs it, and gaussian is calibrated on it.
    #[arg(long, value_name = "H", value_parser = positive, allow_negative_numbers = true)]
    pub(crate) thickness: Option<f64>,
    /// Poisson's ratio of the half-space, from 0 to 0.5 [default: 0.5].
    #[arg(long, value_name = "NU", value_parser = poisson, allow_negative_numbers = true)]
    pub(crate) poisson: Option<f64>,
    /// Indentation, where it is known from elsewhere, such as a robot's pose [default: fitted].
    #[arg(long, value_name = "D", value_parser = positive, allow_negative_numbers = true)]
    pub(crate) indentation: Option<f64>,
    /// Standard deviation of the given indentation.
    #[arg(long, value_name = "S", default_value_t = 0.0, value_parser = not_negative, allow_negative_numbers = true)]
    pub(crate) indentation_std: f64,
    /// Offset common to all normal displacements, which remains without a press.
    #[arg(long, default_value = "known")]
    pub(crate) baseline: BaselineIs,
    /// Standard deviation of an unknown factor near 1 that is common to all normal displacements.
    #[arg(long, value_name = "G", default_value_t = 0.0, value_parser = not_negative, allow_negative_numbers = true)]
    pub(crate) gain_std: f64,
    /// Standard deviation of each normal displacement [default: found from the residuals].
    #[arg(long, value_name = "S", value_parser = positive, allow_negative_numbers = true)]
    pub(crate) normal_std: Option<f64>,
    /// Standard deviation of each component of the tangential displacements [default: found from the
    /// residuals].
    #[arg(long, value_name = "S", value_parser = positive, allow_negative_numbers = true)]
    pub(crate) tangential_std: Option<f64>,
    /// Factor c of the Gaussian method, R = c sigma^2 / indentation [default: the value that gives the
    /// sensor's own radius on a plane pressed equally deep].
    #[arg(long, value_name = "C", value_parser = positive, allow_negative_numbers = true)]
    pub(crate) c: Option<f64>,
    /// Fit the Gaussian only to markers within this distance of the contact [default: all].
    #[arg(long, value_name = "W", value_parser = positive, allow_negative_numbers = true)]
    pub(crate) window: Option<f64>,
    /// Multiply the positions of the markers by this factor.
    #[arg(long, value_name = "F", default_value_t = 1.0, value_parser = positive, allow_negative_numbers = true)]
    pub(crate) radial_scale: f64,
    /// Young's modulus of the soft body, force per squared length unit. With it the output has the force
    /// and the highest pressure, which are proportional to it.
    #[arg(long, value_name = "E", value_parser = positive, allow_negative_numbers = true)]
    pub(crate) young: Option<f64>,
    /// The unit of lengths, if the header does not state it (x_mm).
    #[arg(long, value_name = "UNIT", value_parser = length_unit)]
    pub(crate) length_unit: Option<LengthUnit>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum PressMethodName {
    /// A fit of an elastic half-space, at the markers' depth
    HalfSpace,
    /// A fit of an incompressible layer bonded to a rigid core
    BondedLayer,
    /// The Gaussian of the 2020 paper
    Gaussian,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum BaselineIs {
    /// No offset
    Known,
    /// An unknown offset, which is fitted
    Fitted,
}

pub(super) fn poisson(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(number) if (0.0..=0.5).contains(&number) => Ok(number),
        Ok(_) => Err(format!("must be from 0 to 0.5, is {text}")),
        Err(_) => Err("is not a number".to_owned()),
    }
}
