//! The config of a press: a soft spherical fingertip with markers under its skin is pressed onto an object once.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::marker_sensor::{LayoutConfig, LayoutTable, PressProbeConfig, PressSensorConfig};
use super::press_estimator::PressEstimatorConfig;

/// A sensor is pressed onto an object, and the object's curvature is estimated from the displacements of the markers.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PressConfig {
    /// The sensor that presses.
    pub probe: PressProbeConfig,
    /// The object that is pressed on.
    pub object: PressObjectConfig,
    /// Indentation, and place of the contact on the skin.
    pub motion: PressMotionConfig,
    /// The model of the markers' displacements in the press.
    #[serde(default)]
    pub model: PressModelConfig,
    /// The sensor that reads the markers' displacements.
    #[serde(default)]
    pub sensor: PressSensorConfig,
    /// Errors of the readings.
    #[serde(default)]
    pub noise: PressNoiseConfig,
    /// The estimator of the curvature.
    #[serde(default)]
    pub estimator: PressEstimatorConfig,
}

impl PressConfig {
    pub(super) fn check(&self) -> Result<(), (&'static str, &'static str)> {
        let PressProbeConfig::MarkerSphere { marker_depth, .. } = self.probe;
        let of_model = self.model.thickness();
        if of_model.is_some_and(|thickness| marker_depth > thickness) {
            return Err((
                "scene.probe.marker_depth",
                "the markers lie below the layer: must be at most `scene.model.thickness`",
            ));
        }
        if let PressModelConfig::Auto {
            thickness: Some(_),
            poisson,
            ..
        } = self.model
            && poisson != half()
        {
            return Err((
                "scene.model.poisson",
                "a layer on a core is incompressible: leave out `poisson`, or `thickness`",
            ));
        }
        self.check_sensor()?;
        self.check_strain()?;
        if !self.object.is_round() && of_model.is_some() {
            return Err((
                "scene.object",
                "a layer has no model of an object with two different curvatures: let the object be round, or the model a half-space",
            ));
        }
        if !self.object.is_round() && self.motion.shift != 0.0 {
            return Err((
                "scene.motion.shift",
                "sideways movement is modelled only for a circle of contact: must be 0, or the object round",
            ));
        }
        if self.motion.shift != 0.0 && of_model.is_some() {
            return Err((
                "scene.motion.shift",
                "how a layer moves sideways is not modelled: must be 0, or the model a half-space",
            ));
        }
        let is_image = matches!(self.estimator, PressEstimatorConfig::Image { .. });
        if is_image && self.sensor.camera().is_none() {
            return Err((
                "scene.estimator",
                "a fit of pictures needs a camera: let `scene.sensor` be `projected` or `rendered`",
            ));
        }
        match self.estimator.layer(of_model) {
            None if matches!(self.estimator, PressEstimatorConfig::BondedLayer { .. }) => Err((
                "scene.estimator",
                "`thickness` is missing, and the model has no layer to take it from",
            )),
            Some(thickness) if marker_depth > thickness => Err((
                "scene.estimator.thickness",
                "the layer ends above the markers: must be at least `scene.probe.marker_depth`",
            )),
            _ => Ok(()),
        }
    }

    /// The discs may only strain if the strain of the skin is known.
    fn check_strain(&self) -> Result<(), (&'static str, &'static str)> {
        let PressProbeConfig::MarkerSphere { discs, .. } = &self.probe;
        if discs.as_ref().is_none_or(|discs| discs.strains().is_none()) {
            return Ok(());
        }
        let refuse = |message| Err(("scene.probe.discs.strain", message));
        if self.model.poisson() != half() {
            return refuse(
                "strains are those of an incompressible skin: leave it out, or let `scene.model.poisson` be 0.5",
            );
        }
        if self.noise.sensor.is_some()
            || matches!(self.estimator, PressEstimatorConfig::Image { .. })
        {
            return refuse(
                "a fit of pictures assumes rigid discs: leave it out with `scene.noise.sensor` or an estimator of `image`",
            );
        }
        Ok(())
    }

    /// A sensor may only have the noise and the imperfections of its kind.
    fn check_sensor(&self) -> Result<(), (&'static str, &'static str)> {
        let noise = &self.noise;
        let of_pictures = [
            ("scene.noise.hue", noise.hue.is_some()),
            ("scene.noise.centroid", noise.centroid.is_some()),
            ("scene.noise.size", noise.size.is_some()),
        ];
        let of_frames = ("scene.noise.pixel", noise.pixel.is_some());
        let lost = ("scene.noise.lost_markers", noise.lost_markers.is_some());
        let of_sensor = ("scene.noise.sensor", noise.sensor.is_some());
        let refuse = |rules: &[(&'static str, bool)], message: &'static str| {
            let stray = rules.iter().find(|(_, is_given)| *is_given);
            stray.map_or(Ok(()), |(path, _)| Err((*path, message)))
        };
        match self.sensor.camera() {
            None => refuse(
                &[&of_pictures[..], &[of_frames, lost, of_sensor]].concat(),
                "this sensor has no camera; `projected` and `rendered` have",
            ),
            Some((camera, false)) => refuse(
                &[
                    of_frames,
                    ("scene.sensor.light_at_rim", camera.light_at_rim != 1.0),
                    ("scene.sensor.blur_px", camera.blur_px != 0.0),
                    ("scene.sensor.seam_width", camera.seam_width != 0.0),
                ],
                "a projected sensor has no pixels; a `rendered` one has",
            ),
            Some((camera, true)) => {
                refuse(
                    &of_pictures,
                    "a rendered sensor errs by its pixels, `noise.pixel`; a `projected` one has this",
                )?;
                let PressProbeConfig::MarkerSphere { layout, .. } = &self.probe;
                let has_gores = matches!(
                    layout,
                    LayoutConfig::Named(_) | LayoutConfig::Table(LayoutTable::Gores { .. })
                );
                refuse(
                    &[(
                        "scene.sensor.seam_width",
                        camera.seam_width != 0.0 && !has_gores,
                    )],
                    "seams run between gores, which this layout has not",
                )
            }
        }
    }
}

/// The object that is pressed on.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "kebab-case", deny_unknown_fields)]
pub enum PressObjectConfig {
    /// The outside of a sphere.
    Sphere {
        /// Its radius.
        #[schemars(extend("exclusiveMinimum" = 0, "x-unit" = "length"))]
        radius: f64,
    },
    /// The inside of a sphere. If it is not wider than the sensor, the contact is not one point and the trials fail.
    Dish {
        /// Its radius, without a sign.
        #[schemars(extend("exclusiveMinimum" = 0, "x-unit" = "length"))]
        radius: f64,
    },
    /// A plane.
    Plane {},
    /// The outside of a circular cylinder, touched along its side. Only on a half-space.
    Cylinder {
        /// Its radius.
        #[schemars(extend("exclusiveMinimum" = 0, "x-unit" = "length"))]
        radius: f64,
        /// Angle of its axis from the x axis of the skin at the contact.
        #[serde(default)]
        direction_deg: f64,
    },
    /// An ellipsoid, touched at the end of its third semi-axis. Only on a half-space, unless the first two are equal.
    Ellipsoid {
        /// Semi-axes along the x axis and the y axis of the skin at the contact, and along the normal.
        #[schemars(extend("items" = { "type": "number", "exclusiveMinimum": 0 }, "x-unit" = "length"))]
        semi_axes: [f64; 3],
    },
}

impl PressObjectConfig {
    /// Whether both principal curvatures at the contact are equal.
    pub fn is_round(&self) -> bool {
        match *self {
            Self::Sphere { .. } | Self::Dish { .. } | Self::Plane {} => true,
            Self::Cylinder { .. } => false,
            Self::Ellipsoid {
                semi_axes: [x, y, _],
            } => x == y,
        }
    }
}

/// Indentation, and place of the contact on the skin.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PressMotionConfig {
    /// The approach of the two bodies since first touch.
    #[schemars(extend("exclusiveMinimum" = 0, "x-unit" = "length"))]
    pub indentation: f64,
    /// Place of the contact on the skin: polar angle from the apex, from 0 to 180, and azimuth from x.
    #[serde(default)]
    pub contact_deg: [f64; 2],
    /// Sideways movement of the object along x after the press, without slip. Only for a half-space.
    #[serde(default)]
    #[schemars(extend("x-unit" = "length"))]
    pub shift: f64,
}

/// The model of the markers' displacements in the press.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "kebab-case", deny_unknown_fields)]
pub enum PressModelConfig {
    /// The cheapest other model that meets the tolerance: a layer if `thickness` is given, otherwise a half-space.
    Auto {
        /// Thickness of the layer on a rigid core, at most the radius of the sensor; without it there is no core.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        #[schemars(extend("exclusiveMinimum" = 0, "x-unit" = "length"))]
        thickness: Option<f64>,
        /// Poisson's ratio of the soft body; of a layer 0.5.
        #[serde(default = "half")]
        #[schemars(extend("minimum" = 0, "maximum" = 0.5))]
        poisson: f64,
        /// Largest error of a marker's displacement, relative to the largest displacement of this press.
        #[serde(default = "millionth")]
        #[schemars(extend("exclusiveMinimum" = 0))]
        tolerance: f64,
        /// Young's modulus of the soft body, kPa. With it, the tables have the force between the bodies.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        #[schemars(extend("exclusiveMinimum" = 0))]
        modulus_kpa: Option<f64>,
    },
    /// Hertz contact with displacements at the skin's surface, also for markers below it.
    Hertz {
        /// Poisson's ratio of the soft body.
        #[serde(default = "half")]
        #[schemars(extend("minimum" = 0, "maximum" = 0.5))]
        poisson: f64,
        /// Young's modulus of the soft body, kPa. With it, the tables have the force between the bodies.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        #[schemars(extend("exclusiveMinimum" = 0))]
        modulus_kpa: Option<f64>,
    },
    /// Hertz contact on an elastic half-space, in closed form at the markers' depth.
    HalfSpace {
        /// Poisson's ratio of the soft body.
        #[serde(default = "half")]
        #[schemars(extend("minimum" = 0, "maximum" = 0.5))]
        poisson: f64,
        /// Young's modulus of the soft body, kPa. With it, the tables have the force between the bodies.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        #[schemars(extend("exclusiveMinimum" = 0))]
        modulus_kpa: Option<f64>,
    },
    /// An incompressible layer bonded to a rigid core; the contact is computed numerically.
    BondedLayer {
        /// Thickness of the layer, at most the radius of the sensor.
        #[schemars(extend("exclusiveMinimum" = 0, "x-unit" = "length"))]
        thickness: f64,
        /// Young's modulus of the soft body, kPa. With it, the tables have the force between the bodies.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        #[schemars(extend("exclusiveMinimum" = 0))]
        modulus_kpa: Option<f64>,
    },
}

fn millionth() -> f64 {
    1e-6
}

fn half() -> f64 {
    0.5
}

impl Default for PressModelConfig {
    fn default() -> Self {
        Self::HalfSpace {
            poisson: half(),
            modulus_kpa: None,
        }
    }
}

impl PressModelConfig {
    /// Thickness of the layer, if there is one.
    pub fn thickness(&self) -> Option<f64> {
        match *self {
            Self::BondedLayer { thickness, .. } => Some(thickness),
            Self::Auto { thickness, .. } => thickness,
            Self::Hertz { .. } | Self::HalfSpace { .. } => None,
        }
    }

    /// Poisson's ratio of the soft body.
    pub fn poisson(&self) -> f64 {
        match *self {
            Self::Auto { poisson, .. }
            | Self::Hertz { poisson, .. }
            | Self::HalfSpace { poisson, .. } => poisson,
            Self::BondedLayer { .. } => half(),
        }
    }

    /// Young's modulus of the soft body, kPa, if it is stated.
    pub fn modulus_kpa(&self) -> Option<f64> {
        match *self {
            Self::Auto { modulus_kpa, .. }
            | Self::Hertz { modulus_kpa, .. }
            | Self::HalfSpace { modulus_kpa, .. }
            | Self::BondedLayer { modulus_kpa, .. } => modulus_kpa,
        }
    }

    /// Model with which `auto` is compared: the layer if there is one, otherwise the half-space. Any other model is its own
    /// reference.
    pub fn reference(&self) -> Self {
        match *self {
            Self::Auto {
                thickness: Some(thickness),
                modulus_kpa,
                ..
            } => Self::BondedLayer {
                thickness,
                modulus_kpa,
            },
            Self::Auto {
                poisson,
                modulus_kpa,
                ..
            } => Self::HalfSpace {
                poisson,
                modulus_kpa,
            },
            ref named => named.clone(),
        }
    }
}

/// Errors of the readings; a missing one is 0.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PressNoiseConfig {
    /// Error of each marker's displacement along the normal; of a camera sensor, in addition to the errors of its images.
    pub normal_displacement: Option<ReadingNoise<Length>>,
    /// Error of each component of each marker's displacement along the skin; of a camera sensor, in addition to the errors of its images.
    pub tangential_displacement: Option<ReadingNoise<Length>>,
    /// Error of the indentation that the estimator receives.
    pub indentation: Option<ReadingNoise<Length>>,
    /// Constant error of all normal displacements.
    #[schemars(extend("x-unit" = "length"))]
    pub normal_bias: Option<f64>,
    /// Constant error of the indentation that the estimator receives.
    #[schemars(extend("x-unit" = "length"))]
    pub indentation_bias: Option<f64>,
    /// Error of the factor on all normal displacements of a press, which should be 1.
    pub gain: Option<ReadingNoise<Pure>>,
    /// Markers with a larger error, drawn anew in every trial.
    pub wrong_markers: Option<WrongMarkers>,
    /// Error of each colour of each pixel of a rendered frame, in levels; full light has 255.
    pub pixel: Option<ReadingNoise<Level>>,
    /// Error of each marker's hue, turns; of a projected sensor. The hue of the summed light and the mean hue share it.
    pub hue: Option<ReadingNoise<Pure>>,
    /// Error of each coordinate of each marker's centroid, pixels; of a projected sensor.
    pub centroid: Option<ReadingNoise<Pure>>,
    /// Relative error of each marker's size; of a projected sensor.
    pub size: Option<ReadingNoise<Pure>>,
    /// Markers that are missing in the pressed frame, drawn anew in every trial.
    pub lost_markers: Option<LostMarkers>,
    /// Departure of a camera sensor from its calibration. The sensor is redrawn in every trial, with its own frames at
    /// rest and misalignments. These standard deviations are an input of the estimator `image`.
    pub sensor: Option<SensorNoise>,
}

/// Standard deviations of the sensor parameters that calibration leaves; a missing one is 0.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct SensorNoise {
    /// Standard deviation of either coordinate of the image's centre, pixels: the phase of the pixel grid, and the camera's aim.
    #[schemars(extend("minimum" = 0))]
    pub centre_px: f64,
    /// Standard deviation of the pixels per radian, as a share.
    #[schemars(extend("minimum" = 0, "x-unit" = "1"))]
    pub scale: f64,
    /// Standard deviation of each coordinate of the camera's place.
    #[schemars(extend("minimum" = 0, "x-unit" = "length"))]
    pub place: f64,
    /// Standard deviation of the camera's turn about each axis.
    #[schemars(extend("minimum" = 0))]
    pub turn_deg: f64,
    /// Standard deviation of the depth of the discs of either colour.
    #[schemars(extend("minimum" = 0, "x-unit" = "length"))]
    pub disc_depth: f64,
    /// Standard deviation of the diameter of the discs of either colour, as a share.
    #[schemars(extend("minimum" = 0, "x-unit" = "1"))]
    pub disc_diameter: f64,
    /// Standard deviation of the share of red, of green and of blue light that the discs of either colour transmit.
    #[schemars(extend("minimum" = 0, "x-unit" = "1"))]
    pub colour: f64,
}

/// Distribution of the error of a reading. `S` is the type of its standard deviation.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "kebab-case", deny_unknown_fields)]
pub enum ReadingNoise<S> {
    /// Gaussian with mean 0.
    Gaussian {
        /// Standard deviation.
        std: S,
    },
}

/// A length that is not negative.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(transparent)]
#[schemars(extend("minimum" = 0, "x-unit" = "length"))]
pub struct Length(pub f64);

/// A pure number that is not negative.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(transparent)]
#[schemars(extend("minimum" = 0, "x-unit" = "1"))]
pub struct Pure(pub f64);

/// A level of light; full light has 255.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(transparent)]
#[schemars(extend("minimum" = 0, "maximum" = 255, "x-unit" = "1"))]
pub struct Level(pub f64);

/// Markers that are missing in the pressed frame.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct LostMarkers {
    /// Number of these markers, which are drawn anew in every trial.
    pub count: u32,
}

/// Markers with a larger error, for example because they were confused with others.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct WrongMarkers {
    /// Number of these markers, which are drawn anew in every trial.
    pub count: u32,
    /// Standard deviation of their additional Gaussian error, of the normal displacement and of both tangential components.
    #[schemars(extend("minimum" = 0, "x-unit" = "length"))]
    pub std: f64,
}
