//! Surfaces, their fundamental forms, their curvature, and the classes of surface points by curvature. All crates use
//! these types.
//!
//! All crates use one sign convention: a surface's unit normal points out of the solid, and curvature is positive where
//! the solid is convex. The page `docs/notation.md` lists symbols, units and equations.
//!
//! Every [`Surface`] has two independent descriptions. One uses a chart: first and second derivatives with respect to
//! two parameters, see [`ChartGeometry`]. The other is chart-free and has no poles: gradient and Hessian of a level
//! set, see [`LevelSet`].
//!
//! This crate has no input or output, no random numbers and no file formats.

mod curvature;
mod error;
mod formula;
mod fundamental;
mod level_set;
mod meridian;
mod surface;
mod surfaces;

pub use curvature::{
    CurvatureForm, InvalidThresholds, PrincipalCurvatures, ShapeClass, ShapeThresholds,
    UNKNOWN_DIRECTION_STD,
};
pub use error::SurfaceError;
pub use formula::{Formula, FormulaError, Jet};
pub use fundamental::{ChartGeometry, ChartJet, Parameters};
pub use level_set::{LevelSet, TangentForm};
pub use meridian::{Meridian, MeridianPoint, MeridianSlope};
pub use surface::Surface;
pub use surfaces::{
    Ball, Cylinder, Dish, Ellipsoid, Graph, HeightField, Paraboloid, Plane, Saddle, Shape, Sphere,
    Torus, Visitor,
};

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct ReadMe;
