//! Report of a camera that was estimated from a frame at rest.

use palpate_statistics::Number;
use palpate_study::Warning;
use palpate_study::config::LengthUnit;
use serde::{Deserialize, Serialize};

/// A camera, estimated from its markers at rest.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CameraEstimate {
    /// Unit of lengths.
    pub length_unit: LengthUnit,
    /// Position relative to the sensor's centre: along the axes at the apex, and toward the apex.
    pub place: [f64; 3],
    /// Its standard deviations.
    pub place_std: [f64; 3],
    /// Turn about these axes, degrees.
    pub turn_deg: [f64; 3],
    /// Its standard deviations.
    pub turn_std_deg: [f64; 3],
    /// Focal length f of the fisheye, px per radian: a ray at θ to its axis is seen f (θ + k3 θ³ + k5 θ⁵) px
    /// off-centre.
    pub px_per_rad: f64,
    /// Its standard deviation.
    pub px_per_rad_std: f64,
    /// Odd term of the third power; the study's value if the frame does not determine it.
    #[serde(default)]
    pub k3: f64,
    /// Its standard deviation; absent where the frame does not determine it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub k3_std: Option<f64>,
    /// Odd term of the fifth power, likewise.
    #[serde(default)]
    pub k5: f64,
    /// Its standard deviation.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub k5_std: Option<f64>,
    /// Middle of the image, px.
    pub centre_px: [f64; 2],
    /// Covariance of, in this order: both coordinates of the image centre, px; px per radian, relative; place,
    /// length; turn, rad; odd terms that the frame determines.
    pub covariance: Vec<Vec<f64>>,
    /// Root mean square distance of the markers' centroids from their expected positions, px.
    pub residual_px: f64,
    /// Distance for each marker of the layout that is seen.
    pub residuals_px: Vec<Residual>,
    /// Chi-squared of the frame per degree of freedom: about 1 if the model is right.
    pub reduced_chi_squared: f64,
    /// Warnings about the camera.
    pub warnings: Vec<Warning>,
}

impl CameraEstimate {
    /// The camera as TOML.
    pub fn to_toml(&self) -> String {
        toml::to_string(self).expect("numbers, words and tables of them have a TOML form")
    }

    /// The camera in words.
    pub fn summary(&self) -> String {
        let number = |value: f64| Number::rounded(value).to_string();
        let term = |name: &str, value: f64, std: Option<f64>| match std {
            Some(std) => format!("{name} {} +- {}", number(value), number(std)),
            None => format!(
                "{name} {} as stated (the frame does not tell it)",
                number(value)
            ),
        };
        let three = |values: [f64; 3]| values.map(number).join(", ");
        format!(
            "camera at ({}) +- ({}) {} from the centre, turned by ({}) +- ({}) deg, {} +- {} px per rad, {}, {}; {} markers, {} px from where they should be seen",
            three(self.place),
            three(self.place_std),
            self.length_unit.as_str(),
            three(self.turn_deg),
            three(self.turn_std_deg),
            number(self.px_per_rad),
            number(self.px_per_rad_std),
            term("k3", self.k3, self.k3_std),
            term("k5", self.k5, self.k5_std),
            self.residuals_px.len(),
            number(self.residual_px)
        )
    }
}

/// Distance of a marker's centroid from its expected position.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Residual {
    /// The marker, by its number in the layout, from 0.
    pub marker: usize,
    /// The distance, px.
    pub px: f64,
}
