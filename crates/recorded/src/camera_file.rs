//! A camera that was estimated from a frame at rest, and its TOML file.

use nalgebra::DMatrix;
use palpate_statistics::Number;
use palpate_study::Warning;
use palpate_study::config::LengthUnit;
use serde::{Deserialize, Serialize};

use super::error::RecordedError;
use super::file::RecordedFile;
use super::layout_matching::CAMERA;

/// A camera estimated from the markers in a frame at rest.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CameraEstimate {
    /// Unit of all lengths in this estimate.
    pub length_unit: LengthUnit,
    /// Position of the camera relative to the sensor's centre (length). The first two coordinates are along the x and y
    /// axes of the skin at the apex; the third is toward the apex.
    pub place: [f64; 3],
    /// Standard errors of the camera's position `place` (length).
    pub place_std: [f64; 3],
    /// Rotation vector of the camera (degrees). Its components are along the x and y axes of the skin at the apex, and
    /// toward the apex.
    pub turn_deg: [f64; 3],
    /// Standard errors of the camera's rotation `turn_deg`, degrees.
    pub turn_std_deg: [f64; 3],
    /// Focal length f of the fisheye lens, px per radian. A ray at the angle θ to the camera's axis meets the image at
    /// the distance f (θ + k3 θ³ + k5 θ⁵) px from the image centre.
    pub px_per_rad: f64,
    /// Standard error of `px_per_rad`.
    pub px_per_rad_std: f64,
    /// Coefficient k3 of the lens, estimated from the frame. If the frame does not determine k3, this is the value in
    /// the study.
    #[serde(default)]
    pub k3: f64,
    /// Standard error of `k3`; `None` if the frame does not determine k3.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub k3_std: Option<f64>,
    /// Coefficient k5 of the lens, estimated from the frame. If the frame does not determine k5, this is the value in
    /// the study.
    #[serde(default)]
    pub k5: f64,
    /// Standard error of `k5`; `None` if the frame does not determine k5.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub k5_std: Option<f64>,
    /// Image centre, px: the point where the camera's axis meets the image.
    pub centre_px: [f64; 2],
    /// Covariance of the camera's parameters. The order is: both coordinates of the image centre (px), pixels per
    /// radian (relative), `place` (length), `turn_deg` (in rad), followed by the lens coefficients k3 and k5 if the
    /// frame determines them.
    pub covariance: Vec<Vec<f64>>,
    /// Root mean square distance of the markers' centroids from their expected positions (px).
    pub residual_px: f64,
    /// Residual of each marker of the layout that was found in the frame.
    pub residuals_px: Vec<Residual>,
    /// χ² of the fit per degree of freedom. It is about 1 if the model is right.
    pub reduced_chi_squared: f64,
    /// Warnings about the estimated camera.
    pub warnings: Vec<Warning>,
}

impl CameraEstimate {
    pub(super) fn covariance(&self) -> DMatrix<f64> {
        let size = self.covariance.len();
        DMatrix::from_fn(size, size, |row, column| self.covariance[row][column])
    }

    /// The camera as the text of a TOML file.
    pub fn to_toml(&self) -> String {
        toml::to_string(self).expect("numbers, words and tables of them have a TOML form")
    }

    /// The camera as a text for users.
    pub fn summary(&self) -> String {
        let number = |value: f64| Number::rounded(value).to_string();
        let term = |name: &str, value: f64, std: Option<f64>| match std {
            Some(std) => format!("{name} {} +- {}", number(value), number(std)),
            None => format!(
                "{name} {} as stated (the frame does not determine it)",
                number(value)
            ),
        };
        let three = |values: [f64; 3]| values.map(number).join(", ");
        format!(
            "camera at ({}) +- ({}) {} from the centre, rotated by ({}) +- ({}) deg, {} +- {} px per rad, {}, {}; {} markers, on average {} px from their expected positions",
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

/// Distance in the image between a marker's centroid and the position that the fitted camera predicts.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Residual {
    /// Index of the marker in the layout, from 0.
    pub marker: usize,
    /// Distance between the observed and the predicted centroid of the marker (px).
    pub px: f64,
}

/// Reads a camera from a file that [`CameraEstimate::to_toml`] wrote.
///
/// # Errors
/// [`RecordedError::File`] if the file is a calibration of displacements instead of a camera. The same error if a field
/// is missing or unknown, if a number is not finite, if the scale or a standard error is not positive, or if the matrix
/// is no covariance or contradicts the standard errors.
impl TryFrom<&RecordedFile> for CameraEstimate {
    type Error = RecordedError;

    fn try_from(file: &RecordedFile) -> Result<Self, RecordedError> {
        let text =
            file.text("a camera is needed, as `sensor calibrate` writes it from a frame at rest")?;
        let table: toml::Table = text.parse().unwrap_or_default();
        let parts = ["normal", "lateral"];
        if let Some(part) = parts.iter().find(|part| table.contains_key(**part)) {
            return Err(file.error(format!(
            "is a calibration of displacements (`{part}`); the method image takes the camera that `sensor calibrate` writes from a frame at rest"
        )));
        }
        let camera: CameraEstimate = toml::from_str(text).map_err(|error| {
            let message = error.to_string();
            file.error(format!("is no camera: {}", message.trim_end()))
        })?;
        check(&camera).map_err(|message| file.error(message))?;
        Ok(camera)
    }
}

pub(super) fn is_camera(text: &str) -> bool {
    let table: toml::Table = text.parse().unwrap_or_default();
    let mut keys = ["place", "turn_deg", "px_per_rad", "centre_px"].iter();
    keys.all(|key| table.contains_key(*key))
}

/// Largest accepted relative difference between a standard error in the file and the standard error that follows from
/// the file's covariance. Small differences occur, because the covariance of `px_per_rad` is relative to the start
/// value of the fit, not to the estimated scale.
const ROUNDING: f64 = 0.1;

fn check(camera: &CameraEstimate) -> Result<(), String> {
    let odd_terms = [camera.k3_std, camera.k5_std];
    let [k3_std, k5_std] = odd_terms.map(|std| std.into_iter().collect());
    let numbers: [(&str, Vec<f64>); 8] = [
        ("place", camera.place.to_vec()),
        ("turn_deg", camera.turn_deg.to_vec()),
        ("centre_px", camera.centre_px.to_vec()),
        ("k3", vec![camera.k3]),
        ("k5", vec![camera.k5]),
        ("residual_px", vec![camera.residual_px]),
        ("reduced_chi_squared", vec![camera.reduced_chi_squared]),
        (
            "residuals_px",
            camera.residuals_px.iter().map(|one| one.px).collect(),
        ),
    ];
    let positive: [(&str, Vec<f64>); 6] = [
        ("place_std", camera.place_std.to_vec()),
        ("turn_std_deg", camera.turn_std_deg.to_vec()),
        ("px_per_rad_std", vec![camera.px_per_rad_std]),
        ("px_per_rad", vec![camera.px_per_rad]),
        ("k3_std", k3_std),
        ("k5_std", k5_std),
    ];
    let others = numbers.map(|named| (named, "finite", -1e50));
    let positive = positive.map(|named| (named, "finite and > 0", f64::MIN_POSITIVE));
    for ((name, numbers), expected, least) in others.into_iter().chain(positive) {
        let is_bad = |number: &f64| !(least..=1e50).contains(number);
        if let Some(at) = numbers.iter().position(is_bad) {
            let index = if numbers.len() > 1 {
                format!("[{at}]")
            } else {
                String::new()
            };
            let number = Number(numbers[at]);
            return Err(format!(
                "`{name}{index}` is {number}; it must be {expected}"
            ));
        }
    }
    if odd_terms[0].is_none() && odd_terms[1].is_some() {
        return Err("`k5_std` is stated without `k3_std`".to_owned());
    }
    let size = CAMERA.len() - odd_terms.iter().filter(|std| std.is_none()).count();
    let rows = &camera.covariance;
    if rows.len() != size || rows.iter().any(|row| row.len() != size) {
        return Err(format!(
            "`covariance` must have {size} rows of {size} numbers"
        ));
    }
    let covariance = camera.covariance();
    let is_symmetric = (&covariance - covariance.transpose()).amax() <= 1e-9 * covariance.amax();
    let stds = covariance.map_diagonal(f64::sqrt);
    let correlation = |row, column| covariance[(row, column)] / (stds[row] * stds[column]);
    let correlations = DMatrix::from_fn(size, size, correlation);
    if !is_symmetric || correlations.cholesky().is_none() {
        return Err("`covariance` must be symmetric and positive definite".to_owned());
    }
    let stated = [camera.px_per_rad_std / camera.px_per_rad]
        .into_iter()
        .chain(camera.place_std)
        .chain(camera.turn_std_deg.map(f64::to_radians))
        .chain(odd_terms.into_iter().flatten());
    for (entry, stated) in (2..size).zip(stated) {
        if (stds[entry] - stated).abs() > ROUNDING * stated {
            let [std, stated] = [stds[entry], stated].map(Number::rounded);
            return Err(format!(
                "`covariance[{entry}][{entry}]` belongs to a standard deviation of {std}, but the stated one is {stated}"
            ));
        }
    }
    Ok(())
}
