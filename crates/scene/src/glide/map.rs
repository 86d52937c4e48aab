//! Tables of maps of estimated curvature.

use palpate_ep2::{Ep2Error, MapPoint, Regions, regions};
use palpate_geometry::{ShapeClass, ShapeThresholds};

use super::scene::GlideScene;
use crate::map::MapTable;
use palpate_study::config::LengthUnit;

/// Header of a map: places, curvatures with their standard deviations, principal curvatures and directions, class,
/// region, and the probability of each class. Maps of a study also have the cell and the true class.
fn header(unit: LengthUnit, of_study: bool) -> String {
    let unit = unit.as_str();
    let (cell, true_class) = if of_study {
        ("cell,", "true_class,")
    } else {
        ("", "")
    };
    let probabilities = ShapeClass::ALL.map(probability_column);
    format!(
        "{cell}x_{unit},y_{unit},z_{unit},normal_x,normal_y,normal_z,\
         gaussian_curvature_per_{unit}2,gaussian_curvature_std_per_{unit}2,\
         mean_curvature_per_{unit},mean_curvature_std_per_{unit},\
         k_min_per_{unit},k_max_per_{unit},k_min_x,k_min_y,k_min_z,k_max_x,k_max_y,k_max_z,\
         shape_index,class,{true_class}region,{}",
        probabilities.join(",")
    )
}

impl MapTable {
    /// Empty table for the map of recorded readings.
    pub(crate) fn of_readings(unit: LengthUnit) -> Self {
        Self::new(&header(unit, false), "cells")
    }

    /// Adds the points of a map, with their regions if they are given.
    pub(crate) fn push_map(
        &mut self,
        points: &[MapPoint],
        regions: Option<&Regions>,
        thresholds: &ShapeThresholds,
    ) {
        for (place, point) in points.iter().enumerate() {
            let region = regions.map(|regions| regions.of_point[place]);
            self.push(None, point, region, thresholds);
        }
    }

    /// Adds a point. Values that the method does not provide stay empty.
    fn push(
        &mut self,
        cell_and_truth: Option<(usize, ShapeClass)>,
        point: &MapPoint,
        region: Option<usize>,
        thresholds: &ShapeThresholds,
    ) {
        let curvature = &point.curvature;
        let stds = curvature.uncertainty;
        if let Some((cell, _)) = cell_and_truth {
            self.text(cell);
        }
        self.numbers(point.position.iter().chain(point.normal.iter()));
        self.number(Some(curvature.gaussian));
        self.number(stds.map(|stds| stds.gaussian_std));
        self.number(Some(curvature.mean));
        self.number(stds.map(|stds| stds.mean_std));
        self.numbers([point.k_min, point.k_max].iter());
        let directions = [&point.direction_of_min, &point.direction_of_max];
        self.numbers(directions.into_iter().flat_map(|one| one.iter()));
        self.number(point.shape_index);
        self.text(curvature.class(thresholds).name());
        if let Some((_, truth)) = cell_and_truth {
            self.text(truth.name());
        }
        self.text(region.map_or_else(String::new, |region| region.to_string()));
        let probabilities = curvature.class_probabilities(thresholds);
        for class in 0..ShapeClass::ALL.len() {
            self.number(probabilities.as_ref().map(|all| all[class]));
        }
        self.end_row();
    }

    fn numbers<'a>(&mut self, values: impl Iterator<Item = &'a f64>) {
        values.for_each(|value| self.number(Some(*value)));
    }
}

const fn probability_column(class: ShapeClass) -> &'static str {
    match class {
        ShapeClass::Peak => "probability_peak",
        ShapeClass::Ridge => "probability_ridge",
        ShapeClass::SaddleRidge => "probability_saddle_ridge",
        ShapeClass::Flat => "probability_flat",
        ShapeClass::Minimal => "probability_minimal",
        ShapeClass::Pit => "probability_pit",
        ShapeClass::Valley => "probability_valley",
        ShapeClass::SaddleValley => "probability_saddle_valley",
    }
}

impl GlideScene {
    /// Empty table for the maps of a study's cells.
    pub(super) fn true_map_table(unit: LengthUnit) -> MapTable {
        MapTable::new(&header(unit, true), "cells")
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
            table.push(
                Some((cell, truth.class)),
                point,
                Some(*region),
                &self.grid.thresholds,
            );
        }
        Ok(())
    }
}
