//! The config of a roll: a probe rolls on an object, and the curvature at the first contact is estimated.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::object::ObjectConfig;
use super::schema::{number, whole};

/// A probe rolls on an object without sliding.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RollConfig {
    /// The fingertip that rolls on the object.
    pub probe: ProbeConfig,
    /// The object on whose surface the probe rolls.
    pub object: ObjectConfig,
    /// Position of the first contact: x and y in the object's frame. The default is x = y = 0; on a torus, the default
    /// is a point at the top of the tube.
    #[schemars(extend("x-unit" = "length"))]
    pub object_contact: Option<[f64; 2]>,
    /// The commanded rotation of the probe.
    pub motion: RollMotionConfig,
    /// The model that computes the true path of the contact.
    #[serde(default)]
    pub model: RollModelConfig,
    /// The sensor that reads the contact's position on the probe.
    #[serde(default)]
    pub sensor: RollSensorConfig,
    /// Errors of the probe's rotation.
    #[serde(default)]
    pub noise: RollNoiseConfig,
    /// The estimator of the object's curvature.
    #[serde(default)]
    pub estimator: RollEstimatorConfig,
    /// Whether the result tables also have the object's principal curvatures, their direction and the object's radius.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub principal_curvatures: bool,
}

impl RollConfig {
    pub(super) fn check(&self) -> Result<(), (&'static str, &'static str)> {
        let motion = &self.motion;
        if [motion.duration_s, motion.arc_length, motion.angle_deg] == [None; 3] {
            return Err((
                "scene.motion",
                "needs `duration_s`, `arc_length` or `angle_deg`",
            ));
        }
        if motion.rate_rad_per_s.is_none() {
            let counted = [
                (
                    motion.duration_s.is_some(),
                    "missing key; `duration_s` needs it (`arc_length` and `angle_deg` do not)",
                ),
                (
                    motion.spin_rad_per_s != 0.0,
                    "missing key; `spin_rad_per_s` needs it",
                ),
                (
                    motion.sampling_hz.is_some(),
                    "missing key; `sampling_hz` needs it",
                ),
            ];
            let needed = counted.into_iter().find(|(is_needed, _)| *is_needed);
            if let Some((_, message)) = needed {
                return Err(("scene.motion.rate_rad_per_s", message));
            }
        }
        if let Some(RotationNoise {
            std_deg: None,
            std_rad: None,
            bias_deg: None,
            drift_deg_per_s: None,
            sample_std_deg: None,
            ..
        }) = self.noise.rotation
        {
            let message =
                "needs `std_deg`, `std_rad`, `bias_deg`, `drift_deg_per_s` or `sample_std_deg`";
            return Err(("scene.noise.rotation", message));
        }
        if let Some(EncoderConfig {
            step_deg: None,
            step_rad: None,
        }) = self.noise.encoder
        {
            return Err(("scene.noise.encoder", "needs `step_deg` or `step_rad`"));
        }
        if self.estimator.needs_series() && motion.sampling_hz.is_none() {
            return Err((
                "scene.motion.sampling_hz",
                "missing key; the estimator needs rolls as time series",
            ));
        }
        let has_pads = matches!(self.sensor, RollSensorConfig::Pads { .. });
        if !has_pads && matches!(self.estimator, RollEstimatorConfig::PadEdge { .. }) {
            return Err((
                "scene.estimator.kind",
                "\"pad-edge\" needs a sensor of kind = \"pads\"; \"trajectory\" does not",
            ));
        }
        if motion.axis == RollAxis::Chart && self.model.chart() == Some(Chart::Free) {
            return Err((
                "scene.motion.axis",
                "\"chart\" needs a model that uses the probe's chart: `scene.model` with chart = \
                 \"montana\"",
            ));
        }
        Ok(())
    }
}

/// The shape of the fingertip.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "kebab-case", deny_unknown_fields)]
pub enum ProbeConfig {
    /// A ball.
    Sphere {
        /// Radius of the ball.
        #[schemars(extend("exclusiveMinimum" = 0, "x-unit" = "length"))]
        radius: f64,
    },
}

/// The commanded rotation of the probe. There is one roll for each direction, and all rolls start at the same contact.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RollMotionConfig {
    /// Rate at which the probe rotates. It is required with `duration_s`, and for rolls with a spin about the contact
    /// normal (`spin_rad_per_s`). Otherwise, the default is 1 rad/s, and the rate changes only the times in a trace.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub rate_rad_per_s: Option<f64>,
    /// Duration of each roll. State one of `duration_s`, `arc_length` and `angle_deg`.
    #[schemars(extend("exclusiveMinimum" = 0, "x-instead-of" = ["arc_length", "angle_deg"]))]
    pub duration_s: Option<f64>,
    /// Distance that the contact moves on the probe in each roll, without noise. State one of `duration_s`,
    /// `arc_length` and `angle_deg`.
    #[schemars(extend("exclusiveMinimum" = 0, "x-unit" = "length", "x-instead-of" = ["duration_s", "angle_deg"]))]
    pub arc_length: Option<f64>,
    /// Angle by which the probe turns in each roll, without noise and spin. State one of `duration_s`, `arc_length` and
    /// `angle_deg`.
    #[schemars(extend("exclusiveMinimum" = 0, "x-instead-of" = ["duration_s", "arc_length"]))]
    pub angle_deg: Option<f64>,
    /// Sampling rate of the sensor during a roll, 1/s. If it is stated, the readings of a roll are a time series.
    /// Otherwise, a roll has one reading at its end: the rotation, and the distance that the contact has moved.
    #[schemars(extend("exclusiveMinimum" = 0, "maximum" = 1e6))]
    pub sampling_hz: Option<f64>,
    /// Rate at which the probe rotates about the contact normal.
    #[serde(default)]
    pub spin_rad_per_s: f64,
    /// Number of rolls. Their directions are spread evenly over a full turn, starting at +x. If there are only two
    /// rolls, their directions are at a right angle. State either this or `directions_deg`.
    #[schemars(extend("minimum" = 1, "maximum" = 10_000, "x-instead-of" = ["directions_deg"]))]
    pub rolls: Option<u32>,
    /// Directions of the rolls, as angles from +x in the tangent plane of the first contact. State either this or
    /// `rolls`.
    #[serde(default = "four_directions_twice")]
    #[schemars(extend("minItems" = 1, "x-instead-of" = ["rolls"]))]
    pub directions_deg: Vec<f64>,
    /// Frame in which the axis of rotation stays fixed while the contact moves.
    #[serde(default)]
    pub axis: RollAxis,
}

impl RollMotionConfig {
    /// Directions of the rolls, in degrees from +x.
    pub fn directions(&self) -> Vec<f64> {
        let Some(rolls) = self.rolls else {
            return self.directions_deg.clone();
        };
        // Spread two rolls over half a turn, because two opposite rolls do not span the tangent plane.
        let turn_deg = if rolls == 2 { 180.0 } else { 360.0 };
        let direction = |roll| turn_deg * f64::from(roll) / f64::from(rolls);
        (0..rolls).map(direction).collect()
    }
}

fn four_directions_twice() -> Vec<f64> {
    vec![0.0, 0.0, 90.0, 90.0, 180.0, 180.0, 270.0, 270.0]
}

/// Frame in which the axis of rotation stays fixed while the contact moves.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum RollAxis {
    /// A frame that moves along the contact's path without turning about the normal (parallel transport).
    #[default]
    Transported,
    /// The frame of the probe's surface coordinates (its chart). This choice requires a model with chart = "montana".
    Chart,
}

/// The model that computes the true path of the contact.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "kebab-case", deny_unknown_fields)]
pub enum RollModelConfig {
    /// The cheapest model whose error is within the tolerance.
    Auto {
        /// Largest error of the contact's position, relative to the probe's radius.
        #[serde(default = "tolerance")]
        #[schemars(extend("exclusiveMinimum" = 0))]
        tolerance: f64,
        /// Coordinates in which the path of the contact is integrated. They are used only if `auto` chooses a model
        /// that integrates the path.
        #[serde(default)]
        chart: Chart,
    },
    /// The closed form of the contact's path, if one exists for the shapes of probe and object.
    ClosedForm {},
    /// Computes the length of the contact's path from the roll angle. This is possible for rolls along a meridian
    /// through the apex of a surface of revolution. If the motion has no noise, it is also possible for rolls along the
    /// axes of ellipsoids, saddles and some formulas. The formula must have degree two, or its graph must be symmetric
    /// about the planes x = 0 and y = 0.
    Meridian {},
    /// The classical Runge–Kutta method of order 4 with equal steps.
    Rk4 {
        /// Number of integration steps per roll.
        #[schemars(extend("minimum" = 1, "maximum" = 1_000_000))]
        steps: u32,
        /// Coordinates in which the path of the contact is integrated.
        #[serde(default)]
        chart: Chart,
    },
    /// The Runge–Kutta method of Dormand and Prince of order 8 with step control.
    Dop853 {
        /// Tolerance for the error of each integration step.
        #[serde(default = "tolerance")]
        #[schemars(extend("exclusiveMinimum" = 0))]
        tolerance: f64,
        /// Coordinates in which the path of the contact is integrated.
        #[serde(default)]
        chart: Chart,
    },
}

fn tolerance() -> f64 {
    1e-9
}

impl Default for RollModelConfig {
    fn default() -> Self {
        Self::Auto {
            tolerance: tolerance(),
            chart: Chart::default(),
        }
    }
}

impl RollModelConfig {
    /// Coordinates in which the path of the contact is integrated; `None` for a model without integration.
    pub fn chart(&self) -> Option<Chart> {
        match *self {
            Self::Auto { chart, .. } | Self::Rk4 { chart, .. } | Self::Dop853 { chart, .. } => {
                Some(chart)
            }
            Self::ClosedForm {} | Self::Meridian {} => None,
        }
    }
}

/// Coordinates in which the equations of the moving contact are integrated.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Chart {
    /// Points and frames in space instead of surface coordinates. They have no singularities.
    #[default]
    Free,
    /// Surface coordinates on both bodies, as in Montana's equations. These coordinates have singularities.
    Montana,
}

/// The sensor that reads the contact's position on the probe.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "kebab-case", deny_unknown_fields)]
pub enum RollSensorConfig {
    /// An ideal sensor, whose readings have no error.
    #[default]
    Ideal,
    /// A force sensor in the wrist. The error of the measured contact position is Gaussian, with the same distribution
    /// in all directions along the probe's surface.
    Wrist {
        /// Standard deviation of the error along each of two perpendicular directions.
        #[schemars(extend("minimum" = 0, "x-unit" = "length"))]
        std: f64,
    },
    /// An array of pads. The pad nearest to the contact reports its own centre instead of the contact point.
    Pads {
        /// Distance between neighbouring pads.
        #[schemars(extend("exclusiveMinimum" = 0, "x-unit" = "length"))]
        pitch: f64,
        /// Arrangement of the pads on the probe.
        #[serde(default)]
        layout: PadLayout,
        /// Position of the first contact relative to the pads.
        #[serde(default)]
        offset: PadOffset,
        /// Largest angle between a pad and the middle of the array, seen from the probe's centre.
        #[serde(default = "number::<90>")]
        #[schemars(extend("exclusiveMinimum" = 0, "maximum" = 180))]
        cap_deg: f64,
    },
}

/// Errors of the probe's rotation; an error that is not stated is 0.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RollNoiseConfig {
    /// Error of the angular velocity during a roll.
    pub angular_velocity: Option<AngularVelocityNoise>,
    /// Error of the measured rotation.
    pub rotation: Option<RotationNoise>,
    /// Rounding of the measured rotation by an encoder.
    pub encoder: Option<EncoderConfig>,
}

/// Error of the angular velocity. The error of each component of the angular velocity is drawn independently.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub enum AngularVelocityNoise {
    /// Uniformly distributed error between −b and +b. The bound b is `fraction` times the angular speed of the probe.
    Uniform(AngularVelocityDraws),
    /// Gaussian error with mean 0. Its standard deviation is `fraction` times the angular speed of the probe.
    Gaussian(AngularVelocityDraws),
}

/// Size of the error of the angular velocity, and how often it is drawn.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct AngularVelocityDraws {
    /// Size of the error as a fraction of the angular speed: the bound of uniform noise, or the standard deviation of
    /// Gaussian noise.
    #[schemars(extend("minimum" = 0))]
    pub fraction: f64,
    /// How often the error of the angular velocity is drawn.
    #[serde(default)]
    pub when: When,
    /// Which rotation has the error: the true rotation of the probe or the measured rotation.
    #[serde(default)]
    pub side: Side,
    /// Number of instants in a roll at which the error is drawn. It is used only if `when` is "per-instant".
    #[serde(default = "whole::<100>")]
    #[schemars(extend("minimum" = 1, "maximum" = 1_000_000))]
    pub instants: u32,
}

/// How often the error of the angular velocity is drawn.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum When {
    /// The error is drawn once for each roll.
    #[default]
    PerProbe,
    /// The error is drawn at each of several equally spaced instants of a roll.
    PerInstant,
}

/// Which rotation has the error: the true rotation of the probe or the measured rotation.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Side {
    /// The true motion has the error. The estimator receives the commanded rotation, which has no error.
    #[default]
    Motion,
    /// The measurement has the error. The true motion is the commanded motion, and the estimator receives a rotation
    /// with the error.
    Measurement,
}

/// Error of the measured rotation. It consists of a Gaussian error, which is drawn for each roll and each component, a
/// constant bias and a drift.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RotationNoise {
    /// Distribution of the error of the measured rotation.
    #[serde(default)]
    pub(crate) kind: GaussianKind,
    /// Standard deviation of the Gaussian error, 0 by default. State either this or `std_rad`.
    #[schemars(extend("minimum" = 0, "maximum" = 180, "x-instead-of" = ["std_rad"]))]
    pub std_deg: Option<f64>,
    /// Standard deviation of the Gaussian error, 0 by default. State either this or `std_deg`.
    #[schemars(extend("minimum" = 0, "maximum" = std::f64::consts::PI, "x-instead-of" = ["std_deg"]))]
    pub std_rad: Option<f64>,
    /// Constant error of each component of the measured rotation.
    #[schemars(extend("minimum" = -180, "maximum" = 180))]
    pub bias_deg: Option<f64>,
    /// Drift: the rate at which the error of each component of the measured rotation grows during a roll, as with a
    /// gyroscope.
    #[schemars(extend("minimum" = -1e6, "maximum" = 1e6))]
    pub drift_deg_per_s: Option<f64>,
    /// Standard deviation of an additional error that is drawn for each reading of a time series
    /// (`motion.sampling_hz`), 0 by default.
    #[schemars(extend("minimum" = 0, "maximum" = 180))]
    pub sample_std_deg: Option<f64>,
}

impl RotationNoise {
    /// The standard deviation of the Gaussian error in rad, computed from `std_deg` or `std_rad`.
    pub fn std_rad(&self) -> f64 {
        radians(self.std_deg, self.std_rad)
    }
}

/// Distribution of the error of the measured rotation; it is always Gaussian.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum GaussianKind {
    /// Gaussian error with mean 0.
    #[default]
    Gaussian,
}

/// An encoder that rounds rotations to whole steps. Each roll starts at a random position within a step.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct EncoderConfig {
    /// Size of a step of the encoder. State either this or `step_rad`.
    #[schemars(extend("exclusiveMinimum" = 0, "maximum" = 360, "x-instead-of" = ["step_rad"]))]
    pub step_deg: Option<f64>,
    /// Size of a step of the encoder. State either this or `step_deg`.
    #[schemars(extend("exclusiveMinimum" = 0, "maximum" = std::f64::consts::TAU, "x-instead-of" = ["step_deg"]))]
    pub step_rad: Option<f64>,
}

impl EncoderConfig {
    /// Size of a step of the encoder in rad.
    pub fn step_rad(&self) -> f64 {
        radians(self.step_deg, self.step_rad)
    }
}

/// An angle in rad, from a value in degrees or a value in rad; 0 if both are `None`.
fn radians(deg: Option<f64>, rad: Option<f64>) -> f64 {
    deg.map(f64::to_radians).or(rad).unwrap_or_default()
}

/// The estimator of the object's curvature.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "kebab-case", deny_unknown_fields)]
pub enum RollEstimatorConfig {
    /// A least-squares fit of the curvature to the rotations of all rolls and the distances that the contact has moved,
    /// as in the paper of Charlebois, Gupta and Payandeh (1996).
    #[default]
    LeastSquares,
    /// Finds all curvatures that agree with the times at which the contact moves from one pad to the next. It needs
    /// time series from pads.
    PadEdge {
        /// Whether the estimator receives the position of the first contact on the pads.
        #[serde(default)]
        start: RollStart,
    },
    /// Nonlinear least squares over all readings of the rolls. It estimates the curvature and its change along the
    /// path, and needs time series.
    Trajectory {
        /// Whether the estimator receives the position of the first contact on the pads.
        #[serde(default)]
        start: RollStart,
    },
    /// The estimator that suits the readings: "trajectory" for time series, otherwise "least-squares".
    Auto {
        /// Whether the estimator receives the position of the first contact on the pads.
        #[serde(default)]
        start: RollStart,
    },
}

/// Whether the estimator receives the position of the first contact on the pads.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum RollStart {
    /// The estimator receives only the number of the first active pad, not the position of the contact within this pad.
    #[default]
    Unknown,
    /// The estimator receives the position of the first contact.
    Known,
}

impl RollEstimatorConfig {
    /// Whether the estimator needs time series. Such an estimator cannot use rolls that are read only once, at their
    /// end.
    const fn needs_series(&self) -> bool {
        matches!(self, Self::PadEdge { .. } | Self::Trajectory { .. })
    }

    /// Name of the estimator that is used for these readings. If the setting is `auto`, also the reason for the choice.
    /// `is_series` states whether the readings are time series.
    pub const fn method(&self, is_series: bool) -> (&'static str, Option<&'static str>) {
        match (self, is_series) {
            (Self::LeastSquares, _) => ("least-squares", None),
            (Self::PadEdge { .. }, _) => ("pad-edge", None),
            (Self::Trajectory { .. }, _) => ("trajectory", None),
            (Self::Auto { .. }, false) => {
                ("least-squares", Some("only the end of each roll was read"))
            }
            (Self::Auto { .. }, true) => (
                "trajectory",
                Some("the rolls are time series, and the curvature may change along them"),
            ),
        }
    }
}

/// Arrangement of the pads on the probe.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum PadLayout {
    /// A square grid, measured in arc lengths along the surface of the probe.
    #[default]
    Square,
    /// A hexagonal grid, measured in arc lengths along the surface of the probe.
    Hexagonal,
    /// Pads with almost uniform density over the cap, the part of the probe that has pads.
    Uniform,
}

/// Position of the first contact relative to the pads.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum PadOffset {
    /// The first contact is at the centre of a pad.
    #[default]
    Centred,
    /// The first contact is at a random position within a pad. The position is drawn for each roll.
    Random,
    /// The first contact is at a random position within a pad. The position is drawn once for each trial, and all rolls
    /// of the trial start there.
    RandomPerTrial,
}
