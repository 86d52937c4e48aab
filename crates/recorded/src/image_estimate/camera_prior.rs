//! Camera parameters and their uncertainty before a fit of frames.

use nalgebra::{DMatrix, DVector};
use palpate_chromatouch::{Departure, OddTerms};
use palpate_press::DeparturePrior;
use palpate_statistics::Number;

use super::super::camera_calibration::{CAMERA, CameraEstimate, CameraGeometry, NominalSensor};
use super::super::error::RecordedError;
use super::super::frame_pair::Frame;
use super::image_options::PictureOptions;
use palpate_estimators::departure_stds;

/// Largest difference of a camera parameter from its estimate by the frame at rest, in standard deviations.
const CONTRADICTED: f64 = 6.0;
/// Chi-squared of all parameters together above which the camera contradicts the frame.
const CONTRADICTED_BY_ALL: f64 = 200.0;
/// Chi-squared of 9, 10 and 11 parameters together above which a warning is given: by chance, 1 in 10,000 exceeds it.
const DOUBTFUL: [f64; 3] = [33.7, 35.6, 37.4];
/// Number of camera parameters without the odd terms of the lens, which a frame may not determine.
const SURE: usize = 9;
/// Largest standard deviation of a calibrated parameter, relative to the one before calibration.
const VAGUE: f64 = 10.0;
/// Names of the camera parameters and their units; `None` is the length unit.
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

/// A camera with the uncertainty of its parameters.
pub(super) struct CameraPrior<'a> {
    pub(super) stand: CameraGeometry,
    /// Standard deviation of each `Departure` of the sensor.
    pub(super) stds: [f64; Departure::NUMBERS],
    /// Departures of the camera, with their joint covariance from a calibration.
    pub(super) departure_prior: Option<DeparturePrior>,
    /// File of the calibration; `None` for the study's camera.
    file: Option<&'a str>,
    unit: &'static str,
}

impl<'a> CameraPrior<'a> {
    /// The camera of the calibration if there is one, else the study's camera.
    pub(super) fn of(
        meant: &NominalSensor<'_>,
        options: &'a PictureOptions,
        rest: &Frame,
    ) -> Result<Self, RecordedError> {
        let fail = |file: &str, message: String| RecordedError::Readings {
            file: file.to_owned(),
            message,
        };
        let unit = options.unit();
        let Some((file, camera)) = &options.camera else {
            let stand = meant.stand();
            let of_study = options.press.noise.sensor.as_ref();
            return Ok(Self {
                stand: stand.map_err(|error| {
                    fail(&rest.file, format!("{}: {}", error.path, error.message))
                })?,
                stds: of_study.map_or([0.0; Departure::NUMBERS], departure_stds),
                departure_prior: None,
                file: None,
                unit: unit.as_str(),
            });
        };
        if camera.length_unit != unit {
            return Err(fail(
                file,
                format!(
                    "`length_unit` is {}; it must be that of the other lengths, {}",
                    camera.length_unit.as_str(),
                    unit.as_str()
                ),
            ));
        }
        let covariance = camera.covariance();
        let mut stds = meant.stds;
        let before = meant.with_terms(covariance.nrows() - SURE).stds;
        let scales = scales(camera);
        let determined = &CAMERA[..covariance.nrows()];
        for (entry, &number) in determined.iter().enumerate() {
            let (std, most) = (covariance[(entry, entry)].sqrt(), VAGUE * before[number]);
            if std > most {
                let [std, most] = [std, most].map(|std| Number::rounded(std * scales[entry]));
                let (name, of_number) = NAMES[entry];
                let of_number = of_number.unwrap_or(unit.as_str());
                return Err(fail(
                    file,
                    format!(
                        "`{name}` has a standard deviation of {std} {of_number}; it must be at most {most}"
                    ),
                ));
            }
            stds[number] = std;
        }
        Ok(Self {
            stand: stand_of(camera),
            stds,
            departure_prior: Some(DeparturePrior {
                numbers: determined.to_vec(),
                covariance,
            }),
            file: Some(file),
            unit: unit.as_str(),
        })
    }

    /// Warning if the frame at rest shows a different camera.
    ///
    /// # Errors
    /// [`RecordedError::Readings`] if it contradicts the frame, with the worst parameter and its two values.
    pub(super) fn doubt(
        &self,
        shown: &CameraEstimate,
        rest: &Frame,
    ) -> Result<Option<String>, RecordedError> {
        let (here, there) = (numbers(&self.stand), numbers(&stand_of(shown)));
        let scales = scales(shown);
        let seen = shown.covariance();
        // Odd terms that the frame does not determine are not compared.
        let count = seen.nrows();
        let own = self.covariance().resize(count, count, 0.0);
        let std = |covariance: &DMatrix<f64>, entry: usize| {
            covariance[(entry, entry)].sqrt() * scales[entry]
        };
        let pull = |entry: usize| {
            let std = libm::hypot(std(&own, entry), std(&seen, entry));
            ((here[entry] - there[entry]) / std).abs()
        };
        let worst = (0..count).max_by(|one, other| pull(*one).total_cmp(&pull(*other)));
        let worst = worst.unwrap_or(0);
        let (name, unit) = NAMES[worst];
        let unit = unit.unwrap_or(self.unit);
        // Print enough digits to show the difference.
        let apart = here[worst] - there[worst];
        let told = |value: f64, std: f64| {
            let value = Number::known_to(value, 0.1 * apart);
            let told = match std > 0.0 {
                true => format!("{value} +- {} {unit}", Number::rounded(std)),
                false => format!("{value} {unit}"),
            };
            told.trim_end().to_owned()
        };
        let difference = format!(
            "{} is {}, but {} shows {}",
            match self.file {
                Some(_) => format!("`{name}`"),
                None => format!("`scene.sensor` has a camera whose {name}"),
            },
            told(here[worst], std(&own, worst)),
            rest.file,
            told(there[worst], std(&seen, worst))
        );
        let remedy = "calibrate the camera with this frame by `sensor calibrate`";
        let apart = DVector::from_fn(count, |entry, _| {
            (here[entry] - there[entry]) / scales[entry]
        });
        let both = &own + &seen;
        let square = both
            .cholesky()
            .map(|factor| apart.dot(&factor.solve(&apart)));
        // Strongly correlated parameters may contradict the frame only together.
        let is_contradicted = square.is_some_and(|square| square > CONTRADICTED_BY_ALL);
        let is_alone = pull(worst) > CONTRADICTED;
        let difference = match square {
            Some(square) if !is_alone => format!(
                "its {count} numbers differ from those of the frame together (chi-squared {}), though none alone, most of all: {difference}",
                Number::rounded(square)
            ),
            _ => difference,
        };
        if is_alone || is_contradicted {
            return Err(RecordedError::Readings {
                file: self.file.unwrap_or(&rest.file).to_owned(),
                message: format!("contradicts the frame at rest: {difference}; {remedy}"),
            });
        }
        let is_doubtful = square.is_some_and(|square| square > DOUBTFUL[count - SURE]);
        Ok(is_doubtful.then(|| {
            format!(
                "the camera is not the one that {} shows: {difference}; {remedy}",
                rest.file
            )
        }))
    }

    /// Covariance of departures of the camera.
    fn covariance(&self) -> DMatrix<f64> {
        match &self.departure_prior {
            Some(prior) => prior.covariance.clone(),
            None => DMatrix::from_fn(SURE, SURE, |row, column| match row == column {
                true => self.stds[CAMERA[row]] * self.stds[CAMERA[row]],
                false => 0.0,
            }),
        }
    }
}

fn stand_of(camera: &CameraEstimate) -> CameraGeometry {
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

/// Parameters of a camera in the order of [`NAMES`].
fn numbers(stand: &CameraGeometry) -> [f64; CAMERA.len()] {
    let OddTerms { k3, k5 } = stand.odd_terms;
    let ([x, y], [a, b, c], [d, e, f]) = (stand.centre_px, stand.place, stand.turn_deg);
    [x, y, stand.px_per_rad, a, b, c, d, e, f, k3, k5]
}

/// Factor from each departure to its parameter: departures are a share of px per rad, and angles in rad.
fn scales(camera: &CameraEstimate) -> [f64; CAMERA.len()] {
    let degree = 1.0_f64.to_degrees();
    [
        1.0,
        1.0,
        camera.px_per_rad,
        1.0,
        1.0,
        1.0,
        degree,
        degree,
        degree,
        1.0,
        1.0,
    ]
}
