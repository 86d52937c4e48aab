//! Tests image fits with camera parameters that were calibrated from a frame at rest.

use nalgebra::DMatrix;
use palpate_press::DeparturePrior;

use super::*;

/// Indices of the camera parameters among the sensor parameters: both coordinates of the image centre, and pixels per
/// radian.
const CAMERA: [usize; 3] = [2, 3, 4];

/// A camera model whose nominal sensor parameters are changed by `common`, so deviations are measured from the changed
/// values.
#[derive(Debug)]
struct About {
    ideal: Ideal,
    common: [f64; 5],
}

impl View for About {
    fn pictures(
        &self,
        sensor: &SensorState<'_>,
        moved: &[[MarkerDisplacement; 2]],
    ) -> Option<Vec<Option<[f64; 4]>>> {
        let common: Vec<f64> = sensor
            .common
            .iter()
            .zip(self.common)
            .map(|(more, about)| more + about)
            .collect();
        self.ideal.pictures(
            &SensorState {
                common: &common,
                ..*sensor
            },
            moved,
        )
    }
}

/// A fit whose camera is calibrated from the frame `seen`: the camera parameters have the calibration's values and
/// covariance as prior.
fn fit_with_camera_of(seen: &[Option<Seen>]) -> ImageFit {
    let mut known = fit(None, ROUGHLY);
    let rest = known.at_rest(seen).unwrap();
    let shares = rest.covariance().unwrap();
    let covariance = DMatrix::from_fn(CAMERA.len(), CAMERA.len(), |row, column| {
        let (row, column) = (CAMERA[row], CAMERA[column]);
        shares[(row, column)] * ROUGHLY[row] * ROUGHLY[column]
    });
    let mut common = [0.0; 5];
    for (at, number) in CAMERA.into_iter().enumerate() {
        common[number] = rest.common[number];
        known.common_stds[number] = covariance[(at, at)].sqrt();
    }
    known.departure_prior = Some(DeparturePrior {
        numbers: CAMERA.to_vec(),
        covariance,
    });
    let ideal = ideal();
    known.view = Arc::new(About { ideal, common });
    known
}

/// The camera is calibrated from the frame at rest that the fit also uses. The calibration does not change the result,
/// because the fit uses the information of a frame only once.
#[test]
fn using_the_camera_calibrated_from_the_same_frame_changes_nothing() {
    let truth = Truth::drawn(11, ROUGHLY);
    let mut noise = Stream::new(2, 11, Channel::Centroid);
    let at_rest = truth.at_rest(Some(&mut noise));
    let seen = truth.seen(&truth.moved(None, [2.5, -1.0], 1.0), Some(&mut noise));
    let alone = fit(None, ROUGHLY);
    let rest = alone.at_rest(&at_rest).unwrap();
    let alone = alone.estimate(&rest, &seen, None).unwrap();
    let calibrated = fit_with_camera_of(&at_rest);
    let rest = calibrated.at_rest(&at_rest).unwrap();
    for number in CAMERA {
        assert!(rest.common[number].abs() < 1e-9, "{:?}", rest.common);
    }
    let calibrated = calibrated.estimate(&rest, &seen, None).unwrap();
    let close = |one: f64, other: f64| assert!((one / other - 1.0).abs() < 1e-3, "{one} {other}");
    close(
        calibrated.relative_curvature.value,
        alone.relative_curvature.value,
    );
    close(
        calibrated.relative_curvature.std,
        alone.relative_curvature.std,
    );
    close(calibrated.indentation.std, alone.indentation.std);
}

/// A camera is calibrated from one frame at rest and used with another frame at rest. The misalignments are the same in
/// both frames.
#[test]
fn intervals_contain_the_truth_with_the_camera_of_another_frame() {
    let trials = 150;
    let (mut held, mut squared, mut stated) = (0.0, 0.0, 0.0);
    for number in 0..trials {
        let truth = Truth::drawn(number, ROUGHLY);
        let mut noise = Stream::new(4, number, Channel::Centroid);
        let fit = fit_with_camera_of(&truth.at_rest(Some(&mut noise)));
        let rest = fit.at_rest(&truth.at_rest(Some(&mut noise))).unwrap();
        let seen = truth.seen(&truth.moved(None, [2.5, -1.0], 1.0), Some(&mut noise));
        let curvature = fit.estimate(&rest, &seen, None).unwrap().object_curvature();
        held += f64::from(u8::from(curvature.interval.holds(CURVATURE)));
        squared += (curvature.value - CURVATURE).powi(2);
        stated += curvature.std.powi(2);
    }
    let count = trials as f64;
    // The share of intervals that contain the true value is 0.95 ± 0.018 (standard error) in 150 trials. The limit is
    // three standard errors below 0.95.
    assert!(held / count > 0.89, "{}", held / count);
    let ratio = (stated / squared).sqrt();
    assert!((0.83..1.2).contains(&ratio), "{ratio}");
}

#[test]
fn invalid_covariances_are_refused() {
    let at_rest = Truth::drawn(12, ROUGHLY).at_rest(None);
    let good = fit_with_camera_of(&at_rest);
    let refused = |prior: DeparturePrior| {
        let fit = ImageFit {
            departure_prior: Some(prior),
            ..good.clone()
        };
        let said = fit.at_rest(&at_rest).map(|_| ());
        assert!(matches!(said, Err(PressError::BadSetting(_))), "{said:?}");
    };
    let valid = good.departure_prior.clone().unwrap();
    let with = |numbers: &[usize]| DeparturePrior {
        numbers: numbers.to_vec(),
        ..valid.clone()
    };
    for numbers in [[2, 3, 5], [3, 2, 4], [2, 2, 4]] {
        refused(with(&numbers));
    }
    refused(with(&[2, 3]));
    for (entry, value) in [
        ((0, 0), -1.0),
        ((0, 1), 1.0),
        ((1, 1), f64::NAN),
        ((2, 2), 0.0),
    ] {
        let mut covariance = valid.covariance.clone();
        covariance[entry] = value;
        refused(DeparturePrior {
            covariance,
            ..valid.clone()
        });
    }
}
