//! The fitted surface: its curvature anywhere, with its uncertainty.

use nalgebra::{Point3, Vector3};

use crate::curvature::{Curvatures, form_and_basis};
use crate::line::Line;
use crate::posterior::Series;
use crate::spline::{LANES, Lanes, Local};
use crate::{Curvature, Ep2Error, Fit, Jet};

/// Largest number of places along each side of a map.
pub const MOST_PLACES: usize = 2048;

/// A place on the fitted surface, in the frame of the readings.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MapPoint {
    /// The place.
    pub position: Point3<f64>,
    /// The unit normal, out of the object.
    pub normal: Vector3<f64>,
    /// Gaussian and mean curvature.
    pub curvature: Curvature,
    /// Smallest normal curvature, 1/length, convex positive.
    pub k_min: f64,
    /// Largest normal curvature, 1/length.
    pub k_max: f64,
    /// Unit tangent along `k_min`, of either sign; any at an umbilic.
    pub direction_of_min: Vector3<f64>,
    /// Unit tangent along `k_max`, of either sign; any at an umbilic.
    pub direction_of_max: Vector3<f64>,
    /// Shape index, in [−1, 1]: +1 for a convex cap, −1 for a cup; `None` where the surface is flat.
    pub shape_index: Option<f64>,
}

impl MapPoint {
    /// Whether all of its numbers are.
    pub(crate) fn is_finite(&self) -> bool {
        let directions = [self.normal, self.direction_of_min, self.direction_of_max];
        let mut numbers = directions.iter().flatten().chain(self.position.iter());
        numbers.all(|number| number.is_finite())
            && self.curvature.is_finite()
            && self.k_min.is_finite()
            && self.k_max.is_finite()
    }
}

fn few_enough(side: usize) -> Result<(), Ep2Error> {
    let is_good = side <= MOST_PLACES;
    Ep2Error::unless_good("grid", side as f64, is_good, "at most 2048")
}

impl Fit {
    /// Gaussian and mean curvature where the line through `world` along the patch's normal meets
    /// the surface. For contacts without error on a paraboloid, and a place at its apex, the error of a
    /// quadric and of a penalised spline is at most 1e-11 of the sharper curvature.
    ///
    /// # Errors
    /// [`Ep2Error::OutOfRange`] where the curvature leaves the range of doubles.
    pub fn curvature_at(&self, world: &Point3<f64>) -> Result<Curvature, Ep2Error> {
        let place = self.frame.point(world);
        let (u, line) = self.around(place.x, place.y);
        let jet = line.jet(&u, self);
        let series = self.series([place.x; LANES]);
        Ok(self.curvatures_on(&line, &series, &jet)?.at(0))
    }

    /// The surface at a place of the patch, in the patch's coordinates.
    ///
    /// # Errors
    /// [`Ep2Error::OutOfRange`] where the surface leaves the range of doubles.
    pub fn point_at(&self, u: f64, v: f64) -> Result<MapPoint, Ep2Error> {
        let (local, line) = self.around(u, v);
        let jet = line.jet(&local, self);
        let series = self.series([u; LANES]);
        let curvature = self.curvatures_on(&line, &series, &jet)?.at(0);
        self.map_point([u, v], &jet.apart()[0], curvature)
    }

    /// The surface where lines through points along the patch's normal meet it.
    ///
    /// # Errors
    /// Errors of [`Fit::point_at`].
    pub fn points_at(&self, world: &[Point3<f64>]) -> Result<Vec<MapPoint>, Ep2Error> {
        world
            .iter()
            .map(|point| {
                let place = self.frame.point(point);
                self.point_at(place.x, place.y)
            })
            .collect()
    }

    /// The middle of the patch.
    ///
    /// # Errors
    /// Errors of [`Fit::point_at`].
    pub fn centre(&self) -> Result<MapPoint, Ep2Error> {
        let [u, v] = self.domain.map(|[low, high]| 0.5 * low + 0.5 * high);
        self.point_at(u, v)
    }

    /// Gaussian and mean curvature on a grid of `side` × `side` places that spans the contacts, u
    /// slowest.
    ///
    /// # Errors
    /// Errors of [`Fit::curvature_at`]; [`Ep2Error::BadSetting`] for more than [`MOST_PLACES`] along a side.
    pub fn curvatures(&self, side: usize) -> Result<Vec<Curvature>, Ep2Error> {
        few_enough(side)?;
        let columns = self.columns(side);
        let mut by_v: Vec<Curvatures> = Vec::with_capacity(side * columns.len());
        self.for_each_line(side, |_, line| {
            for one in &columns {
                let jet = line.jet(&one.locals, self);
                by_v.push(self.curvatures_on(line, &one.series, &jet)?);
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

    /// The surface on a grid of `side` × `side` places that spans the contacts, u slowest.
    ///
    /// # Errors
    /// Errors of [`Fit::point_at`]; [`Ep2Error::BadSetting`] for more than [`MOST_PLACES`] along a side.
    pub fn map(&self, side: usize) -> Result<Vec<MapPoint>, Ep2Error> {
        few_enough(side)?;
        let columns = self.columns(side);
        let mut by_v = Vec::with_capacity(side * side);
        self.for_each_line(side, |v, line| {
            for one in &columns {
                let jet = line.jet(&one.locals, self);
                let curvatures = self.curvatures_on(line, &one.series, &jet)?;
                for (lane, jet) in jet.apart()[..one.count].iter().enumerate() {
                    by_v.push(self.map_point([one.places[lane], v], jet, curvatures.at(lane))?);
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

    /// The columns of a grid.
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

    /// Visits the rows of a grid, lines of constant v.
    fn for_each_line(
        &self,
        side: usize,
        mut visit: impl FnMut(f64, &Line) -> Result<(), Ep2Error>,
    ) -> Result<(), Ep2Error> {
        for v in places(self.domain[1], side) {
            visit(v, &Line::of(self, v, 0..self.spline.u.functions()))?;
        }
        Ok(())
    }

    /// The line of constant `v`, as far as it is needed at `u`.
    fn around(&self, u: f64, v: f64) -> (Local<Lanes>, Line) {
        let local = Local::of(&self.spline.u, u);
        let functions = local.first..local.first + self.spline.u.degree() + 1;
        let line = Line::of(self, v, functions);
        (Local::side_by_side([&local; LANES]), line)
    }

    /// The polynomials in u of the posterior, if there is one.
    fn series(&self, u: [f64; LANES]) -> Option<Series> {
        let posterior = self.posterior.as_ref()?;
        Some(posterior.series(Lanes::from(u)))
    }

    /// Curvatures at places on a line, where the surface has these jets.
    #[inline(always)]
    fn curvatures_on(
        &self,
        line: &Line,
        series: &Option<Series>,
        jet: &Jet<Lanes>,
    ) -> Result<Curvatures, Ep2Error> {
        let posterior = line.posterior.as_ref().zip(series.as_ref());
        let errors = posterior.map(|(line, series)| line.errors(series, jet));
        Curvatures::of_graph(jet, errors.as_ref(), self.frame.scale())
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

/// Neighbouring columns of a grid, on the same interval of the knots.
struct Columns {
    /// Places of the columns along u; the last is repeated where there are fewer than [`LANES`].
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

/// Places at equal distances, `side` of them, from end to end; the middle where there is one.
fn places([low, high]: [f64; 2], side: usize) -> impl Iterator<Item = f64> {
    let share = move |index: usize| match side {
        1 => 0.5,
        _ => index as f64 / (side - 1) as f64,
    };
    (0..side).map(move |index| low + (high - low) * share(index))
}
