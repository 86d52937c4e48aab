//! Builds the parts that all kinds of scenes share from their configs.

use std::ops::Range;

use palpate_geometry::formula::Formula;
use palpate_geometry::surfaces::{Cylinder, Dish, Ellipsoid, Graph, Plane, Sphere, Torus};
use palpate_geometry::{InvalidShape, Shape};
use palpate_number::Number;
use palpate_sensing::{InvalidSensor, PadLayout};

use palpate_study::config::{self, ObjectConfig};

/// Error of a config: the invalid field, and what is wrong with it.
#[derive(Clone, Debug, PartialEq)]
pub struct PlanError {
    /// Path of the field, such as `scene.object.radius`.
    pub path: String,
    /// What is wrong.
    pub message: String,
    /// Byte range of the wrong part of the field's text.
    pub part: Option<Range<usize>>,
}

impl PlanError {
    pub(crate) fn at(path: impl Into<String>, message: impl ToString) -> Self {
        Self {
            path: path.into(),
            message: message.to_string(),
            part: None,
        }
    }

    fn of_shape(error: InvalidShape) -> Self {
        let message = format!("must be {}, is {}", error.expected, Number(error.value));
        Self::at(format!("scene.object.{}", error.parameter), message)
    }

    pub(crate) fn of_sensor(table: &str, error: InvalidSensor) -> Self {
        let message = format!("must be {}, is {}", error.expected, Number(error.value));
        Self::at(format!("{table}.{}", error.parameter), message)
    }
}

/// The object of a scene.
pub(crate) fn shape(config: &ObjectConfig) -> Result<Shape, PlanError> {
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
            let formula = Formula::parse(formula, parameters).map_err(|error| PlanError {
                path: "scene.object.formula".to_owned(),
                message: error.kind.to_string(),
                part: error.span,
            })?;
            Ok(Shape::HeightField(Graph::of_formula(formula)))
        }
    }
    .map_err(PlanError::of_shape)
}

pub(crate) const fn pad_layout(layout: config::PadLayout) -> PadLayout {
    match layout {
        config::PadLayout::Square => PadLayout::Square,
        config::PadLayout::Uniform => PadLayout::Uniform,
    }
}
