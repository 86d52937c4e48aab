//! Families of glides, and the flaws of their contacts.

use nalgebra::{Rotation3, Unit, Vector3};
use palpate_ep2::{Contact, Noise};
use palpate_sensing::{Channel, Distribution};

use super::Draws;
use super::glide_contacts::GlideSetup;

/// Standard deviations of positions, in finger distances, and of normals, degrees.
const NOISE_LEVELS: [(f64, Option<f64>); 4] = [
    (0.005, Some(0.5)),
    (0.02, Some(1.0)),
    (0.1, Some(5.0)),
    (0.02, None),
];
/// Smallest and largest displacement of a finger, in standard deviations of a position.
pub(super) const DISPLACEMENTS: [f64; 2] = [3.0, 15.0];
/// Smallest and largest rotation of the normals' frame, degrees.
const ROTATIONS: [f64; 2] = [5.0, 20.0];

/// Glides with one setup and one flaw.
#[derive(Clone, Copy, Debug)]
pub(super) struct Family {
    pub(super) case: GlideSetup,
    pub(super) flaw: Flaw,
}

impl Family {
    /// All families.
    pub(super) fn all() -> Vec<Self> {
        let mut all = Vec::new();
        for flaw in Flaw::ALL {
            for (states_noise, fingers) in [(true, 3), (true, 5), (false, 5)] {
                all.extend(NOISE_LEVELS.map(|(position_std, normal_std_deg)| Self {
                    case: GlideSetup {
                        fingers,
                        position_std,
                        distribution: Distribution::Gaussian,
                        normal_std_deg,
                        states_noise,
                    },
                    flaw,
                }));
            }
        }
        all.retain(|family| family.flaw.can_be_in(&family.case));
        all
    }

    /// Name of the family in the table.
    pub(super) fn name(&self) -> String {
        let flaw = self.flaw.name().map(|name| format!(", {name}"));
        format!("{}{}", self.case.name(), flaw.unwrap_or_default())
    }
}

/// Flaw of the contacts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Flaw {
    None,
    /// One finger is displaced along z.
    Displaced,
    /// The frame of the normals is rotated about a random axis.
    Rotated,
    /// The stated noise is half of the true one.
    HalfNoise,
}

impl Flaw {
    pub(super) const ALL: [Self; 4] = [Self::None, Self::Displaced, Self::Rotated, Self::HalfNoise];

    pub(super) const fn name(self) -> Option<&'static str> {
        match self {
            Self::None => None,
            Self::Displaced => Some("a displaced finger"),
            Self::Rotated => Some("normals of a turned frame"),
            Self::HalfNoise => Some("half the noise told"),
        }
    }

    /// Whether contacts of a setup can have the flaw.
    fn can_be_in(self, case: &GlideSetup) -> bool {
        match self {
            Self::None | Self::Displaced => true,
            Self::Rotated => case.normal_std_deg.is_some(),
            Self::HalfNoise => case.states_noise,
        }
    }

    /// Noise that is stated to the estimator.
    pub(super) fn stated_noise(self, noise: Noise) -> Noise {
        let share = if self == Self::HalfNoise { 0.5 } else { 1.0 };
        Noise {
            position_std: noise.position_std.map(|std| share * std),
            normal_std_rad: noise.normal_std_rad.map(|std| share * std),
        }
    }

    /// Adds the flaw to the contacts of the scene with this number.
    pub(super) fn add_to(
        self,
        case: &GlideSetup,
        contacts: &mut [Contact],
        seed: u64,
        number: u64,
    ) {
        match self {
            Self::None | Self::HalfNoise => (),
            Self::Displaced => {
                let (finger, by) = displacement(case, seed, number);
                let displaced = contacts.iter_mut().filter(|one| one.finger == finger);
                displaced.for_each(|one| one.position.z += by);
            }
            Self::Rotated => {
                let mut draws = draws(seed, number);
                let axis = Vector3::from_fn(|_, _| draws.between([-1.0, 1.0]));
                let angle = draws.between(ROTATIONS).to_radians();
                let turn = Rotation3::from_axis_angle(&Unit::new_normalize(axis), angle);
                for contact in contacts {
                    contact.normal = contact.normal.map(|normal| turn * normal);
                }
            }
        }
    }
}

/// The displaced finger in the scene with this number, and its displacement.
pub(super) fn displacement(case: &GlideSetup, seed: u64, number: u64) -> (usize, f64) {
    let mut draws = draws(seed, number);
    let finger = draws.between([0.0, case.fingers as f64]) as usize;
    (finger, draws.between(DISPLACEMENTS) * case.position_std)
}

fn draws(seed: u64, number: u64) -> Draws {
    Draws::new(seed, number, Channel::Indentation)
}
