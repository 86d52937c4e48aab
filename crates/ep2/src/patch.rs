//! The contacts of a patch, after checks and in the patch's own frame.

use std::borrow::Cow;
use std::collections::BTreeMap;

use nalgebra::{Point3, Vector3};

use crate::error::LARGEST;
use crate::{Ep2Error, PatchFrame};

/// Smallest allowed ratio of a patch's width to its length. In a narrower patch, rounding errors of the heights would
/// cause a large false curvature across the patch.
const MIN_WIDTH_RATIO: f64 = 1e-6;
/// Largest allowed angle between a contact's normal and the mean normal (degrees). At a larger angle, the patch is not
/// a graph.
const MAX_TILT_DEG: f64 = 85.0;

/// A contact between a finger and the object.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contact {
    /// Number of the finger. The contacts of one finger must be in the order in which the finger made them.
    pub finger: usize,
    /// Position (length) of the contact.
    pub position: Point3<f64>,
    /// Measured normal, out of the object. Its length is arbitrary. Either all contacts have a normal, or none has one.
    pub normal: Option<Vector3<f64>>,
    /// Weight of the contact relative to the other contacts (an inverse variance). It must be finite and > 0; usually
    /// it is 1.
    pub weight: f64,
}

impl Contact {
    /// A contact with the weight 1.
    pub const fn new(finger: usize, position: Point3<f64>, normal: Option<Vector3<f64>>) -> Self {
        Self {
            finger,
            position,
            normal,
            weight: 1.0,
        }
    }
}

/// One value for each finger, in the order in which the fingers first appear among the contacts. Access is fast if the
/// contacts of one finger follow each other.
#[derive(Debug, Default)]
pub(crate) struct FingerMap<T> {
    places: BTreeMap<usize, usize>,
    values: Vec<T>,
    last: Option<(usize, usize)>,
}

impl<T: Default> FingerMap<T> {
    /// The value of `finger`. If the finger has no value, the default value is stored first.
    #[inline]
    pub(crate) fn entry(&mut self, finger: usize) -> &mut T {
        let place = match self.last {
            Some((last, place)) if last == finger => place,
            _ => {
                let next = self.values.len();
                let place = *self.places.entry(finger).or_insert(next);
                if place == next {
                    self.values.push(T::default());
                }
                self.last = Some((finger, place));
                place
            }
        };
        &mut self.values[place]
    }

    pub(crate) fn iter(&self) -> std::slice::Iter<'_, T> {
        self.values.iter()
    }
}

/// The indices of the contacts of each finger, in the order of `contacts`.
pub(crate) fn by_finger(contacts: &[Contact]) -> Vec<Vec<usize>> {
    let mut fingers: FingerMap<Vec<usize>> = FingerMap::default();
    for (index, contact) in contacts.iter().enumerate() {
        fingers.entry(contact.finger).push(index);
    }
    fingers.values
}

/// A contact in the patch's frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// Coordinate of the contact along the fingers' direction of travel, in the patch's unit.
    pub u: f64,
    /// Coordinate of the contact across the fingers' direction of travel, in the patch's unit.
    pub v: f64,
    /// Height of the contact above the plane of the patch, in the patch's unit.
    pub w: f64,
    /// Weight of the contact, as in [`Contact::weight`].
    pub weight: f64,
    /// Slopes ∂w/∂u and ∂w/∂v from the normal, if the contacts have normals.
    pub slopes: Option<[f64; 2]>,
}

/// The contacts of a patch, in the patch's frame.
///
/// ```
/// use nalgebra::{Point3, Vector3};
/// use palpate_ep2::{Contact, Patch};
///
/// // Three fingers, 1 apart, slide by 4 over a plane.
/// let places = (0..15).map(|i| (i / 5, f64::from(i % 5), f64::from(i / 5)));
/// let contacts: Vec<Contact> = places
///     .map(|(finger, x, y)| Contact::new(finger as usize, Point3::new(x, y, 0.0), None))
///     .collect();
/// let patch = Patch::new(&contacts, &Vector3::z())?;
/// assert_eq!((patch.fingers, patch.equations()), (3, 15));
/// assert!((patch.frame.scale() - 2.0).abs() < 1e-14);
/// assert!(patch.finger_distance.is_some_and(|distance| (distance - 0.5).abs() < 1e-14));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Patch {
    /// The patch's frame.
    pub frame: PatchFrame,
    /// The contacts in the patch's frame, in their original order.
    pub samples: Vec<Sample>,
    /// The rectangle that contains the contacts: smallest and largest u, then smallest and largest v.
    pub domain: [[f64; 2]; 2],
    /// Mean distance between neighbouring fingers, measured across their travel, in the patch's unit; `None` for a
    /// single finger.
    pub finger_distance: Option<f64>,
    /// Number of fingers that made the contacts.
    pub fingers: usize,
}

impl Patch {
    /// Checks the contacts and transforms them to the frame of their patch. Therefore the patch's orientation, position
    /// and size do not affect the fit.
    ///
    /// If the contacts have no normals, `outward` determines which side of the patch is outside of the object.
    ///
    /// # Errors
    /// [`Ep2Error`] if a number is invalid, or if there are fewer than three contacts. It is also an error if the
    /// contacts lie on one point or on one line, or if the patch is not a graph over its mean plane.
    pub fn new(contacts: &[Contact], outward: &Vector3<f64>) -> Result<Self, Ep2Error> {
        if contacts.len() < 3 {
            let with_normal = contacts.iter().filter(|one| one.normal.is_some()).count();
            return Err(Ep2Error::TooFewContacts {
                contacts: contacts.len(),
                equations: contacts.len() + 2 * with_normal,
                needed: 6,
            });
        }
        check(contacts.iter().enumerate())?;
        let mut frame = PatchFrame::of(contacts, &direction(outward)?)?;
        let mut samples = contacts
            .iter()
            .enumerate()
            .map(|(index, contact)| sample(&frame, index, contact))
            .collect::<Result<Vec<_>, _>>()?;
        // The patch is scaled so that half of its larger side is the unit of length.
        let sides = domain(&samples).map(|[low, high]| high - low);
        let half = 0.5 * sides[0].max(sides[1]);
        let spread = sides[0].min(sides[1]) / sides[0].max(sides[1]);
        if spread < MIN_WIDTH_RATIO {
            return Err(Ep2Error::Collinear {
                contacts: contacts.len(),
                spread,
            });
        }
        frame = frame.with_scale(frame.scale() * half);
        for sample in &mut samples {
            sample.u /= half;
            sample.v /= half;
            sample.w /= half;
        }
        let places = finger_places(contacts, &samples);
        Ok(Self {
            frame,
            domain: domain(&samples),
            finger_distance: mean_distance(&places),
            fingers: places.len(),
            samples,
        })
    }

    /// Whether the contacts have normals.
    pub(crate) fn has_normals(&self) -> bool {
        self.samples[0].slopes.is_some()
    }

    /// The patch with an evenly spaced selection of at most `count` contacts. The second result is the step of the
    /// selection: 1 if all contacts are selected, 2 if every second contact is selected, and so on.
    pub(crate) fn thinned(&self, count: usize) -> (Cow<'_, Self>, usize) {
        // The step must have no common divisor with the number of fingers. Otherwise, if the contacts of the fingers
        // alternate, the selection would omit some fingers.
        let is_prime_to_fingers = |step: &usize| {
            !(2..=self.fingers).any(|f| self.fingers.is_multiple_of(f) && step.is_multiple_of(f))
        };
        let step = (self.samples.len().div_ceil(count).max(1)..).find(is_prime_to_fingers);
        let step = step.unwrap_or(1);
        let samples = || self.samples.iter().copied().step_by(step).collect();
        let thinned = match step {
            1 => Cow::Borrowed(self),
            _ => Cow::Owned(Self {
                samples: samples(),
                ..*self
            }),
        };
        (thinned, step)
    }

    /// Number of equations for a fit: one per contact, or three if the contacts have normals.
    pub fn equations(&self) -> usize {
        self.samples.len() * if self.has_normals() { 3 } else { 1 }
    }
}

/// The direction `outward`, scaled such that the largest absolute value of its components is 1.
pub(crate) fn direction(outward: &Vector3<f64>) -> Result<Vector3<f64>, Ep2Error> {
    // Use the sum of the components as the length, because it is NaN if any component is NaN. `amax` would ignore a
    // NaN.
    let length = outward.abs().sum();
    let is_good = length > 0.0 && length <= LARGEST;
    let expected = "a vector of finite length > 0";
    Ep2Error::unless_good("outward", length, is_good, expected)?;
    Ok(outward / outward.amax())
}

/// Checks the coordinates, normals and weights of contacts. Each contact has an index, which errors report.
pub(crate) fn check<'a>(
    contacts: impl Iterator<Item = (usize, &'a Contact)> + Clone,
) -> Result<(), Ep2Error> {
    let mut normals = contacts.clone().map(|(_, contact)| contact.normal);
    let with_normals = normals.any(|normal| normal.is_some());
    for (index, contact) in contacts {
        let normal = contact.normal.unwrap_or(Vector3::zeros());
        let largest = contact.position.coords.abs().sum() + normal.abs().sum();
        let is_sound = |number: f64| number <= LARGEST;
        if !is_sound(largest) || !is_sound(contact.weight) {
            return Err(Ep2Error::NotFinite { contact: index });
        }
        if contact.weight <= 0.0 {
            return Err(Ep2Error::BadWeight {
                contact: index,
                weight: contact.weight,
            });
        }
        if with_normals && contact.normal.is_none() {
            return Err(Ep2Error::MissingNormal { contact: index });
        }
        let length = normal.amax();
        if with_normals && length < 1.0 / LARGEST {
            return Err(Ep2Error::BadNormal {
                contact: index,
                length,
            });
        }
    }
    Ok(())
}

/// Converts a contact to the frame of a patch. Errors report `index` as the number of the contact.
pub(crate) fn sample(
    frame: &PatchFrame,
    index: usize,
    contact: &Contact,
) -> Result<Sample, Ep2Error> {
    let place = frame.point(&contact.position);
    let slopes = match contact.normal {
        Some(normal) => {
            let normal = frame.direction(&normal.normalize());
            let angle_deg = libm::acos(normal.z.clamp(-1.0, 1.0)).to_degrees();
            if angle_deg > MAX_TILT_DEG {
                return Err(Ep2Error::Folded {
                    contact: index,
                    angle_deg,
                });
            }
            Some([-normal.x / normal.z, -normal.y / normal.z])
        }
        None => None,
    };
    Ok(Sample {
        u: place.x,
        v: place.y,
        w: place.z,
        weight: contact.weight,
        slopes,
    })
}

fn domain(samples: &[Sample]) -> [[f64; 2]; 2] {
    let mut domain = [[f64::INFINITY, f64::NEG_INFINITY]; 2];
    for sample in samples {
        for ([low, high], place) in domain.iter_mut().zip([sample.u, sample.v]) {
            *low = low.min(place);
            *high = high.max(place);
        }
    }
    domain
}

/// For each finger, the mean coordinate of its contacts across the direction of travel.
fn finger_places(contacts: &[Contact], samples: &[Sample]) -> Vec<f64> {
    let mut fingers: FingerMap<[f64; 2]> = FingerMap::default();
    for (contact, sample) in contacts.iter().zip(samples) {
        let [count, sum] = fingers.entry(contact.finger);
        *count += 1.0;
        *sum += sample.v;
    }
    fingers.iter().map(|[count, sum]| sum / count).collect()
}

/// Mean distance between neighbouring fingers with the coordinates `places`; `None` if all coordinates are equal.
fn mean_distance(places: &[f64]) -> Option<f64> {
    let low = places.iter().copied().fold(f64::INFINITY, f64::min);
    let high = places.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    (high > low).then(|| (high - low) / (places.len() - 1) as f64)
}
