//! Markers under the skin, with their displacements in a press and the derivatives of these displacements.
//!
//! The displacement is u = C F(a, r), where C is the relative curvature and r the distance from the contact. The
//! contact's radius a follows from C D(a) = δ, where δ is the indentation. Therefore ∂u/∂δ = F_a/D' and ∂u/∂ln C = C F
//! − δ F_a/D', with the derivatives F_a = ∂F/∂a and D' = dD/da.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use nalgebra::{Vector2, Vector3};

use crate::body::Field;
use crate::shear::{StuckShift, stuck_shift};
use crate::{Contact, EllipticContact, Place, PressError, Skin};

/// Largest unit of length in a fit of an elliptic contact, as a multiple of the size of the area of the markers.
const MAX_SCALE: f64 = 10.0;
/// Markers at points under the skin.
#[derive(Clone, Debug)]
pub struct Markers {
    skin: Skin,
    places: Vec<Place>,
}

/// The displacement of a marker in a press.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MarkerDisplacement {
    /// Inward displacement (length) along the normal.
    pub normal: f64,
    /// Displacement (length) along the skin. Its components are along the x and y axes at the apex after these axes
    /// were transported along the meridian to the marker.
    pub tangential: [f64; 2],
}

/// Relative widening of the skin around each marker. It is computed from the displacements just above and just below
/// the marker, at two depths that differ by `apart` (length). If an incompressible skin is compressed along its normal,
/// it widens in both tangential directions, each by half of the normal strain.
pub fn skin_widening(
    above: &[MarkerDisplacement],
    below: &[MarkerDisplacement],
    apart: f64,
) -> Vec<f64> {
    let squeezed = above.iter().zip(below);
    let widening = squeezed.map(|(above, below)| 0.5 * (above.normal - below.normal) / apart);
    widening.collect()
}

#[derive(Clone, Copy, Debug)]
pub(crate) struct Sight {
    /// Distance (length) from the contact to the marker along the skin.
    pub(crate) distance: f64,
    /// The length R_s sin(distance/R_s), where R_s is the sensor's radius. It is the radius of the circle around the
    /// contact on which the marker lies.
    pub(crate) reach: f64,
    /// Unit vector from the contact towards the marker, in the axes at the contact.
    pub(crate) bearing: Vector2<f64>,
    /// Unit vector at the marker that points away from the contact, in the axes at the marker.
    pub(crate) outward: Vector2<f64>,
}

impl Sight {
    /// Displacement of the marker along the skin due to a sideways shift, in the axes at the marker. `sine` and
    /// `cosine` are the sine and cosine of the angle between the shift and the direction from the contact to the
    /// marker.
    pub(crate) fn along_skin(&self, moved: &StuckShift, sine: f64, cosine: f64) -> Vector2<f64> {
        let outward = moved.along * cosine + moved.across * sine;
        let around = moved.across * cosine - moved.along * sine;
        let turned = Vector2::new(-self.outward.y, self.outward.x);
        self.outward * outward + turned * around
    }
}

impl Markers {
    /// Markers at the coordinates `positions` of the skin.
    ///
    /// # Errors
    /// [`PressError::NotFinite`] for the first marker whose coordinates are not finite; [`PressError::OffSkin`] for the
    /// first marker beyond the point opposite the apex.
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

    /// The markers with the numbers `chosen`, counted from 0. Numbers that no marker has are ignored.
    #[must_use]
    pub fn subset(&self, chosen: &[usize]) -> Self {
        let places = chosen.iter().filter_map(|&marker| self.places.get(marker));
        Self {
            skin: self.skin,
            places: places.copied().collect(),
        }
    }

    /// The skin of the sensor.
    pub const fn skin(&self) -> &Skin {
        &self.skin
    }

    /// Number of markers.
    pub fn count(&self) -> usize {
        self.places.len()
    }

    /// Places of the markers on the skin.
    pub(crate) fn places(&self) -> &[Place] {
        &self.places
    }

    /// Unit of length in a fit of an elliptic contact: the smaller of the skin's radius and a multiple of the size of
    /// the area of the markers.
    pub(crate) fn scale(&self) -> f64 {
        self.skin.place_radius() * (MAX_SCALE * self.extent_rad()).min(1.0)
    }

    /// Size of the area of the markers: the smaller of the skin's radius and twice the largest distance between the
    /// first marker and another marker.
    pub(crate) fn extent(&self) -> f64 {
        self.skin.place_radius() * (2.0 * self.extent_rad()).min(1.0)
    }

    /// The largest distance between the first marker and another marker, in radii of the skin. Infinite if all markers
    /// are at one place.
    fn extent_rad(&self) -> f64 {
        let directions = || self.places.iter().map(|place| place.direction.as_ref());
        let first = directions().next();
        let chords = first.map(|first| directions().map(move |other| (other - first).norm()));
        let extent = chords.into_iter().flatten().fold(0.0, f64::max);
        if extent > 0.0 { extent } else { f64::INFINITY }
    }

    /// Distance along the skin from a point to each marker. `from` contains the coordinates of the point.
    pub fn distances(&self, from: [f64; 2]) -> Vec<f64> {
        let contact = self.skin.place(from);
        self.places
            .iter()
            .map(|place| self.sight(&contact, place).distance)
            .collect()
    }

    /// Displacement of each marker by a contact at the skin coordinates `at`.
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

    /// Displacement of each marker, at `depth` under the skin, by an elliptic contact at the skin coordinates `at`.
    /// `axis` is the angle between the longer axis of the contact and the x axis at the contact.
    pub(crate) fn elliptic_displacements(
        &self,
        contact: &EllipticContact,
        at: [f64; 2],
        axis: f64,
        depth: f64,
    ) -> Vec<MarkerDisplacement> {
        self.moved_by_ellipse(contact, &self.skin.place(at), axis, depth)
    }

    pub(crate) fn moved_by_ellipse(
        &self,
        contact: &EllipticContact,
        middle: &Place,
        axis: f64,
        depth: f64,
    ) -> Vec<MarkerDisplacement> {
        let (sine, cosine) = libm::sincos(axis);
        let [long, short] = [Vector2::new(cosine, sine), Vector2::new(-sine, cosine)];
        let moved = |place: &Place| {
            let sight = self.sight(middle, place);
            let at = sight.bearing * sight.distance;
            let moved = contact.displacement(at.dot(&long), at.dot(&short), depth);
            let along = long * moved.tangential[0] + short * moved.tangential[1];
            let turned = |vector: &Vector2<f64>| Vector2::new(-vector.y, vector.x);
            // Transport the displacement along the skin. Its component away from the contact and its component around
            // the contact keep their magnitudes.
            let tangential = sight.outward * along.dot(&sight.bearing)
                + turned(&sight.outward) * along.dot(&turned(&sight.bearing));
            MarkerDisplacement {
                normal: moved.normal,
                tangential: [tangential.x, tangential.y],
            }
        };
        self.places.iter().map(moved).collect()
    }

    /// Displacement of each marker when the pressed object moves sideways. The body is a half-space, and the markers are
    /// at `depth` below its surface. The contact has the radius `contact_radius` and is at the skin coordinates `at`. The
    /// object sticks to the skin and moves by `shift` along the local x axis. All arguments except Poisson's ratio
    /// `poisson` are lengths.
    ///
    /// # Errors
    /// [`PressError::BadSetting`] unless `poisson` is from 0 to 0.5, `depth` from 0 to 1e50, `contact_radius` from
    /// 1e-50 to 1e50, and the magnitude of `shift` at most 1e50.
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
            let tangential = sight.along_skin(&moved, sine, cosine) * shift;
            Ok(MarkerDisplacement {
                normal: moved.normal * shift,
                tangential: [tangential.x, tangential.y],
            })
        };
        self.places.iter().map(moved).collect()
    }

    /// Checks that the markers can observe a contact at the place `at` with the radius `contact_radius`. The check
    /// passes in two cases: the distance of the nearest marker from the contact is at most twice this radius, or the
    /// markers less than 90° away (as viewed from the sensor's centre) surround the contact.
    ///
    /// # Errors
    /// [`PressError::OffMarkers`].
    pub fn see(&self, at: [f64; 2], contact_radius: f64) -> Result<(), PressError> {
        self.see_around(&self.skin.place(at), contact_radius)
    }

    pub(crate) fn see_around(
        &self,
        contact: &Place,
        contact_radius: f64,
    ) -> Result<(), PressError> {
        let places = self.places.iter();
        let sights: Vec<Sight> = places.map(|place| self.sight(contact, place)).collect();
        see(
            &sights,
            contact_radius,
            FRAC_PI_2 * self.skin.place_radius(),
        )
    }

    pub(crate) fn sight(&self, contact: &Place, marker: &Place) -> Sight {
        let (from, to) = (contact.direction.as_ref(), marker.direction.as_ref());
        // For small angles, 1 − cos loses digits, so it is computed from the chord instead: 1 − cos = chord²/2.
        let chord = to - from;
        let half_square = 0.5 * chord.norm_squared();
        let half_chord = (0.5 * half_square).sqrt().min(1.0);
        let sine = 2.0 * half_chord * (1.0 - 0.5 * half_square).max(0.0).sqrt();
        // If the marker is exactly at the contact, the direction from the contact to the marker is undefined. Use +x.
        let unit = |along: Vector3<f64>, axes: &Place| {
            if sine > 0.0 {
                Vector2::new(along.dot(&axes.x_axis), along.dot(&axes.y_axis)) / sine
            } else {
                Vector2::x()
            }
        };
        let radius = self.skin.place_radius();
        Sight {
            distance: 2.0 * radius * libm::asin(half_chord),
            reach: radius * sine,
            bearing: unit(chord + from * half_square, contact),
            outward: unit(chord - to * half_square, marker),
        }
    }
}

/// Checks that the markers can observe a contact with the radius `contact_radius`. The check passes in two cases: the
/// distance of the nearest marker from the contact is at most twice this radius, or the markers at distances below
/// `around` surround the contact.
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

/// Whether the markers surround the contact: their directions, as viewed from the contact, have no gap of more than
/// half a turn.
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

/// Derivatives of a marker's displacement with respect to four fit parameters: logarithm of the relative curvature,
/// position of the contact along x and along y, and indentation.
pub(crate) type Slopes = [f64; 4];

/// Values of a contact from which the derivatives of displacements are computed.
pub(crate) struct PressSlopes {
    pub(crate) curvature: f64,
    pub(crate) indentation: f64,
    /// Derivative of the contact's radius with respect to D, where D is the indentation divided by the relative
    /// curvature.
    pub(crate) per_d: f64,
}

impl PressSlopes {
    /// `slope` is the derivative of D with respect to the contact's radius, where D is the indentation divided by the
    /// relative curvature.
    pub(crate) fn new(contact: &Contact<'_>, slope: f64) -> Self {
        Self {
            curvature: contact.relative_curvature,
            indentation: contact.indentation,
            per_d: slope.recip(),
        }
    }

    fn by_log(&self, value: f64, per_a: f64) -> f64 {
        self.curvature * value - self.indentation * per_a * self.per_d
    }

    #[inline(always)]
    pub(crate) fn normal(&self, field: &Field, sight: &Sight, gain: f64) -> Slopes {
        // If the contact moves towards the marker, the distance between contact and marker decreases. Therefore the
        // derivative has a negative sign.
        let nearer = -self.curvature * field.normal_per_r;
        [
            gain * self.by_log(field.normal, field.normal_per_a),
            gain * nearer * sight.bearing.x,
            gain * nearer * sight.bearing.y,
            gain * (field.normal_per_a * self.per_d),
        ]
    }

    #[inline(always)]
    pub(crate) fn tangential(&self, field: &Field, sight: &Sight) -> [Slopes; 2] {
        let nearer = -self.curvature * field.radial_per_r;
        // If the contact moves perpendicular to the direction of the marker, the direction of the displacement at the
        // marker rotates.
        let turn = if sight.reach > 1e-6 * sight.distance && sight.distance > 0.0 {
            -self.curvature * field.radial / sight.reach
        } else {
            -self.curvature * field.radial_per_r
        };
        let (bearing, outward) = (sight.bearing, sight.outward);
        let across = [-outward.y, outward.x];
        [0, 1].map(|axis| {
            let onward = outward[axis];
            [
                onward * self.by_log(field.radial, field.radial_per_a),
                nearer * bearing.x * onward - turn * bearing.y * across[axis],
                nearer * bearing.y * onward + turn * bearing.x * across[axis],
                onward * (field.radial_per_a * self.per_d),
            ]
        })
    }
}
