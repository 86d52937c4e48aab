//! Doubts about estimates: none where the model holds, named ones where it does not.

use palpate_press::{Body, Doubt, ForwardFit, Interval, Measured, PressEstimate, Reading};

use crate::sensor::{DEPTH, Readings, at, doubted_share, fit_of, half_space, published};

const STD: f64 = 0.03;
const TOLD: Measured = Measured {
    value: 1.0,
    std: 0.02,
};

/// Names of the doubts of presses whose readings are changed, fitted by a body: of each trial that gave an estimate.
fn doubts(body: &Body, pressed: &Body, change: impl Fn(&mut Readings)) -> Vec<Vec<Doubt>> {
    let markers = published();
    let contact = markers.skin().contact(pressed, 1.0 / 40.0, 1.0).unwrap();
    let fit = fit_of(body, STD);
    let exact = Readings::of(&markers, &contact, at(6.0, 20.0));
    let told = (0..60).filter_map(|trial| {
        let mut readings = exact.noisy(STD, trial);
        change(&mut readings);
        let reading = readings.reading(&markers, Some(TOLD));
        let estimate = fit.estimate(&reading).ok()?;
        Some(fit.doubts(&reading, &estimate).unwrap())
    });
    told.collect()
}

#[test]
fn sound_readings_are_seldom_doubted() {
    let doubts = doubts(&half_space(), &half_space(), |_| {});
    assert_eq!(doubts.len(), 60);
    // Of 60 trials 2.4 are expected at 4 %; more than 6 have a chance of 1 %.
    assert!(doubted_share(&doubts, None) <= 0.1, "{doubts:?}");
}

/// Patterns are judged by the noise that there is.
#[test]
fn noise_that_is_stated_too_small_makes_no_other_doubt() {
    let trial = std::cell::Cell::new(1000);
    let doubts = doubts(&half_space(), &half_space(), |readings| {
        trial.set(trial.get() + 1);
        *readings = readings.noisy(2.0 * STD, trial.get());
    });
    assert!(doubts.len() > 50, "{}", doubts.len());
    assert!(
        doubted_share(&doubts, Some("large-residuals")) == 1.0,
        "{doubts:?}"
    );
    let others: Vec<Vec<Doubt>> = doubts
        .into_iter()
        .map(|one| {
            one.into_iter()
                .filter(|doubt| doubt.name() != "large-residuals")
                .collect()
        })
        .collect();
    // As few as of sound readings.
    assert!(doubted_share(&others, None) <= 0.1, "{others:?}");
}

#[test]
fn another_body_is_told() {
    let layer = Body::bonded_layer(20.0, DEPTH).unwrap();
    let doubts = doubts(&layer, &half_space(), |_| {});
    assert!(doubts.len() > 50, "{}", doubts.len());
    assert!(doubted_share(&doubts, None) > 0.9, "{doubts:?}");
}

/// A fit to displacements in all directions, with errors of this size and two fifths of it.
fn in_all_directions(body: &Body, std: f64) -> ForwardFit {
    ForwardFit {
        normal_std: Some(std),
        tangential_std: Some(0.4 * std),
        ..ForwardFit::new(body.clone())
    }
}

/// A thinner layer than the pressed one is another body, and its press as round.
#[test]
fn a_round_press_of_another_layer_is_not_called_an_edge() {
    let markers = published();
    let [thin, thick] = [4.0, 5.0].map(|thickness| Body::bonded_layer(thickness, DEPTH).unwrap());
    let contact = markers.skin().contact(&thick, 1.0 / 30.0, 1.5).unwrap();
    let exact = Readings::of(&markers, &contact, [0.0; 2]);
    let told = Measured {
        value: 1.5,
        std: 0.02,
    };
    let reading = Reading {
        tangential: Some(&exact.tangential),
        ..exact.reading(&markers, Some(told))
    };
    let fit = in_all_directions(&thin, 0.05);
    let doubts = fit
        .doubts(&reading, &fit.estimate(&reading).unwrap())
        .unwrap();
    let names: Vec<&str> = doubts.iter().map(|doubt| doubt.name()).collect();
    assert!(names.contains(&"other-body"), "{names:?}");
    assert!(!names.contains(&"not-round"), "{names:?}");
}

/// A slip of the marker under which the object presses fits a needle there, but for the markers beside it.
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
    let told = |std: f64, trial: u64| {
        let mut readings = exact.noisy_along(std, 0.4 * std, trial);
        readings.normal[apex] += 1.0;
        let reading = Reading {
            tangential: Some(&readings.tangential),
            ..readings.reading(&markers, None)
        };
        let fit = in_all_directions(&body, std);
        fit.estimate(&reading).unwrap()
    };
    let is_left_out = |trial: &u64| told(0.01, *trial).wrong_markers == [apex];
    assert!((0..20).filter(is_left_out).count() >= 17);
    // More noise hides how much it contradicts the others, but not that it does.
    let is_held = |trial: &u64| {
        let curvature = told(0.05, *trial).relative_curvature;
        curvature.interval.holds(contact.relative_curvature)
    };
    assert!((0..20).filter(is_held).count() >= 15);
}

/// A layer's markers hardly move beside the contact, where those of a half-space would.
#[test]
fn what_no_press_of_the_body_does_is_refused_by_that_name() {
    let (markers, layer) = (published(), Body::bonded_layer(5.0, DEPTH).unwrap());
    let contact = markers.skin().contact(&layer, 1.0 / 40.0, 1.0).unwrap();
    let readings = Readings::of(&markers, &contact, at(6.0, 20.0)).noisy(STD, 1);
    let fit = fit_of(&half_space(), STD);
    let refused = fit.estimate(&readings.reading(&markers, Some(TOLD)));
    assert_eq!(refused.unwrap_err().name(), "other-body");
}

/// Markers, the nearest to the contact first.
fn nearest(count: usize) -> Vec<usize> {
    let distances = published().distances(at(6.0, 20.0));
    let mut order: Vec<usize> = (0..distances.len()).collect();
    order.sort_by(|&one, &other| distances[one].total_cmp(&distances[other]));
    order.truncate(count);
    order
}

/// A marker beside the contact may move the curvature; one far from it does not.
#[test]
fn one_marker_among_sound_ones_is_named_where_it_matters() {
    let order = nearest(61);
    let told = |slipped: usize| {
        let doubts = doubts(&half_space(), &half_space(), |readings| {
            readings.normal[slipped] += 4.6 * STD;
        });
        let named = |one: &&Vec<Doubt>| {
            let is_it = |doubt: &Doubt| matches!(doubt, Doubt::SlippedMarker { marker, .. } if *marker == slipped);
            one.iter().any(is_it)
        };
        doubts.iter().filter(named).count() as f64 / doubts.len() as f64
    };
    // It is left out where noise adds to it.
    let [near, far] = [order[3], order[60]].map(told);
    assert!(near > 0.3 && far == 0.0, "{near} {far}");
}

/// Curvatures that the others tell without the marker belong to the interval, since either may be right.
#[test]
fn an_interval_holds_what_the_others_tell_where_one_marker_contradicts_them() {
    let (markers, body) = (published(), half_space());
    let contact = markers.skin().contact(&body, 1.0 / 40.0, 1.0).unwrap();
    let fit = fit_of(&body, STD);
    let exact = Readings::of(&markers, &contact, at(6.0, 20.0));
    let marker = nearest(4)[3];
    let interval = |slip: f64| {
        let mut readings = exact.noisy(0.0, 0);
        readings.normal[marker] += slip * STD;
        let reading = readings.reading(&markers, Some(TOLD));
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

#[test]
fn an_elongated_press_is_not_round() {
    let (markers, body) = (published(), half_space());
    let contact = markers.skin().contact(&body, 1.0 / 40.0, 1.0).unwrap();
    let [x, y] = at(6.0, 20.0);
    let doubts = doubts(&half_space(), &half_space(), |readings| {
        // Two more contacts at either side, half as deep.
        for side in [-6.0, 6.0] {
            let beside = Readings::of(&markers, &contact, [x + side, y]);
            for (normal, more) in readings.normal.iter_mut().zip(beside.normal) {
                *normal = 0.75 * *normal + 0.35 * more;
            }
        }
    });
    assert!(
        doubted_share(&doubts, Some("not-round")) > 0.9,
        "{doubts:?}"
    );
}

#[test]
fn a_stated_indentation_that_is_another_is_told() {
    let (markers, body) = (published(), half_space());
    let pressed = |indentation: f64| {
        let contact = markers.skin().contact(&body, 1.0 / 40.0, indentation);
        Readings::of(&markers, &contact.unwrap(), at(6.0, 20.0)).normal
    };
    let more: Vec<f64> = pressed(1.3)
        .iter()
        .zip(pressed(1.0))
        .map(|(deep, shallow)| deep - shallow)
        .collect();
    let doubts = doubts(&body, &body, |readings| {
        for (normal, more) in readings.normal.iter_mut().zip(&more) {
            *normal += more;
        }
    });
    assert!(
        doubted_share(&doubts, Some("other-indentation")) > 0.9,
        "{doubts:?}"
    );
}

/// A press far below the noise leaves all but blunt objects, and says that it is not seen.
#[test]
fn what_is_not_seen_is_bounded_and_said() {
    let (markers, body) = (published(), half_space());
    let contact = markers.skin().contact(&body, 1.0 / 20.0, 0.6).unwrap();
    let exact = Readings::of(&markers, &contact, at(6.0, 20.0));
    let fit = fit_of(&body, 0.2);
    let told = Measured {
        value: 0.6,
        std: 0.02,
    };
    let (mut unseen, mut held) = (0, 0);
    for trial in 0..60 {
        let readings = exact.noisy(0.2, trial);
        let Ok(found) = fit.estimate(&readings.reading(&markers, Some(told))) else {
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

/// An estimate whose numbers have been changed to those of no press.
#[test]
fn estimates_of_no_press_are_refused() {
    let markers = published();
    let body = half_space();
    let contact = markers.skin().contact(&body, 1.0 / 40.0, 1.0);
    let fit = fit_of(&half_space(), STD);
    let readings = Readings::of(&markers, &contact.unwrap(), at(6.0, 20.0)).noisy(STD, 1);
    let reading = readings.reading(&markers, Some(TOLD));
    let sound = fit.estimate(&reading).unwrap();
    assert!(fit.doubts(&reading, &sound).is_ok());
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
            if let Ok(doubts) = fit.doubts(&reading, &changed) {
                let of_chance = |doubt: &Doubt| (0.0..=1.0).contains(&doubt.p_value());
                assert!(doubts.iter().all(of_chance), "{number}: {doubts:?}");
            }
        }
    }
}
