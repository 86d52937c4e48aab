//! The prior of the camera: its parameters and their uncertainty before the fit to the frames.

use nalgebra::{DMatrix, DVector};
use palpate_chromatouch::{Departure, OddTerms};
use palpate_press::DeparturePrior;
use palpate_statistics::Number;

use super::camera_calibration::compressed;
use super::camera_file::CameraEstimate;
use super::error::RecordedError;
use super::frame_pair::Frame;
use super::layout_matching::CAMERA;
use super::nominal_sensor::{CameraGeometry, NominalSensor};
use super::press_options::PictureOptions;
use palpate_estimators::departure_stds;

/// Largest accepted difference between the prior and the estimate from the frame at rest, for a single camera
/// parameter, in standard deviations of this difference. If the difference is larger, there is a warning.
const MAX_PULL: f64 = 6.0;
/// Largest accepted joint χ² of the differences between the prior and the estimate from the frame at rest, for all
/// camera parameters together. If it is larger, the camera contradicts the frame, which is an error.
const MAX_CHI_SQUARED: f64 = 200.0;
/// Largest joint χ² of the differences between prior and estimate for which there is no warning, for 9, 10 or 11 camera
/// parameters. For a correct camera, χ² exceeds this value with a probability of 1/10,000.
const WARNING_CHI_SQUARED: [f64; 3] = [33.7, 35.6, 37.4];
/// Number of camera parameters without the lens coefficients k3 and k5, which not every frame determines.
const WITHOUT_TERMS: usize = 9;
/// Largest accepted ratio of a camera parameter's standard error after the calibration to its prior standard deviation.
const MAX_STD_RATIO: f64 = 10.0;
/// Names of the camera parameters, and their units; `None` stands for the unit of length.
const NAMES: [(&str, Option<&str>); CAMERA.len()] = [
    ("centre_px[0]", Some("px")),
    ("centre_px[1]", Some("px")),
    ("px_per_rad", Some("px")),
    ("place[0]", None),
    ("place[1]", None),
    ("place[2]", None),
    ("turn_deg[0]", Some("deg")),
    ("turn_deg[1]", Some("deg")),
    ("turn_deg[2]", Some("deg")),
    ("k3", Some("")),
    ("k5", Some("")),
];

pub(super) struct CameraPrior<'a> {
    pub(super) geometry: CameraGeometry,
    /// Prior standard deviation of each sensor parameter, in the order of a [`Departure`], which contains the
    /// differences between the sensor parameters and their nominal values.
    pub(super) stds: [f64; Departure::NUMBERS],
    /// Joint prior of the camera's parameters from a calibration: their differences from the nominal values, and the
    /// covariance of these differences. `None` without a calibration.
    pub(super) departure_prior: Option<DeparturePrior>,
    file: Option<&'a str>,
    unit: &'static str,
}

impl<'a> CameraPrior<'a> {
    /// Builds the prior from the calibration file of the camera or, if there is no such file, from the study.
    pub(super) fn of(
        nominal: &NominalSensor<'_>,
        options: &'a PictureOptions,
        rest: &Frame,
    ) -> Result<Self, RecordedError> {
        let unit = options.unit.as_str();
        let Some((file, camera)) = &options.camera else {
            let geometry = nominal.geometry().map_err(|error| {
                let message = format!("{}: {}", error.path, error.message);
                RecordedError::readings(&rest.file, message)
            })?;
            let of_study = options.press.noise.sensor.as_ref();
            return Ok(Self {
                geometry,
                stds: of_study.map_or([0.0; Departure::NUMBERS], departure_stds),
                departure_prior: None,
                file: None,
                unit,
            });
        };
        let fail = |message: String| Err(RecordedError::readings(file, message));
        if camera.length_unit != options.unit {
            let own = camera.length_unit.as_str();
            return fail(format!(
                "`length_unit` is {own}; it must be {unit}, the unit of the other lengths"
            ));
        }
        let covariance = camera.covariance();
        let mut stds = nominal.stds;
        let before = nominal.with_terms(covariance.nrows() - WITHOUT_TERMS).stds;
        let scales = scales(camera);
        let determined = &CAMERA[..covariance.nrows()];
        for (entry, &number) in determined.iter().enumerate() {
            let (std, most) = (
                covariance[(entry, entry)].sqrt(),
                MAX_STD_RATIO * before[number],
            );
            if std > most {
                let [std, most] = [std, most].map(|std| Number::rounded(std * scales[entry]));
                let (name, of_number) = NAMES[entry];
                let of_number = of_number.unwrap_or(unit);
                return fail(format!(
                    "`{name}` has a standard deviation of {std} {of_number}; it must be at most {most}"
                ));
            }
            stds[number] = std;
        }
        Ok(Self {
            geometry: geometry_of(camera),
            stds,
            departure_prior: Some(DeparturePrior {
                numbers: determined.to_vec(),
                covariance,
            }),
            file: Some(file),
            unit,
        })
    }

    /// Returns a warning if the camera that was estimated from the frame at rest differs significantly from the camera
    /// of this prior.
    ///
    /// # Errors
    /// [`RecordedError::Readings`] if the difference is too large. The message states the parameter with the largest
    /// difference, and both values of this parameter.
    pub(super) fn other_camera(
        &self,
        at_rest: &CameraEstimate,
        rest: &Frame,
    ) -> Result<Option<String>, RecordedError> {
        let (own, found) = (numbers(&self.geometry), numbers(&geometry_of(at_rest)));
        let scales = scales(at_rest);
        let found_covariance = at_rest.covariance();
        // Compare only the parameters that the frame determines. Lens coefficients (k3, k5) that the frame does not
        // determine are at the end of the list and are left out.
        let count = found_covariance.nrows();
        let own_covariance = self.covariance().resize(count, count, 0.0);
        let std = |covariance: &DMatrix<f64>, entry: usize| {
            covariance[(entry, entry)].sqrt() * scales[entry]
        };
        let both = &own_covariance + &found_covariance;
        let pull = |entry: usize| ((own[entry] - found[entry]) / std(&both, entry)).abs();
        let worst = (0..count).max_by(|one, other| pull(*one).total_cmp(&pull(*other)));
        let worst = worst.unwrap_or(0);
        let is_alone = pull(worst) > MAX_PULL;
        let (name, unit) = NAMES[worst];
        let unit = unit.unwrap_or(self.unit);
        // The warning states both values of the parameter, rounded to a tenth of their difference. After coarser
        // rounding, they could look equal.
        let digit = 0.1 * (own[worst] - found[worst]);
        let with_std = |value: f64, std: f64| {
            let value = known_to(value, digit);
            let std = match std > 0.0 {
                true => format!(" +- {}", Number::rounded(std)),
                false => String::new(),
            };
            format!("{value}{std} {unit}").trim_end().to_owned()
        };
        let name = match self.file {
            Some(_) => format!("`{name}`"),
            None => format!("{name} of the camera in `scene.sensor`"),
        };
        let mut difference = format!(
            "{name} is {}, but {} shows {}",
            with_std(own[worst], std(&own_covariance, worst)),
            rest.file,
            with_std(found[worst], std(&found_covariance, worst))
        );
        let apart = DVector::from_fn(count, |entry, _| {
            (own[entry] - found[entry]) / scales[entry]
        });
        // The errors of the parameters are correlated. So all parameters together may contradict the frame although
        // each single parameter agrees with it. Therefore test them jointly.
        let square = both
            .cholesky()
            .map(|factor| apart.dot(&factor.solve(&apart)));
        let square = square.unwrap_or_default();
        if !is_alone {
            difference = format!(
                "its {count} numbers together differ from the frame (chi-squared {}), most of all: {difference}",
                Number::rounded(square)
            );
        }
        let calibrate = "calibrate the camera with this frame by `sensor calibrate`";
        let of_format = |cause| format!("{cause}, or {calibrate}");
        let remedy = compressed(rest).map_or(calibrate.to_owned(), of_format);
        if is_alone || square > MAX_CHI_SQUARED {
            let message = format!("contradicts the frame at rest: {difference}; {remedy}");
            return Err(RecordedError::readings(
                self.file.unwrap_or(&rest.file),
                message,
            ));
        }
        let (is_far, file) = (
            square > WARNING_CHI_SQUARED[count - WITHOUT_TERMS],
            &rest.file,
        );
        let text = format!("the camera differs from {file}: {difference}; {remedy}");
        Ok(is_far.then_some(text))
    }

    fn covariance(&self) -> DMatrix<f64> {
        match &self.departure_prior {
            Some(prior) => prior.covariance.clone(),
            None => {
                let variance = |row: usize, _| self.stds[CAMERA[row]] * self.stds[CAMERA[row]];
                DMatrix::from_diagonal(&DVector::from_fn(WITHOUT_TERMS, variance))
            }
        }
    }
}

fn geometry_of(camera: &CameraEstimate) -> CameraGeometry {
    CameraGeometry {
        centre_px: camera.centre_px,
        px_per_rad: camera.px_per_rad,
        place: camera.place,
        turn_deg: camera.turn_deg,
        odd_terms: OddTerms {
            k3: camera.k3,
            k5: camera.k5,
        },
    }
}

fn numbers(geometry: &CameraGeometry) -> [f64; CAMERA.len()] {
    let OddTerms { k3, k5 } = geometry.odd_terms;
    let ([x, y], [a, b, c], [d, e, f]) = (geometry.centre_px, geometry.place, geometry.turn_deg);
    [x, y, geometry.px_per_rad, a, b, c, d, e, f, k3, k5]
}

/// Factors that convert the camera entries of a [`Departure`] to the units of the camera parameters. A `Departure`
/// contains the differences between the sensor parameters and their nominal values. In it, the change of the scale is
/// relative to `px_per_rad`, and angles are in rad.
fn scales(camera: &CameraEstimate) -> [f64; CAMERA.len()] {
    let mut scales = [1.0; CAMERA.len()];
    scales[2] = camera.px_per_rad;
    scales[6..9].fill(1.0_f64.to_degrees());
    scales
}

/// The number, rounded to the decimal place at which its standard deviation `std` has two significant digits. The
/// number keeps at least three significant digits.
fn known_to(number: f64, std: f64) -> Number {
    let size = |number: f64| libm::floor(libm::log10(number.abs()));
    let digits = size(number) - size(std) + 1.0;
    // `digits` is the number of digits after the decimal point of the scientific notation. It is at most 16: together
    // with the digit before the point, 17 significant digits identify every double-precision number.
    let digits = if digits.is_finite() {
        digits.clamp(2.0, 16.0)
    } else {
        2.0
    };
    let rounded = format!("{number:.*e}", digits as usize);
    Number(rounded.parse().unwrap_or(number))
}

#[cfg(test)]
mod tests {
    use super::known_to;

    #[test]
    fn numbers_keep_the_digits_that_their_std_leaves() {
        let shown = [0.00456, 2.0, 500.0].map(|std| known_to(320.0347, std).to_string());
        assert_eq!(shown, ["320.0347", "320", "320"]);
    }
}
