//! Cameras as TOML files.

use std::path::Path;

use nalgebra::DMatrix;
use palpate_statistics::Number;

use super::super::error::RecordedError;
use super::super::file::RecordedFile;
use super::camera_report::CameraEstimate;
use super::layout_matching::CAMERA;

/// Largest relative difference between a standard deviation and the covariance. It is not zero, because the
/// covariance divides px per rad by a slightly different scale.
const ROUNDING: f64 = 0.1;

/// Reads a camera from a file, as [`parse_camera`].
///
/// # Errors
/// Errors of [`parse_camera`], and of a file that cannot be read.
pub fn read_camera(path: &Path) -> Result<CameraEstimate, RecordedError> {
    parse_camera(&RecordedFile::read(path)?)
}

/// A camera as [`CameraEstimate::to_toml`] writes it.
///
/// # Errors
/// [`RecordedError::File`] for a calibration of displacements, a field that is missing or unknown, a number that is
/// not finite, a scale or a standard deviation that is not positive, and a matrix that is no covariance or
/// contradicts the standard deviations.
pub fn parse_camera(file: &RecordedFile) -> Result<CameraEstimate, RecordedError> {
    let text =
        file.text("a camera is needed, as `sensor calibrate` writes it from a frame at rest")?;
    let kinds = kinds_of_calibration(text);
    if !kinds.is_empty() {
        return Err(file.error(format!(
            "is a calibration of displacements (`{}`); the method image takes the camera that `sensor calibrate` writes from a frame at rest",
            kinds.join("`, `")
        )));
    }
    let camera: CameraEstimate = toml::from_str(text).map_err(|error| {
        let message = error.to_string();
        file.error(format!("is no camera: {}", message.trim_end()))
    })?;
    check(&camera).map_err(|message| file.error(message))?;
    Ok(camera)
}

/// Tables of a displacement calibration that a text contains.
fn kinds_of_calibration(text: &str) -> Vec<&'static str> {
    let table: toml::Table = text.parse().unwrap_or_default();
    let parts = ["normal", "lateral"].into_iter();
    parts.filter(|part| table.contains_key(*part)).collect()
}

/// Whether a text describes a camera.
pub(crate) fn is_camera(text: &str) -> bool {
    let table: toml::Table = text.parse().unwrap_or_default();
    ["place", "turn_deg", "px_per_rad", "centre_px"]
        .iter()
        .all(|key| table.contains_key(*key))
}

fn check(camera: &CameraEstimate) -> Result<(), String> {
    let named = |name: &'static str, numbers: &[f64]| {
        let all = numbers.iter().enumerate();
        let several = numbers.len() > 1;
        all.map(move |(at, number)| match several {
            true => (format!("{name}[{at}]"), *number),
            false => (name.to_owned(), *number),
        })
        .collect::<Vec<_>>()
    };
    let residuals: Vec<f64> = camera.residuals_px.iter().map(|one| one.px).collect();
    let stds = [
        named("place_std", &camera.place_std),
        named("turn_std_deg", &camera.turn_std_deg),
        named("px_per_rad_std", &[camera.px_per_rad_std]),
        named("px_per_rad", &[camera.px_per_rad]),
        named("k3_std", camera.k3_std.as_slice()),
        named("k5_std", camera.k5_std.as_slice()),
    ]
    .concat();
    let others = [
        named("place", &camera.place),
        named("turn_deg", &camera.turn_deg),
        named("centre_px", &camera.centre_px),
        named("k3", &[camera.k3]),
        named("k5", &[camera.k5]),
        named("residual_px", &[camera.residual_px]),
        named("reduced_chi_squared", &[camera.reduced_chi_squared]),
        named("residuals_px", &residuals),
    ]
    .concat();
    for (name, number) in others {
        let is_good = number.abs() <= 1e50;
        if !is_good {
            return Err(format!("`{name}` is {}; it must be finite", Number(number)));
        }
    }
    for (name, number) in stds {
        let is_good = number > 0.0 && number <= 1e50;
        if !is_good {
            return Err(format!(
                "`{name}` is {}; it must be finite and > 0",
                Number(number)
            ));
        }
    }
    let of_terms = [camera.k3_std, camera.k5_std];
    if of_terms[0].is_none() && of_terms[1].is_some() {
        return Err("`k5_std` is stated without `k3_std`".to_owned());
    }
    let size = CAMERA.len() - of_terms.iter().filter(|std| std.is_none()).count();
    let is_square =
        camera.covariance.len() == size && camera.covariance.iter().all(|row| row.len() == size);
    if !is_square {
        return Err(format!(
            "`covariance` must have {size} rows of {size} numbers"
        ));
    }
    let covariance = camera.covariance();
    let scale = covariance.amax();
    let is_symmetric = (&covariance - covariance.transpose()).amax() <= 1e-9 * scale;
    let stds = covariance.map_diagonal(f64::sqrt);
    let shares = DMatrix::from_fn(size, size, |row, column| {
        covariance[(row, column)] / (stds[row] * stds[column])
    });
    if !is_symmetric || shares.cholesky().is_none() {
        return Err("`covariance` is none: it must be symmetric and positive definite".to_owned());
    }
    let stated = [camera.px_per_rad_std / camera.px_per_rad]
        .into_iter()
        .chain(camera.place_std)
        .chain(camera.turn_std_deg.map(f64::to_radians))
        .chain(of_terms.into_iter().flatten());
    for (entry, stated) in (2..size).zip(stated) {
        let std = stds[entry];
        if (std - stated).abs() > ROUNDING * stated {
            return Err(format!(
                "`covariance[{entry}][{entry}]` is that of a standard deviation of {}, but {} is stated",
                Number::rounded(std),
                Number::rounded(stated)
            ));
        }
    }
    Ok(())
}

impl CameraEstimate {
    /// Covariance of the camera's numbers.
    pub(crate) fn covariance(&self) -> DMatrix<f64> {
        let size = self.covariance.len();
        DMatrix::from_fn(size, size, |row, column| self.covariance[row][column])
    }
}
