//! Tables of a glide: its trace (true contacts and readings), and maps of the curvature that is estimated in trials.

use palpate_ep2::{Contact, ShapeError, regions};
use palpate_estimators::push_map_point;
use palpate_study::config::LengthUnit;
use palpate_study::readings::{GLIDES, table_columns};
use palpate_study::{Column, Table, Unit};

use super::glide_trial::GlideScene;
use crate::trace::{Trace, counted};

impl GlideScene {
    /// Records the true contacts and the readings of one glide. The readings have the noise of trial number `trial`;
    /// they have no noise if `trial` is `None`.
    pub(super) fn record(&self, trial: Option<u64>, unit: LengthUnit) -> Trace {
        let tip = Column::in_length(["tip_x", "tip_y", "tip_z"], Unit::Length, unit);
        let mut contacts = Table::new(table_columns(&GLIDES, unit).into_iter().chain(tip));
        for one in &self.touches {
            let touch = &one.touch;
            let row = touch.point.iter().chain(touch.normal.iter());
            contacts.push(one.finger, row.chain(touch.tip_centre.iter()).copied());
        }
        let fingers = self.touches.last().map_or(0, |last| last.finger + 1);
        let fingers = counted(fingers, "finger");
        Trace {
            what: format!("{} of {fingers}", counted(contacts.rows.len(), "contact")),
            contacts,
            readings: readings_table(&self.readings(trial), unit),
            camera: None,
        }
    }

    /// Adds the map of trial number `trial` to a table. There is one row per grid point, and x changes slowest.
    pub(super) fn push_map(
        &self,
        cell: usize,
        trial: u64,
        table: &mut Table,
    ) -> Result<(), ShapeError> {
        let fit = self.fit(Some(trial))?;
        let world: Vec<_> = self.grid.places.iter().map(|place| place.point).collect();
        let points = fit.points_at(&world)?;
        let regions = regions(self.grid.side, &points, &self.grid.thresholds)?;
        let places = points.iter().zip(&self.grid.places).zip(&regions.of_point);
        for ((point, truth), region) in places {
            push_map_point(
                table,
                Some((cell, truth.class)),
                point,
                Some(*region),
                &self.grid.thresholds,
            );
        }
        Ok(())
    }
}

/// Readings of the contacts, as a table in the format of `palpate estimate glide`, one row per contact.
fn readings_table(contacts: &[Contact], unit: LengthUnit) -> Table {
    let first = contacts.first();
    let columns = match first.and_then(|contact| contact.normal) {
        Some(_) => &GLIDES[..],
        None => &GLIDES[..4],
    };
    let mut table = Table::new(table_columns(columns, unit));
    for contact in contacts {
        let normal = contact.normal.iter().flat_map(|normal| normal.iter());
        table.push(
            contact.finger,
            contact.position.iter().chain(normal).copied(),
        );
    }
    table
}
