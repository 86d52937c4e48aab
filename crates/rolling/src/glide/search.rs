//! The search for the contact of a spherical tip.
//!
//! Seen from above, the contact `w` carries the tip's centre to `w + r n_xy(w)`. This map has no
//! singularity at the silhouettes of closed objects, where heights do, and its derivative has the
//! determinant `det(I + r S)`: it folds only where the object is as hollow as the tip is round.

use std::f64::consts::FRAC_1_SQRT_2;

use nalgebra::{Point3, Vector2};
use palpate_geometry::{Surface, SurfaceError};

use super::foot::Foot;
use super::relief::Relief;
use super::touch::GlideError;

/// Newton steps before giving up, and lengths tried of each.
const STEPS: usize = 100;
const HALVINGS: i32 = 40;
/// A miss above this, relative to the lengths involved, is no contact.
pub(super) const ACCEPTED_MISS: f64 = 1e-12;
/// The next step tells the error of a contact, within a factor of 2 where it is small.
const STEP_SHARE: f64 = 0.5;
/// Longest last step that tells the error of a contact, in radii of the tip; a longer one tells nothing.
const LONGEST_LAST_STEP: f64 = 1e-3;
/// Largest distance that counts as touching, as a share of the tip's radius.
const TOUCHING: f64 = 1e-9;
/// Clearance below which a search that makes no progress is taken to be at a fold of the offset surface.
const FOLD: f64 = 1e-3;
/// Vertical component of the object's unit normal below which the contact lies on its silhouette.
const SILHOUETTE: f64 = 1e-3;

/// Places across a tip, in radii: eight on a ring of 0.85, and between them eight on one of 0.45.
const PLACES: [[f64; 2]; 16] = {
    let [outer, outer_diagonal] = [0.85, 0.85 * FRAC_1_SQRT_2];
    // 0.45 times the cosine and the sine of 22.5°.
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

/// A tip held above a place.
pub(super) struct Search<'a, S> {
    pub(super) object: &'a S,
    pub(super) radius: f64,
    /// Largest error of a contact that is accepted, in radii of the tip.
    pub(super) tolerance: f64,
    /// Whether a contact that fits may not be the only one.
    pub(super) rugged: bool,
    /// Place at which the tip's centre is held, seen from above.
    pub(super) centre: Vector2<f64>,
}

impl<S: Surface> Search<'_, S> {
    /// The contact that the tip meets first.
    pub(super) fn contact(&self) -> Result<Foot, GlideError> {
        palpate_statistics::work::searched(1);
        // The order of rivals must not depend on the tolerance: the contact that they are compared with
        // is found at least as accurately as rivals are told apart.
        let tolerance = if self.rugged {
            self.tolerance.min(TOUCHING)
        } else {
            self.tolerance
        };
        let first = self.settle(self.start()?, tolerance);
        match first {
            Ok(foot) if self.fits(&foot) && !(self.rugged && self.rivalled(&foot)) => Ok(foot),
            Err(GlideError::ContactLost { .. }) => first,
            _ => self.highest(first.and_then(|foot| self.settle(foot, 0.0))),
        }
    }

    /// Beneath the tip's centre; where there is nothing, at the part of the object nearest to a
    /// place above; failing that, where the object is touched by default.
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

    /// Horizontal displacement to the tip's centre from the place where a contact at `foot` would put it.
    fn miss(&self, foot: &Foot) -> Vector2<f64> {
        self.centre - foot.point.coords.xy() - foot.normal.xy() * self.radius
    }

    /// Newton's method from `foot`, each step halved until the miss shrinks, until the miss and the next
    /// step along the object are within the tolerance, or rounding allows no more.
    fn settle(&self, mut foot: Foot, tolerance: f64) -> Result<Foot, GlideError> {
        let mut miss = self.miss(&foot);
        for _ in 0..STEPS {
            let lengths = self.centre.norm() + foot.point.coords.xy().norm();
            if miss.norm() <= f64::EPSILON * lengths {
                return Ok(foot);
            }
            let close = miss.norm() <= ACCEPTED_MISS * (lengths + self.radius);
            let Some(step) = foot.step(self.radius, &miss) else {
                return if close { Ok(foot) } else { Err(self.two()) };
            };
            let far = (step.norm() / foot.normal.z).max(miss.norm());
            if far <= (STEP_SHARE * tolerance).min(LONGEST_LAST_STEP) * self.radius {
                return Ok(foot);
            }
            if close {
                // Rounding allows one more step at most.
                let next = self.descend(&foot, &miss, &step, 1);
                return Ok(next.map_or(foot, |(next, _)| next));
            }
            match self.descend(&foot, &miss, &step, HALVINGS) {
                Ok(next) => (foot, miss) = next,
                Err(_) if foot.clearance(self.radius) < FOLD => return Err(self.two()),
                Err(Some(_)) if foot.normal.z < SILHOUETTE => return Err(self.lost()),
                Err(Some(edge)) => return Err(edge.into()),
                Err(None) => break,
            }
        }
        Err(self.unsettled(miss.norm()))
    }

    /// The longest of the step and its halves that misses by less; if there is none, the edge of the
    /// object that was in the way, if there was one.
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

    /// Whether the object is rounder than the tip is hollow at `foot`, so that the tip can rest
    /// there.
    fn fits(&self, foot: &Foot) -> bool {
        foot.clearance(self.radius) > ACCEPTED_MISS
    }

    /// Sixteen places under the tip, on two rings.
    fn places(&self) -> impl Iterator<Item = Vector2<f64>> + '_ {
        let place = |&[x, y]: &[f64; 2]| self.centre + Vector2::new(x, y) * self.radius;
        PLACES.iter().map(place)
    }

    /// Whether there may be a contact higher than that at `foot`: at one of those places the object
    /// reaches into the tip, or is too hollow for it.
    fn rivalled(&self, foot: &Foot) -> bool {
        let centre = foot.tip_centre(self.radius);
        let rounding = 8.0 * f64::EPSILON * centre.coords.abs().sum();
        let inside = self.radius * (1.0 - TOUCHING) - rounding;
        self.places()
            .filter_map(|at| self.foot(at).ok())
            .any(|place| !self.fits(&place) || (place.point - centre).norm() < inside)
    }

    /// The contact with the highest tip among those near the tops of a relief, and `first`.
    fn highest(&self, first: Result<Foot, GlideError>) -> Result<Foot, GlideError> {
        let relief = Relief::under(self.object, self.centre, self.radius);
        let reached = relief
            .tops()
            .filter_map(|at| self.settle(self.foot(at).ok()?, 0.0).ok());
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
                let apart = (foot.point - highest.point).norm();
                tied |= apart > TOUCHING.sqrt() * self.radius;
            } else if rise > 0.0 {
                (best, tied) = (Some(foot), false);
            }
        }
        let Some(best) = best else {
            return Err(first.err().unwrap_or_else(|| self.two()));
        };
        let hidden = relief.summit() - height(&best);
        if hidden > TOUCHING * self.radius + 8.0 * f64::EPSILON * relief.summit().abs() {
            // The highest place led to no contact: at an edge of the object, or on a spike.
            Err(match first {
                Err(edge @ GlideError::Surface(_)) => edge,
                _ => self.unsettled(hidden),
            })
        } else if tied {
            Err(self.two())
        } else {
            Ok(best)
        }
    }

    fn unsettled(&self, miss: f64) -> GlideError {
        GlideError::unsettled(self.radius, &self.centre, miss)
    }

    fn two(&self) -> GlideError {
        GlideError::two(self.radius, &self.centre)
    }

    fn lost(&self) -> GlideError {
        GlideError::lost(self.radius, &self.centre)
    }
}
