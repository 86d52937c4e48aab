//! Tables of one pass of a glide.

use palpate_ep2::Contact;

use super::scene::GlideScene;
use crate::trace::{Trace, counted};
use palpate_study::Table;
use palpate_study::config::LengthUnit;

const NORMAL: [&str; 3] = ["normal_x", "normal_y", "normal_z"];

impl GlideScene {
    /// Records one pass of every finger: in trial number `trial`, or without noise if it is `None`.
    pub(super) fn followed(&self, trial: Option<u64>, unit: LengthUnit) -> Trace {
        let header = std::iter::once("finger".to_owned())
            .chain(lengths(["x", "y", "z"], unit))
            .chain(NORMAL.map(str::to_owned))
            .chain(lengths(["tip_x", "tip_y", "tip_z"], unit));
        let mut contacts = Table::new(header);
        for one in &self.touches {
            let touch = &one.touch;
            let row = touch.point.iter().chain(touch.normal.iter());
            contacts.push(one.finger, row.chain(touch.tip_centre.iter()).copied());
        }
        let of_fingers = counted(self.fingers(), "finger");
        Trace {
            what: format!(
                "{} of {of_fingers}",
                counted(contacts.rows.len(), "contact")
            ),
            contacts,
            readings: readings_table(&self.readings(trial), unit),
            seen: None,
        }
    }
}

/// Readings as a table that [`crate::recorded::read_glide`] accepts, one row per contact.
fn readings_table(contacts: &[Contact], unit: LengthUnit) -> Table {
    let with_normals = contacts
        .first()
        .is_some_and(|contact| contact.normal.is_some());
    let normal = with_normals.then_some(NORMAL).into_iter().flatten();
    let header = std::iter::once("finger".to_owned()).chain(lengths(["x", "y", "z"], unit));
    let mut table = Table::new(header.chain(normal.map(str::to_owned)));
    for contact in contacts {
        let normal = contact.normal.iter().flat_map(|normal| normal.iter());
        let row: Vec<f64> = contact.position.iter().chain(normal).copied().collect();
        table.push(contact.finger, row);
    }
    table
}

fn lengths(names: [&'static str; 3], unit: LengthUnit) -> impl Iterator<Item = String> {
    names
        .into_iter()
        .map(move |name| format!("{name}_{}", unit.as_str()))
}
