//! Maps of estimated curvature, written down.

use std::fmt::Write;

use palpate_ep2::{Ep2Error, MapPoint, Regions, regions};
use palpate_geometry::{ShapeClass, ShapeThresholds};

use super::GlideScene;
use palpate_study::config::LengthUnit;

/// A map as CSV: places, curvatures with their standard deviations, principal curvatures and
/// directions, class, region, and the probability of each class. What a method does not state is
/// empty.
#[derive(Clone, Debug)]
pub struct MapTable {
    csv: String,
    /// Whether rows begin with their cell and know the true class.
    of_study: bool,
}

impl MapTable {
    /// A table of the maps of a study's cells.
    pub fn of_cells(unit: LengthUnit) -> Self {
        Self::new(unit, true)
    }

    /// A table of one map.
    pub(crate) fn of_readings(unit: LengthUnit) -> Self {
        Self::new(unit, false)
    }

    fn new(unit: LengthUnit, of_study: bool) -> Self {
        let unit = unit.as_str();
        let (cell, true_class) = if of_study {
            ("cell,", "true_class,")
        } else {
            ("", "")
        };
        let probabilities = ShapeClass::ALL.map(|class| probability_column(class).to_owned());
        let csv = format!(
            "{cell}x_{unit},y_{unit},z_{unit},normal_x,normal_y,normal_z,\
             gaussian_curvature_per_{unit}2,gaussian_curvature_std_per_{unit}2,\
             mean_curvature_per_{unit},mean_curvature_std_per_{unit},\
             k_min_per_{unit},k_max_per_{unit},k_min_x,k_min_y,k_min_z,k_max_x,k_max_y,k_max_z,\
             shape_index,class,{true_class}region,{}\n",
            probabilities.join(",")
        );
        Self { csv, of_study }
    }

    /// The table as CSV text.
    pub fn into_csv(self) -> String {
        self.csv
    }

    /// Adds the places of a map, and their regions where they are known.
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
            let _ = write!(self.csv, "{cell},");
        }
        self.numbers(point.position.iter().chain(point.normal.iter()));
        self.number(curvature.gaussian);
        self.optional(stds.map(|stds| stds.gaussian_std));
        self.number(curvature.mean);
        self.optional(stds.map(|stds| stds.mean_std));
        self.numbers([point.k_min, point.k_max].iter());
        let directions = [&point.direction_of_min, &point.direction_of_max];
        self.numbers(directions.into_iter().flat_map(|one| one.iter()));
        self.optional(point.shape_index);
        let _ = write!(self.csv, "{},", curvature.class(thresholds).name());
        if let Some((_, truth)) = cell_and_truth {
            let _ = write!(self.csv, "{},", truth.name());
        }
        if let Some(region) = region {
            let _ = write!(self.csv, "{region}");
        }
        let probabilities = curvature.class_probabilities(thresholds);
        for class in 0..ShapeClass::ALL.len() {
            self.csv.push(',');
            if let Some(probabilities) = &probabilities {
                let _ = write!(self.csv, "{}", probabilities[class] + 0.0);
            }
        }
        self.csv.push('\n');
    }

    fn numbers<'a>(&mut self, values: impl Iterator<Item = &'a f64>) {
        values.for_each(|value| self.number(*value));
    }

    fn number(&mut self, value: f64) {
        // Zero without a sign.
        let _ = write!(self.csv, "{},", value + 0.0);
    }

    fn optional(&mut self, value: Option<f64>) {
        match value {
            Some(value) => self.number(value),
            None => self.csv.push(','),
        }
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
    /// Adds the map of trial number `trial` to a table made with [`MapTable::of_cells`]: one row
    /// per place of the grid, x slowest.
    ///
    /// # Errors
    /// Why the trial failed.
    pub fn map(&self, cell: usize, trial: u64, table: &mut MapTable) -> Result<(), Ep2Error> {
        debug_assert!(table.of_study);
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
