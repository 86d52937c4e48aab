//! The surface of the object that the sensor explores.

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The shape of the object's surface.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "kebab-case", deny_unknown_fields)]
pub enum ObjectConfig {
    /// The outside of a sphere. The probe touches its upper half.
    Sphere {
        /// Radius of the sphere.
        #[schemars(extend("exclusiveMinimum" = 0, "x-unit" = "length"))]
        radius: f64,
    },
    /// The inside of a sphere. The probe touches its lower half.
    Dish {
        /// Radius of the sphere.
        #[schemars(extend("exclusiveMinimum" = 0, "x-unit" = "length"))]
        radius: f64,
    },
    /// A plane.
    Plane {},
    /// The outside of a circular cylinder.
    Cylinder {
        /// Radius of the cylinder.
        #[schemars(extend("exclusiveMinimum" = 0, "x-unit" = "length"))]
        radius: f64,
        /// Angle between the cylinder's axis and the x axis. The axis is horizontal.
        #[serde(default)]
        direction_deg: f64,
    },
    /// An ellipsoid. The probe touches its upper half.
    Ellipsoid {
        /// Semi-axes along x, y and z.
        #[schemars(extend("items" = { "type": "number", "exclusiveMinimum": 0 }, "x-unit" = "length"))]
        semi_axes: [f64; 3],
    },
    /// A ring torus around the z axis.
    Torus {
        /// Distance between the z axis and the centre of the tube.
        #[schemars(extend("exclusiveMinimum" = 0, "x-unit" = "length"))]
        major_radius: f64,
        /// Radius of the tube, less than the major radius.
        #[schemars(extend("exclusiveMinimum" = 0, "x-unit" = "length"))]
        minor_radius: f64,
    },
    /// The paraboloid of revolution z = −c (x² + y²).
    Paraboloid {
        /// Half the curvature at the apex: positive for a convex hill, negative for a bowl.
        #[schemars(extend("x-unit" = "1/length"))]
        c: f64,
    },
    /// The saddle z = a (x² − y²).
    Saddle {
        /// Coefficient a of the saddle. At the origin, the curvature is −2a along x and 2a along y.
        #[schemars(extend("x-unit" = "1/length"))]
        a: f64,
    },
    /// The surface z = f(x, y), where a formula defines f.
    HeightField {
        /// Formula of f, written with x, y and the parameters, e.g. `A*sin(k*x)*cos(k*y)`.
        formula: String,
        /// Values of the formula's parameters.
        #[serde(default)]
        parameters: BTreeMap<String, f64>,
    },
}
