//! The forward law: from a press to the displacements of both discs of every marker.

use nalgebra::Vector2;

use super::settings::ImageFit;
use super::view::View;
use crate::shear::stuck_shift;
use crate::{Body, Contact, MarkerDisplacement, Place, PressError};

/// Values of the unknowns.
#[derive(Clone, Copy, Debug)]
pub(super) struct State {
    pub(super) log_curvature: f64,
    pub(super) place: Place,
    pub(super) indentation: f64,
    /// Sideways shift of the object, length, along the axes at the contact.
    pub(super) shift: [f64; 2],
}

impl State {
    pub(super) fn curvature(&self) -> f64 {
        libm::exp(self.log_curvature)
    }
}

impl<V: View> ImageFit<V> {
    /// The contact as a body has it.
    pub(super) fn contact<'b>(
        &self,
        body: &'b Body,
        state: &State,
    ) -> Result<Contact<'b>, PressError> {
        let skin = self.markers.skin();
        skin.press(body, state.curvature(), state.indentation)
    }

    /// Displacements of the magenta and the yellow disc of each marker.
    pub(super) fn moved(&self, state: &State) -> Result<Vec<[MarkerDisplacement; 2]>, PressError> {
        self.moved_by(&self.bodies, state)
    }

    /// Displacements per length by which discs lie deeper; `None` where they lie no other way.
    pub(super) fn per_depth(
        &self,
        state: &State,
        moved: &[[MarkerDisplacement; 2]],
    ) -> Result<Option<Vec<[MarkerDisplacement; 2]>>, PressError> {
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

    fn moved_by(
        &self,
        bodies: &[Body; 2],
        state: &State,
    ) -> Result<Vec<[MarkerDisplacement; 2]>, PressError> {
        let [magenta, yellow] = bodies;
        let contacts = [self.contact(magenta, state)?, self.contact(yellow, state)?];
        let shift = Vector2::from(state.shift);
        let (size, azimuth) = (shift.norm(), libm::atan2(shift.y, shift.x));
        let moved = |place: &Place| {
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
                    let outward = by_shift.along * cosine + by_shift.across * sine;
                    let around = by_shift.across * cosine - by_shift.along * sine;
                    let turned = Vector2::new(-sight.outward.y, sight.outward.x);
                    tangential += (sight.outward * outward + turned * around) * size;
                    moved.normal += size * by_shift.normal;
                }
                moved.tangential = tangential.into();
            }
            Ok(both)
        };
        self.markers.places().iter().map(moved).collect()
    }
}
