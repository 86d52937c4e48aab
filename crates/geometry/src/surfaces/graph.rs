//! Graphs z = f(x, y): paraboloid, saddle, and height fields from formulas.

use nalgebra::{Matrix2, Matrix3, Point3, Vector2, Vector3};
use palpate_statistics::BadSetting;

use crate::error::{SQUARABLE, checked_finite, is_within_reach};
use crate::formula::Formula;
use crate::{ChartJet, Jet, LevelSet, Meridian, Parameters, Surface, SurfaceError, TangentForm};

/// A twice differentiable height z = f(x, y).
pub(crate) trait Height {
    /// Largest allowed slope. Places with a larger slope, for example near a vertical wall, do not belong to the graph.
    const STEEPEST: f64 = *SQUARABLE.end();

    /// Height and derivatives at `(x, y)`. Where the height is undefined or not twice
    /// differentiable, some of the derivatives are not finite.
    fn jet(&self, x: f64, y: f64) -> Jet;

    /// The section of the graph through its point at `(x, y)`, as in [`Surface::meridian`] with this point as the apex.
    fn meridian_at(&self, _x: f64, _y: f64, _direction: &Vector3<f64>) -> Option<Meridian> {
        None
    }

    /// Whether a ball of `radius` that touches the graph of this height may penetrate it at another place, as in
    /// [`Surface::may_touch_twice`].
    fn may_touch_twice(&self, radius: f64) -> bool;
}

/// The graph of a height in the Monge chart `(x, y, f(x, y))`. The solid is below the graph.
///
/// ```
/// use nalgebra::Vector3;
/// use palpate_geometry::{Graph, Surface};
///
/// // At the apex of z = −c (x² + y²) every normal curvature is 2 c.
/// let bump = Graph::paraboloid(0.25)?;
/// let apex = bump.contact_at(0.0, 0.0)?;
/// let form = bump.level_set(&apex)?.curvature(&Vector3::x(), &Vector3::y());
/// assert_eq!((form.k_uu, form.k_uv, form.k_vv), (0.5, 0.0, 0.5));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Graph<H> {
    height: H,
}

/// The paraboloid `z = −c (x² + y²)`, which is a bowl if `c < 0`. The radius of curvature at the apex is `1/(2c)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Paraboloid {
    c: f64,
}

/// The saddle `z = a (x² − y²)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Saddle {
    a: f64,
}

/// The graph `z = f(x, y)` of a [`Formula`].
#[derive(Clone, Debug, PartialEq)]
pub struct HeightField {
    formula: Formula,
}

impl<H> Graph<H> {
    pub(crate) const fn of_height(height: H) -> Self {
        Self { height }
    }
}

impl Graph<Paraboloid> {
    /// The graph `z = −c (x² + y²)`.
    ///
    /// # Errors
    /// [`BadSetting`] unless `c` (1/length) is finite.
    pub fn paraboloid(c: f64) -> Result<Self, BadSetting> {
        let c = checked_finite("c", c)?;
        Ok(Self::of_height(Paraboloid { c }))
    }
}

impl Graph<Saddle> {
    /// The graph `z = a (x² − y²)`.
    ///
    /// # Errors
    /// [`BadSetting`] unless `a` (1/length) is finite.
    pub fn saddle(a: f64) -> Result<Self, BadSetting> {
        let a = checked_finite("a", a)?;
        Ok(Self::of_height(Saddle { a }))
    }
}

/// The graph of a formula.
impl From<Formula> for Graph<HeightField> {
    fn from(formula: Formula) -> Self {
        Self::of_height(HeightField { formula })
    }
}

impl HeightField {
    /// The height and its first and second derivatives at the distance `t` from the origin along the x axis (`axis` =
    /// 0) or the y axis (1). NaN outside the domain of the graph: where the height or a derivative is not finite, where
    /// the slope is too large, or where `t` is too large.
    pub(crate) fn along(&self, axis: usize, t: f64) -> [f64; 3] {
        checked_jet(self, [t, 0.0][axis], [0.0, t][axis]).map_or([f64::NAN; 3], |jet| {
            [jet.value, jet.gradient[axis], jet.hessian[2 * axis]]
        })
    }
}

impl Height for Paraboloid {
    #[inline]
    fn jet(&self, x: f64, y: f64) -> Jet {
        let twice = -2.0 * self.c;
        Jet {
            value: -self.c * (x * x + y * y),
            gradient: [twice * x, twice * y],
            hessian: [twice, 0.0, twice],
        }
    }

    fn meridian_at(&self, x: f64, y: f64, _: &Vector3<f64>) -> Option<Meridian> {
        (x == 0.0 && y == 0.0).then_some(Meridian::Paraboloid { c: self.c })
    }

    // A ball that touches one side of a bowl touches the opposite side too if its centre is on the axis. In this
    // position, the bowl's curvature across the meridian equals the ball's curvature, so the ball does not fit into the
    // bowl at the contact. A ball that fits therefore never touches twice.
    fn may_touch_twice(&self, _radius: f64) -> bool {
        false
    }
}

impl Height for Saddle {
    #[inline]
    fn jet(&self, x: f64, y: f64) -> Jet {
        let twice = 2.0 * self.a;
        Jet {
            value: self.a * (x - y) * (x + y),
            gradient: [twice * x, -twice * y],
            hessian: [twice, 0.0, -twice],
        }
    }

    fn meridian_at(&self, x: f64, y: f64, direction: &Vector3<f64>) -> Option<Meridian> {
        let c = match (direction.y == 0.0, direction.x == 0.0) {
            (true, _) => -self.a,
            (_, true) => self.a,
            _ => return None,
        };
        (x == 0.0 && y == 0.0).then_some(Meridian::Paraboloid { c })
    }

    // A ball touches both sides of a valley only if its centre reaches the valley's plane of symmetry. This is only
    // possible if the radius of curvature at the bottom of the valley is at most the radius of the ball.
    fn may_touch_twice(&self, radius: f64) -> bool {
        2.0 * self.a.abs() * radius > 1.0
    }
}

impl Height for HeightField {
    // Near a vertical wall, such as that of sqrt(1 − x) at x = 1, the rounding error of x causes a large error of the
    // height. Therefore limit the slope.
    const STEEPEST: f64 = 1e6;

    fn jet(&self, x: f64, y: f64) -> Jet {
        let jet = self.formula.jet(x, y);
        // For x < 0, ln(x) is NaN, but the formulas of its derivatives are finite. Therefore 0 · NaN is added, which
        // makes the derivatives NaN too.
        let nothing = 0.0 * jet.value;
        Jet {
            hessian: jet.hessian.map(|second| second + nothing),
            ..jet
        }
    }

    /// Returns a section at the vertex of a polynomial of degree two, along its principal directions x and y. For any
    /// other formula, returns a section only at the origin. The section has any direction if the graph is a surface of
    /// revolution. It must lie along x or y if the graph is only symmetric about both axes.
    fn meridian_at(&self, x: f64, y: f64, direction: &Vector3<f64>) -> Option<Meridian> {
        let is_along = [direction.y == 0.0, direction.x == 0.0];
        if let Some([_, fx, fy, xx, xy, yy]) = self.formula.quadratic() {
            let is_vertex = fx + 2.0 * xx * x == 0.0 && fy + 2.0 * yy * y == 0.0 && xy == 0.0;
            let c = match is_along {
                [true, _] => -xx,
                [_, true] => -yy,
                _ if xx == yy => -xx,
                _ => return None,
            };
            return is_vertex.then_some(Meridian::Paraboloid { c });
        }
        let axis = usize::from(is_along[1]);
        let is_symmetric = self.formula.is_revolved() || (is_along[axis] && self.formula.is_even());
        (x == 0.0 && y == 0.0 && is_symmetric).then(|| Meridian::HeightField {
            height: self.clone(),
            axis,
        })
    }

    fn may_touch_twice(&self, _radius: f64) -> bool {
        true
    }
}

#[inline]
fn checked_jet<H: Height>(height: &H, x: f64, y: f64) -> Result<Jet, SurfaceError> {
    let jet = height.jet(x, y);
    let [fx, fy] = jet.gradient;
    let steep = fx.abs().max(fy.abs()) > H::STEEPEST;
    // Check only the sum of the height and its derivatives, because the sum is finite only if all of them are
    // finite.
    let [fxx, fxy, fyy] = jet.hessian;
    let is_finite = (jet.value + fx + fy + fxx + fxy + fyy).is_finite();
    if is_finite && !steep && is_within_reach(x, y) {
        Ok(jet)
    } else {
        Err(SurfaceError::OffDomain { x, y })
    }
}

/// A candidate for the point of a graph that is closest to a target point.
struct Foot {
    at: Vector2<f64>,
    height: f64,
    slope: Vector2<f64>,
    /// Half the squared distance from the candidate to the target. The next two fields are its gradient and its Hessian
    /// with respect to (x, y).
    half_square: f64,
    gradient: Vector2<f64>,
    hessian: Matrix2<f64>,
    /// Determinant of the Gauss–Newton matrix `I + s sᵀ`, where I is the identity and s the slope. The next field is
    /// the determinant of the Hessian. Both determinants are computed from expanded formulas, because on a steep slope
    /// the formula `(1 + s_x²)(1 + s_y²) − s_x² s_y²` loses all digits.
    stretch: f64,
    determinant: f64,
}

impl Foot {
    fn new<H: Height>(
        graph: &Graph<H>,
        target: &Point3<f64>,
        at: Vector2<f64>,
    ) -> Result<Self, SurfaceError> {
        let jet = checked_jet(&graph.height, at.x, at.y)?;
        let [fxx, fxy, fyy] = jet.hessian;
        let slope = Vector2::from(jet.gradient);
        let aside = at - target.xy().coords;
        // If the heights of the candidate and the target differ only by the rounding error, the difference counts as 0.
        // Otherwise, near a sharp peak, the rounding error would be multiplied by a large curvature, and the peak would
        // look like a hollow.
        let above = match jet.value - target.z {
            tiny if tiny.abs() <= 2.0 * f64::EPSILON * target.z.abs() => 0.0,
            above => above,
        };
        let stretch = 1.0 + slope.norm_squared();
        let bend = fxx + fyy + fxx * slope.y * slope.y + fyy * slope.x * slope.x
            - 2.0 * fxy * slope.x * slope.y;
        let gauss_newton = Matrix2::identity() + slope * slope.transpose();
        Ok(Self {
            at,
            height: jet.value,
            slope,
            half_square: 0.5 * (aside.norm_squared() + above * above),
            gradient: aside + slope * above,
            hessian: gauss_newton + Matrix2::new(fxx, fxy, fxy, fyy) * above,
            stretch,
            determinant: stretch + above * (bend + above * (fxx * fyy - fxy * fxy)),
        })
    }

    fn is_minimum(&self) -> bool {
        self.hessian.m11 > 0.0 && self.determinant > 0.0
    }

    /// Newton's step towards the minimum of the squared distance. Where the Hessian is not positive definite, it is the
    /// Gauss–Newton step.
    fn step(&self) -> Option<Vector2<f64>> {
        let (hessian, determinant) = if self.is_minimum() {
            (self.hessian, self.determinant)
        } else {
            let of_a_plane = Matrix2::identity() + self.slope * self.slope.transpose();
            (of_a_plane, self.stretch)
        };
        let adjugate = Matrix2::new(hessian.m22, -hessian.m12, -hessian.m21, hessian.m11);
        let step = -adjugate * self.gradient / determinant;
        step.sum().is_finite().then_some(step)
    }

    /// Whether this candidate is better than the candidate `other`, that is, closer to the target. A small increase of
    /// the squared distance, by a factor below 1 + 1e-6, is accepted if the gradient here is less than half of the
    /// gradient at `other`.
    fn improves(&self, other: &Self) -> bool {
        let settles = self.gradient.norm() < 0.5 * other.gradient.norm();
        let allowance = if settles { 1.0 + 1e-6 } else { 1.0 };
        self.half_square < other.half_square * allowance
    }
}

impl<H: Height> Surface for Graph<H> {
    const IS_GRAPH: bool = true;

    fn chart(&self, at: Parameters) -> Result<ChartJet, SurfaceError> {
        let jet = checked_jet(&self.height, at.u, at.v)?;
        let [fx, fy] = jet.gradient;
        let [fxx, fxy, fyy] = jet.hessian;
        Ok(ChartJet {
            point: Point3::new(at.u, at.v, jet.value),
            du: Vector3::new(1.0, 0.0, fx),
            dv: Vector3::new(0.0, 1.0, fy),
            duu: Vector3::z() * fxx,
            duv: Vector3::z() * fxy,
            dvv: Vector3::z() * fyy,
        })
    }

    #[inline]
    fn level_set(&self, point: &Point3<f64>) -> Result<LevelSet, SurfaceError> {
        // The level set belongs to the function F = z − f(x, y).
        let jet = checked_jet(&self.height, point.x, point.y)?;
        let [fx, fy] = jet.gradient;
        let [fxx, fxy, fyy] = jet.hessian;
        let hessian = Matrix3::new(-fxx, -fxy, 0.0, -fxy, -fyy, 0.0, 0.0, 0.0, 0.0);
        LevelSet::new(Vector3::new(-fx, -fy, 1.0), hessian)
            .ok_or_else(|| SurfaceError::off_domain(point))
    }

    #[inline]
    fn tangent_form(
        &self,
        point: &Point3<f64>,
        x: &Vector3<f64>,
    ) -> Result<TangentForm, SurfaceError> {
        let jet = self.height.jet(point.x, point.y);
        let [fx, fy] = jet.gradient;
        let [fxx, fxy, fyy] = jet.hessian;
        let steepness_squared = 1.0 + fx * fx + fy * fy;
        // Two checks replace the checks of `Graph::jet`: if a derivative is NaN, `in_domain` is false or the sum of the
        // second derivatives is not finite. In both cases, the point is rejected.
        let in_domain = steepness_squared <= H::STEEPEST * H::STEEPEST;
        if !(in_domain && (fxx + fxy + fyy).is_finite()) {
            return Err(SurfaceError::off_domain(point));
        }
        let gradient = Vector3::new(-fx, -fy, 1.0);
        let y = x.cross(&gradient);
        let bend_x = [fxx * x.x + fxy * x.y, fxy * x.x + fyy * x.y];
        let bend_y = [fxx * y.x + fxy * y.y, fxy * y.x + fyy * y.y];
        Ok(TangentForm {
            gradient,
            steepness: steepness_squared.sqrt(),
            steepness_squared,
            xx: -(x.x * bend_x[0] + x.y * bend_x[1]),
            xy: -(y.x * bend_x[0] + y.y * bend_x[1]),
            yy: -(y.x * bend_y[0] + y.y * bend_y[1]),
        })
    }

    fn parameters(&self, point: &Point3<f64>) -> Parameters {
        Parameters::new(point.x, point.y)
    }

    fn closest_point(&self, point: &Point3<f64>) -> Result<Point3<f64>, SurfaceError> {
        self.closest_point_from(point, point.xy().coords)
    }

    /// Finds the closest point with a damped Newton's method on the squared distance. Where the Hessian is not positive
    /// definite, it uses Gauss–Newton steps.
    fn closest_point_from(
        &self,
        point: &Point3<f64>,
        start: Vector2<f64>,
    ) -> Result<Point3<f64>, SurfaceError> {
        let none = SurfaceError::no_closest_point(point);
        let mut foot = Foot::new(self, point, start)?;
        // The squared distance is not finite if the `z` of the point is NaN, or if a square has overflowed.
        if !foot.half_square.is_finite() {
            return Err(none);
        }
        for _ in 0..200 {
            let step = foot.step().ok_or(none)?;
            let shorter = (0..40)
                .map(|halvings| foot.at + step * libm::scalbn(1.0, -halvings))
                .take_while(|next| *next != foot.at)
                .filter_map(|next| Foot::new(self, point, next).ok())
                .find(|next| next.improves(&foot));
            let Some(next) = shorter else { break };
            foot = next;
        }
        // The iteration may end at a stationary point of the distance that is not a minimum. In this case, two points
        // on both sides of the stationary point are equally close, so no single point is closest.
        if foot.is_minimum() {
            Ok(Point3::new(foot.at.x, foot.at.y, foot.height))
        } else {
            Err(none)
        }
    }

    fn contact_at(&self, x: f64, y: f64) -> Result<Point3<f64>, SurfaceError> {
        Ok(Point3::new(x, y, checked_jet(&self.height, x, y)?.value))
    }

    fn meridian(&self, apex: &Point3<f64>, direction: &Vector3<f64>) -> Option<Meridian> {
        self.height.meridian_at(apex.x, apex.y, direction)
    }

    fn may_touch_twice(&self, radius: f64) -> bool {
        self.height.may_touch_twice(radius)
    }
}
