//! Converts the parts of a config that rolls and glides have in common (objects, pads) to models. Errors in their
//! settings are converted to errors with a path in the config.

use palpate_statistics::{BadSetting, Number};
use std::fmt::Display;

use palpate_geometry::{Cylinder, Dish, Ellipsoid, Formula, Graph, Plane, Shape, Sphere, Torus};
use palpate_sensing::PadLayout;

use palpate_study::FieldError;
use palpate_study::config::{self, ObjectConfig};

pub(crate) fn range_error(path: &str, expected: impl Display, value: f64) -> FieldError {
    FieldError::at(path, format!("must be {expected}, is {}", Number(value)))
}

/// Converts an error of a sensor's parameter to an error with a path in the config. `table` is the path of the config
/// table that contains the parameter.
pub(crate) fn sensor_error(table: &str, error: BadSetting<String>) -> FieldError {
    let path = format!("{table}.{}", error.setting);
    range_error(&path, error.expected, error.value)
}

pub(crate) fn shape(config: &ObjectConfig) -> Result<Shape, FieldError> {
    match config {
        ObjectConfig::Sphere { radius } => Sphere::new(*radius).map(Shape::Sphere),
        ObjectConfig::Dish { radius } => Dish::new(*radius).map(Shape::Dish),
        ObjectConfig::Plane {}
        | ObjectConfig::Paraboloid { c: 0.0 }
        | ObjectConfig::Saddle { a: 0.0 } => Ok(Shape::Plane(Plane)),
        ObjectConfig::Cylinder {
            radius,
            direction_deg,
        } => Cylinder::new(*radius, direction_deg.to_radians()).map(Shape::Cylinder),
        ObjectConfig::Ellipsoid { semi_axes } => {
            Ellipsoid::new(*semi_axes).and_then(|ellipsoid| match *semi_axes {
                [a, b, c] if a == b && b == c => Sphere::new(a).map(Shape::Sphere),
                _ => Ok(Shape::Ellipsoid(ellipsoid)),
            })
        }
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
                message: error.message,
                part: error.span,
            })?;
            Ok(Shape::HeightField(Graph::from(formula)))
        }
    }
    .map_err(|error: BadSetting| {
        let path = format!("scene.object.{}", error.setting);
        range_error(&path, error.expected, error.value)
    })
}

pub(crate) const fn pad_layout(layout: config::PadLayout) -> PadLayout {
    match layout {
        config::PadLayout::Square => PadLayout::Square,
        config::PadLayout::Hexagonal => PadLayout::Hexagonal,
        config::PadLayout::Uniform => PadLayout::Uniform,
    }
}
