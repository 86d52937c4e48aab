//! Rolls on every rung, and fingertips that glide, at their extremes.

mod asked;
mod conforming;
mod glide;
mod integrated;
mod meridian;
mod round;
mod touch_model;

use nalgebra::Vector3;
use palpate_geometry::Shape;
use palpate_rolling::{Contact, InvalidRoll, Model, Motion, Probe, RollError, Roller, Rolls};

use super::Case;
use super::answer::Named;

pub(super) fn cases() -> Vec<Case> {
    let parts = [
        round::cases(),
        conforming::cases(),
        meridian::cases(),
        integrated::cases(),
        asked::cases(),
        glide::cases(),
        touch_model::cases(),
    ];
    parts.into_iter().flatten().collect()
}

const MADE: &str = "a length between 1e-100 and 1e100";

fn roller(
    radius: f64,
    object: Shape,
    place: (f64, f64),
    model: Model,
    motion: Motion,
) -> Result<Roller, Named> {
    let rolls = [vec![motion]];
    let probe = Probe::new(radius).expect(MADE);
    Roller::new(probe, object, place, model, Rolls { rolls: &rolls }).map_err(invalid)
}

fn roll(roller: &Roller, motion: Motion) -> Result<Contact, Named> {
    roller.roll(&[motion]).map_err(ended)
}

fn invalid(error: InvalidRoll) -> Named {
    Named(match error {
        InvalidRoll::FirstContact(error) => error.name(),
        InvalidRoll::Fault(fault) => fault.name(),
        InvalidRoll::Unsupported { .. } => "unsupported",
        InvalidRoll::Tolerance { .. } => "tolerance",
    })
}

fn ended(error: RollError) -> Named {
    Named(error.fault.name())
}

/// All numbers of a contact.
fn numbers(contact: &Contact) -> Vec<f64> {
    let vectors: [Vector3<f64>; 3] = [contact.on_object.coords, contact.normal, contact.x_axis];
    let turn = contact.body_from_contact.coords;
    (vectors.iter().flatten().copied())
        .chain(turn.iter().copied())
        .chain([contact.arc_length])
        .collect()
}
