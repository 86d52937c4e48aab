//! The config of a press: a soft spherical fingertip with markers under its skin is pressed onto an object once.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::marker_sensor::{LayoutConfig, LayoutTable, PressProbeConfig, PressSensorConfig};
use super::press_estimator::PressEstimatorConfig;

/// A sensor is pressed onto an object, and the object's curvature is estimated from how its markers move.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PressConfig {
    /// The sensor that presses.
    pub probe: PressProbeConfig,
    /// The object that is pressed on.
    pub object: PressObjectConfig,
    /// How deep, and with which part of the skin.
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
    /// How curvature follows from the readings.
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
        if discs.as_ref().is_none_or(|discs| discs.strain == 0.0) {
            return Ok(());
        }
        let refuse = |message| Err(("scene.probe.discs.strain", message));
        if self.model.poisson() != half() {
            return refuse(
                "strains are those of an incompressible skin: must be 0, or `scene.model.poisson` 0.5",
            );
        }
        if self.noise.sensor.is_some()
            || matches!(self.estimator, PressEstimatorConfig::Image { .. })
        {
            return refuse(
                "a fit of pictures knows rigid discs: must be 0, without `scene.noise.sensor` and an estimator of `image`",
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
    /// The inside of a sphere. One that is not wider than the sensor is not touched in one point: trials fail.
    Dish {
        /// Its radius, without a sign.
        #[schemars(extend("exclusiveMinimum" = 0, "x-unit" = "length"))]
        radius: f64,
    },
    /// A plane.
    Plane {},
}

/// How deep the press goes, and with which part of the skin.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PressMotionConfig {
    /// The approach of the two bodies since first touch.
    #[schemars(extend("exclusiveMinimum" = 0, "x-unit" = "length"))]
    pub indentation: f64,
    /// Place of the contact on the skin: polar angle from the apex, from 0 to 180, and azimuth from x.
    #[serde(default)]
    pub contact_deg: [f64; 2],
    /// How far the object then moves sideways, along x, sticking to the skin; of a half-space.
    #[serde(default)]
    #[schemars(extend("x-unit" = "length"))]
    pub shift: f64,
}

/// The model of the markers' displacements in the press.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "kebab-case", deny_unknown_fields)]
pub enum PressModelConfig {
    /// The cheapest of the others that meets the tolerance: of a layer if there is a `thickness`, else of a half-space.
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
    },
    /// Hertz contact, seen at the skin's surface whatever the markers' depth.
    Hertz {
        /// Poisson's ratio of the soft body.
        #[serde(default = "half")]
        #[schemars(extend("minimum" = 0, "maximum" = 0.5))]
        poisson: f64,
    },
    /// Hertz contact on an elastic half-space, in closed form at the markers' depth.
    HalfSpace {
        /// Poisson's ratio of the soft body.
        #[serde(default = "half")]
        #[schemars(extend("minimum" = 0, "maximum" = 0.5))]
        poisson: f64,
    },
    /// An incompressible layer bonded to a rigid core; the contact is solved for.
    BondedLayer {
        /// Thickness of the layer, at most the radius of the sensor.
        #[schemars(extend("exclusiveMinimum" = 0, "x-unit" = "length"))]
        thickness: f64,
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
        Self::HalfSpace { poisson: half() }
    }
}

impl PressModelConfig {
    /// Thickness of the layer, if there is one.
    pub fn thickness(&self) -> Option<f64> {
        match *self {
            Self::BondedLayer { thickness } => Some(thickness),
            Self::Auto { thickness, .. } => thickness,
            Self::Hertz { .. } | Self::HalfSpace { .. } => None,
        }
    }

    /// Poisson's ratio of the soft body.
    pub fn poisson(&self) -> f64 {
        match *self {
            Self::Auto { poisson, .. } | Self::Hertz { poisson } | Self::HalfSpace { poisson } => {
                poisson
            }
            Self::BondedLayer { .. } => half(),
        }
    }

    /// Model with which `auto` is compared: the layer if there is one, otherwise the half-space. Any other model is its own
    /// reference.
    pub fn reference(&self) -> Self {
        match *self {
            Self::Auto {
                thickness: Some(thickness),
                ..
            } => Self::BondedLayer { thickness },
            Self::Auto { poisson, .. } => Self::HalfSpace { poisson },
            ref named => named.clone(),
        }
    }
}

/// Errors of the readings; what is absent has none.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PressNoiseConfig {
    /// Error of each marker's displacement along the normal; behind a camera, on top of what its pictures err by.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub normal_displacement: Option<LengthNoise>,
    /// Error of each component of each marker's displacement along the skin; behind a camera, likewise.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub tangential_displacement: Option<LengthNoise>,
    /// Error of the known indentation that the estimator is given.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub indentation: Option<LengthNoise>,
    /// Error of a factor, which should be 1, on all normal displacements of a press.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub gain: Option<GainNoise>,
    /// Markers that err by more, others in every trial.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub wrong_markers: Option<WrongMarkers>,
    /// Error of each colour of each pixel of a rendered frame.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub pixel: Option<PixelNoise>,
    /// Error of each marker's mean hue, of a projected sensor.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub hue: Option<HueNoise>,
    /// Error of each coordinate of each marker's centroid, of a projected sensor.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub centroid: Option<CentroidNoise>,
    /// Error of each marker's size, of a projected sensor.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub size: Option<SizeNoise>,
    /// Markers that a camera does not see once the sensor is pressed, others in every trial.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub lost_markers: Option<LostMarkers>,
    /// How far the sensor before a camera departs from what calibration knows of it: another sensor in every trial, with
    /// frames at rest and misalignments of its own. An estimator of kind `image` is told the standard deviations.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sensor: Option<SensorNoise>,
}

/// Standard deviations of what calibration knows only roughly of a sensor; what is absent is known exactly.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SensorNoise {
    /// Standard deviation of either coordinate of the image's centre, pixels: the phase of the pixel grid, and the camera's aim.
    #[serde(default)]
    #[schemars(extend("minimum" = 0))]
    pub centre_px: f64,
    /// Standard deviation of the pixels per radian, as a share.
    #[serde(default)]
    #[schemars(extend("minimum" = 0, "x-unit" = "1"))]
    pub scale: f64,
    /// Standard deviation of each coordinate of the camera's place.
    #[serde(default)]
    #[schemars(extend("minimum" = 0, "x-unit" = "length"))]
    pub place: f64,
    /// Standard deviation of the camera's turn about each axis.
    #[serde(default)]
    #[schemars(extend("minimum" = 0))]
    pub turn_deg: f64,
    /// Standard deviation of the depth of the discs of either colour.
    #[serde(default)]
    #[schemars(extend("minimum" = 0, "x-unit" = "length"))]
    pub disc_depth: f64,
    /// Standard deviation of the diameter of the discs of either colour, as a share.
    #[serde(default)]
    #[schemars(extend("minimum" = 0, "x-unit" = "1"))]
    pub disc_diameter: f64,
    /// Standard deviation of the share of red, of green and of blue light that discs of either colour let through.
    #[serde(default)]
    #[schemars(extend("minimum" = 0, "x-unit" = "1"))]
    pub colour: f64,
}

/// Error of a length.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "kebab-case", deny_unknown_fields)]
pub enum LengthNoise {
    /// Gaussian with mean 0.
    Gaussian {
        /// Standard deviation.
        #[schemars(extend("minimum" = 0, "x-unit" = "length"))]
        std: f64,
    },
}

/// Error of a factor.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "kebab-case", deny_unknown_fields)]
pub enum GainNoise {
    /// Gaussian with mean 0.
    Gaussian {
        /// Standard deviation, a share of the displacement.
        #[schemars(extend("minimum" = 0, "x-unit" = "1"))]
        std: f64,
    },
}

/// Error of a pixel.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "kebab-case", deny_unknown_fields)]
pub enum PixelNoise {
    /// Gaussian with mean 0.
    Gaussian {
        /// Standard deviation, in levels of which full light has 255.
        #[schemars(extend("minimum" = 0, "maximum" = 255, "x-unit" = "1"))]
        std: f64,
    },
}

/// Error of a hue.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "kebab-case", deny_unknown_fields)]
pub enum HueNoise {
    /// Gaussian with mean 0.
    Gaussian {
        /// Standard deviation, turns.
        #[schemars(extend("minimum" = 0, "x-unit" = "1"))]
        std: f64,
    },
}

/// Error of a place in the image.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "kebab-case", deny_unknown_fields)]
pub enum CentroidNoise {
    /// Gaussian with mean 0.
    Gaussian {
        /// Standard deviation, pixels.
        #[schemars(extend("minimum" = 0, "x-unit" = "1"))]
        std: f64,
    },
}

/// Error of a size in the image.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "kebab-case", deny_unknown_fields)]
pub enum SizeNoise {
    /// Gaussian with mean 0.
    Gaussian {
        /// Standard deviation, a share of the size.
        #[schemars(extend("minimum" = 0, "x-unit" = "1"))]
        std: f64,
    },
}

/// Markers that are not seen.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct LostMarkers {
    /// How many, drawn anew in every trial.
    pub count: u32,
}

/// Markers that are taken for others, say.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct WrongMarkers {
    /// How many, drawn anew in every trial.
    pub count: u32,
    /// Standard deviation of their Gaussian error on top of the others': of the normal displacement and of both tangential components.
    #[schemars(extend("minimum" = 0, "x-unit" = "length"))]
    pub std: f64,
}
