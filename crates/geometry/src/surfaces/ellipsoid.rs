//! Triaxial ellipsoids.

use nalgebra::{Matrix3, Point3, Vector3};
use palpate_statistics::BadSetting;

use crate::error::{checked_length, is_within_reach};
use crate::{ChartJet, LevelSet, Meridian, Parameters, Surface, SurfaceError};

/// The ellipsoid `x²/a² + y²/b² + z²/c² = 1`.
///
/// Chart `(a sin u, b cos u sin v, c cos u cos v)` with |u| ≤ π/2: `u = v = 0` is the top, and the poles of the chart
/// lie on the x axis. The chart is not orthogonal unless two semi-axes are equal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ellipsoid {
    semi_axes: Vector3<f64>,
}

impl Ellipsoid {
    /// An ellipsoid with semi-axes along x, y and z.
    ///
    /// # Errors
    /// [`BadSetting`] unless all three semi-axes are between 1e-150 and 1e150.
    pub fn new(semi_axes: [f64; 3]) -> Result<Self, BadSetting> {
        for axis in semi_axes {
            checked_length("semi_axes", axis)?;
        }
        Ok(Self {
            semi_axes: Vector3::from(semi_axes),
        })
    }

    pub(crate) fn semi_axes(&self) -> [f64; 3] {
        self.semi_axes.into()
    }
}

impl Surface for Ellipsoid {
    fn chart(&self, at: Parameters) -> Result<ChartJet, SurfaceError> {
        let at = at.unless_beyond_pole()?;
        let (sin_u, cos_u) = libm::sincos(at.u);
        let (sin_v, cos_v) = libm::sincos(at.v);
        let scaled = |x: f64, y: f64, z: f64| self.semi_axes.component_mul(&Vector3::new(x, y, z));
        let outward = scaled(sin_u, cos_u * sin_v, cos_u * cos_v);
        Ok(ChartJet {
            point: Point3::from(outward),
            du: scaled(cos_u, -sin_u * sin_v, -sin_u * cos_v),
            dv: scaled(0.0, cos_u * cos_v, -cos_u * sin_v),
            duu: -outward,
            duv: scaled(0.0, -sin_u * cos_v, sin_u * sin_v),
            dvv: scaled(0.0, -cos_u * sin_v, -cos_u * cos_v),
        })
    }

    fn level_set(&self, point: &Point3<f64>) -> Result<LevelSet, SurfaceError> {
        let inverse_squares = self.semi_axes.map(|axis| 1.0 / (axis * axis));
        let gradient = point.coords.component_mul(&inverse_squares);
        LevelSet::new(gradient, Matrix3::from_diagonal(&inverse_squares))
            .ok_or_else(|| SurfaceError::off_domain(point))
    }

    fn parameters(&self, point: &Point3<f64>) -> Parameters {
        let unit = point.coords.component_div(&self.semi_axes);
        Parameters::new(
            libm::atan2(unit.x, libm::hypot(unit.y, unit.z)),
            libm::atan2(unit.y, unit.z),
        )
    }

    /// Computes the point `x` of the ellipsoid that is closest to the given point `p`. It satisfies
    /// `x_i/a_i = w_i/(σ + b_i)` with `w_i = p_i a_i/a_min²` and `b_i = (a_i/a_min)² − 1`, where `a_i` are the
    /// semi-axes and `a_min` is the shortest. σ is the only value `σ >= 0` for which `x` is on the ellipsoid (Eberly,
    /// *Distance from a Point to an Ellipse, an Ellipsoid, or a Hyperellipsoid*).
    fn closest_point(&self, point: &Point3<f64>) -> Result<Point3<f64>, SurfaceError> {
        let none = SurfaceError::no_closest_point(point);
        let smallest = self.semi_axes.min();
        let ratios = self.semi_axes / smallest;
        let weights = (point.coords / smallest).component_mul(&ratios);
        let beyond = ratios.map(|ratio| (ratio - 1.0) * (ratio + 1.0));
        if weights
            .iter()
            .chain(&beyond)
            .any(|length| !is_within_reach(*length, 0.0))
        {
            return Err(none);
        }
        let scaled = |sigma: f64| {
            weights.zip_map(&beyond, |w, b| if w == 0.0 { 0.0 } else { w / (sigma + b) })
        };

        // Newton's method solves Σ x_i²/a_i² = 1 for the unknown σ. It starts at the smallest σ for which no term of
        // this sum exceeds 1; the sum is then between 1 and 3. The sum is convex and decreases with σ, so the method
        // converges monotonically and fast.
        let mut sigma = (weights.abs() - beyond).max().max(0.0);
        let mut unit = scaled(sigma);
        if unit.norm_squared() < 1.0 - 8.0 * f64::EPSILON {
            // If the point lies in the plane of symmetry that is perpendicular to the shortest axis, two mirrored
            // points are equally close.
            return Err(none);
        }
        for _ in 0..64 {
            let fall: f64 = unit
                .zip_map(
                    &beyond,
                    |x, b| if x == 0.0 { 0.0 } else { x * x / (sigma + b) },
                )
                .sum();
            let next = sigma + 0.5 * (unit.norm_squared() - 1.0) / fall;
            if next > sigma {
                sigma = next;
                unit = scaled(sigma);
            } else {
                break;
            }
        }
        Ok(Point3::from(
            unit.normalize().component_mul(&self.semi_axes),
        ))
    }

    fn contact_at(&self, x: f64, y: f64) -> Result<Point3<f64>, SurfaceError> {
        let rim = libm::hypot(x / self.semi_axes.x, y / self.semi_axes.y);
        if rim <= 1.0 {
            let z = self.semi_axes.z * ((1.0 - rim) * (1.0 + rim)).sqrt();
            Ok(Point3::new(x, y, z))
        } else {
            Err(SurfaceError::OffDomain { x, y })
        }
    }

    fn meridian(&self, apex: &Point3<f64>, direction: &Vector3<f64>) -> Option<Meridian> {
        let [a, b, c] = self.semi_axes();
        let across = match (a == b || direction.y == 0.0, direction.x == 0.0) {
            (true, _) => a,
            (_, true) => b,
            _ => return None,
        };
        let from_the_top = apex.x == 0.0 && apex.y == 0.0 && apex.z > 0.0;
        from_the_top.then_some(Meridian::Spheroid { a: across, c })
    }
}
