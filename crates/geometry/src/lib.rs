//! The vocabulary of the workspace: surfaces and their fundamental forms, curvature and its classes.
//!
//! One sign convention holds everywhere: a surface's unit normal points out of the solid, and
//! curvature is positive where the solid is convex. Symbols, units and equations are listed in
//! `NOTATION.md` beside this crate.
//!
//! Every [`Surface`] can be asked in two independent ways: through its chart (first and second
//! derivatives with respect to two parameters, see [`ChartGeometry`]) and chart-free (gradient and
//! Hessian of a level set, see [`LevelSet`]), which has no poles.
//!
//! This crate does no input or output, draws no random numbers and knows no file format.

pub mod curvature;
mod error;
pub mod formula;
mod fundamental;
mod level_set;
mod meridian;
mod posed;
mod reach;
mod shape;
mod surface;
pub mod surfaces;

pub use curvature::{
    CurvatureForm, InvalidThresholds, PrincipalCurvatures, ShapeClass, ShapeThresholds,
};
pub use error::{InvalidShape, SurfaceError};
pub use fundamental::{ChartGeometry, ChartJet, GaussFrame, Parameters};
pub use level_set::{LevelSet, TangentForm};
pub use meridian::{Meridian, MeridianPoint, MeridianSlope};
pub use posed::Posed;
pub use shape::{Shape, Visitor};
pub use surface::Surface;

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct ReadMe;
