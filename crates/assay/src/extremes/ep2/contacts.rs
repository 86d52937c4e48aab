//! Contacts that span no patch, or hardly one.

use std::f64::consts::PI;

use nalgebra::{Point3, Vector3};
use palpate_ep2::{Contact, Criterion, Ep2Error, Method, Patch, Penalised, Quadric, TwoPass};

use super::consistent;
use crate::extremes::{Answer, Case};

fn contact(x: f64, y: f64, z: f64, normal: Option<[f64; 3]>) -> Contact {
    Contact::new(0, Point3::new(x, y, z), normal.map(Vector3::from))
}

/// `count` contacts of a cylinder of radius 1 along x: on one of its rulings within an angle.
fn on_a_ruling(count: usize, angle: f64) -> Vec<Contact> {
    let at = |index: usize| {
        let share = index as f64 / (count - 1) as f64;
        let (sine, cosine) = libm::sincos(angle * libm::sin(PI * 7.0 * share));
        contact(share, sine, cosine, Some([0.0, sine, cosine]))
    };
    (0..count).map(at).collect()
}

pub(super) fn cases() -> Vec<Case> {
    let up = Some([0.0, 0.0, 1.0]);
    let mut cases = Vec::new();
    let mut refused = |input: &str, contacts: Vec<Contact>| {
        cases.push(Case::refusal("ep2::Patch::new", input, move || {
            Patch::new(&contacts, &Vector3::z())
        }));
    };
    refused("no contact", Vec::new());
    refused("one contact", vec![contact(0.0, 0.0, 0.0, up)]);
    refused("two contacts", vec![contact(0.0, 0.0, 0.0, up); 2]);
    refused(
        "1000 contacts in one place",
        vec![contact(1.0, 2.0, 3.0, up); 1000],
    );
    refused(
        "1000 contacts in one place 1e9 away",
        vec![contact(1e9, 2e9, 3e9, None); 1000],
    );
    refused("contacts on a cylinder's ruling", on_a_ruling(30, 0.0));
    refused(
        "contacts within 1e-9 rad of a ruling",
        on_a_ruling(30, 1e-9),
    );
    let line = |across: f64| {
        let at = |index: i32| contact(f64::from(index), across * f64::from(index % 2), 0.0, None);
        (0..20).map(at).collect::<Vec<_>>()
    };
    refused("contacts on a line", line(0.0));
    refused("contacts on a line within 1e-13", line(1e-13));
    for number in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e200] {
        for place in 0..3 {
            let mut contacts = line(1.0);
            contacts[3].position[place] = number;
            refused(&format!("coordinate {place} is {number:e}"), contacts);
        }
        let mut contacts = line(1.0);
        contacts[3].weight = number;
        refused(&format!("a weight is {number:e}"), contacts);
        let mut contacts = on_a_ruling(30, 0.5);
        contacts[3].normal = Some(Vector3::repeat(number));
        refused(&format!("a normal's components are {number:e}"), contacts);
    }
    for weight in [0.0, -0.0, -1.0] {
        let mut contacts = line(1.0);
        contacts[3].weight = weight;
        refused(&format!("a weight is {weight:?}"), contacts);
    }
    let mut contacts = on_a_ruling(30, 0.5);
    contacts[3].normal = Some(Vector3::repeat(f64::from_bits(1)));
    refused("a normal's components are subnormal", contacts);
    for outward in [0.0, f64::NAN, f64::INFINITY, 1e200] {
        let contacts = on_a_ruling(30, 0.5);
        cases.push(Case::refusal(
            "ep2::Patch::new",
            format!("outward of {outward:e}"),
            move || Patch::new(&contacts, &Vector3::new(0.0, 0.0, outward)),
        ));
    }
    for (name, angle) in [("1e-5", 1e-5), ("1e-3", 1e-3), ("0.5", 0.5), ("1.2", 1.2)] {
        for method in ["quadric", "penalised", "two-pass"] {
            cases.push(Case::new(
                "ep2::Method::fit",
                format!("{method}, contacts within {name} rad of a cylinder's ruling: whether its numbers fit together"),
                move || centre(method, &on_a_ruling(30, angle)).into(),
            ));
        }
    }
    for distance in [1.0, 1e-3, 1e-6, 1e-9, 1e-300] {
        for method in ["quadric", "penalised", "two-pass"] {
            cases.push(Case::new(
                "ep2::Method::fit",
                format!("{method}, two fingers {distance:e} of their way apart: whether its numbers fit together"),
                move || centre(method, &fingers(distance)).into(),
            ));
        }
    }
    for ratio in [1e-300, 1e-15, 1e-6, 1e6, 1e15, 1e149] {
        for method in ["quadric", "penalised", "two-pass"] {
            cases.push(Case::new(
                "ep2::Method::fit",
                format!("{method}, one weight {ratio:e} times the others: whether its numbers fit together"),
                move || {
                    let mut contacts = fingers(0.5);
                    contacts[3].weight = ratio;
                    centre(method, &contacts).into()
                },
            ));
        }
    }
    for gamma in [f64::NAN, f64::INFINITY, 0.0, -1.0, 101.0] {
        cases.push(Case::refusal(
            "ep2::Penalised::fit",
            format!("gamma {gamma}"),
            move || {
                let criterion = Criterion::RobustGcv { gamma };
                centre_of(
                    &Penalised {
                        criterion,
                        ..Penalised::default()
                    },
                    &fingers(0.5),
                )
            },
        ));
    }
    for criterion in [
        Criterion::Gcv,
        Criterion::Reml,
        Criterion::RobustGcv { gamma: 100.0 },
    ] {
        for distance in [1e-3, 1.0] {
            cases.push(Case::new(
                "ep2::Penalised::fit",
                format!("{criterion:?}, two fingers {distance:e} of their way apart: whether its numbers fit together"),
                move || {
                    let method = Penalised {
                        criterion,
                        ..Penalised::default()
                    };
                    centre_of(&method, &fingers(distance)).into()
                },
            ));
        }
    }
    for intervals in [0, 25, usize::MAX] {
        cases.push(Case::refusal(
            "ep2::Penalised::fit",
            format!("{intervals} intervals"),
            move || {
                let method = Penalised {
                    intervals: Some(intervals),
                    ..Penalised::default()
                };
                centre_of(&method, &fingers(0.5))
            },
        ));
    }
    cases
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

fn centre(method: &str, contacts: &[Contact]) -> Result<Answer, Ep2Error> {
    match method {
        "quadric" => centre_of(&Quadric::default(), contacts),
        "penalised" => centre_of(&Penalised::default(), contacts),
        _ => centre_of(&TwoPass::default(), contacts),
    }
}

fn centre_of(method: &impl Method, contacts: &[Contact]) -> Result<Answer, Ep2Error> {
    let fit = method.fit(&Patch::new(contacts, &Vector3::z())?)?;
    let centre = fit.centre()?;
    Ok(consistent(&centre).also([fit.effective_unknowns]))
}
