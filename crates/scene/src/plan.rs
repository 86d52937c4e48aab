//! Builds the parts that all kinds of scenes share from their configs.

use palpate_geometry::formula::Formula;
use palpate_geometry::surfaces::{Cylinder, Dish, Ellipsoid, Graph, Plane, Sphere, Torus};
use palpate_geometry::{InvalidShape, Shape};
use palpate_sensing::{InvalidSensor, PadLayout};
use palpate_statistics::Number;

use palpate_study::FieldError;
use palpate_study::config::{self, ObjectConfig};

fn shape_error(error: InvalidShape) -> FieldError {
    let message = format!("must be {}, is {}", error.expected, Number(error.value));
    FieldError::at(format!("scene.object.{}", error.parameter), message)
}

/// Error at the parameter of a sensor, which is a field of `table`.
pub(crate) fn sensor_error(table: &str, error: InvalidSensor) -> FieldError {
    let message = format!("must be {}, is {}", error.expected, Number(error.value));
    FieldError::at(format!("{table}.{}", error.parameter), message)
}

/// The object of a scene.
pub(crate) fn shape(config: &ObjectConfig) -> Result<Shape, FieldError> {
    match config {
        ObjectConfig::Sphere { radius } => Sphere::new(*radius).map(Shape::Sphere),
        ObjectConfig::Dish { radius } => Dish::new(*radius).map(Shape::Dish),
        ObjectConfig::Plane {} => Ok(Shape::Plane(Plane)),
        ObjectConfig::Cylinder {
            radius,
            direction_deg,
        } => Cylinder::new(*radius, direction_deg.to_radians()).map(Shape::Cylinder),
        ObjectConfig::Ellipsoid { semi_axes } => Ellipsoid::new(*semi_axes).map(Shape::Ellipsoid),
        ObjectConfig::Torus {
            major_radius,
            minor_radius,
        } => Torus::new(*major_radius, *minor_radius).map(Shape::Torus),
        ObjectConfig::Paraboloid { c } => Graph::paraboloid(*c).map(Shape::Paraboloid),
        ObjectConfig::Saddle { a } => Graph::saddle(*a).map(Shape::Saddle),
        ObjectConfig::HeightField {
            formula,
            parameters,
        } => {
            let formula = Formula::parse(formula, parameters).map_err(|error| FieldError {
                path: "scene.object.formula".to_owned(),
                message: error.kind.to_string(),
                part: error.span,
            })?;
            Ok(Shape::HeightField(Graph::of_formula(formula)))
        }
    }
    .map_err(shape_error)
}

pub(crate) const fn pad_layout(layout: config::PadLayout) -> PadLayout {
    match layout {
        config::PadLayout::Square => PadLayout::Square,
        config::PadLayout::Uniform => PadLayout::Uniform,
    }
}
