//! Tests the reported misfits of estimates, which are contradictions between readings and model. If the model is right,
//! misfits are reported rarely. If the model is wrong, the expected misfit is reported.

use palpate_press::{Body, ForwardFit, Interval, Measured, Misfit, PressEstimate, Reading};

use crate::sensor::{DEPTH, Readings, at, fit_of, half_space, measured, misfit_share, published};

const STD: f64 = 0.03;
const TRIALS: u64 = 60;
const STATED: Measured = Measured {
    value: 1.0,
    std: 0.02,
};

/// Codes of the misfits (or of the fit's error) in each trial. The presses are simulated with the body `pressed`, their
/// readings are altered by `change`, and they are fitted with the body `body`.
fn codes(
    trials: u64,
    [body, pressed]: [&Body; 2],
    stated: Measured,
    change: impl Fn(&mut Readings, u64),
) -> Vec<Vec<&'static str>> {
    let markers = published();
    let contact = markers.skin().contact(pressed, 1.0 / 40.0, 1.0).unwrap();
    let fit = fit_of(body, STD);
    let exact = Readings::of(&markers, &contact, at(6.0, 20.0));
    let of_trial = |trial| {
        let mut readings = exact.noisy(STD, trial);
        change(&mut readings, trial);
        let reading = readings.reading(&markers, Some(stated));
        let estimate = match fit.estimate(&reading) {
            Ok(estimate) => estimate,
            Err(error) => return vec![error.into()],
        };
        let indentation = fit.check_indentation(&reading, Some(&estimate));
        let misfits = fit.misfits(&reading, &estimate).unwrap();
        let misfits = indentation.ok().flatten().into_iter().chain(misfits);
        let left_out = estimate.wrong_markers.iter().map(|_| "left out");
        misfits
            .map(|misfit| misfit.code())
            .chain(left_out)
            .collect()
    };
    (0..trials).map(of_trial).collect()
}

fn no_change(_: &mut Readings, _: u64) {}

#[test]
fn sound_readings_seldom_have_a_misfit() {
    let layer = Body::bonded_layer(5.0, DEPTH).unwrap();
    for body in [&half_space(), &layer] {
        let codes = codes(TRIALS, [body; 2], STATED, no_change);
        // By chance, 3 of 60 presses (5 %) are expected to have a misfit; the probability of more than 6 is 3 %.
        assert!(misfit_share(&codes, None) <= 0.1, "{codes:?}");
    }
}

#[test]
fn another_body_is_found() {
    let (half_space, layer) = (half_space(), Body::bonded_layer(5.0, DEPTH).unwrap());
    for bodies in [[&half_space, &layer], [&layer, &half_space]] {
        let codes = codes(20, bodies, STATED, no_change);
        assert!(misfit_share(&codes, None) >= 0.9, "{codes:?}");
        assert!(misfit_share(&codes, Some("other-body")) >= 0.9, "{codes:?}");
    }
}

/// The noise is three times the stated noise. Only a poor fit and the wrong stated noise are reported, because the
/// other tests use the noise of the residuals if the residuals are too large.
#[test]
fn larger_noise_than_stated_is_found() {
    let codes = codes(TRIALS, [&half_space(); 2], STATED, |readings, trial| {
        *readings = readings.noisy(8.0_f64.sqrt() * STD, 1000 + trial);
    });
    for code in ["poor-fit", "stated-noise"] {
        assert!(misfit_share(&codes, Some(code)) >= 0.9, "{codes:?}");
    }
    for code in ["other-body", "not-round", "outlier"] {
        assert!(misfit_share(&codes, Some(code)) <= 0.1, "{codes:?}");
    }
}

#[test]
fn smaller_noise_than_stated_is_found() {
    let (markers, body) = (published(), half_space());
    let contact = markers.skin().contact(&body, 1.0 / 40.0, 1.0);
    let readings = Readings::of(&markers, &contact.unwrap(), [0.0; 2]).noisy(0.3 * STD, 1);
    let fit = fit_of(&half_space(), STD);
    let reading = readings.reading(&markers, None);
    let misfits = fit.misfits(&reading, &fit.estimate(&reading).unwrap());
    let [
        Misfit::Stated {
            stated, estimated, ..
        },
    ] = misfits.unwrap()[..]
    else {
        panic!("no stated noise");
    };
    assert!(
        stated == STD && (0.2..0.4).contains(&(estimated / STD)),
        "{estimated}"
    );
}

#[test]
fn a_smaller_stated_indentation_is_found() {
    // The stated indentation in this test is too small. An indentation that is too large seldom causes a misfit: a
    // sharper object that is pressed deeper moves the markers almost in the same way.
    let (markers, body) = (published(), half_space());
    let contact = markers.skin().contact(&body, 1.0 / 40.0, 1.0);
    let exact = Readings::of(&markers, &contact.unwrap(), at(6.0, 20.0));
    let alone = fit_of(&body, STD).estimate(&exact.reading(&markers, None));
    let std = libm::hypot(alone.unwrap().indentation.std, STATED.std);
    let stated = Measured {
        value: 1.0 - 5.0 * std,
        ..STATED
    };
    let codes = codes(TRIALS, [&body; 2], stated, no_change);
    let share = misfit_share(&codes, Some("stated-indentation"));
    assert!(share >= 0.9, "{share} {codes:?}");
}

#[test]
fn an_elongated_press_is_not_round() {
    let (markers, body) = (published(), half_space());
    let contact = markers.skin().contact(&body, 1.0 / 40.0, 1.0).unwrap();
    let [x, y] = at(6.0, 20.0);
    let codes = codes(TRIALS, [&body; 2], STATED, |readings, _| {
        // Simulate an elongated contact by a weighted sum of the displacements by three contacts. They are at (x, y),
        // (x − 6, y) and (x + 6, y).
        for side in [-6.0, 6.0] {
            let beside = Readings::of(&markers, &contact, [x + side, y]);
            for (normal, more) in readings.normal.iter_mut().zip(beside.normal) {
                *normal = 0.75 * *normal + 0.35 * more;
            }
        }
    });
    assert!(misfit_share(&codes, Some("not-round")) > 0.9, "{codes:?}");
}

fn in_all_directions(body: &Body, std: f64) -> ForwardFit {
    ForwardFit {
        normal_std: Some(std),
        tangential_std: Some(0.4 * std),
        ..ForwardFit::new(body.clone())
    }
}

/// The marker under the object slips. The reading of this marker alone would look like the press of a needle, but the
/// readings of the neighbouring markers contradict a needle.
#[test]
fn a_slip_at_the_contact_is_not_taken_for_a_needle() {
    let (markers, body) = (published(), half_space());
    let contact = markers.skin().contact(&body, 1.0 / 30.0, 1.5).unwrap();
    let exact = Readings::of(&markers, &contact, [0.0; 2]);
    let distances = markers.distances([0.0; 2]);
    let apex = distances
        .iter()
        .position(|&distance| distance == 0.0)
        .unwrap();
    let estimate = |std: f64, trial: u64| {
        let mut readings = exact.noisy_along(std, 0.4 * std, trial);
        readings.normal[apex] += 1.0;
        let reading = Reading {
            tangential: Some(&readings.tangential),
            ..readings.reading(&markers, None)
        };
        let fit = in_all_directions(&body, std);
        fit.estimate(&reading).unwrap()
    };
    let is_left_out = |trial: &u64| estimate(0.01, *trial).wrong_markers == [apex];
    assert!((0..20).filter(is_left_out).count() >= 17);
    // If the noise is five times as large as in the previous check (0.05 instead of 0.01), most intervals must still
    // contain the true curvature, although the reading of one marker is wrong.
    let is_held = |trial: &u64| {
        let curvature = estimate(0.05, *trial).relative_curvature;
        curvature.interval.holds(contact.relative_curvature)
    };
    assert!((0..20).filter(is_held).count() >= 15);
}

fn nearest(count: usize) -> Vec<usize> {
    let distances = published().distances(at(6.0, 20.0));
    let mut order: Vec<usize> = (0..distances.len()).collect();
    order.sort_by(|&one, &other| distances[one].total_cmp(&distances[other]));
    order.truncate(count);
    order
}

/// An error of a marker near the contact changes the estimated curvature, so this marker is reported. An error of a
/// marker far away does not change the curvature, so that marker is hardly ever reported.
#[test]
fn one_marker_among_sound_ones_is_named_if_it_changes_the_curvature() {
    let order = nearest(61);
    let named = |outlier: usize| {
        let codes = codes(TRIALS, [&half_space(); 2], STATED, |readings, _| {
            readings.normal[outlier] += 4.6 * STD;
        });
        misfit_share(&codes, Some("outlier"))
    };
    // `named` computes the share of trials in which the misfit test reports an outlier. For the near marker, a share of
    // 0.3 is sufficient. Noise often increases its error from 4.6 to more than 5 standard deviations. Then the fit
    // itself rejects the marker, so the misfit test does not report it. If no marker is wrong, the share is 0.5 %.
    let [near, far] = [order[3], order[60]].map(named);
    assert!(near > 0.3 && far < 0.05, "{near} {far}");
}

/// The interval of the curvature must also contain the estimate without the contradicting marker, because either
/// estimate, with or without this marker, may be right.
#[test]
fn an_interval_contains_the_estimate_without_a_marker_that_contradicts() {
    let (markers, body) = (published(), half_space());
    let contact = markers.skin().contact(&body, 1.0 / 40.0, 1.0).unwrap();
    let fit = fit_of(&body, STD);
    let exact = Readings::of(&markers, &contact, at(6.0, 20.0));
    let marker = nearest(4)[3];
    let interval = |slip: f64| {
        let mut readings = exact.noisy(0.0, 0);
        readings.normal[marker] += slip * STD;
        let reading = readings.reading(&markers, Some(STATED));
        let found = fit.estimate(&reading).unwrap();
        assert!(found.wrong_markers.is_empty());
        let Interval { low, high } = found.relative_curvature.interval;
        [low.unwrap(), high.unwrap()]
    };
    let [sound, little, much] = [0.0, 2.0, 5.0].map(interval);
    assert!(
        little[0] < sound[0] && little[1] < sound[1],
        "{little:?} {sound:?}"
    );
    assert!(
        much[0] < little[0] && much[1] > sound[1],
        "{much:?} {sound:?}"
    );
}

/// The displacements of the press are far smaller than the noise. Such readings exclude only blunt objects, and the
/// estimate must state that the contact is not detected.
#[test]
fn undetected_presses_are_bounded_and_reported() {
    let (markers, body) = (published(), half_space());
    let contact = markers.skin().contact(&body, 1.0 / 20.0, 0.6).unwrap();
    let exact = Readings::of(&markers, &contact, at(6.0, 20.0));
    let fit = fit_of(&body, 0.2);
    let (mut unseen, mut held) = (0, 0);
    for trial in 0..60 {
        let readings = exact.noisy(0.2, trial);
        let Ok(found) = fit.estimate(&readings.reading(&markers, measured(0.6, 0.02))) else {
            continue;
        };
        let curvature = found.relative_curvature;
        assert!(curvature.value.is_finite() && curvature.std.is_finite());
        assert!(curvature.interval.holds(curvature.value));
        if !found.is_detected {
            unseen += 1;
            held += u32::from(curvature.interval.holds(contact.relative_curvature));
        }
    }
    assert!(unseen > 10, "{unseen}");
    assert!(
        f64::from(held) >= 0.85 * f64::from(unseen),
        "{held} of {unseen}"
    );
}

#[test]
fn estimates_of_no_press_are_refused() {
    let markers = published();
    let body = half_space();
    let contact = markers.skin().contact(&body, 1.0 / 40.0, 1.0);
    let fit = fit_of(&half_space(), STD);
    let readings = Readings::of(&markers, &contact.unwrap(), at(6.0, 20.0)).noisy(STD, 1);
    let reading = readings.reading(&markers, Some(STATED));
    let sound = fit.estimate(&reading).unwrap();
    assert!(fit.misfits(&reading, &sound).is_ok());
    for number in [f64::NAN, f64::INFINITY, 0.0, -1.0, 1e300, 1e-300] {
        let changes: [fn(&mut PressEstimate, f64); 4] = [
            |estimate, number| estimate.most_likely_curvature = number,
            |estimate, number| estimate.indentation.value = number,
            |estimate, number| estimate.normal_std = number,
            |estimate, number| estimate.contact = [number; 2],
        ];
        for change in changes {
            let mut changed = sound.clone();
            change(&mut changed, number);
            if let Ok(misfits) = fit.misfits(&reading, &changed) {
                let is_sound = |misfit: &Misfit| (0.0..=1.0).contains(&misfit.p_value());
                assert!(misfits.iter().all(is_sound), "{number}: {misfits:?}");
            }
        }
    }
}
