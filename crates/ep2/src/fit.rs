//! The surface that a method fits to a patch, with its curvature and standard errors at any place.

use std::ops::Range;

use nalgebra::{Point3, SMatrix, Vector3};

use crate::curvature::{Curvatures, form_and_basis, principal_stds};
use crate::penalised::Basis;
use crate::posterior::{Posterior, PosteriorLine, Series};
use crate::spline::{Jet, LANES, Lanes, Local, TensorSpline};
use crate::square_quadric::{Square, SquareQuadric};
use crate::{Curvature, Ep2Error, MisfitTest, NoiseEstimate, Patch, PatchFrame, Status};

/// Maximum number of grid points along each side of a map.
const MAX_SIDE: usize = 2048;

/// A method that fits a surface to the contacts of a patch.
pub trait Method {
    /// Fits a surface to the contacts of a patch.
    ///
    /// # Errors
    /// [`Ep2Error`] if the contacts do not determine the surface, or a setting is out of its range.
    fn fit(&self, patch: &Patch) -> Result<Fit, Ep2Error>;

    /// Tests the fit. Returns the goodness of fit, and the ways in which the contacts contradict the method's model.
    /// Both are empty for methods without a test. `fit` is the method's fit to the patch, if it was already computed.
    /// Without it, or if there are more than 2,000 contacts, the test computes a fit to at most 2,000 contacts.
    ///
    /// # Errors
    /// Errors of [`Method::fit`].
    fn misfit(&self, _patch: &Patch, _fit: Option<&Fit>) -> Result<MisfitTest, Ep2Error> {
        Ok(MisfitTest::default())
    }
}

/// The fitted surface of a patch, as a graph in the patch's frame.
#[derive(Clone, Debug)]
pub struct Fit {
    /// The patch's frame. Its scale is the unit of length of the spline.
    pub frame: PatchFrame,
    /// The rectangle that contains the contacts, in the patch's frame: smallest and largest u, then smallest and
    /// largest v.
    pub domain: [[f64; 2]; 2],
    /// The surface as a height w(u, v) over the plane of the patch. If `mean` is not `None`, the spline is only the
    /// deviation of the surface from this quadric.
    pub(crate) spline: TensorSpline,
    /// The implicit quadric to which the spline is added, with the square in which the quadric is defined. `None` if
    /// the spline alone describes the surface.
    pub(crate) mean: Option<(SquareQuadric, Square)>,
    /// Posterior mean and covariance of the surface, if the method computes them.
    pub(crate) posterior: Option<Posterior>,
    /// For a penalised spline, the surface from which the spline describes the deviation; `None` for other methods.
    pub(crate) basis: Option<Box<Basis>>,
    /// Noise of the contacts: stated, or estimated by the method.
    pub noise: Option<NoiseEstimate>,
    /// Effective degrees of freedom of the fit: the trace of the linear map from the observations to the fitted values.
    pub effective_unknowns: f64,
    /// Status of the smoothing splines; `None` if the method uses no smoothing splines. If a spline did not reach its
    /// required sum of squared residuals, it is the status of the first such spline, and the curvature is useless.
    /// Otherwise it is the status of the last spline.
    pub status: Option<Status>,
}

/// A point of the fitted surface, in the frame of the readings.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MapPoint {
    /// Position of the point.
    pub position: Point3<f64>,
    /// The unit normal of the surface at the point, out of the object.
    pub normal: Vector3<f64>,
    /// Gaussian and mean curvature at the point.
    pub curvature: Curvature,
    /// Smallest normal curvature at the point, 1/length; positive where the surface is convex.
    pub k_min: f64,
    /// Largest normal curvature at the point, 1/length.
    pub k_max: f64,
    /// Unit tangent along the direction of `k_min`, with an arbitrary sign. At an umbilic (equal curvatures), any
    /// direction.
    pub direction_of_min: Vector3<f64>,
    /// Unit tangent along the direction of `k_max`, with an arbitrary sign. At an umbilic (equal curvatures), any
    /// direction.
    pub direction_of_max: Vector3<f64>,
    /// Shape index, in [−1, 1]: +1 for a convex cap, −1 for a cup; `None` where the surface is flat.
    pub shape_index: Option<f64>,
}

impl MapPoint {
    pub(crate) fn is_finite(&self) -> bool {
        let directions = [self.normal, self.direction_of_min, self.direction_of_max];
        let mut numbers = directions.iter().flatten().chain(self.position.iter());
        numbers.all(|number| number.is_finite())
            && self.curvature.is_finite()
            && self.k_min.is_finite()
            && self.k_max.is_finite()
    }
}

fn check_side(side: usize) -> Result<(), Ep2Error> {
    let is_good = side <= MAX_SIDE;
    Ep2Error::unless_good("grid", side as f64, is_good, "at most 2048")
}

impl Fit {
    /// Removes the standard errors from the fit, which makes the computation of curvatures faster.
    pub fn without_uncertainty(self) -> Self {
        Self {
            posterior: None,
            ..self
        }
    }

    /// Gaussian and mean curvature at the point where the line through `world` along the patch's normal meets the
    /// surface. For exact contacts on a paraboloid, a fitted quadric or penalised spline has an error at the apex of at
    /// most 1e-11 of the larger principal curvature.
    ///
    /// # Errors
    /// [`Ep2Error::OutOfRange`] if the curvature is beyond the range of doubles.
    pub fn curvature_at(&self, world: &Point3<f64>) -> Result<Curvature, Ep2Error> {
        let place = self.frame.point(world);
        Ok(self.jet_and_curvature(place.x, place.y)?.1)
    }

    /// Standard errors of the principal curvatures k_min and k_max (1/length), and of the angle of their directions (rad),
    /// at the same point as [`Fit::curvature_at`]. They have the properties of
    /// [`CurvatureForm::principal_stds`](palpate_geometry::CurvatureForm::principal_stds). `None` if the method computes
    /// no standard errors.
    pub fn principal_stds_at(&self, world: &Point3<f64>) -> Option<[f64; 3]> {
        let place = self.frame.point(world);
        let local = Local::of(&self.spline.u, place.x);
        let line = Line::of(self, place.y, 0..self.spline.u.functions());
        let jets = line.jet(&Local::side_by_side([&local; LANES]), self);
        let series = self.series([place.x; LANES])?;
        let errors = line.posterior.as_ref()?.errors(&series, &jets);
        let covariance = SMatrix::from_fn(|row, at| errors[row][at].to_array()[0]);
        let [min, max, angle] = principal_stds(&self.jet(place.x, place.y), &covariance);
        let scale = self.frame.scale();
        Some([min / scale, max / scale, angle])
    }

    /// The point of the surface at a place (u, v) in the patch's coordinates.
    ///
    /// # Errors
    /// [`Ep2Error::OutOfRange`] if the surface is beyond the range of doubles.
    pub(crate) fn point_at(&self, u: f64, v: f64) -> Result<MapPoint, Ep2Error> {
        let (jet, curvature) = self.jet_and_curvature(u, v)?;
        self.map_point([u, v], &jet, curvature)
    }

    /// For each position in `world`, the point of the surface that lies on the line through this position along the
    /// patch's normal.
    ///
    /// # Errors
    /// [`Ep2Error::OutOfRange`] if the surface exceeds the range of doubles.
    pub fn points_at(&self, world: &[Point3<f64>]) -> Result<Vec<MapPoint>, Ep2Error> {
        world
            .iter()
            .map(|point| {
                let place = self.frame.point(point);
                self.point_at(place.x, place.y)
            })
            .collect()
    }

    /// The point of the fitted surface in the middle of the patch.
    ///
    /// # Errors
    /// [`Ep2Error::OutOfRange`] if the surface exceeds the range of doubles.
    pub fn centre(&self) -> Result<MapPoint, Ep2Error> {
        let [u, v] = self.domain.map(|[low, high]| 0.5 * low + 0.5 * high);
        self.point_at(u, v)
    }

    /// Gaussian and mean curvature on a grid of `side` × `side` points over the rectangle of the contacts. u varies
    /// slowest.
    ///
    /// # Errors
    /// Errors of [`Fit::curvature_at`]; [`Ep2Error::BadSetting`] for more than 2048 places along a side.
    pub fn curvatures(&self, side: usize) -> Result<Vec<Curvature>, Ep2Error> {
        check_side(side)?;
        let columns = self.columns(side);
        let mut by_v: Vec<Curvatures> = Vec::with_capacity(side * columns.len());
        self.for_each_line(side, |line| {
            for one in &columns {
                let (_, curvatures) = self.on_line(line, &one.locals, &one.series, one.places)?;
                by_v.push(curvatures);
            }
            Ok(())
        })?;
        let mut result = Vec::with_capacity(side * side);
        for (index, one) in columns.iter().enumerate() {
            for lane in 0..one.count {
                let column = by_v[index..].iter().step_by(columns.len());
                result.extend(column.map(|curvatures| curvatures.at(lane)));
            }
        }
        Ok(result)
    }

    /// The fitted surface on a grid of `side` × `side` points over the rectangle of the contacts; u varies slowest.
    ///
    /// # Errors
    /// The errors of [`Fit::centre`]; [`Ep2Error::BadSetting`] if there are more than 2048 points along a side.
    pub fn map(&self, side: usize) -> Result<Vec<MapPoint>, Ep2Error> {
        check_side(side)?;
        let columns = self.columns(side);
        let mut by_v = Vec::with_capacity(side * side);
        self.for_each_line(side, |line| {
            for one in &columns {
                let (jets, curvatures) =
                    self.on_line(line, &one.locals, &one.series, one.places)?;
                for (lane, jet) in jets.lanes()[..one.count].iter().enumerate() {
                    let place = [one.places[lane], line.v];
                    by_v.push(self.map_point(place, jet, curvatures.at(lane))?);
                }
            }
            Ok(())
        })?;
        let mut result = Vec::with_capacity(side * side);
        for column in 0..side {
            result.extend(by_v[column..].iter().step_by(side));
        }
        Ok(result)
    }

    /// The columns of a grid of points, in groups of neighbouring columns that are computed together.
    fn columns(&self, side: usize) -> Vec<Columns> {
        let columns: Vec<(f64, Local)> = places(self.domain[0], side)
            .map(|u| (u, Local::of(&self.spline.u, u)))
            .collect();
        columns
            .chunk_by(|(_, one), (_, other)| one.first == other.first)
            .flat_map(|interval| interval.chunks(LANES))
            .map(|columns| Columns::of(columns, self))
            .collect()
    }

    fn for_each_line(
        &self,
        side: usize,
        mut visit: impl FnMut(&Line) -> Result<(), Ep2Error>,
    ) -> Result<(), Ep2Error> {
        for v in places(self.domain[1], side) {
            visit(&Line::of(self, v, 0..self.spline.u.functions()))?;
        }
        Ok(())
    }

    fn jet_and_curvature(&self, u: f64, v: f64) -> Result<(Jet, Curvature), Ep2Error> {
        let local = Local::of(&self.spline.u, u);
        let functions = local.first..local.first + self.spline.u.degree() + 1;
        let line = Line::of(self, v, functions);
        let (locals, series) = (
            Local::side_by_side([&local; LANES]),
            self.series([u; LANES]),
        );
        let (jets, curvatures) = self.on_line(&line, &locals, &series, [u; LANES])?;
        Ok((jets.lanes()[0], curvatures.at(0)))
    }

    pub(crate) fn jet(&self, u: f64, v: f64) -> Jet {
        let mut jet = self.spline.jet(u, v);
        if let Some((mean, square)) = &self.mean {
            mean.add_to(&mut jet, square, [u, v]);
        }
        jet
    }

    /// Values of the Chebyshev polynomials at the coordinates `u`, from which the standard errors at these places are
    /// computed. `None` if the fit has no standard errors.
    fn series(&self, u: [f64; LANES]) -> Option<Series> {
        let posterior = self.posterior.as_ref()?;
        Some(posterior.series(Lanes::from(u)))
    }

    #[inline(always)]
    fn on_line(
        &self,
        line: &Line,
        locals: &Local<Lanes>,
        series: &Option<Series>,
        u: [f64; LANES],
    ) -> Result<(Jet<Lanes>, Curvatures), Ep2Error> {
        let mut jet = line.jet(locals, self);
        let posterior = line.posterior.as_ref().zip(series.as_ref());
        let errors = posterior.map(|(line, series)| line.errors(series, &jet));
        if let Some((mean, square)) = &self.mean {
            let mut jets = jet.lanes();
            for (jet, u) in jets.iter_mut().zip(u) {
                mean.add_to(jet, square, [u, line.v]);
            }
            jet = Jet::side_by_side(&jets);
        }
        let curvatures = Curvatures::of_graph(&jet, errors.as_ref(), self.frame.scale())?;
        Ok((jet, curvatures))
    }

    fn map_point(
        &self,
        [u, v]: [f64; 2],
        jet: &Jet,
        curvature: Curvature,
    ) -> Result<MapPoint, Ep2Error> {
        let (form, [along, across]) = form_and_basis(jet);
        let principal = form.principal();
        let (sin, cos) = libm::sincos(principal.angle_of_max_rad);
        let in_world = |direction: Vector3<f64>| self.frame.direction_in_world(&direction);
        let point = MapPoint {
            position: self.frame.point_in_world(&Vector3::new(u, v, jet.w)),
            normal: in_world(along.cross(&across)),
            curvature,
            k_min: principal.k_min / self.frame.scale(),
            k_max: principal.k_max / self.frame.scale(),
            direction_of_min: in_world(across * cos - along * sin),
            direction_of_max: in_world(along * cos + across * sin),
            shape_index: principal.shape_index(),
        };
        if point.is_finite() {
            Ok(point)
        } else {
            Err(Ep2Error::OutOfRange)
        }
    }
}

/// Neighbouring columns of a grid of points that are in the same interval between knots.
struct Columns {
    /// Coordinate u of each column. If there are fewer than [`LANES`] columns, the last one is repeated.
    places: [f64; LANES],
    count: usize,
    locals: Local<Lanes>,
    series: Option<Series>,
}

impl Columns {
    fn of(columns: &[(f64, Local)], fit: &Fit) -> Self {
        let count = columns.len();
        let in_lane = |lane: usize| &columns[lane.min(count - 1)];
        let places = std::array::from_fn(|lane| in_lane(lane).0);
        Self {
            places,
            count,
            locals: Local::side_by_side(std::array::from_fn(|lane| &in_lane(lane).1)),
            series: fit.series(places),
        }
    }
}

/// Values of the surface that are the same for all places on a line of constant v.
struct Line {
    v: f64,
    /// Index of the B-spline in u to which the first element of `heights` belongs.
    first: usize,
    /// For each B-spline in u, three coefficients on the line: for the height and for its first and second derivatives
    /// along v. Each is a sum over the B-splines in v.
    heights: Vec<[f64; 3]>,
    posterior: Option<PosteriorLine>,
}

impl Line {
    /// The values for the line of constant `v`. `heights` contains the B-splines in u whose indices are in `functions`.
    fn of(fit: &Fit, v: f64, functions: Range<usize>) -> Self {
        let spline = &fit.spline;
        let local = Local::of(&spline.v, v);
        let width = spline.v.functions();
        let support = spline.v.degree() + 1;
        let first = functions.start;
        let heights = functions
            .map(|function| {
                let start = function * width + local.first;
                let row = &spline.coefficients[start..start + support];
                local
                    .jets
                    .map(|basis| row.iter().zip(&basis).map(|(c, b)| c * b).sum())
            })
            .collect();
        Self {
            v,
            first,
            heights,
            posterior: fit.posterior.as_ref().map(|posterior| posterior.line(v)),
        }
    }

    #[inline(always)]
    fn jet(&self, u: &Local<Lanes>, fit: &Fit) -> Jet<Lanes> {
        let start = u.first - self.first;
        Jet::from_sums(u, &self.heights[start..=start + fit.spline.u.degree()])
    }
}

/// Coordinates of `side` places at equal distances from end to end. A single place is in the middle.
fn places([low, high]: [f64; 2], side: usize) -> impl Iterator<Item = f64> {
    let share = move |index: usize| match side {
        1 => 0.5,
        _ => index as f64 / (side - 1) as f64,
    };
    (0..side).map(move |index| low + (high - low) * share(index))
}
