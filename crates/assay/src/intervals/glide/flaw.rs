//! Flaws that contacts of glides may have.

use nalgebra::{Rotation3, Unit, Vector3};
use palpate_ep2::{Contact, Noise};
use palpate_sensing::Channel;

use super::super::case::Case;
use super::super::draws::Draws;

/// Smallest and largest displacement of a finger, in standard deviations of a position.
pub(super) const DISPLACED: [f64; 2] = [3.0, 15.0];
/// Smallest and largest turn of the normals' frame, degrees.
const TURNED: [f64; 2] = [5.0, 20.0];

/// Flaw of the contacts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Flaw {
    None,
    /// One finger is displaced along z.
    Displaced,
    /// The frame of the normals is turned about any axis.
    Turned,
    /// The noise that is told is half of what it is.
    HalfNoise,
}

impl Flaw {
    pub(super) const ALL: [Self; 4] = [Self::None, Self::Displaced, Self::Turned, Self::HalfNoise];

    pub(super) const fn name(self) -> Option<&'static str> {
        match self {
            Self::None => None,
            Self::Displaced => Some("a displaced finger"),
            Self::Turned => Some("normals of a turned frame"),
            Self::HalfNoise => Some("half the noise told"),
        }
    }

    /// Whether readings of a case can have it.
    pub(super) fn can_be_in(self, case: &Case) -> bool {
        match self {
            Self::None | Self::Displaced => true,
            Self::Turned => case.normal_std_deg.is_some(),
            Self::HalfNoise => case.is_told,
        }
    }

    /// Noise that is told.
    pub(super) fn told(self, noise: Noise) -> Noise {
        let share = if self == Self::HalfNoise { 0.5 } else { 1.0 };
        Noise {
            position_std: noise.position_std.map(|std| share * std),
            normal_std_rad: noise.normal_std_rad.map(|std| share * std),
        }
    }

    /// Changes the contacts of the scene of this number.
    pub(super) fn spoil(self, case: &Case, contacts: &mut [Contact], seed: u64, number: u64) {
        match self {
            Self::None | Self::HalfNoise => (),
            Self::Displaced => {
                let (finger, by) = displacement(case, seed, number);
                let those = contacts.iter_mut().filter(|one| one.finger == finger);
                those.for_each(|one| one.position.z += by);
            }
            Self::Turned => {
                let mut draws = draws(seed, number);
                let axis = Vector3::from_fn(|_, _| draws.between([-1.0, 1.0]));
                let angle = draws.between(TURNED).to_radians();
                let turn = Rotation3::from_axis_angle(&Unit::new_normalize(axis), angle);
                for contact in contacts {
                    contact.normal = contact.normal.map(|normal| turn * normal);
                }
            }
        }
    }
}

/// The finger that is displaced in the scene of this number, and how far.
pub(super) fn displacement(case: &Case, seed: u64, number: u64) -> (usize, f64) {
    let mut draws = draws(seed, number);
    let finger = draws.between([0.0, case.fingers as f64]) as usize;
    (finger, draws.between(DISPLACED) * case.position_std)
}

fn draws(seed: u64, number: u64) -> Draws {
    Draws::new(seed, number, Channel::Indentation)
}
