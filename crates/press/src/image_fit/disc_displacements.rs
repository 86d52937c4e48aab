//! Computes the displacements of both discs of each marker in a press.

use nalgebra::{SMatrix, Vector2};

use super::ImageFit;
use crate::markers::PressSlopes;
use crate::shear::stuck_shift;
use crate::unknowns::{ACROSS, ALONG, CURVATURE, INDENTATION, State, UNKNOWNS, Unknowns};
use crate::{Body, MarkerDisplacement, Place, PressError};

/// Step for numerical derivatives of the displacements of discs, relative to the scale of each fit parameter.
const STEP: f64 = 1e-5;

pub(super) type Discs = Vec<[MarkerDisplacement; 2]>;

/// Derivatives of a disc's displacement (inward, and along both axes of the skin) with respect to the fit parameters.
pub(super) type DiscSlopes = SMatrix<f64, 3, UNKNOWNS>;

/// Displacements of the discs of each marker, with their derivatives with respect to the fit parameters.
#[derive(Clone, Debug)]
pub(super) struct Moving {
    pub(super) moved: Discs,
    pub(super) slopes: Vec<[DiscSlopes; 2]>,
}

impl ImageFit {
    pub(super) fn moved(&self, state: &State) -> Result<Discs, PressError> {
        self.moved_by(&self.bodies, state)
    }

    pub(super) fn moving(&self, state: &State) -> Result<Moving, PressError> {
        if self.shifts() {
            self.moving_by_differences(state)
        } else {
            self.moving_in_closed_form(state)
        }
    }

    pub(super) fn shifts(&self) -> bool {
        self.shift_std > 0.0 && self.bodies[0].sideways().is_some()
    }

    fn moving_in_closed_form(&self, state: &State) -> Result<Moving, PressError> {
        let markers = self.markers.places();
        let mut moving = Moving {
            moved: vec![[MarkerDisplacement::default(); 2]; markers.len()],
            slopes: vec![[DiscSlopes::zeros(); 2]; markers.len()],
        };
        let [magenta, yellow] = &self.bodies;
        let of_body = |body| -> Result<_, PressError> {
            let contact = state.contact(self.markers.skin(), body)?;
            let [_, slope] = body.indentation_of(contact.radius)?;
            let slopes = PressSlopes::new(&contact, slope);
            Ok((contact, slopes))
        };
        let presses = [of_body(magenta)?, of_body(yellow)?];
        let pairs = moving.moved.iter_mut().zip(&mut moving.slopes);
        for (place, (moved, slopes)) in markers.iter().zip(pairs) {
            let sight = self.markers.sight(&state.place, place);
            let discs = moved.iter_mut().zip(slopes).zip(&presses);
            for ((moved, slopes), (contact, press)) in discs {
                let field = contact.field(sight.distance);
                let radial = contact.relative_curvature * field.radial;
                moved.normal = contact.relative_curvature * field.normal;
                moved.tangential = (sight.outward * radial).into();
                let [x, y] = press.tangential(&field, &sight);
                let rows = [press.normal(&field, &sight, 1.0), x, y];
                for (row, values) in rows.iter().enumerate() {
                    for (unknown, value) in values.iter().enumerate() {
                        slopes[(row, unknown)] = *value;
                    }
                }
            }
        }
        Ok(moving)
    }

    fn moving_by_differences(&self, state: &State) -> Result<Moving, PressError> {
        let skin = self.markers.skin();
        let moved = self.moved(state)?;
        let mut slopes = vec![[DiscSlopes::zeros(); 2]; moved.len()];
        for unknown in 0..UNKNOWNS {
            let size = match unknown {
                CURVATURE => 1.0,
                ALONG | ACROSS => skin.radius(),
                INDENTATION => state.indentation,
                _ => self.shift_std,
            };
            let mut step = Unknowns::zeros();
            step[unknown] = STEP * size;
            let place_at = |direction: &_| skin.place_at(direction);
            let beside = self.moved(&state.stepped(skin, &step, place_at))?;
            for ((slopes, beside), at) in slopes.iter_mut().zip(&beside).zip(&moved) {
                for ((slopes, beside), at) in slopes.iter_mut().zip(beside).zip(at) {
                    let [x, y] = [0, 1].map(|axis| beside.tangential[axis] - at.tangential[axis]);
                    for (row, value) in [beside.normal - at.normal, x, y].iter().enumerate() {
                        slopes[(row, unknown)] = value / (STEP * size);
                    }
                }
            }
        }
        Ok(Moving { moved, slopes })
    }

    /// Derivatives of the disc displacements with respect to the depths of the discs; `None` if the depths are exact.
    pub(super) fn per_depth(
        &self,
        state: &State,
        moved: &[[MarkerDisplacement; 2]],
    ) -> Result<Option<Discs>, PressError> {
        let Some((depth, bodies)) = &self.deeper else {
            return Ok(None);
        };
        let deeper = self.moved_by(bodies, state)?;
        let slope = |one: &MarkerDisplacement, other: &MarkerDisplacement| MarkerDisplacement {
            normal: (one.normal - other.normal) / depth,
            tangential: [0, 1].map(|axis| (one.tangential[axis] - other.tangential[axis]) / depth),
        };
        let pairs = deeper.iter().zip(moved);
        Ok(Some(
            pairs
                .map(|(deeper, moved)| [0, 1].map(|disc| slope(&deeper[disc], &moved[disc])))
                .collect(),
        ))
    }

    fn moved_by(&self, bodies: &[Body; 2], state: &State) -> Result<Discs, PressError> {
        let [magenta, yellow] = bodies;
        let skin = self.markers.skin();
        let contacts = [state.contact(skin, magenta)?, state.contact(skin, yellow)?];
        let shift = Vector2::from(state.others);
        let (size, azimuth) = (shift.norm(), libm::atan2(shift.y, shift.x));
        let moved = |place: &Place| -> Result<_, PressError> {
            let sight = self.markers.sight(&state.place, place);
            let mut both = [MarkerDisplacement::default(); 2];
            for ((moved, contact), body) in both.iter_mut().zip(&contacts).zip(bodies) {
                let by_press = contact.displacement(sight.distance);
                let mut tangential = sight.outward * by_press.radial;
                moved.normal = by_press.normal;
                if let Some((poisson, depth)) = body.sideways().filter(|_| size > 0.0) {
                    let bearing = libm::atan2(sight.bearing.y, sight.bearing.x) - azimuth;
                    let by_shift =
                        stuck_shift(poisson, depth, contact.radius, sight.distance, bearing)?;
                    let (sine, cosine) = libm::sincos(bearing);
                    tangential += sight.along_skin(&by_shift, sine, cosine) * size;
                    moved.normal += size * by_shift.normal;
                }
                moved.tangential = tangential.into();
            }
            Ok(both)
        };
        let places = self.markers.places();
        let mut all = Vec::with_capacity(places.len());
        for place in places {
            all.push(moved(place)?);
        }
        Ok(all)
    }
}
