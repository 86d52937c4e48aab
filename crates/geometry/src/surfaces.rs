//! The surfaces themselves, one family per file.

mod cylinder;
mod ellipsoid;
mod graph;
mod plane;
mod sphere;
mod torus;

pub use cylinder::Cylinder;
pub use ellipsoid::Ellipsoid;
pub use graph::{Graph, Height, HeightField, HeightJet, Paraboloid, Saddle};
pub use plane::Plane;
pub use sphere::{Dish, Sphere};
pub use torus::Torus;
