//! Searches for the contact of a spherical tip.
//!
//! In a view from above, a tip that touches the object at `w` has its centre at `w + r n_xy(w)`. Here r is the radius
//! of the tip, and n_xy is the horizontal part of the object's normal. This map from contacts to centres has no
//! singularity at the silhouettes of closed objects, where heights have one. The determinant of its derivative is
//! `det(I + r S)`, where S is the shape operator of the object. So the map has a fold, where two contacts belong to the
//! same centre of the tip, only if the object's concave curvature reaches 1/r.

use std::f64::consts::FRAC_1_SQRT_2;

use nalgebra::{Point3, Vector2};
use palpate_geometry::{Surface, SurfaceError};

use super::touch::{Foot, GlideError};

const MAX_STEPS: usize = 100;
const MAX_HALVINGS: i32 = 40;
/// Largest accepted horizontal distance between the actual centre of the tip and the centre of a tip that touches at
/// the found contact. The distance is divided by the sum of three lengths: the tip's radius, and the distances of the
/// centre and of the contact from the origin.
pub(super) const ACCEPTED_MISS: f64 = 1e-12;
/// The search stops if the next Newton step is shorter than this share of the tolerance. The length of the next step
/// estimates the contact's error; for small steps, this estimate is correct within a factor of 2.
const STEP_SHARE: f64 = 0.5;
/// Longest Newton step from which the error of a contact can be estimated, in radii of the tip.
const MAX_LAST_STEP: f64 = 1e-3;
/// Tip and object count as touching if their distance is at most this share of the tip's radius.
const TOUCHING: f64 = 1e-9;
/// The search may stop at a fold of the offset surface (the surface on which the tip's centre moves), where the tip
/// touches the object at two places. A place counts as a fold if [`Foot::clearance`] is below this limit.
const FOLD: f64 = 1e-3;
/// A contact counts as lying on the object's silhouette if the vertical component of its unit normal is below this
/// value.
const SILHOUETTE: f64 = 1e-3;

/// Sixteen places under a tip, in radii from its centre. Eight places are on a ring of radius 0.85. The other eight are
/// on a ring of radius 0.45, at angles between those of the first ring.
const PLACES: [[f64; 2]; 16] = {
    let [outer, outer_diagonal] = [0.85, 0.85 * FRAC_1_SQRT_2];
    // Coordinates of a place on the ring of radius 0.45, at an angle of 22.5°: 0.45 cos 22.5° and 0.45 sin 22.5°.
    let [inner, inner_aside] = [0.415_745_789_6, 0.172_207_544_6];
    [
        [outer, 0.0],
        [outer_diagonal, outer_diagonal],
        [0.0, outer],
        [-outer_diagonal, outer_diagonal],
        [-outer, 0.0],
        [-outer_diagonal, -outer_diagonal],
        [0.0, -outer],
        [outer_diagonal, -outer_diagonal],
        [inner, inner_aside],
        [inner_aside, inner],
        [-inner_aside, inner],
        [-inner, inner_aside],
        [-inner, -inner_aside],
        [-inner_aside, -inner],
        [inner_aside, -inner],
        [inner, -inner_aside],
    ]
};

/// Number of grid lines of the height grid on each side of its centre line.
const HALF: usize = 12;
/// Number of grid lines of the height grid along each direction.
const SIDE: usize = 2 * HALF + 1;

pub(super) struct Search<'a, S> {
    pub(super) object: &'a S,
    pub(super) radius: f64,
    /// Largest accepted error of the contact, in radii of the tip.
    pub(super) tolerance: f64,
    pub(super) rugged: bool,
    /// Position of the tip's centre in the xy plane.
    pub(super) centre: Vector2<f64>,
}

impl<S: Surface> Search<'_, S> {
    /// The first contact of the tip on its way down.
    pub(super) fn contact(&self) -> Result<Foot, GlideError> {
        palpate_statistics::work::searched(1);
        // On a `rugged` object (a graph), the tip may fit at several contacts. The choice among them must not depend on
        // the stated tolerance. Therefore, the search uses a tolerance of at most `TOUCHING`: contacts whose heights
        // differ by less count as equally high.
        let tolerance = if self.rugged {
            self.tolerance.min(TOUCHING)
        } else {
            self.tolerance
        };
        let first = self.converge(self.start()?, tolerance);
        match first {
            Ok(foot) if self.fits(&foot) && !(self.rugged && self.has_rivals(&foot)) => Ok(foot),
            Err(GlideError::ContactLost { .. }) => first,
            _ => self.highest(first.and_then(|foot| self.converge(foot, 0.0))),
        }
    }

    /// Start of the search: the point of the object below the tip's centre. If the object has no point there, the
    /// search starts at the point that is closest to a point high above the tip. If this fails too, the search starts
    /// at the object's default contact.
    fn start(&self) -> Result<Foot, SurfaceError> {
        let beneath = self.foot(self.centre);
        let Err(off_domain) = beneath else {
            return beneath;
        };
        let height = self.radius.max(self.centre.norm());
        let above = Point3::new(self.centre.x, self.centre.y, height);
        let (x, y) = self.object.default_contact();
        let nearest = self.object.closest_point(&above);
        nearest
            .and_then(|near| self.foot(near.coords.xy()))
            .or_else(|_| self.foot(Vector2::new(x, y)))
            .map_err(|_| off_domain)
    }

    fn foot(&self, at: Vector2<f64>) -> Result<Foot, SurfaceError> {
        Foot::at(self.object, self.object.contact_at(at.x, at.y)?)
    }

    /// Horizontal displacement, called the miss, from the centre of a tip that would touch at `foot` to the centre of
    /// the actual tip.
    fn miss(&self, foot: &Foot) -> Vector2<f64> {
        self.centre - foot.point.coords.xy() - foot.normal.xy() * self.radius
    }

    /// Newton's method for the contact, starting at `foot`. Each step is halved until the miss (see [`Self::miss`])
    /// decreases. The method ends when the miss and the next step along the object are within the tolerance, or when
    /// rounding errors prevent further progress.
    fn converge(&self, mut foot: Foot, tolerance: f64) -> Result<Foot, GlideError> {
        let mut miss = self.miss(&foot);
        for _ in 0..MAX_STEPS {
            let lengths = self.centre.norm() + foot.point.coords.xy().norm();
            if miss.norm() <= f64::EPSILON * lengths {
                return Ok(foot);
            }
            let close = miss.norm() <= ACCEPTED_MISS * (lengths + self.radius);
            let Some(step) = foot.step(self.radius, &miss) else {
                return if close {
                    Ok(foot)
                } else {
                    Err(self.two_contacts())
                };
            };
            let far = (step.norm() / foot.normal.z).max(miss.norm());
            if far <= (STEP_SHARE * tolerance).min(MAX_LAST_STEP) * self.radius {
                return Ok(foot);
            }
            if close {
                // The miss is already close to the rounding errors, so at most one more step can reduce it.
                let next = self.descend(&foot, &miss, &step, 1);
                return Ok(next.map_or(foot, |(next, _)| next));
            }
            match self.descend(&foot, &miss, &step, MAX_HALVINGS) {
                Ok(next) => (foot, miss) = next,
                Err(_) if foot.clearance(self.radius) < FOLD => return Err(self.two_contacts()),
                Err(Some(_)) if foot.normal.z < SILHOUETTE => {
                    return Err(GlideError::contact_lost(self.radius, &self.centre));
                }
                Err(Some(edge)) => return Err(edge.into()),
                Err(None) => break,
            }
        }
        Err(self.no_convergence(miss.norm()))
    }

    /// Tries the steps `step`, `step/2`, `step/4` and so on. Returns the first of them that decreases the miss (see
    /// [`Self::miss`]). If no step decreases the miss, the returned error states whether the edge of the object was
    /// reached.
    fn descend(
        &self,
        foot: &Foot,
        miss: &Vector2<f64>,
        step: &Vector2<f64>,
        attempts: i32,
    ) -> Result<(Foot, Vector2<f64>), Option<SurfaceError>> {
        let from = foot.point.coords.xy();
        let mut edge = None;
        for halvings in 0..attempts {
            let to = from + step * libm::scalbn(1.0, -halvings);
            if to == from {
                break;
            }
            match self.foot(to) {
                Ok(next) => {
                    let next_miss = self.miss(&next);
                    if next_miss.norm() < miss.norm() {
                        return Ok((next, next_miss));
                    }
                }
                Err(error) => edge = Some(error),
            }
        }
        Err(edge)
    }

    /// Whether the tip fits at `foot`: the object's concave curvature there must be smaller than the tip's curvature.
    fn fits(&self, foot: &Foot) -> bool {
        foot.clearance(self.radius) > ACCEPTED_MISS
    }

    fn places(&self) -> impl Iterator<Item = Vector2<f64>> + '_ {
        let place = |&[x, y]: &[f64; 2]| self.centre + Vector2::new(x, y) * self.radius;
        PLACES.iter().map(place)
    }

    /// Whether the tip may touch the object at a higher contact than `foot`. This is possible if, at one of the sixteen
    /// places under the tip, the object extends into the tip or the tip does not fit.
    fn has_rivals(&self, foot: &Foot) -> bool {
        let centre = foot.tip_centre(self.radius);
        let rounding = 8.0 * f64::EPSILON * centre.coords.abs().sum();
        let inside = self.radius * (1.0 - TOUCHING) - rounding;
        self.places()
            .filter_map(|at| self.foot(at).ok())
            .any(|place| !self.fits(&place) || (place.point - centre).norm() < inside)
    }

    /// The contact at which the tip is highest, among `first` and the contacts near the local maxima of the height
    /// grid.
    fn highest(&self, first: Result<Foot, GlideError>) -> Result<Foot, GlideError> {
        let relief = Relief::under(self.object, self.centre, self.radius);
        let reached = relief
            .tops()
            .filter_map(|at| self.converge(self.foot(at).ok()?, 0.0).ok());
        let height = |foot: &Foot| foot.tip_centre(self.radius).z;
        let mut best: Option<Foot> = None;
        let mut tied = false;
        for foot in first.ok().into_iter().chain(reached) {
            if !self.fits(&foot) {
                continue;
            }
            let Some(highest) = best else {
                best = Some(foot);
                continue;
            };
            let rise = height(&foot) - height(&highest);
            if rise.abs() <= TOUCHING * self.radius {
                let distance = (foot.point - highest.point).norm();
                tied |= distance > TOUCHING.sqrt() * self.radius;
            } else if rise > 0.0 {
                (best, tied) = (Some(foot), false);
            }
        }
        let Some(best) = best else {
            return Err(first.err().unwrap_or_else(|| self.two_contacts()));
        };
        let hidden = relief.summit() - height(&best);
        if hidden > TOUCHING * self.radius + 8.0 * f64::EPSILON * relief.summit().abs() {
            // At the highest grid point, the centre of the tip is higher than at every contact that was found. So the
            // object has an edge or a spike at this grid point.
            Err(match first {
                Err(edge @ GlideError::Surface(_)) => edge,
                _ => self.no_convergence(hidden),
            })
        } else if tied {
            Err(self.two_contacts())
        } else {
            Ok(best)
        }
    }

    fn no_convergence(&self, miss: f64) -> GlideError {
        GlideError::no_convergence(self.radius, &self.centre, miss)
    }

    fn two_contacts(&self) -> GlideError {
        GlideError::two_contacts(self.radius, &self.centre)
    }
}

/// A square grid of places of the object under the tip, with one height per place. A tip that touches the object at a
/// place has its centre at this height; the height is −∞ if the object does not exist there. A tip that is lowered
/// touches first at the place with the largest height.
struct Relief {
    centre: Vector2<f64>,
    spacing: f64,
    heights: [[f64; SIDE]; SIDE],
}

impl Relief {
    fn under<S: Surface>(object: &S, centre: Vector2<f64>, radius: f64) -> Self {
        let mut relief = Self {
            centre,
            spacing: radius / HALF as f64,
            heights: [[f64::NEG_INFINITY; SIDE]; SIDE],
        };
        for row in 0..SIDE {
            for column in 0..SIDE {
                let at = relief.place(row, column);
                let aside = (at - centre).norm();
                if aside <= radius
                    && let Ok(place) = object.contact_at(at.x, at.y)
                {
                    let rise = (radius - aside) * (radius + aside);
                    relief.heights[row][column] = place.z + rise.sqrt();
                }
            }
        }
        relief
    }

    /// Largest height in the grid, that is, the highest position of the tip's centre.
    fn summit(&self) -> f64 {
        self.heights
            .iter()
            .flatten()
            .copied()
            .fold(f64::NEG_INFINITY, f64::max)
    }

    /// The grid points that have no higher neighbour.
    fn tops(&self) -> impl Iterator<Item = Vector2<f64>> + '_ {
        let places = (0..SIDE).flat_map(|row| (0..SIDE).map(move |column| (row, column)));
        places
            .filter(|&(row, column)| self.is_top(row, column))
            .map(|(row, column)| self.place(row, column))
    }

    fn is_top(&self, row: usize, column: usize) -> bool {
        let height = self.heights[row][column];
        let around = |line: usize| line.saturating_sub(1)..(line + 2).min(SIDE);
        height > f64::NEG_INFINITY
            && around(row).all(|r| around(column).all(|c| self.heights[r][c] <= height))
    }

    fn place(&self, row: usize, column: usize) -> Vector2<f64> {
        let step = |line: usize| line as f64 - HALF as f64;
        self.centre + Vector2::new(step(column), step(row)) * self.spacing
    }
}
