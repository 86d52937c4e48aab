//! Markers under the skin, and what a press does to them.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use nalgebra::{Vector2, Vector3};

use crate::shear::stuck_shift;
use crate::{Contact, Place, PressError, Skin};

/// Markers at places under the skin.
#[derive(Clone, Debug)]
pub struct Markers {
    skin: Skin,
    places: Vec<Place>,
}

/// The displacement of a marker.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MarkerDisplacement {
    /// Inward, length.
    pub normal: f64,
    /// Along the apex's x and y axes, carried to the marker along the meridian, length.
    pub tangential: [f64; 2],
}

/// A marker's place as seen from the contact.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sight {
    /// Distance along the skin.
    pub(crate) distance: f64,
    /// Distance across the view per radian of bearing at this distance, R_s sin(distance/R_s).
    pub(crate) reach: f64,
    /// The way there, in the contact's axes; unit.
    pub(crate) bearing: Vector2<f64>,
    /// The way on, away from the contact, in the marker's axes; unit.
    pub(crate) outward: Vector2<f64>,
}

impl Markers {
    /// Markers at chart coordinates of the skin.
    ///
    /// # Errors
    /// [`PressError::NotFinite`] for the first that has none; [`PressError::OffSkin`] for the first beyond the pole
    /// opposite the apex.
    pub fn new(skin: Skin, positions: &[[f64; 2]]) -> Result<Self, PressError> {
        let sound = |[x, y]: &[f64; 2]| x.abs() <= 1e50 && y.abs() <= 1e50;
        if let Some(marker) = positions.iter().position(|position| !sound(position)) {
            return Err(PressError::NotFinite { marker });
        }
        let limit = std::f64::consts::PI * skin.radius();
        for (marker, [x, y]) in positions.iter().enumerate() {
            let distance = libm::hypot(*x, *y);
            if distance > limit * (1.0 + 1e-9) {
                return Err(PressError::OffSkin {
                    marker,
                    distance,
                    limit,
                });
            }
        }
        let places = positions
            .iter()
            .map(|&position| skin.place(position))
            .collect();
        Ok(Self { skin, places })
    }

    /// The markers with these numbers, counted from 0; numbers that no marker has are passed over.
    #[must_use]
    pub fn subset(&self, chosen: &[usize]) -> Self {
        let places = chosen.iter().filter_map(|&marker| self.places.get(marker));
        Self {
            skin: self.skin,
            places: places.copied().collect(),
        }
    }

    /// The skin above them.
    pub const fn skin(&self) -> &Skin {
        &self.skin
    }

    /// Places of the markers.
    pub fn places(&self) -> &[Place] {
        &self.places
    }

    /// Arc distances of the markers from a place on the skin at chart coordinates.
    pub fn distances(&self, from: [f64; 2]) -> Vec<f64> {
        let contact = self.skin.place(from);
        self.places
            .iter()
            .map(|place| self.sight(&contact, place).distance)
            .collect()
    }

    /// Displacement of each marker by a contact at chart coordinates `at`.
    pub fn displacements(&self, contact: &Contact<'_>, at: [f64; 2]) -> Vec<MarkerDisplacement> {
        let middle = self.skin.place(at);
        self.places
            .iter()
            .map(|place| {
                let sight = self.sight(&middle, place);
                let moved = contact.displacement(sight.distance);
                let tangential = sight.outward * moved.radial;
                MarkerDisplacement {
                    normal: moved.normal,
                    tangential: [tangential.x, tangential.y],
                }
            })
            .collect()
    }

    /// Displacement of each marker, at `depth` under the skin of a half-space, by a sideways move of the object: it
    /// touches with radius `contact_radius` at chart coordinates `at`, sticks to the skin and moves by `shift` along
    /// the x axis there. All are lengths, but for the ratio `poisson`.
    ///
    /// # Errors
    /// [`PressError::BadSetting`] as [`stuck_shift`], and for a `shift` beyond 1e50.
    pub fn shifted(
        &self,
        poisson: f64,
        depth: f64,
        contact_radius: f64,
        at: [f64; 2],
        shift: f64,
    ) -> Result<Vec<MarkerDisplacement>, PressError> {
        let good = shift.abs() <= 1e50;
        PressError::unless_good("shift", shift, good, "from -1e50 to 1e50")?;
        let middle = self.skin.place(at);
        let moved = |place: &Place| {
            let sight = self.sight(&middle, place);
            let (cosine, sine) = (sight.bearing.x, sight.bearing.y);
            let azimuth = libm::atan2(sine, cosine);
            let moved = stuck_shift(poisson, depth, contact_radius, sight.distance, azimuth)?;
            let outward = moved.along * cosine + moved.across * sine;
            let around = moved.across * cosine - moved.along * sine;
            let turned = Vector2::new(-sight.outward.y, sight.outward.x);
            let tangential = (sight.outward * outward + turned * around) * shift;
            Ok(MarkerDisplacement {
                normal: moved.normal * shift,
                tangential: [tangential.x, tangential.y],
            })
        };
        self.places.iter().map(moved).collect()
    }

    /// Refuses a contact of this radius that has no marker within twice its radius and is not surrounded by markers of
    /// its hemisphere.
    ///
    /// # Errors
    /// [`PressError::OffMarkers`].
    pub fn see(&self, contact: &Place, contact_radius: f64) -> Result<(), PressError> {
        let places = self.places.iter();
        let sights: Vec<Sight> = places.map(|place| self.sight(contact, place)).collect();
        see(&sights, contact_radius, FRAC_PI_2 * self.skin.radius())
    }

    pub(crate) fn sight(&self, contact: &Place, marker: &Place) -> Sight {
        let (from, to) = (contact.direction.as_ref(), marker.direction.as_ref());
        // The chord keeps its digits where the angle's cosine does not: 1 − cos = chord²/2.
        let chord = to - from;
        let half_square = 0.5 * chord.norm_squared();
        let half_chord = (0.5 * half_square).sqrt().min(1.0);
        let sine = 2.0 * half_chord * (1.0 - 0.5 * half_square).max(0.0).sqrt();
        // A marker on the contact is seen along +x.
        let unit = |along: Vector3<f64>, axes: &Place| {
            if sine > 0.0 {
                Vector2::new(along.dot(&axes.x_axis), along.dot(&axes.y_axis)) / sine
            } else {
                Vector2::x()
            }
        };
        let radius = self.skin.radius();
        Sight {
            distance: 2.0 * radius * libm::asin(half_chord),
            reach: radius * sine,
            bearing: unit(chord + from * half_square, contact),
            outward: unit(chord - to * half_square, marker),
        }
    }
}

/// Refuses a contact of this radius, from which markers are seen so, that has no marker within twice its radius and is
/// not surrounded by markers up to `around` away.
pub(crate) fn see(sights: &[Sight], contact_radius: f64, around: f64) -> Result<(), PressError> {
    let distances = sights.iter().map(|sight| sight.distance);
    let nearest = distances.fold(f64::INFINITY, f64::min);
    let near = sights.iter().filter(|sight| sight.distance < around);
    if nearest <= 2.0 * contact_radius || are_around(near) {
        Ok(())
    } else {
        Err(PressError::OffMarkers { distance: nearest })
    }
}

/// Whether bearings leave no gap of more than half a turn.
fn are_around<'a>(sights: impl Iterator<Item = &'a Sight>) -> bool {
    let mut bearings: Vec<f64> = sights
        .map(|sight| libm::atan2(sight.bearing.y, sight.bearing.x))
        .collect();
    bearings.sort_by(f64::total_cmp);
    let Some(&first) = bearings.first() else {
        return false;
    };
    bearings.push(first + TAU);
    let is_gap = |pair: &[f64]| pair[1] - pair[0] > PI + 1e-6;
    !bearings.windows(2).any(is_gap)
}
