//! From pictures back to the curvature: on sensors of all sizes, of pictures without error, and of what are none.

use nalgebra::Matrix4;
use palpate_press::{
    Doubt, ImageFit, KnownPress, MarkerDisplacement, Measured, PressError, PressEstimate, Rest,
    Seen, SensorState, View,
};
use palpate_verdict::{Answer, NOT_FINITE, rows};

use super::fit::numbers;
use crate::ideal::{Ideal, RADIUS, ROUGHLY, STDS};

const ESTIMATE: &str = "press::ImageFit::estimate";
const AT_REST: &str = "press::ImageFit::at_rest";
const CALIBRATED: &str = "press::ImageFit::calibrated";
const BEYOND: &str = "press::ImageFit::beyond";
const BOUND: &str = "press::ImageFit::std_bound";
const DOUBTS: &str = "press::ImageFit::doubts";
const MARKERS: usize = 81;
/// Units of length, of which the skin's radius is 20.
const UNITS: [f64; 5] = [1e-30, 1e-9, 1.0, 1e9, 1e30];
const EXACT: [f64; 5] = [0.0; 5];
const SENSORS: [(&str, [f64; 5]); 2] = [("exactly", EXACT), ("roughly", ROUGHLY)];
/// The press that rows change, lengths in units.
const PRESS: Press = Press {
    unit: 1.0,
    known: EXACT,
    stated: 1.0,
    object: 0.25,
    at: [2.5, -1.0],
    depth: 0.05,
};
/// Error that the documentation of `ImageFit::estimate` allows for pictures without error, in standard deviations.
const REACHED: f64 = 1e-3;
/// Objects of which presses of 0.01 and 0.05 of the sensor's radius tell the curvature, in the sensor's.
const TOLD: [f64; 6] = [-0.9, -0.5, 0.0, 1.0, 5.0, 20.0];
/// Numbers that are no standard deviations.
const NO_STDS: [f64; 5] = [f64::NAN, f64::INFINITY, -1.0, 1e-101, 1e101];
const NO_READINGS: [f64; 4] = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e60];
/// Presses that cannot be: curvature, both coordinates and indentation.
const NOWHERE: [(f64, f64, f64); 4] = [
    (0.06, f64::NAN, 1.0),
    (0.06, f64::INFINITY, 1.0),
    (0.06, 0.0, f64::NAN),
    (0.06, 0.0, 0.0),
];

/// Indentations of no press on this sensor.
const NO_DEPTHS: [(f64, &str); 6] = [
    (f64::NAN, "out-of-range"),
    (f64::NEG_INFINITY, "out-of-range"),
    (f64::INFINITY, "too-deep"),
    (RADIUS, "too-deep"),
    (0.0, "no-indentation"),
    (-1.0, "no-indentation"),
];

/// Departures of a sensor: of the image's centre and of pixels per radian.
const DEPARTED: [f64; 5] = [0.0, 0.0, 0.3, -0.2, 0.005];

/// Indentations that no press that is known has.
const NO_KNOWN_DEPTHS: [(f64, &str); 6] = [
    (f64::NAN, "out-of-range"),
    (f64::NEG_INFINITY, "out-of-range"),
    (f64::INFINITY, "out-of-range"),
    (-1.0, "out-of-range"),
    (0.0, "no-indentation"),
    (RADIUS, "too-deep"),
];

rows! {
    ESTIMATE, "unit {unit:e}, sensor known {how}, pictures without error" => exact(&Press { unit, known, ..PRESS }),
        for unit in UNITS, for (how, known) in SENSORS;
    ESTIMATE, "object of {object} times the sensor's curvature, indentation {depth} of its radius" =>
        exact(&Press { object, depth, ..PRESS }), for object in TOLD, for depth in [0.01, 0.05];
    ESTIMATE, "dish of {object} times the sensor's curvature, indentation {depth} of its radius" =>
        exact(&Press { object, depth, ..PRESS }),
        for (object, depth) in [(-0.99, 0.001), (-0.99, 0.01), (-0.9, 0.001)];
    ESTIMATE, "needle of {object} times the sensor's curvature, indentation {depth} of its radius: 1 where any fits" =>
        needle(object, depth), for (object, depth) in [(100.0, 0.01), (1e3, 0.01), (1e3, 0.05)];
    ESTIMATE, "object of {object} times the sensor's curvature, indentation 0.001 of its radius", "no-contact" =>
        of(&Press { object, depth: 0.001, ..PRESS }), for object in [5.0, 20.0, 100.0, 1e3];
    ESTIMATE, "stated errors of {stated:e} of the usual ones" => exact(&Press { stated, ..PRESS }),
        for stated in [1e-20, 1e-12, 1e-9, 1e-3, 10.0, 1e2];
    ESTIMATE, "stated errors of {stated:e} of the usual ones", "no-contact" => of(&Press { stated, ..PRESS }),
        for stated in [1e3, 1e9];
    ESTIMATE, "contact at ({x:e}, 0), markers up to 8" => exact(&Press { at: [x, 0.0], ..PRESS }),
        for x in [0.0, 1e-300, 7.9, 10.0, 15.0];
    ESTIMATE, "contact at ({x:e}, 0), markers up to 8", "off-markers" => of(&Press { at: [x, 0.0], ..PRESS }),
        for x in [18.0, 20.0, 22.0];
    ESTIMATE, "contact at ({x:e}, 0), markers up to 8", "undetermined" => of(&Press { at: [x, 0.0], ..PRESS }),
        for x in [24.0, 31.0, 40.0, 62.0];
    ESTIMATE, "unit {unit:e}, nothing pressed", "no-contact" =>
        Press { unit, ..PRESS }.read(&PRESS.at_rest(), None), for unit in UNITS;
    ESTIMATE, "all pictures alike", "other-body" => PRESS.read(&alike(), None);
    ESTIMATE, "no markers seen", "too-few-markers" => PRESS.read(&few(0), None);
    ESTIMATE, "one marker seen, object that may have moved", "too-few-markers" =>
        ImageFit { shift_std: 1.0, ..fit() }.estimate(&PRESS.rest(), &few(1), None);
    ESTIMATE, "{count} markers seen: 1 where it may be a needle" =>
        PRESS.read(&few(count), None).map(|found| vague(&found, &PRESS)), for count in [1, 2, 3];
    ESTIMATE, "unit {unit:e}, object that may have moved sideways" => still(unit), for unit in UNITS;
    ESTIMATE, "number {place} of a picture is {bad:e}", "not-finite" => PRESS.read(&spoilt(place, bad), None),
        for bad in NO_READINGS, for place in 0..4;
    ESTIMATE, "covariance {bad:e}", "not-finite" => PRESS.read(&erring(bad), None), for bad in NO_READINGS;
    ESTIMATE, "covariance {bad:e}", "bad-setting" => PRESS.read(&erring(bad), None),
        for bad in [0.0, -0.0, -1.0, -1e50];
    ESTIMATE, "{count} readings of 81 markers", "bad-setting" =>
        PRESS.read(&vec![None; count], None), for count in [0, 80, 82];
    ESTIMATE, "indentation {bad:e}", "no-indentation" => given(bad, 0.0), for bad in [0.0, -0.0, -1.0];
    ESTIMATE, "indentation {bad:e}", "out-of-range" => given(bad, 0.0), for bad in NOT_FINITE;
    ESTIMATE, "indentation known to {bad:e}", "bad-setting" => given(1.0, bad),
        for bad in NOT_FINITE.into_iter().chain([-1.0]);
    ESTIMATE, "indentation known to {std:e}" => given(1.0, std).map(|found| found_near(&found, &PRESS)),
        for std in [0.0, 1e-300, 1e-11, 1e-6, 1.0, 1e100];
    AT_REST, "unit {unit:e}: departures of the image's centre and of pixels per radian" =>
        departed(unit, |press, seen| press.fit().at_rest(seen)), for unit in UNITS;
    AT_REST, "number {place} of a picture is {bad:e}", "not-finite" => fit().at_rest(&spoilt(place, bad)),
        for bad in NO_READINGS, for place in 0..4;
    AT_REST, "covariance {bad:e}", "bad-setting" => fit().at_rest(&erring(bad)), for bad in [0.0, -0.0, -1.0];
    AT_REST, "no markers seen", "too-few-markers" => fit().at_rest(&few(0));
    AT_REST, "{count} readings of 81 markers", "bad-setting" => fit().at_rest(&vec![None; count]),
        for count in [0, 80, 82];
    AT_REST, "common_stds {bad:e}", "bad-setting" =>
        ImageFit { common_stds: vec![bad; 5], ..fit() }.at_rest(&PRESS.at_rest()), for bad in NO_STDS;
    AT_REST, "misalignment_std {bad:e}", "bad-setting" =>
        ImageFit { misalignment_std: bad, ..fit() }.at_rest(&PRESS.at_rest()), for bad in NO_STDS;
    AT_REST, "shift_std {bad:e}", "bad-setting" =>
        ImageFit { shift_std: bad, ..fit() }.at_rest(&PRESS.at_rest()), for bad in NO_STDS;
    AT_REST, "{count} departures of a camera that has 5", "out-of-range" =>
        ImageFit { common_stds: vec![0.01; count], ..fit() }.at_rest(&PRESS.at_rest()), for count in [0, 4, 6];
    CALIBRATED, "unit {unit:e}, one press: departures of the image's centre and of pixels per radian" =>
        departed(unit, |press, seen| press.fit().calibrated(seen, &[press.told(&DEPARTED)])), for unit in UNITS;
    CALIBRATED, "press of curvature {bad:e}", "bad-setting" => by(|press| press.relative_curvature = bad),
        for bad in NOT_FINITE.into_iter().chain([0.0, -1.0, 1e51]);
    CALIBRATED, "press at ({bad:e}, 0)", "out-of-range" => by(|press| press.at[0] = bad),
        for bad in NOT_FINITE.into_iter().chain([1e51]);
    CALIBRATED, "press of indentation {bad:e}", error => by(|press| press.indentation = bad),
        for (bad, error) in NO_KNOWN_DEPTHS;
    CALIBRATED, "press of {times} times its curvature", "contradicting-press" =>
        by(|press| press.relative_curvature *= times), for times in [0.3, 0.5, 2.0];
    CALIBRATED, "press of another place, {x} further", "contradicting-press" => by(|press| press.at[0] += x),
        for x in [-1.0, 1.0, 5.0];
    CALIBRATED, "number {place} of a press's picture is {bad:e}", "not-finite" => by(|press| press.seen = spoilt(place, bad)),
        for bad in NO_READINGS, for place in 0..4;
    CALIBRATED, "{count} readings of a press, 81 markers", "bad-setting" => by(|press| press.seen = vec![None; count]),
        for count in [0, 80, 82];
    CALIBRATED, "press of which {count} markers are seen: departures that are 0" =>
        by(|press| press.seen = few(count)).map(|rest| none_of(&rest.common, 1e-6)), for count in [0, 1, 3];
    BEYOND, "unit {unit:e}, sensor known {how}, pictures without error: none, in units" =>
        beyond(&Press { unit, known, ..PRESS }, |_| ()), for unit in UNITS, for (how, known) in SENSORS;
    BEYOND, "estimate whose curvature is {curvature:e}", error =>
        beyond(&PRESS, |estimate| estimate.most_likely_curvature = curvature),
        for (curvature, error) in [(0.0, "conforming"), (1e-9, "too-wide"), (f64::NAN, "out-of-range"), (-1.0, "out-of-range")];
    BEYOND, "estimate whose indentation is {depth:e}", error =>
        beyond(&PRESS, |estimate| estimate.indentation.value = depth),
        for (depth, error) in NO_DEPTHS.into_iter().filter(|(depth, _)| depth.is_finite());
    BEYOND, "estimate whose indentation is {bad:e}", "out-of-range" =>
        beyond(&PRESS, |estimate| estimate.indentation.value = bad), for bad in NOT_FINITE;
    BOUND, "unit {unit:e}: in proportion to 1/unit" => bound_of_unit(unit), for unit in UNITS;
    BOUND, "stated errors of {stated:e} of the usual ones: in proportion to them" => bound_of(stated),
        for stated in [1e-9, 1e-3, 1e3, 1e9];
    BOUND, "curvature {bad:e}", "bad-setting" => bound(&PRESS, (bad, [0.0; 2], 1.0)),
        for bad in NOT_FINITE.into_iter().chain([0.0, -1.0, 1e51]);
    BOUND, "curvature {curvature}, at {x}, indentation {depth}", "out-of-range" =>
        bound(&PRESS, (curvature, [x; 2], depth)),
        for (curvature, x, depth) in NOWHERE;
    BOUND, "no markers seen", "undetermined" => fit().std_bound(&PRESS.rest(), &few(0), None, (0.06, [0.0; 2], 1.0));
    BOUND, "curvature 1e-9, indentation 1", "too-wide" => bound(&PRESS, (1e-9, [0.0; 2], 1.0));
    DOUBTS, "unit {unit:e}, sensor known {how}, pictures without error: how many" =>
        doubts(&Press { unit, known, ..PRESS }, |_| ()).map(|doubts| Answer::at_scale(doubts.len() as f64, 0.0, 1.0)),
        for unit in UNITS, for (how, known) in SENSORS;
    DOUBTS, "estimate whose curvature is {bad:e}", "out-of-range" =>
        doubts(&PRESS, |estimate| estimate.most_likely_curvature = bad),
        for bad in NOT_FINITE.into_iter().chain([-1.0]);
    DOUBTS, "estimate whose curvature is {curvature:e}", error =>
        doubts(&PRESS, |estimate| estimate.most_likely_curvature = curvature),
        for (curvature, error) in [(0.0, "conforming"), (1e-9, "too-wide"), (1e-300, "out-of-range")];
    DOUBTS, "estimate whose indentation is {depth:e}", error =>
        doubts(&PRESS, |estimate| estimate.indentation.value = depth), for (depth, error) in NO_DEPTHS;
}

/// A press of a sensor.
#[derive(Clone, Copy)]
struct Press {
    /// Unit of length.
    unit: f64,
    /// Standard deviations of what is known only roughly of the sensor, as of [`Ideal::fit`].
    known: [f64; 5],
    /// Stated errors, in the usual ones.
    stated: f64,
    /// Curvature of the object, in the sensor's.
    object: f64,
    /// Place of the contact, in units of length.
    at: [f64; 2],
    /// Indentation, in radii of the sensor.
    depth: f64,
}

impl Press {
    fn fit(&self) -> ImageFit<Ideal> {
        ImageFit {
            misalignment_std: 0.0,
            ..Ideal::new(self.unit).fit(None, self.known)
        }
    }

    /// Readings without error of a sensor that departs so, after displacements of its discs.
    fn seen(&self, common: &[f64; 5], moved: &[[MarkerDisplacement; 2]]) -> Vec<Option<Seen>> {
        let misalignments = &[[0.0; 2]; MARKERS];
        let sensor = SensorState {
            common,
            misalignments,
        };
        let pictures = Ideal::new(self.unit).pictures(&sensor, moved).unwrap();
        let variances = STDS.map(|std| (self.stated * std) * (self.stated * std));
        let covariance = Matrix4::from_diagonal(&variances.into());
        let seen = |picture: Option<[f64; 4]>| {
            picture.map(|picture| Seen {
                picture,
                covariance,
            })
        };
        pictures.into_iter().map(seen).collect()
    }

    fn at_rest(&self) -> Vec<Option<Seen>> {
        self.seen(&EXACT, &[[MarkerDisplacement::default(); 2]; MARKERS])
    }

    fn rest(&self) -> Rest {
        self.fit().at_rest(&self.at_rest()).unwrap()
    }

    fn pressed(&self) -> Vec<Option<Seen>> {
        self.seen(&EXACT, &self.moved())
    }

    fn moved(&self) -> Vec<[MarkerDisplacement; 2]> {
        let ideal = Ideal::new(self.unit);
        let (skin, markers) = (ideal.skin(), ideal.markers());
        let [magenta, yellow] = ideal.bodies(None, [0.0; 2]).map(|body| {
            let depth = self.depth * skin.radius();
            let contact = skin.contact(&body, self.object * skin.curvature(), depth);
            let at = self.at.map(|along| along * self.unit);
            markers.displacements(&contact.unwrap(), at)
        });
        magenta.into_iter().zip(yellow).map(Into::into).collect()
    }

    /// The press where all of it is known, before a sensor that departs so.
    fn told(&self, common: &[f64; 5]) -> KnownPress {
        KnownPress {
            seen: self.seen(common, &self.moved()),
            relative_curvature: self.relative_curvature(),
            at: self.at.map(|along| along * self.unit),
            indentation: self.depth * RADIUS * self.unit,
        }
    }

    fn read(
        &self,
        seen: &[Option<Seen>],
        indentation: Option<Measured>,
    ) -> Result<PressEstimate, PressError> {
        self.fit().estimate(&self.rest(), seen, indentation)
    }

    fn relative_curvature(&self) -> f64 {
        (1.0 + self.object) / (RADIUS * self.unit)
    }
}

fn fit() -> ImageFit<Ideal> {
    PRESS.fit()
}

fn of(press: &Press) -> Result<PressEstimate, PressError> {
    press.read(&press.pressed(), None)
}

/// The curvature that an estimate takes for the likeliest, which may err by a share of its standard deviation.
fn found_near(found: &PressEstimate, press: &Press) -> Answer {
    let likeliest = found.most_likely_curvature;
    let std = found.relative_curvature.std / likeliest;
    let answer = Answer::near(likeliest, press.relative_curvature());
    answer.within(REACHED * std + 1e-12).also(numbers(found))
}

fn exact(press: &Press) -> Result<Answer, PressError> {
    Ok(found_near(&of(press)?, press))
}

/// Whether an interval holds the curvature, and has no upper end, as that of a needle.
fn vague(found: &PressEstimate, press: &Press) -> Answer {
    let interval = found.relative_curvature.interval;
    let holds = interval.holds(press.relative_curvature()) && interval.high.is_none();
    Answer::holds(holds).also(numbers(found))
}

fn needle(object: f64, depth: f64) -> Result<Answer, PressError> {
    let press = Press {
        object,
        depth,
        ..PRESS
    };
    of(&press).map(|found| vague(&found, &press))
}

/// A press that may have moved sideways, and has not.
fn still(unit: f64) -> Result<Answer, PressError> {
    let press = Press { unit, ..PRESS };
    let fit = ImageFit {
        shift_std: unit,
        ..press.fit()
    };
    let found = fit.estimate(&press.rest(), &press.pressed(), None)?;
    Ok(found_near(&found, &press))
}

/// Readings of which the first so many markers alone are seen.
fn few(count: usize) -> Vec<Option<Seen>> {
    let seen = PRESS.pressed().into_iter().enumerate();
    seen.map(|(marker, seen)| seen.filter(|_| marker < count))
        .collect()
}

fn alike() -> Vec<Option<Seen>> {
    vec![PRESS.pressed()[40]; MARKERS]
}

fn spoilt(place: usize, bad: f64) -> Vec<Option<Seen>> {
    let mut seen = PRESS.pressed();
    seen[7].as_mut().unwrap().picture[place] = bad;
    seen
}

fn erring(bad: f64) -> Vec<Option<Seen>> {
    let mut seen = PRESS.pressed();
    seen[7].as_mut().unwrap().covariance *= bad;
    seen
}

fn given(value: f64, std: f64) -> Result<PressEstimate, PressError> {
    PRESS.read(&PRESS.pressed(), Some(Measured { value, std }))
}

/// Departures that a fit finds of a sensor; 81 markers leave the prior a share of 1e-5.
fn departed(
    unit: f64,
    find: impl Fn(&Press, &[Option<Seen>]) -> Result<Rest, PressError>,
) -> Result<Answer, PressError> {
    let press = Press {
        unit,
        known: ROUGHLY,
        ..PRESS
    };
    let still = [[MarkerDisplacement::default(); 2]; MARKERS];
    let rest = find(&press, &press.seen(&DEPARTED, &still))?;
    let pairs = (2..5).map(|number| {
        (
            rest.common[number] / ROUGHLY[number],
            DEPARTED[number] / ROUGHLY[number],
        )
    });
    let answer = Answer::all_at_scale(pairs, 1.0).within(1e-4);
    Ok(answer
        .also(rest.misalignments.into_iter().flatten())
        .also([rest.chi_squared]))
}

/// A sensor that is known roughly, by a press that is changed.
fn by(change: impl Fn(&mut KnownPress)) -> Result<Rest, PressError> {
    let mut told = PRESS.told(&EXACT);
    change(&mut told);
    let press = Press {
        known: ROUGHLY,
        ..PRESS
    };
    press.fit().calibrated(&PRESS.at_rest(), &[told])
}

/// Numbers that are to be 0.
fn none_of(numbers: &[f64], within: f64) -> Answer {
    let pairs = numbers.iter().map(|&number| (number, 0.0));
    Answer::all_at_scale(pairs, 1.0).within(within)
}

/// Displacements of all markers beyond a press, of an estimate of it that is changed; in units of length.
fn beyond(press: &Press, change: impl Fn(&mut PressEstimate)) -> Result<Answer, PressError> {
    let (rest, seen) = (press.rest(), press.pressed());
    let mut estimate = press.read(&seen, None)?;
    change(&mut estimate);
    let beyond = press.fit().beyond(&rest, &seen, &estimate)?;
    let numbers = beyond.into_iter().flat_map(|more| {
        let more = more.map(|more| [more.normal, more.tangential[0], more.tangential[1]]);
        more.unwrap_or([f64::NAN; 3])
            .map(|along| along / press.unit)
    });
    Ok(none_of(&numbers.collect::<Vec<_>>(), 1e-3))
}

fn bound(press: &Press, at: (f64, [f64; 2], f64)) -> Result<f64, PressError> {
    press
        .fit()
        .std_bound(&press.rest(), &press.pressed(), None, at)
}

/// The bound of a press, in the sensor's curvature.
fn own_bound(press: &Press) -> Result<f64, PressError> {
    let radius = RADIUS * press.unit;
    let at = press.at.map(|along| along * press.unit);
    let bound = bound(
        press,
        (press.relative_curvature(), at, press.depth * radius),
    )?;
    Ok(bound * radius)
}

fn bound_of_unit(unit: f64) -> Result<Answer, PressError> {
    let found = own_bound(&Press {
        unit,
        known: ROUGHLY,
        ..PRESS
    })?;
    Ok(Answer::near(
        found,
        own_bound(&Press {
            known: ROUGHLY,
            ..PRESS
        })?,
    )
    .within(1e-9))
}

fn bound_of(stated: f64) -> Result<Answer, PressError> {
    let found = own_bound(&Press { stated, ..PRESS })? / stated;
    Ok(Answer::near(found, own_bound(&PRESS)?).within(1e-9))
}

/// Doubts about a press, of an estimate of it that is changed.
fn doubts(press: &Press, change: impl Fn(&mut PressEstimate)) -> Result<Vec<Doubt>, PressError> {
    let (rest, seen) = (press.rest(), press.pressed());
    let mut estimate = press.read(&seen, None)?;
    change(&mut estimate);
    press.fit().doubts(&rest, &seen, None, &estimate)
}
