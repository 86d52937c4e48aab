//! Maps of the curvature that trials estimate.

use palpate_ep2::{Ep2Error, regions};
use palpate_estimators::{push_map_point, study_map_table};
use palpate_study::MapTable;
use palpate_study::config::LengthUnit;

use super::scene::GlideScene;

impl GlideScene {
    /// Empty table for the maps of a study's cells.
    pub(super) fn true_map_table(unit: LengthUnit) -> MapTable {
        study_map_table(unit)
    }

    /// Adds the map of trial number `trial`: one row per point of the grid; x changes slowest.
    pub(super) fn push_true_map(
        &self,
        cell: usize,
        trial: u64,
        table: &mut MapTable,
    ) -> Result<(), Ep2Error> {
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
