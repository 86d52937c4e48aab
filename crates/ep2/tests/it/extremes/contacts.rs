//! Contacts that span no patch, or hardly one.

use std::f64::consts::PI;

use nalgebra::{Point3, Vector3};
use palpate_ep2::{Contact, Criterion, Ep2Error, Patch, Penalised, TwoPass};
use palpate_verdict::{NOT_FINITE, rows};

use super::fits::{METHOD, centre, methods};

const PATCH: &str = "ep2::Patch::new";
const PENALISED: &str = "ep2::Penalised::fit";
const UP: Option<[f64; 3]> = Some([0.0, 0.0, 1.0]);
const BAD: [f64; 4] = [NOT_FINITE[0], NOT_FINITE[1], NOT_FINITE[2], 1e200];
const NO_WEIGHTS: [f64; 4] = [0.0, -0.0, -1.0, f64::NEG_INFINITY];
const ANGLES: [f64; 4] = [1e-5, 1e-3, 0.5, 1.2];

rows! {
    PATCH, "{input}", "too-few-contacts" => patch(&vec![contact(0.0, 0.0, 0.0, UP); count]),
        for (input, count) in [("no contact", 0), ("one contact", 1), ("two contacts", 2)];
    PATCH, "1000 contacts in one place", "coincident" => patch(&vec![contact(1.0, 2.0, 3.0, UP); 1000]);
    PATCH, "1000 contacts in one place 1e9 away", "coincident" => patch(&vec![contact(1e9, 2e9, 3e9, None); 1000]);
    PATCH, "contacts on a cylinder's ruling", "collinear" => patch(&on_a_ruling(0.0));
    PATCH, "contacts within 1e-9 rad of a ruling", "collinear" => patch(&on_a_ruling(1e-9));
    PATCH, "contacts on a line", "collinear" => patch(&line(0.0));
    PATCH, "contacts on a line within 1e-13", "collinear" => patch(&line(1e-13));
    PATCH, "coordinate {place} is {bad:e}", "not-finite" =>
        patch(&with(line(1.0), |contact| contact.position[place] = bad)), for bad in BAD, for place in 0..3;
    PATCH, "a weight is {bad:e}", "not-finite" => patch(&with(line(1.0), |contact| contact.weight = bad)),
        for bad in [f64::NAN, f64::INFINITY, 1e200];
    PATCH, "a weight is {bad:?}", "bad-weight" => patch(&with(line(1.0), |contact| contact.weight = bad)),
        for bad in NO_WEIGHTS;
    PATCH, "a normal's components are {bad:e}", "not-finite" =>
        patch(&with(on_a_ruling(0.5), |contact| contact.normal = Some(Vector3::repeat(bad)))), for bad in BAD;
    PATCH, "a normal's components are subnormal", "bad-normal" =>
        patch(&with(on_a_ruling(0.5), |contact| contact.normal = Some(Vector3::repeat(f64::from_bits(1)))));
    PATCH, "outward of {outward:e}", "bad-setting" => Patch::new(&on_a_ruling(0.5), &Vector3::new(0.0, 0.0, outward)),
        for outward in [0.0, f64::NAN, f64::INFINITY, 1e200];
    METHOD, "{name}, contacts within {angle:?} rad of a cylinder's ruling: whether its numbers fit together" =>
        centre(&*method, &on_a_ruling(angle)), for angle in ANGLES, for (name, method) in methods().into_iter().take(2);
    METHOD, "two-pass, contacts of one finger within {angle:?} rad of a cylinder's ruling", "bad-setting" =>
        centre(&TwoPass::default(), &on_a_ruling(angle)), for angle in ANGLES;
    METHOD, "{name}, two fingers {distance:e} of their way apart: whether its numbers fit together" =>
        centre(&*method, &fingers(distance)), for distance in [1.0, 1e-3], for (name, method) in methods();
    METHOD, "{name}, two fingers {distance:e} of their way apart", "collinear" => centre(&*method, &fingers(distance)),
        for distance in [1e-6, 1e-9, 1e-300], for (name, method) in methods();
    METHOD, "{name}, one weight {ratio:e} times the others: whether its numbers fit together" =>
        centre(&*method, &weighted(ratio)), for ratio in [1e-300, 1e-15, 1e-6, 1e6], for (name, method) in methods();
    METHOD, "{name}, one weight {ratio:e} times the others", "undetermined" => centre(&*method, &weighted(ratio)),
        for ratio in [1e15, 1e149], for (name, method) in methods();
    PENALISED, "gamma {gamma}", "bad-setting" => centre(&by(Criterion::RobustGcv { gamma }), &fingers(0.5)),
        for gamma in [f64::NAN, f64::INFINITY, 0.0, -1.0, 101.0];
    PENALISED, "{criterion:?}, two fingers {distance:e} of their way apart: whether its numbers fit together" =>
        centre(&by(criterion), &fingers(distance)),
        for criterion in [Criterion::Gcv, Criterion::Reml, Criterion::RobustGcv { gamma: 100.0 }],
        for distance in [1e-3, 1.0];
    PENALISED, "{intervals} intervals", "bad-setting" =>
        centre(&Penalised { intervals: Some(intervals), ..Penalised::default() }, &fingers(0.5)),
        for intervals in [0, 25, usize::MAX];
}

fn patch(contacts: &[Contact]) -> Result<Patch, Ep2Error> {
    Patch::new(contacts, &Vector3::z())
}

fn contact(x: f64, y: f64, z: f64, normal: Option<[f64; 3]>) -> Contact {
    Contact::new(0, Point3::new(x, y, z), normal.map(Vector3::from))
}

/// Contacts of which one is made worse.
fn with(mut contacts: Vec<Contact>, worsen: impl FnOnce(&mut Contact)) -> Vec<Contact> {
    worsen(&mut contacts[3]);
    contacts
}

fn weighted(ratio: f64) -> Vec<Contact> {
    with(fingers(0.5), |contact| contact.weight = ratio)
}

fn by(criterion: Criterion) -> Penalised {
    Penalised {
        criterion,
        ..Penalised::default()
    }
}

/// Contacts along a line, every other this far beside it.
fn line(across: f64) -> Vec<Contact> {
    let at = |index: i32| contact(f64::from(index), across * f64::from(index % 2), 0.0, None);
    (0..20).map(at).collect()
}

/// Contacts of a cylinder of radius 1 along x: on one of its rulings within an angle.
fn on_a_ruling(angle: f64) -> Vec<Contact> {
    let at = |index: u32| {
        let share = f64::from(index) / 29.0;
        let (sine, cosine) = libm::sincos(angle * libm::sin(PI * 7.0 * share));
        contact(share, sine, cosine, Some([0.0, sine, cosine]))
    };
    (0..30).map(at).collect()
}

/// Two fingers that slide along x over a sphere of radius 2, this far apart.
fn fingers(apart: f64) -> Vec<Contact> {
    let at = |index: usize| {
        let (x, y) = (
            index as f64 / 9.5 - 1.0,
            if index < 10 { 0.0 } else { apart },
        );
        let x = if index < 10 { x } else { x - 1.0 };
        let place = Vector3::new(x, y, (4.0 - x * x - y * y).sqrt());
        Contact::new(index / 10, Point3::from(place), Some(place))
    };
    (0..20).map(at).collect()
}
