//! All types of surfaces, and the enum [`Shape`], which contains a surface of any type.

mod cylinder;
mod ellipsoid;
mod graph;
mod plane;
mod sphere;
mod torus;

pub use cylinder::Cylinder;
pub use ellipsoid::Ellipsoid;
pub use graph::{Graph, HeightField, Paraboloid, Saddle};
pub use plane::Plane;
pub use sphere::{Ball, Dish, Sphere};
pub use torus::Torus;

use strum::IntoStaticStr;

use nalgebra::{Point3, Vector2, Vector3};

use crate::{
    ChartJet, CurvatureForm, LevelSet, Meridian, Parameters, Surface, SurfaceError, TangentForm,
};

/// A surface of any type of this crate.
#[derive(Clone, Debug, IntoStaticStr)]
#[strum(serialize_all = "kebab-case")]
#[allow(missing_docs, reason = "each variant is the surface of the same name")]
pub enum Shape {
    Sphere(Sphere),
    Dish(Dish),
    Plane(Plane),
    Cylinder(Cylinder),
    Ellipsoid(Ellipsoid),
    Torus(Torus),
    Paraboloid(Graph<Paraboloid>),
    Saddle(Graph<Saddle>),
    HeightField(Graph<HeightField>),
}

macro_rules! delegate {
    ($shape:expr, $surface:ident => $call:expr) => {
        match $shape {
            Shape::Sphere($surface) => $call,
            Shape::Dish($surface) => $call,
            Shape::Plane($surface) => $call,
            Shape::Cylinder($surface) => $call,
            Shape::Ellipsoid($surface) => $call,
            Shape::Torus($surface) => $call,
            Shape::Paraboloid($surface) => $call,
            Shape::Saddle($surface) => $call,
            Shape::HeightField($surface) => $call,
        }
    };
}

/// A computation on a surface that is compiled separately for each type of surface. It is faster than the same
/// computation on a [`Shape`], because a [`Shape`] selects the type at every call.
pub trait Visitor {
    /// Type of the result that the computation returns.
    type Out;

    /// Runs the computation on the surface `surface`.
    fn visit<S: Surface>(self, surface: &S) -> Self::Out;
}

impl Shape {
    /// The result of the visitor's computation on this surface.
    #[inline]
    pub fn visited_by<V: Visitor>(&self, visitor: V) -> V::Out {
        delegate!(self, surface => visitor.visit(surface))
    }

    /// Name of the surface in configs, in kebab case.
    pub fn name(&self) -> &'static str {
        self.into()
    }
}

impl Surface for Shape {
    fn chart(&self, at: Parameters) -> Result<ChartJet, SurfaceError> {
        delegate!(self, surface => surface.chart(at))
    }

    #[inline]
    fn level_set(&self, point: &Point3<f64>) -> Result<LevelSet, SurfaceError> {
        delegate!(self, surface => surface.level_set(point))
    }

    #[inline]
    fn tangent_form(
        &self,
        point: &Point3<f64>,
        x: &Vector3<f64>,
    ) -> Result<TangentForm, SurfaceError> {
        delegate!(self, surface => surface.tangent_form(point, x))
    }

    fn parameters(&self, point: &Point3<f64>) -> Parameters {
        delegate!(self, surface => surface.parameters(point))
    }

    fn closest_point(&self, point: &Point3<f64>) -> Result<Point3<f64>, SurfaceError> {
        delegate!(self, surface => surface.closest_point(point))
    }

    fn closest_point_from(
        &self,
        point: &Point3<f64>,
        start: Vector2<f64>,
    ) -> Result<Point3<f64>, SurfaceError> {
        delegate!(self, surface => surface.closest_point_from(point, start))
    }

    fn may_touch_twice(&self, radius: f64) -> bool {
        delegate!(self, surface => surface.may_touch_twice(radius))
    }

    fn contact_at(&self, x: f64, y: f64) -> Result<Point3<f64>, SurfaceError> {
        delegate!(self, surface => surface.contact_at(x, y))
    }

    fn default_contact(&self) -> (f64, f64) {
        delegate!(self, surface => surface.default_contact())
    }

    fn meridian(&self, apex: &Point3<f64>, direction: &Vector3<f64>) -> Option<Meridian> {
        delegate!(self, surface => surface.meridian(apex, direction))
    }

    fn constant_curvature(&self) -> Option<CurvatureForm> {
        delegate!(self, surface => surface.constant_curvature())
    }
}
