//! The surface that is explored.

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The shape of the explored surface.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "kebab-case", deny_unknown_fields)]
pub enum ObjectConfig {
    /// The outside of a sphere, touched on its upper half.
    Sphere {
        /// Its radius.
        #[schemars(extend("exclusiveMinimum" = 0, "x-unit" = "length"))]
        radius: f64,
    },
    /// The inside of a sphere, touched on its lower half.
    Dish {
        /// Its radius.
        #[schemars(extend("exclusiveMinimum" = 0, "x-unit" = "length"))]
        radius: f64,
    },
    /// A plane.
    Plane {},
    /// The outside of a circular cylinder.
    Cylinder {
        /// Its radius.
        #[schemars(extend("exclusiveMinimum" = 0, "x-unit" = "length"))]
        radius: f64,
        /// Angle of its axis from x.
        #[serde(default)]
        direction_deg: f64,
    },
    /// An ellipsoid, touched on its upper half.
    Ellipsoid {
        /// Semi-axes along x, y and z.
        #[schemars(extend("items" = { "type": "number", "exclusiveMinimum": 0 }, "x-unit" = "length"))]
        semi_axes: [f64; 3],
    },
    /// A ring torus around z.
    Torus {
        /// Distance of the tube's centre from z.
        #[schemars(extend("exclusiveMinimum" = 0, "x-unit" = "length"))]
        major_radius: f64,
        /// Radius of the tube, less than the major radius.
        #[schemars(extend("exclusiveMinimum" = 0, "x-unit" = "length"))]
        minor_radius: f64,
    },
    /// The paraboloid of revolution z = −c (x² + y²).
    Paraboloid {
        /// Half the curvature at the apex; positive is convex, negative is a bowl.
        #[schemars(extend("x-unit" = "1/length"))]
        c: f64,
    },
    /// The saddle z = a (x² − y²).
    Saddle {
        /// Half the curvature at the origin.
        #[schemars(extend("x-unit" = "1/length"))]
        a: f64,
    },
    /// The graph z = f(x, y) of a formula.
    HeightField {
        /// f, a formula in x, y and the parameters, e.g. `A*sin(k*x)*cos(k*y)`.
        formula: String,
        /// Values of the formula's parameters.
        #[serde(default)]
        parameters: BTreeMap<String, f64>,
    },
}
