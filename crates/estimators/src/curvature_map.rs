//! Tables of curvature maps. A map contains the estimated curvature at many points of a surface, one row per point.

use palpate_ep2::MapPoint;
use palpate_geometry::{ShapeClass, ShapeThresholds};
use palpate_study::config::LengthUnit;
use palpate_study::number::shortest;
use palpate_study::{Column, Table, Unit};

/// Columns of a table of curvature maps: positions, curvatures with their standard errors, principal curvatures and
/// directions, shape class, number of the region (an area of one shape class), and the probability of each class. For
/// the maps of a study (`of_study`), the first column is `cell`, the number of the grid point, and there is a column
/// for the true class.
fn columns(unit: LengthUnit, of_study: bool) -> Vec<Column> {
    let cell = of_study.then(|| Column::count("cell"));
    let true_class = of_study.then(|| Column::text("true_class"));
    let gaussian = ["gaussian_curvature", "gaussian_curvature_std"];
    let others = ["mean_curvature", "mean_curvature_std", "k_min", "k_max"];
    let directions = [
        "k_min_x", "k_min_y", "k_min_z", "k_max_x", "k_max_y", "k_max_z",
    ];
    (cell.into_iter())
        .chain(Column::in_length(["x", "y", "z"], Unit::Length, unit))
        .chain(Column::pure(["normal_x", "normal_y", "normal_z"]))
        .chain(Column::in_length(gaussian, Unit::PerLengthSquared, unit))
        .chain(Column::in_length(others, Unit::PerLength, unit))
        .chain(Column::pure(directions))
        .chain([Column::number("shape_index", "1"), Column::text("class")])
        .chain(true_class)
        .chain([Column::count("region")])
        .chain(Column::pure(ShapeClass::ALL.map(probability_column)))
        .collect()
}

/// An empty table for the points of maps. If `of_study` is true, the table is for the maps of all grid points of a
/// study, and it has the columns `cell` and `true_class`. Otherwise, the table is for a map from recorded readings.
pub fn map_table(unit: LengthUnit, of_study: bool) -> Table {
    Table::new(columns(unit, of_study))
}

/// Adds the row of one point to a table of maps. A field stays empty if the estimator does not compute its value.
pub fn push_map_point(
    table: &mut Table,
    cell_and_true_class: Option<(usize, ShapeClass)>,
    point: &MapPoint,
    region: Option<usize>,
    thresholds: &ShapeThresholds,
) {
    let (cell, true_class) = cell_and_true_class.unzip();
    let curvature = &point.curvature;
    let stds = curvature.uncertainty;
    let place = point.position.iter().chain(point.normal.iter());
    let curvatures = [
        Some(curvature.gaussian),
        stds.map(|stds| stds.gaussian_std),
        Some(curvature.mean),
        stds.map(|stds| stds.mean_std),
        Some(point.k_min),
        Some(point.k_max),
    ];
    let directions = [&point.direction_of_min, &point.direction_of_max];
    let directions = directions.into_iter().flat_map(|one| one.iter());
    let numbers = (place.copied().map(Some))
        .chain(curvatures)
        .chain(directions.copied().map(Some))
        .chain([point.shape_index]);
    let probabilities = curvature.class_probabilities(thresholds);
    let classes = 0..ShapeClass::ALL.len();
    let probabilities = classes.map(|class| probabilities.as_ref().map(|all| all[class]));
    let text = |number: Option<f64>| number.map_or_else(String::new, shortest);
    let class = thresholds.classify(curvature.gaussian, curvature.mean);
    let row = (cell.map(|cell| cell.to_string()).into_iter())
        .chain(numbers.map(text))
        .chain([class.name().to_owned()])
        .chain(true_class.map(|class| class.name().to_owned()))
        .chain([region.map_or_else(String::new, |region| region.to_string())])
        .chain(probabilities.map(text));
    table.rows.push(row.collect());
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
