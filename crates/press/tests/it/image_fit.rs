//! Tests fits of marker images. The camera is the simple model [`Ideal`].

use std::sync::Arc;

use nalgebra::Matrix4;
use palpate_press::{
    Body, ImageFit, MarkerDisplacement, Markers, Measured, PressError, PressEstimate, Seen,
    SensorState, Skin, View,
};
use palpate_sensing::{Channel, GaussianError, Stream};
use proptest::prelude::*;

use crate::ideal::{Ideal, RADIUS, ROUGHLY, STDS};

mod departure_prior;
mod image_check;
mod limits;

const CURVATURE: f64 = 1.0 / 80.0;

fn ideal() -> Ideal {
    Ideal::new(1.0)
}

fn places() -> Vec<[f64; 2]> {
    ideal().places
}

fn bodies(layer: Option<f64>, deeper: f64) -> [Body; 2] {
    ideal().bodies(layer, [deeper; 2])
}

fn fit(layer: Option<f64>, common_stds: [f64; 5]) -> ImageFit {
    ideal().fit(layer, common_stds)
}

#[derive(Clone)]
struct Truth {
    common: [f64; 5],
    misalignments: Vec<[f64; 2]>,
}

impl Truth {
    fn drawn(trial: u64, stds: [f64; 5]) -> Self {
        let mut stream = Stream::new(1, trial, Channel::Sensor);
        let mut draw = |std: f64| GaussianError::new(std).unwrap().draw(&mut stream);
        Self {
            common: stds.map(&mut draw),
            misalignments: places().iter().map(|_| [draw(0.02), draw(0.02)]).collect(),
        }
    }

    fn seen(
        &self,
        moved: &[[MarkerDisplacement; 2]],
        noise: Option<&mut Stream>,
    ) -> Vec<Option<Seen>> {
        let state = SensorState {
            common: &self.common,
            misalignments: &self.misalignments,
        };
        let pictures = ideal().pictures(&state, moved).unwrap();
        let mut noise = noise;
        let mut covariance = Matrix4::zeros();
        for number in 0..4 {
            covariance[(number, number)] = STDS[number] * STDS[number];
        }
        let erring = |picture: Option<[f64; 4]>| {
            let mut picture = picture?;
            if let Some(stream) = noise.as_deref_mut() {
                for (number, std) in picture.iter_mut().zip(STDS) {
                    *number += GaussianError::new(std).unwrap().draw(stream);
                }
            }
            Some(Seen {
                picture,
                covariance,
            })
        };
        pictures.into_iter().map(erring).collect()
    }

    fn moved(&self, layer: Option<f64>, at: [f64; 2], depth: f64) -> Vec<[MarkerDisplacement; 2]> {
        let skin = Skin::new(RADIUS).unwrap();
        let markers = Markers::new(skin, &places()).unwrap();
        let [magenta, yellow] = [0, 1].map(|disc| {
            let deeper = self.common[disc];
            let body = &bodies(layer, deeper)[disc];
            let contact = skin.contact(body, CURVATURE, depth).unwrap();
            markers.displacements(&contact, at)
        });
        magenta.into_iter().zip(yellow).map(Into::into).collect()
    }

    fn at_rest(&self, noise: Option<&mut Stream>) -> Vec<Option<Seen>> {
        self.seen(&[[MarkerDisplacement::default(); 2]; 81], noise)
    }
}

/// The estimate of trial `number`, and chi-squared of the fit at rest divided by its degrees of freedom. The fit
/// assumes that the sensor parameters have the standard deviations `known`.
fn trial(number: u64, known: [f64; 5]) -> Result<(PressEstimate, f64), PressError> {
    let truth = Truth::drawn(number, ROUGHLY);
    let mut noise = Stream::new(2, number, Channel::Centroid);
    let fit = fit(None, known);
    let rest = fit.at_rest(&truth.at_rest(Some(&mut noise)))?;
    let moved = truth.moved(None, [2.5, -1.0], 1.0);
    let seen = truth.seen(&moved, Some(&mut noise));
    let share = rest.chi_squared / rest.freedom as f64;
    Ok((fit.estimate(&rest, &seen, None)?, share))
}

#[test]
fn noiseless_pictures_determine_the_press() {
    let truth = Truth::drawn(0, [0.0; 5]);
    for layer in [None, Some(6.0)] {
        let fit = fit(layer, [0.0; 5]);
        let rest = fit.at_rest(&truth.at_rest(None)).unwrap();
        for (found, true_one) in rest.misalignments.iter().zip(&truth.misalignments) {
            for axis in 0..2 {
                // The prior of the misalignments pulls the estimates slightly towards 0, hence the tolerance.
                assert!((found[axis] - true_one[axis]).abs() < 2e-4 * 0.06);
            }
        }
        let at = [2.5, -1.0];
        let moved = truth.moved(layer, at, 1.0);
        let estimate = fit
            .estimate(&rest, &truth.seen(&moved, None), None)
            .unwrap();
        let curvature = estimate.most_likely_object_curvature();
        assert!((curvature / CURVATURE - 1.0).abs() < 2e-3, "{curvature}");
        assert!((estimate.indentation.value - 1.0).abs() < 1e-4);
        for (contact, at) in estimate.contact.iter().zip(at) {
            assert!((contact - at).abs() < 1e-3);
        }
        assert!(estimate.object_curvature().interval.holds(CURVATURE));
        assert!(estimate.wrong_markers.is_empty());
        assert!(estimate.r_squared > 0.999_999);
    }
}

/// One marker has an additional displacement, and one other marker is not visible in the press.
#[test]
fn noiseless_pictures_determine_the_displacements() {
    let truth = Truth::drawn(0, [0.0; 5]);
    let fit = fit(None, [0.0; 5]);
    let rest = fit.at_rest(&truth.at_rest(None)).unwrap();
    let mut moved = truth.moved(None, [2.5, -1.0], 1.0);
    for disc in &mut moved[20] {
        disc.normal += 0.02;
        disc.tangential[1] -= 0.03;
    }
    let mut seen = truth.seen(&moved, None);
    let estimate = fit.estimate(&rest, &seen, None).unwrap();
    seen[30] = None;
    let found = fit.beyond(&rest, &seen, &estimate).unwrap();
    for (marker, found) in found.iter().enumerate() {
        let Some(found) = found else {
            assert_eq!(marker, 30);
            continue;
        };
        let more = if marker == 20 {
            [0.02, 0.0, -0.03]
        } else {
            [0.0; 3]
        };
        let [x, y] = found.tangential;
        for (found, more) in [found.normal, x, y].into_iter().zip(more) {
            assert!((found - more).abs() < 1e-3, "{marker}: {found} {more}");
        }
    }
    let few = fit.beyond(&rest, &seen[1..], &estimate);
    assert!(matches!(few, Err(PressError::BadSetting(_))), "{few:?}");
}

/// The errors of the estimates from 150 presses are compared with the stated standard errors.
#[test]
fn intervals_contain_the_truth_for_uncertain_sensors() {
    let (mut held, mut squared, mut stated, mut at_rest) = (0.0, 0.0, 0.0, 0.0);
    let trials = 150;
    for number in 0..trials {
        let (estimate, share) = trial(number, ROUGHLY).unwrap();
        let curvature = estimate.object_curvature();
        held += f64::from(u8::from(curvature.interval.holds(CURVATURE)));
        squared += (curvature.value - CURVATURE).powi(2);
        stated += curvature.std.powi(2);
        at_rest += share;
    }
    let count = trials as f64;
    // The share of intervals that contain the true value is 0.95 ± 0.018 (standard error) in 150 trials. The limit is
    // three standard errors below 0.95.
    assert!(held / count > 0.89, "{}", held / count);
    // The root mean square of 150 errors has a relative standard error of 6 %. The limits allow about three standard
    // errors.
    let ratio = (stated / squared).sqrt();
    assert!((0.83..1.2).contains(&ratio), "{ratio}");
    assert!((at_rest / count - 1.0).abs() < 0.1, "{}", at_rest / count);
}

#[test]
fn a_sensor_without_stated_uncertainty_contradicts_its_frame_at_rest() {
    let (estimate, share) = trial(3, [0.0; 5]).unwrap();
    assert!(share > 5.0, "{share}");
    let (known, _) = trial(3, ROUGHLY).unwrap();
    assert!(estimate.relative_curvature.std < known.relative_curvature.std);
}

#[test]
fn a_known_indentation_narrows_the_interval() {
    let truth = Truth::drawn(5, ROUGHLY);
    let fit = fit(None, ROUGHLY);
    let rest = fit.at_rest(&truth.at_rest(None)).unwrap();
    let seen = truth.seen(&truth.moved(None, [0.0; 2], 1.2), None);
    let alone = fit.estimate(&rest, &seen, None).unwrap();
    let with_indentation = |std| {
        let value = 1.2;
        fit.estimate(&rest, &seen, Some(Measured { value, std }))
            .unwrap()
    };
    let (roughly, exactly) = (with_indentation(0.02), with_indentation(0.0));
    let std = |estimate: &PressEstimate| estimate.relative_curvature.std;
    assert!(std(&exactly) < std(&roughly) && std(&roughly) < std(&alone));
    assert_eq!(exactly.indentation.value, 1.2);
}

#[test]
fn an_outlier_is_found_and_excluded() {
    let truth = Truth::drawn(6, [0.0; 5]);
    let fit = fit(None, [0.0; 5]);
    let rest = fit.at_rest(&truth.at_rest(None)).unwrap();
    let mut seen = truth.seen(&truth.moved(None, [0.0; 2], 1.0), None);
    if let Some(seen) = &mut seen[40] {
        seen.picture[3] += 0.05;
    }
    let estimate = fit.estimate(&rest, &seen, None).unwrap();
    assert_eq!(estimate.wrong_markers, [40]);
    let curvature = estimate.most_likely_object_curvature();
    assert!((curvature / CURVATURE - 1.0).abs() < 1e-2, "{curvature}");
}

#[test]
fn markers_at_rest_are_no_contact() {
    let truth = Truth::drawn(7, [0.0; 5]);
    let fit = fit(None, [0.0; 5]);
    let mut noise = Stream::new(3, 7, Channel::Centroid);
    let rest = fit.at_rest(&truth.at_rest(Some(&mut noise))).unwrap();
    let still = truth.at_rest(Some(&mut noise));
    let refused = fit.estimate(&rest, &still, None);
    assert!(
        matches!(
            refused,
            Err(PressError::NoContact { .. } | PressError::Undetermined { .. })
        ),
        "{refused:?}"
    );
}

/// A sideways shift of the object moves the skin under the contact. Because the shift is a fit parameter, the estimated
/// curvature does not change.
#[test]
fn a_fitted_sideways_shift_does_not_change_the_curvature() {
    let truth = Truth::drawn(8, [0.0; 5]);
    let mut moved = truth.moved(None, [1.0, 1.0], 1.0);
    let skin = Skin::new(RADIUS).unwrap();
    let markers = Markers::new(skin, &places()).unwrap();
    for (disc, depth) in [(0, 3.0), (1, 1.0)] {
        let body = Body::half_space(0.5, depth).unwrap();
        let contact = skin.contact(&body, CURVATURE, 1.0).unwrap();
        let sideways = markers
            .shifted(0.5, depth, contact.radius, [1.0, 1.0], 0.3)
            .unwrap();
        for (moved, more) in moved.iter_mut().zip(sideways) {
            moved[disc].normal += more.normal;
            for axis in 0..2 {
                moved[disc].tangential[axis] += more.tangential[axis];
            }
        }
    }
    let fit = ImageFit {
        shift_std: 1.0,
        ..fit(None, [0.0; 5])
    };
    let rest = fit.at_rest(&truth.at_rest(None)).unwrap();
    let estimate = fit
        .estimate(&rest, &truth.seen(&moved, None), None)
        .unwrap();
    let curvature = estimate.most_likely_object_curvature();
    assert!((curvature / CURVATURE - 1.0).abs() < 5e-3, "{curvature}");
}

#[test]
fn a_non_finite_reading_is_refused_with_its_marker() {
    let truth = Truth::drawn(9, [0.0; 5]);
    let fit = fit(None, ROUGHLY);
    let good = truth.at_rest(None);
    let mut bad = good.clone();
    if let Some(seen) = &mut bad[12] {
        seen.picture[0] = f64::NAN;
    }
    let refused = fit.at_rest(&bad).map(|_| ());
    assert_eq!(refused, Err(PressError::NotFinite { marker: 12 }));
    let rest = fit.at_rest(&good).unwrap();
    let refused = fit.estimate(&rest, &bad, None);
    assert_eq!(refused, Err(PressError::NotFinite { marker: 12 }));
    let none = vec![None; 81];
    assert_eq!(
        <&str>::from(fit.at_rest(&none).unwrap_err()),
        "too-few-markers"
    );
    let few = fit.estimate(&rest, &good[..80], None);
    assert_eq!(<&str>::from(few.unwrap_err()), "bad-setting");
}

/// A camera model in which the marker `hidden` is not visible, or that returns the images of only `count` markers.
#[derive(Debug)]
struct Partial {
    whole: Ideal,
    hidden: Option<usize>,
    count: usize,
}

impl View for Partial {
    fn pictures(
        &self,
        sensor: &SensorState<'_>,
        moved: &[[MarkerDisplacement; 2]],
    ) -> Option<Vec<Option<[f64; 4]>>> {
        let mut pictures = self.whole.pictures(sensor, moved)?;
        if let Some(hidden) = self.hidden {
            pictures[hidden] = None;
        }
        pictures.resize(self.count, None);
        Some(pictures)
    }
}

fn partial(hidden: Option<usize>, count: usize) -> ImageFit {
    let whole = ideal();
    ImageFit {
        view: Arc::new(Partial {
            whole,
            hidden,
            count,
        }),
        ..fit(None, ROUGHLY)
    }
}

#[test]
fn a_reading_of_a_hidden_marker_is_named() {
    let at_rest = Truth::drawn(2, ROUGHLY).at_rest(None);
    let error = partial(Some(30), 81).at_rest(&at_rest).map(|_| ());
    assert_eq!(error, Err(PressError::HiddenMarker { marker: 30 }));
}

#[test]
fn camera_models_with_another_number_of_markers_are_refused() {
    let truth = Truth::drawn(2, ROUGHLY);
    let (at_rest, seen) = (
        truth.at_rest(None),
        truth.seen(&truth.moved(None, [0.0; 2], 0.5), None),
    );
    let rest = partial(None, 81).at_rest(&at_rest).unwrap();
    for count in [0, 80, 82] {
        let fit = partial(None, count);
        assert!(fit.at_rest(&at_rest).is_err(), "{count}");
        assert!(fit.estimate(&rest, &seen, None).is_err(), "{count}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn any_pictures_return_finite_numbers_or_an_error(
        numbers in prop::collection::vec(any::<u64>().prop_map(f64::from_bits), 8),
        marker in 0_usize..81,
    ) {
        let truth = Truth::drawn(10, [0.0; 5]);
        let fit = fit(None, ROUGHLY);
        let spoilt = |mut seen: Vec<Option<Seen>>, numbers: &[f64]| {
            if let Some(seen) = &mut seen[marker] {
                seen.picture.copy_from_slice(&numbers[..4]);
            }
            seen
        };
        let moved = truth.moved(None, [0.0; 2], 1.0);
        let found = fit
            .at_rest(&spoilt(truth.at_rest(None), &numbers[..4]))
            .and_then(|rest| fit.estimate(&rest, &spoilt(truth.seen(&moved, None), &numbers[4..]), None));
        if let Ok(found) = found {
            prop_assert!(found.relative_curvature.value.is_finite());
            prop_assert!(found.relative_curvature.std.is_finite());
        }
    }
}
