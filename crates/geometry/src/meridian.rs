//! Meridians of surfaces of revolution, and sections of other surfaces in planes of symmetry, from the apex outwards.

use std::f64::consts::TAU;

use crate::HeightField;

/// The meridian of a surface of revolution from its apex, or the section of another surface in a plane of symmetry.
///
/// The parameter `t` is 0 at the apex and increases along the meridian. Points, normals, slope angles and arc-length
/// elements have relative errors of at most 1e-15. For a height field, the rounding errors of its formula determine the
/// errors instead.
///
/// ```
/// use palpate_geometry::Meridian;
///
/// let spheroid = Meridian::Spheroid { a: 2.0, c: 1.0 };
/// // A quarter of the ellipse leads from the pole to the equator.
/// let equator = spheroid.at(std::f64::consts::FRAC_PI_2);
/// assert!((equator.r - 2.0).abs() < 1e-15);
/// assert!((equator.height + 1.0).abs() < 1e-15);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub enum Meridian {
    /// The curve `z = −c r²` of a paraboloid or of a section of a saddle; the parameter is `r`.
    Paraboloid {
        /// Coefficient c (1/length) of the curve; negative for a bowl.
        c: f64,
    },
    /// The curve `r = a sin φ`, `height = c cos φ` of a spheroid or of a section of an ellipsoid, from its pole. `a` is
    /// the equatorial radius and `c` the polar half-axis; the parameter is φ.
    Spheroid {
        /// Equatorial radius (length) of the spheroid.
        a: f64,
        /// Polar half-axis (length) of the spheroid.
        c: f64,
    },
    /// The section of a height field along one of its coordinate axes, from the origin. The parameter is the coordinate
    /// along the axis. Outside of the height field's domain, all numbers are NaN.
    HeightField {
        /// The height field that contains the section.
        height: HeightField,
        /// Axis of the section: 0 for x, 1 for y.
        axis: usize,
    },
}

/// A point of a [`Meridian`] and the surface normal there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeridianPoint {
    /// Distance of the point from the axis of the meridian (length).
    pub r: f64,
    /// Height above the apex along the normal at the apex; negative below the apex.
    pub height: f64,
    /// Components of the unit normal: away from the axis (the sine of the slope angle) and along the axis (the cosine
    /// of the slope angle).
    pub normal: [f64; 2],
}

/// Slope angle of a [`Meridian`] at a point, and two derivatives with respect to the parameter: of the arc length and
/// of the slope angle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeridianSlope {
    /// Angle by which the normal has turned from the axis, positive on a convex surface.
    pub slope_rad: f64,
    /// Derivative of the arc length with respect to the parameter.
    pub arc_per_parameter: f64,
    /// Derivative of the slope angle with respect to the parameter.
    pub slope_per_parameter: f64,
}

impl Meridian {
    /// The point with parameter `t`. `t` and the coefficients of the meridian must be finite.
    pub fn at(&self, t: f64) -> MeridianPoint {
        let (r, height, [outward, along]) = match *self {
            Self::HeightField { ref height, axis } => {
                let ([apex, ..], [z, slope, _]) = (height.along(axis, 0.0), height.along(axis, t));
                (t, z - apex, [-slope, 1.0])
            }
            Self::Paraboloid { c } => (t, -c * t * t, [2.0 * c * t, 1.0]),
            Self::Spheroid { a, c } => {
                let (sin, cos) = libm::sincos(t);
                let height = -2.0 * c * libm::sin(0.5 * t).powi(2);
                (a * sin, height, [c * sin, a * cos])
            }
        };
        let length = libm::hypot(outward, along);
        MeridianPoint {
            r,
            height,
            normal: [outward / length, along / length],
        }
    }

    /// The slope at parameter `t`. As in [`Meridian::at`], `t` and the coefficients of the meridian must be finite.
    pub fn slope(&self, t: f64) -> MeridianSlope {
        let of_graph = |slope: f64, bend: f64| {
            let stretch = libm::hypot(slope, 1.0);
            MeridianSlope {
                slope_rad: libm::atan(slope),
                arc_per_parameter: stretch,
                slope_per_parameter: bend / stretch / stretch,
            }
        };
        match *self {
            Self::Paraboloid { c } => of_graph(2.0 * c * t, 2.0 * c),
            Self::HeightField { ref height, axis } => {
                let [_, slope, bend] = height.along(axis, t);
                of_graph(-slope, -bend)
            }
            Self::Spheroid { a, c } => {
                let (sin, cos) = libm::sincos(t);
                let square = (a * cos).powi(2) + (c * sin).powi(2);
                // The normal has the direction (c sin t, a cos t), with the semi-axes a and c and the parameter t. The
                // angle of the normal differs from t by less than a quarter turn. So the number of whole turns of the
                // normal follows from t.
                let within_turn = libm::atan2(c * sin, a * cos);
                let turns = ((t - within_turn) / TAU).round();
                MeridianSlope {
                    slope_rad: within_turn + turns * TAU,
                    arc_per_parameter: square.sqrt(),
                    slope_per_parameter: a * c / square,
                }
            }
        }
    }
}
