//! Rolls that tell why they are refused, for the tables.

use palpate_geometry::Shape;
use palpate_rolling::{
    Chart, Contact, InvalidRoll, Model, Motion, Probe, RollError, Roller, Rolls,
};

pub(super) const NEW: &str = "rolling::Roller::new";
pub(super) const ROLL: &str = "rolling::Roller::roll";
pub(super) const SHIFT: &str = "rolling::Roller::shift";
pub(super) const DURATION: &str = "rolling::Roller::duration_for_arc";

pub(super) fn roller(
    radius: f64,
    object: Shape,
    place: (f64, f64),
    model: Model,
    motion: Motion,
) -> Result<Roller, &'static str> {
    let rolls = [vec![motion]];
    let probe = Probe::new(radius).unwrap();
    Roller::new(probe, object, place, model, Rolls { rolls: &rolls }).map_err(|error| match error {
        InvalidRoll::FirstContact(error) => error.name(),
        InvalidRoll::Fault(fault) => fault.name(),
        InvalidRoll::Unsupported { .. } => "unsupported",
        InvalidRoll::Tolerance { .. } => "tolerance",
    })
}

pub(super) fn roll(roller: &Roller, motion: Motion) -> Result<Contact, &'static str> {
    roller.roll(&[motion]).map_err(ended)
}

pub(super) fn ended(error: RollError) -> &'static str {
    error.fault.name()
}

pub(super) const fn dop853(tolerance: f64) -> Model {
    let chart = Chart::Free;
    Model::Dop853 { tolerance, chart }
}

pub(super) const fn auto(tolerance: f64) -> Model {
    let chart = Chart::Free;
    Model::Auto { tolerance, chart }
}

/// All numbers of a contact.
pub(super) fn numbers(contact: &Contact) -> Vec<f64> {
    let vectors = [contact.on_object.coords, contact.normal, contact.x_axis];
    let turn = contact.body_from_contact.coords;
    (vectors.iter().flatten().copied())
        .chain(turn.iter().copied())
        .chain([contact.arc_length])
        .collect()
}
