//! The config of a sensor with markers under its skin: its sphere, the layout of its markers, and its camera.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::schema::{number, whole};

/// The soft sensor that is pressed onto the object.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "kebab-case", deny_unknown_fields)]
pub enum PressProbeConfig {
    /// A soft sphere with markers under its skin, or a flat soft pad.
    MarkerSphere {
        /// Radius of the skin; `inf` for a flat pad. A flat pad has no camera, and its layout must place the markers in
        /// x and y.
        #[serde(with = "super::infinite_length")]
        #[schemars(with = "f64", extend("exclusiveMinimum" = 0, "x-unit" = "length", "x-infinite" = true))]
        radius: f64,
        /// Depth of the markers under the skin, less than the radius. If a marker consists of two discs, this is the
        /// mean depth of the discs.
        #[schemars(extend("minimum" = 0, "x-unit" = "length"))]
        marker_depth: f64,
        /// Positions of the markers along the skin: the name of a layout, or a table that describes a layout.
        #[serde(default)]
        layout: LayoutConfig,
        /// The two coloured discs that form each marker. A camera sees only these discs, so a sensor with a camera
        /// needs them.
        discs: Option<DiscsConfig>,
        /// Number of steps in which the outline of a gore is computed, from the apex to the equator. Gores are the flat
        /// pieces from which the skin is made.
        #[serde(default = "whole::<24>")]
        #[schemars(extend("minimum" = 1, "maximum" = 1000))]
        outline_samples: u32,
    },
}

/// The two discs of each marker.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct DiscsConfig {
    /// Diameter of the magenta disc.
    #[schemars(extend("exclusiveMinimum" = 0, "x-unit" = "length"))]
    pub magenta_diameter: f64,
    /// Diameter of the yellow disc.
    #[schemars(extend("exclusiveMinimum" = 0, "x-unit" = "length"))]
    pub yellow_diameter: f64,
    /// Distance between the two discs along the normal of the skin. `marker_depth` is the depth of the point midway
    /// between the discs.
    #[serde(default)]
    #[schemars(extend("minimum" = 0, "x-unit" = "length"))]
    pub separation: f64,
    /// Colour of the marker's disc that is nearer to the camera.
    #[serde(default, skip_serializing_if = "DiscColour::is_magenta")]
    pub inner: DiscColour,
    /// Largest offset between the two discs of a marker along the skin, as a share of the diameter of the yellow disc.
    /// The offsets are random, and are drawn once for each seed.
    #[serde(default)]
    #[schemars(extend("minimum" = 0, "maximum" = 1, "x-unit" = "1"))]
    pub misalignment: f64,
    /// Ratio of the strain of a disc to the strain of the skin: 0 for rigid discs, 1 for discs as soft as the skin. A
    /// strained disc stays a circle, but its area changes. The misalignment of the discs changes with the strain of the
    /// skin. By default, strain of the discs is not simulated. This key requires an incompressible skin.
    #[schemars(extend("minimum" = 0, "maximum" = 1, "x-unit" = "1"))]
    pub strain: Option<f64>,
    /// Ratio of the strain of a yellow disc to the strain of the skin. The default is `strain`. If this key is stated,
    /// `strain` applies only to the magenta discs.
    #[schemars(extend("minimum" = 0, "maximum" = 1, "x-unit" = "1"))]
    pub yellow_strain: Option<f64>,
}

impl DiscsConfig {
    /// Ratios of the strain of the magenta disc and of the yellow disc to the strain of the skin; `None` if the strain
    /// of the discs is not modelled.
    pub fn strains(&self) -> Option<[f64; 2]> {
        let magenta = self.strain.or(self.yellow_strain.map(|_| 0.0))?;
        Some([magenta, self.yellow_strain.unwrap_or(magenta)])
    }
}

/// Colour of a marker's disc.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum DiscColour {
    /// The magenta disc.
    #[default]
    Magenta,
    /// The yellow disc.
    Yellow,
}

impl DiscColour {
    // The parameter is a reference because `skip_serializing_if` requires one.
    #[allow(clippy::trivially_copy_pass_by_ref)]
    fn is_magenta(&self) -> bool {
        *self == Self::Magenta
    }
}

/// Positions of the markers along the skin: the name of a layout, or a table that describes a layout.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum LayoutConfig {
    /// The name of a layout of markers.
    Named(NamedLayout),
    /// A table that describes a layout of markers.
    Table(LayoutTable),
}

impl Default for LayoutConfig {
    fn default() -> Self {
        Self::Named(NamedLayout::Published)
    }
}

/// The name of a layout of markers.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum NamedLayout {
    /// The 77 markers of the sensor of Lin and others (2020). One marker is at the apex. Each of 4 gores has rows of 1,
    /// 3, 3, 5 and 7 markers, and neighbouring rows are 11.9° apart.
    Published,
}

/// A table that describes a layout of markers.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "kebab-case", deny_unknown_fields)]
pub enum LayoutTable {
    /// A marker at the apex, and the same rows of markers in every gore. Gores are the flat pieces from which the skin
    /// is made.
    Gores {
        /// Number of gores around the apex.
        #[schemars(extend("minimum" = 1))]
        gores: u32,
        /// Numbers of markers in the rows of a gore, from the apex outward.
        rows: Vec<u32>,
        /// Polar angle between neighbouring rows, seen from the sensor's centre.
        #[schemars(extend("exclusiveMinimum" = 0, "maximum" = 180))]
        row_spacing_deg: f64,
    },
    /// Markers with uniform density over a cap around the apex.
    Lattice {
        /// Distance between neighbouring markers.
        #[schemars(extend("exclusiveMinimum" = 0, "x-unit" = "length"))]
        pitch: f64,
        /// Angle between the rim of the cap and the apex, seen from the sensor's centre.
        #[schemars(extend("exclusiveMinimum" = 0, "maximum" = 180))]
        cap_deg: f64,
    },
    /// Markers on a rectangular grid along x and y, with the apex in its middle.
    Grid {
        /// Distance between neighbouring markers.
        #[schemars(extend("exclusiveMinimum" = 0, "x-unit" = "length"))]
        pitch: f64,
        /// Distance between the outermost markers of a row, along x. It is rounded down to a multiple of the pitch.
        #[schemars(extend("minimum" = 0, "x-unit" = "length"))]
        width: f64,
        /// Distance between the outermost markers of a column, along y. It is rounded down to a multiple of the pitch.
        #[schemars(extend("minimum" = 0, "x-unit" = "length"))]
        height: f64,
    },
    /// Markers at equal distances on a great circle along x, with the apex in their middle.
    Line(MarkerRow),
    /// Markers at equal distances along x, with the first marker at the apex.
    Radius(MarkerRow),
}

/// Markers at equal distances along a line on the skin.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct MarkerRow {
    /// Number of markers on the line.
    #[schemars(extend("minimum" = 2, "maximum" = 100_000))]
    pub markers: u32,
    /// Distance from the first marker to the last marker along the skin.
    #[schemars(extend("exclusiveMinimum" = 0, "x-unit" = "length"))]
    pub length: f64,
}

/// The sensor that measures the displacements of the markers.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "kebab-case", deny_unknown_fields)]
pub enum PressSensorConfig {
    /// A sensor that reads the displacement of every marker directly, without a camera.
    Direct {
        /// Whether the sensor reads displacements along the skin, in addition to normal displacements.
        #[serde(default = "yes")]
        tangential: bool,
        /// Number of readings that are averaged. The noise of displacements is divided by the square root of this
        /// number.
        #[serde(default = "whole::<1>")]
        #[schemars(extend("minimum" = 1))]
        frames: u32,
    },
    /// A camera in the centre of the sensor. The image of each marker is computed without rendering pixels.
    Projected(CameraConfig),
    /// A camera in the centre of the sensor. Camera frames are rendered, and the markers are detected and tracked in
    /// these frames.
    Rendered(CameraConfig),
}

impl Default for PressSensorConfig {
    fn default() -> Self {
        Self::Direct {
            tangential: true,
            frames: 1,
        }
    }
}

impl PressSensorConfig {
    /// The camera, and whether the sensor renders frames; `None` if the sensor reads the markers without a camera.
    pub const fn camera(&self) -> Option<(&CameraConfig, bool)> {
        match self {
            Self::Projected(camera) => Some((camera, false)),
            Self::Rendered(camera) => Some((camera, true)),
            _ => None,
        }
    }
}

/// The camera, and the method that computes displacements from its images. The camera has a fisheye lens. If `k3` and
/// `k5` are 0, the distance of an image point from the image's centre is proportional to the polar angle, that is, the
/// angle from the camera's axis.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CameraConfig {
    /// Number of pixels along each side of the square image.
    #[serde(default = "whole::<640>")]
    #[schemars(extend("minimum" = 1, "maximum" = 8192))]
    pub size_px: u32,
    /// Largest polar angle that the camera images. A point at this angle appears at the rim of the image circle, which
    /// is the largest circle that fits into the image.
    #[serde(default = "number::<65>")]
    #[schemars(extend("exclusiveMinimum" = 0, "maximum" = 180))]
    pub field_deg: f64,
    /// Third-order term of the fisheye lens. A polar angle θ, in rad, appears at the distance f (θ + k3 θ³ + k5 θ⁵)
    /// from the image's centre. For any k3 and k5, f is chosen so that `field_deg` appears at the rim of the image
    /// circle.
    #[serde(default, skip_serializing_if = "is_zero")]
    #[schemars(extend("minimum" = -100, "maximum" = 100, "x-unit" = "1"))]
    pub k3: f64,
    /// Fifth-order term k5 of the fisheye lens; see `k3`.
    #[serde(default, skip_serializing_if = "is_zero")]
    #[schemars(extend("minimum" = -100, "maximum" = 100, "x-unit" = "1"))]
    pub k5: f64,
    /// Brightness at the rim of the image circle, as a share of the brightness in the middle. Only for a sensor of the
    /// kind `rendered`.
    #[serde(default = "number::<1>")]
    #[schemars(extend("exclusiveMinimum" = 0, "maximum" = 1, "x-unit" = "1"))]
    pub light_at_rim: f64,
    /// Standard deviation of the Gaussian blur of the image, in pixels. Only for a sensor of the kind `rendered`.
    #[serde(default)]
    #[schemars(extend("minimum" = 0))]
    pub blur_px: f64,
    /// Width of the seams between the gores, which are the flat pieces from which the skin is made. Only for a sensor
    /// of the kind `rendered` whose layout has gores.
    #[serde(default)]
    #[schemars(extend("minimum" = 0, "x-unit" = "length"))]
    pub seam_width: f64,
    /// Position of the camera relative to the sensor's centre: the components along x, along y, and towards the apex.
    /// By default, the camera is at the centre.
    #[serde(default, skip_serializing_if = "is_default")]
    #[schemars(extend("x-unit" = "length"))]
    pub place: [f64; 3],
    /// Rotation of the camera as a rotation vector: the components about x, about y, and about the axis towards the
    /// apex. By default, the camera points at the apex.
    #[serde(default, skip_serializing_if = "is_default")]
    pub turn_deg: [f64; 3],
    /// Feature of a marker's image (hue, size or both) from which the marker's normal displacement is computed.
    #[serde(default)]
    pub normal_from: NormalFrom,
    /// Calibration of the sensor with presses on a plane.
    #[serde(default)]
    pub calibration: CalibrationConfig,
    /// Whether the sensor reads displacements along the skin, in addition to normal displacements.
    #[serde(default = "yes")]
    pub tangential: bool,
    /// Number of frames of a press that are averaged.
    #[serde(default = "whole::<1>")]
    #[schemars(extend("minimum" = 1))]
    pub frames: u32,
}

fn is_default(numbers: &[f64; 3]) -> bool {
    *numbers == [0.0; 3]
}

fn yes() -> bool {
    true
}

/// Feature of a marker's image (hue, size or both) from which the marker's normal displacement is computed.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum NormalFrom {
    /// The hue of the marker's summed light, that is, of the sum over its pixels. The hue depends on the difference
    /// between the displacements of the marker's two discs.
    Hue,
    /// The size of the marker in the image. It depends on the marker's distance from the camera.
    Size,
    /// Both hue and size, with weights from the calibration.
    #[default]
    Both,
}

/// Calibration of the sensor by presses on a plane. The apex touches the plane.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct CalibrationConfig {
    /// Number of calibration presses. Their indentations increase in equal steps.
    #[schemars(extend("minimum" = 2, "maximum" = 1000))]
    pub presses: u32,
    /// Indentation of the deepest calibration press; by default the indentation of the scene.
    #[schemars(extend("exclusiveMinimum" = 0, "x-unit" = "length"))]
    pub indentation: Option<f64>,
    /// Number of frames without a press that are averaged. The noise of these frames and of the calibration presses is
    /// drawn once. Therefore, these frames and presses have the same errors in all trials.
    #[schemars(extend("minimum" = 1, "maximum" = 1000))]
    pub rest_frames: u32,
    /// Markers whose normal displacement is used in the calibration.
    pub markers: ShownMarkers,
}

impl Default for CalibrationConfig {
    fn default() -> Self {
        Self {
            presses: 7,
            indentation: None,
            rest_frames: 16,
            markers: ShownMarkers::default(),
        }
    }
}

/// Markers whose normal displacement is used in the calibration.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum ShownMarkers {
    /// All markers. Their true displacements come from the contact model.
    #[default]
    All,
    /// Only the marker under the contact, as in the paper of Lin and others (2020).
    UnderContact,
}

/// A sensor without an object. The study computes two properties of the sensor: the area of one marker's image, and the
/// strain that arises when the flat pieces of the skin are folded into a sphere.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct BareFingertipConfig {
    /// The sensor: a sphere with markers under its skin, as for a press.
    pub probe: PressProbeConfig,
    /// The camera in the centre of the sensor, which images the marker.
    #[serde(default)]
    pub sensor: LensConfig,
    /// Position of the marker whose image is computed.
    #[serde(default)]
    pub view: ViewConfig,
}

/// A camera in the sensor's centre.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct LensConfig {
    /// Type of the lens, that is, the relation between polar angles and distances in the image.
    pub lens: LensName,
    /// Number of pixels along each side of the square image.
    #[schemars(extend("minimum" = 1, "maximum" = 8192))]
    pub size_px: u32,
    /// Largest polar angle that the camera images. A point at this angle appears at the rim of the image circle, which
    /// is the largest circle that fits into the image. For a pinhole camera, it must be less than 90.
    #[schemars(extend("exclusiveMinimum" = 0, "maximum" = 180))]
    pub field_deg: f64,
}

impl Default for LensConfig {
    fn default() -> Self {
        Self {
            lens: LensName::default(),
            size_px: 640,
            field_deg: 65.0,
        }
    }
}

/// Type of the lens, that is, the relation between polar angles and distances in the image.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum LensName {
    /// A lens for which the distance of an image point from the image's centre is proportional to the polar angle.
    #[default]
    Fisheye,
    /// A lens for which the distance of an image point from the image's centre is proportional to the tangent of the
    /// polar angle.
    Pinhole,
}

/// Position of the marker whose image is computed.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ViewConfig {
    /// Polar angle of the marker from the apex.
    #[serde(default)]
    #[schemars(extend("minimum" = 0, "maximum" = 180))]
    pub polar_deg: f64,
}

// The parameter is a reference because `skip_serializing_if` requires one.
#[allow(clippy::trivially_copy_pass_by_ref)]
fn is_zero(number: &f64) -> bool {
    *number == 0.0
}
