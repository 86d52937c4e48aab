//! The config of a press: a soft sensor with markers under its skin is pressed once onto an object.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::marker_sensor::{LayoutConfig, LayoutTable, PressProbeConfig, PressSensorConfig};
use super::press_estimator::PressEstimatorConfig;

/// A sensor is pressed onto an object, and the object's curvature is estimated from the displacements of the markers.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PressConfig {
    /// The soft sensor that is pressed onto the object.
    pub probe: PressProbeConfig,
    /// The object onto which the sensor is pressed.
    pub object: PressObjectConfig,
    /// Indentation of the press, and position of the contact on the skin.
    pub motion: PressMotionConfig,
    /// The model that computes the displacements of the markers in the press.
    #[serde(default)]
    pub model: PressModelConfig,
    /// The sensor that reads the markers' displacements.
    #[serde(default)]
    pub sensor: PressSensorConfig,
    /// Errors of the sensor's readings.
    #[serde(default)]
    pub noise: PressNoiseConfig,
    /// The estimator of the object's curvature.
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
                "the markers lie below the layer: their depth must be at most `scene.model.thickness`",
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
                "a layer is modelled only for circular contacts: the object must be round, or the model must be a half-space",
            ));
        }
        if !self.object.is_round() && self.motion.shift != 0.0 {
            return Err((
                "scene.motion.shift",
                "sideways movement is modelled only for circular contacts: the movement must be 0, or the object must be round",
            ));
        }
        if self.motion.shift != 0.0 && of_model.is_some() {
            return Err((
                "scene.motion.shift",
                "sideways movement on a layer is not modelled: the movement must be 0, or the model must be \
                 a half-space",
            ));
        }
        let is_image = matches!(self.estimator, PressEstimatorConfig::Image { .. });
        if is_image && self.sensor.camera().is_none() {
            return Err((
                "scene.estimator",
                "an estimator of kind image needs a camera: set `scene.sensor` to `projected` or \
                 `rendered`",
            ));
        }
        match self.estimator.layer(of_model) {
            None if matches!(self.estimator, PressEstimatorConfig::BondedLayer { .. }) => Err((
                "scene.estimator",
                "`thickness` is missing, and the model has no layer whose thickness could be used",
            )),
            Some(thickness) if marker_depth > thickness => Err((
                "scene.estimator.thickness",
                "the layer ends above the markers: its thickness must be at least `scene.probe.marker_depth`",
            )),
            _ => Ok(()),
        }
    }

    /// Rejects a stated strain of the discs (`strain`) if the skin is compressible, because the strain is then not
    /// computed. Also rejects it together with `scene.noise.sensor` or the estimator `image`, because a fit to images
    /// assumes rigid discs.
    fn check_strain(&self) -> Result<(), (&'static str, &'static str)> {
        let PressProbeConfig::MarkerSphere { discs, .. } = &self.probe;
        if discs.as_ref().is_none_or(|discs| discs.strains().is_none()) {
            return Ok(());
        }
        let refuse = |message| Err(("scene.probe.discs.strain", message));
        if self.model.poisson() != half() {
            return refuse(
                "the strain of discs is computed only for an incompressible skin: leave out `strain` and `yellow_strain`, or set `scene.model.poisson` to 0.5",
            );
        }
        if self.noise.sensor.is_some()
            || matches!(self.estimator, PressEstimatorConfig::Image { .. })
        {
            return refuse(
                "a fit to images assumes rigid discs: leave out `strain` and `yellow_strain`, or use neither `scene.noise.sensor` nor the estimator `image`",
            );
        }
        Ok(())
    }

    /// Rejects noise and image defects that this kind of sensor cannot have.
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
                "this sensor has no camera; `projected` and `rendered` have a camera",
            ),
            Some((camera, false)) => refuse(
                &[
                    of_frames,
                    ("scene.sensor.light_at_rim", camera.light_at_rim != 1.0),
                    ("scene.sensor.blur_px", camera.blur_px != 0.0),
                    ("scene.sensor.seam_width", camera.seam_width != 0.0),
                ],
                "a projected sensor has no pixels; a `rendered` sensor has pixels",
            ),
            Some((camera, true)) => {
                refuse(
                    &of_pictures,
                    "a rendered sensor has no such noise, only the noise of its pixels, \
                     `noise.pixel`; a `projected` sensor has it",
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
                    "seams run between gores, but this layout has no gores",
                )
            }
        }
    }
}

/// The object that the sensor is pressed onto.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "kebab-case", deny_unknown_fields)]
pub enum PressObjectConfig {
    /// The outside of a sphere.
    Sphere {
        /// Radius of the sphere.
        #[schemars(extend("exclusiveMinimum" = 0, "x-unit" = "length"))]
        radius: f64,
    },
    /// The inside of a sphere. If its radius is not larger than the sensor's radius, there is no single contact point,
    /// and the trials fail.
    Dish {
        /// Radius of the dish, as a positive number.
        #[schemars(extend("exclusiveMinimum" = 0, "x-unit" = "length"))]
        radius: f64,
    },
    /// A plane.
    Plane {},
    /// The outside of a circular cylinder; the contact is on its curved side. For a cylinder, the model must be a
    /// half-space.
    Cylinder {
        /// Radius of the cylinder.
        #[schemars(extend("exclusiveMinimum" = 0, "x-unit" = "length"))]
        radius: f64,
        /// Angle between the cylinder's axis and the x axis of the skin at the contact.
        #[serde(default)]
        direction_deg: f64,
    },
    /// An ellipsoid. The contact is at the end of its third semi-axis. Unless the first two semi-axes are equal, the
    /// model must be a half-space.
    Ellipsoid {
        /// Semi-axes of the ellipsoid: along the skin's x axis and y axis at the contact, and along the normal.
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

/// Indentation of the press, and position of the contact on the skin.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PressMotionConfig {
    /// Indentation: the distance by which the sensor and the object approach each other after their first touch.
    #[schemars(extend("exclusiveMinimum" = 0, "x-unit" = "length"))]
    pub indentation: f64,
    /// Position of the contact on the skin, as two angles: the polar angle from the apex, from 0 to 180, and the
    /// azimuth from the x axis.
    #[serde(default)]
    pub contact_deg: [f64; 2],
    /// Distance by which the object moves along x after the press, without slip. Unless this distance is 0, the model
    /// must be a half-space.
    #[serde(default)]
    #[schemars(extend("x-unit" = "length"))]
    pub shift: f64,
}

/// The model that computes the displacements of the markers in the press.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "kebab-case", deny_unknown_fields)]
pub enum PressModelConfig {
    /// The cheapest model whose error is within the tolerance. If `thickness` is stated, the soft body is a layer,
    /// otherwise a half-space.
    Auto {
        /// Thickness of the soft layer on a rigid core, at most the radius of the sensor. Without this key, the sensor
        /// has no core.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        #[schemars(extend("exclusiveMinimum" = 0, "x-unit" = "length"))]
        thickness: Option<f64>,
        /// Poisson's ratio of the soft body; it must be 0.5 for a layer.
        #[serde(default = "half")]
        #[schemars(extend("minimum" = 0, "maximum" = 0.5))]
        poisson: f64,
        /// Largest error of a marker's displacement, relative to the largest displacement of this press.
        #[serde(default = "millionth")]
        #[schemars(extend("exclusiveMinimum" = 0))]
        tolerance: f64,
        /// Young's modulus of the soft body, kPa. If it is stated, the tables contain the contact force.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        #[schemars(extend("exclusiveMinimum" = 0))]
        modulus_kpa: Option<f64>,
    },
    /// Hertz contact. All markers move like the surface of the skin, even if they are below the surface.
    Hertz {
        /// Poisson's ratio of the soft body.
        #[serde(default = "half")]
        #[schemars(extend("minimum" = 0, "maximum" = 0.5))]
        poisson: f64,
        /// Young's modulus of the soft body, kPa. If it is stated, the tables contain the contact force.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        #[schemars(extend("exclusiveMinimum" = 0))]
        modulus_kpa: Option<f64>,
    },
    /// Hertz contact on an elastic half-space. The displacements at the markers' depth are computed in closed form.
    HalfSpace {
        /// Poisson's ratio of the soft body.
        #[serde(default = "half")]
        #[schemars(extend("minimum" = 0, "maximum" = 0.5))]
        poisson: f64,
        /// Young's modulus of the soft body, kPa. If it is stated, the tables contain the contact force.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        #[schemars(extend("exclusiveMinimum" = 0))]
        modulus_kpa: Option<f64>,
    },
    /// An incompressible layer that is bonded to a rigid core. The contact is computed numerically.
    BondedLayer {
        /// Thickness of the layer, at most the radius of the sensor.
        #[schemars(extend("exclusiveMinimum" = 0, "x-unit" = "length"))]
        thickness: f64,
        /// Young's modulus of the soft body, kPa. If it is stated, the tables contain the contact force.
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
    /// Thickness of the layer; `None` if the model has no layer.
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

    /// Young's modulus of the soft body, kPa; `None` if it is not stated.
    pub fn modulus_kpa(&self) -> Option<f64> {
        match *self {
            Self::Auto { modulus_kpa, .. }
            | Self::Hertz { modulus_kpa, .. }
            | Self::HalfSpace { modulus_kpa, .. }
            | Self::BondedLayer { modulus_kpa, .. } => modulus_kpa,
        }
    }

    /// The reference model, from which the errors of cheaper models are measured. For `auto`, it is the most accurate
    /// model of the same soft body: the bonded layer if the body is a layer, otherwise the half-space. Any other model
    /// is its own reference.
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

/// Errors of the sensor's readings; an error that is not stated is 0.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PressNoiseConfig {
    /// Error of each marker's normal displacement. If the sensor has a camera, this error is added to the error of the
    /// images.
    pub normal_displacement: Option<ReadingNoise<Length>>,
    /// Error of each of the two components of a marker's displacement along the skin. If the sensor has a camera, this
    /// error is added to the error of the images.
    pub tangential_displacement: Option<ReadingNoise<Length>>,
    /// Error of the indentation that the estimator receives.
    pub indentation: Option<ReadingNoise<Length>>,
    /// Constant error that all normal displacements share.
    #[schemars(extend("x-unit" = "length"))]
    pub normal_bias: Option<f64>,
    /// Constant error of the indentation that the estimator receives.
    #[schemars(extend("x-unit" = "length"))]
    pub indentation_bias: Option<f64>,
    /// Error of the gain, drawn for each press. The gain is a factor on all normal displacements of a press; without
    /// error, it is 1.
    pub gain: Option<ReadingNoise<Pure>>,
    /// Markers that have a large error in addition to the other errors. Each trial chooses them anew at random.
    pub wrong_markers: Option<WrongMarkers>,
    /// Error of the red, green and blue value of each pixel in a rendered frame, in grey levels. The brightest level is
    /// 255.
    pub pixel: Option<ReadingNoise<Level>>,
    /// Error of each marker's hue, in turns. A marker has two hues, the hue of its summed light and the mean hue of its
    /// pixels; both have the same error. Only for a sensor of the kind `projected`.
    pub hue: Option<ReadingNoise<Pure>>,
    /// Error of each coordinate of a marker's centroid, in pixels. Only for a sensor of the kind `projected`.
    pub centroid: Option<ReadingNoise<Pure>>,
    /// Relative error of each marker's size in the image. Only for a sensor of the kind `projected`.
    pub size: Option<ReadingNoise<Pure>>,
    /// Markers that are missing in the pressed frame. Each trial chooses them anew at random.
    pub lost_markers: Option<LostMarkers>,
    /// Differences between a camera sensor and its calibration. Each trial draws new sensor parameters, new frames
    /// without a press, and new misalignments of the discs. The estimator `image` uses the standard deviations in this
    /// table as its prior.
    pub sensor: Option<SensorNoise>,
}

/// Standard deviations of the differences between the sensor's parameters and their calibrated values. A standard
/// deviation that is not stated is 0.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct SensorNoise {
    /// Standard deviation of each coordinate of the image's centre, in pixels. This error also represents small errors
    /// of the camera's direction.
    #[schemars(extend("minimum" = 0))]
    pub centre_px: f64,
    /// Relative standard deviation of the image scale, that is, of the pixels per radian.
    #[schemars(extend("minimum" = 0, "x-unit" = "1"))]
    pub scale: f64,
    /// Standard deviation of each coordinate of the camera's position.
    #[schemars(extend("minimum" = 0, "x-unit" = "length"))]
    pub place: f64,
    /// Standard deviation of the camera's rotation about each of the three axes.
    #[schemars(extend("minimum" = 0))]
    pub turn_deg: f64,
    /// Standard deviation of the error of the discs' depth. All magenta discs have the same error, and all yellow discs
    /// have another common error.
    #[schemars(extend("minimum" = 0, "x-unit" = "length"))]
    pub disc_depth: f64,
    /// Standard deviation of the relative error of the discs' diameter. All magenta discs have the same error, and all
    /// yellow discs have another common error.
    #[schemars(extend("minimum" = 0, "x-unit" = "1"))]
    pub disc_diameter: f64,
    /// Standard deviation of the errors of the discs' transmittances, that is, of the shares of red, green and blue
    /// light that they transmit. Discs of one colour have the same errors.
    #[schemars(extend("minimum" = 0, "x-unit" = "1"))]
    pub colour: f64,
}

/// Distribution of the error of a reading. `S` is the type of its standard deviation: a length, a pure number or a grey
/// level.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "kebab-case", deny_unknown_fields)]
pub enum ReadingNoise<S> {
    /// Gaussian error with mean 0.
    Gaussian {
        /// Standard deviation of the reading's error.
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

/// A grey level. The brightest level is 255.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(transparent)]
#[schemars(extend("minimum" = 0, "maximum" = 255, "x-unit" = "1"))]
pub struct Level(pub f64);

/// Markers that are missing in the pressed frame.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct LostMarkers {
    /// Number of missing markers. Each trial chooses the missing markers anew at random.
    pub count: u32,
}

/// Markers with a large additional error, for example because the tracker confused them with other markers.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct WrongMarkers {
    /// Number of markers with the additional error. Each trial chooses these markers anew at random.
    pub count: u32,
    /// Standard deviation of the additional Gaussian error. It applies to the normal displacement and to both
    /// components along the skin.
    #[schemars(extend("minimum" = 0, "x-unit" = "length"))]
    pub std: f64,
}
