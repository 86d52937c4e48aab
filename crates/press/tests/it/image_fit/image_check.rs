//! Tests the goodness of fit of image fits, and the misfits that they report (contradictions between images and model).

use palpate_press::{Body, Contact, Measured, PressError, PressEstimate, Rest};
use palpate_sensing::{Channel, Stream};

use super::*;
use crate::sensor::{distance_from_uniform, misfit_share};

const PRESSES: u64 = 120;
const AT: [f64; 2] = [2.5, -1.0];
const STATED: Measured = Measured {
    value: 1.0,
    std: 0.02,
};

/// The frames of one simulated press, with the fit that is applied to them. The sensor parameters differ from trial to
/// trial.
struct Press {
    fit: ImageFit,
    rest: Rest,
    seen: Vec<Option<Seen>>,
}

impl Press {
    fn of(number: u64, fit: ImageFit, change: impl Fn(&mut [[MarkerDisplacement; 2]])) -> Self {
        let truth = Truth::drawn(number, ROUGHLY);
        let mut noise = Stream::new(4, number, Channel::Centroid);
        let rest = fit.at_rest(&truth.at_rest(Some(&mut noise))).unwrap();
        let mut moved = truth.moved(None, AT, 1.0);
        change(&mut moved);
        let seen = truth.seen(&moved, Some(&mut noise));
        Self { fit, rest, seen }
    }

    fn estimate(&self, given: Option<Measured>) -> Result<PressEstimate, PressError> {
        self.fit.estimate(&self.rest, &self.seen, given)
    }

    fn codes(&self, given: Option<Measured>) -> Result<Vec<&'static str>, PressError> {
        let Self { fit, rest, seen } = self;
        let estimate = self.estimate(given)?;
        let indentation = fit.check_indentation(rest, seen, given)?;
        let misfits = fit.misfits(rest, seen, given, &estimate)?;
        let misfits = indentation.into_iter().chain(misfits);
        Ok(misfits.map(|misfit| misfit.code()).collect())
    }
}

/// The p-values of 120 presses are compared with the uniform distribution. For 120 numbers that are drawn from the
/// uniform distribution, the Kolmogorov distance exceeds 0.149 with a probability of 1 %.
#[test]
fn p_values_are_uniform_and_misfits_are_rare_if_the_model_is_right() {
    for given in [None, Some(STATED)] {
        let (mut p_values, mut codes) = (Vec::new(), Vec::new());
        for number in 0..PRESSES {
            let mut stream = Stream::new(5, number, Channel::Indentation);
            let given = given.map(|given| Measured {
                value: given.value + given.std * stream.standard_normal(),
                ..given
            });
            let press = Press::of(number, fit(None, ROUGHLY), |_| {});
            let goodness = press.estimate(given).unwrap().goodness.unwrap();
            // Each of the 81 markers has four residuals. The fitted parameters are the curvature, the two coordinates
            // of the contact and, if no indentation is given, the indentation.
            let unknowns = 4 - usize::from(given.is_some());
            assert_eq!(goodness.freedom, 4 * 81 - unknowns);
            p_values.push(goodness.p_value);
            if given.is_some() {
                codes.push(press.codes(given).unwrap());
            }
        }
        let distance = distance_from_uniform(p_values);
        assert!(distance < 0.149, "{distance}");
        // By chance, 6 of 120 presses (5 %) are expected to have a misfit; the probability of more than 11 is 2 %.
        let misfits = codes.iter().filter(|codes| !codes.is_empty()).count();
        assert!(misfits <= 11, "{codes:?}");
    }
}

fn codes(
    trials: u64,
    fit: impl Fn() -> ImageFit,
    given: Option<Measured>,
    change: impl Fn(&mut [[MarkerDisplacement; 2]]),
) -> Vec<Vec<&'static str>> {
    let of_trial = |number| Press::of(number, fit(), &change).codes(given).ok();
    (0..trials).filter_map(of_trial).collect()
}

/// The same contact with both models of the soft body. One model computes displacements at the depth of the magenta
/// discs, the other at the depth of the yellow discs.
fn contacts(bodies: &[Body; 2]) -> [Contact<'_>; 2] {
    let skin = Skin::new(RADIUS).unwrap();
    [0, 1].map(|disc| skin.contact(&bodies[disc], CURVATURE, 1.0).unwrap())
}

#[test]
fn another_body_is_found() {
    let codes = codes(20, || fit(Some(10.0), ROUGHLY), Some(STATED), |_| {});
    assert!(codes.len() > 15, "{}", codes.len());
    for code in ["poor-fit", "other-body"] {
        assert!(misfit_share(&codes, Some(code)) > 0.9, "{codes:?}");
    }
}

#[test]
fn motions_that_no_press_causes_are_another_body() {
    let refused = |change: fn(&mut [[MarkerDisplacement; 2]])| {
        let press = Press::of(1, fit(None, ROUGHLY), change);
        [None, Some(STATED)].map(|given| <&str>::from(press.estimate(given).unwrap_err()))
    };
    let outward = refused(|moved| {
        for disc in moved.iter_mut().flatten() {
            disc.normal = -disc.normal;
            disc.tangential = disc.tangential.map(|along| -along);
        }
    });
    let apart = refused(|moved| {
        for (marker, discs) in moved.iter_mut().enumerate() {
            for disc in discs {
                disc.normal = if marker % 2 == 0 { 0.2 } else { -0.2 };
                disc.tangential = [0.0; 2];
            }
        }
    });
    assert_eq!([outward, apart], [["other-body"; 2]; 2]);
}

/// An elongated contact is simulated by adding two shallower contacts, one on each side of the first contact.
#[test]
fn an_elongated_press_is_not_round() {
    let bodies = bodies(None, 0.0);
    let contacts = contacts(&bodies);
    let markers = Markers::new(Skin::new(RADIUS).unwrap(), &places()).unwrap();
    let [x, y] = AT;
    let codes = codes(
        20,
        || fit(None, ROUGHLY),
        None,
        |moved| {
            for side in [-3.0, 3.0] {
                for (disc, contact) in contacts.iter().enumerate() {
                    let beside = markers.displacements(contact, [x + side, y]);
                    for (moved, more) in moved.iter_mut().zip(beside) {
                        moved[disc].normal += 0.05 * more.normal;
                        for axis in 0..2 {
                            moved[disc].tangential[axis] += 0.05 * more.tangential[axis];
                        }
                    }
                }
            }
        },
    );
    assert_eq!(codes.len(), 20);
    assert!(misfit_share(&codes, Some("not-round")) > 0.9, "{codes:?}");
}

#[test]
fn another_indentation_than_stated_is_found() {
    for std in [STATED.std, 0.0] {
        let stated = Measured { value: 1.15, std };
        let codes = codes(20, || fit(None, ROUGHLY), Some(stated), |_| {});
        assert!(codes.len() > 15, "{}", codes.len());
        let share = misfit_share(&codes, Some("stated-indentation"));
        assert!(share > 0.9, "{codes:?}");
    }
}

/// One marker has an additional displacement, which is too small for the fit to reject this marker as an outlier.
#[test]
fn one_marker_is_named() {
    let change = |moved: &mut [[MarkerDisplacement; 2]]| {
        for disc in &mut moved[42] {
            disc.tangential[0] += 0.0055;
        }
    };
    let codes = codes(40, || fit(None, ROUGHLY), None, change);
    let share = misfit_share(&codes, Some("outlier"));
    assert!(share > 0.3, "{codes:?}");
}
