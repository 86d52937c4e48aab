//! Flaws that readings of rolls may have.

use nalgebra::{Matrix2, Vector2};
use palpate_ep1::ProbeReading;

use super::super::draws::Draws;

/// Radius of the probe, mm.
pub(super) const RADIUS: f64 = 10.0;
/// Smallest and largest factor between the probe's radius and the one that is told.
const GAINS: [f64; 2] = [1.1, 1.3];
/// Smallest and largest angle between the frames of rotations and shifts, degrees.
const TURNS: [f64; 2] = [5.0, 30.0];
/// Smallest and largest share of the way that a probe slips.
const SLIPS: [f64; 2] = [0.2, 1.0];
/// Smallest and largest length by which all first contacts are off, mm.
const OFFSETS: [f64; 2] = [0.2, 1.0];

/// Flaw of the readings.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Flaw {
    None,
    /// The probe has another radius than is told.
    Gain,
    /// Rotations are measured in a frame that is turned about the normal.
    Turned,
    /// One probe slipped.
    Slipped,
    /// All first contacts are off alike.
    Offset,
    /// The noise that is told is half of what it is.
    HalfNoise,
}

impl Flaw {
    /// All that is wrong.
    pub(super) const ALL: [Self; 5] = [
        Self::Gain,
        Self::Turned,
        Self::Slipped,
        Self::Offset,
        Self::HalfNoise,
    ];

    pub(super) const fn name(self) -> Option<&'static str> {
        match self {
            Self::None => None,
            Self::Gain => Some("wrong radius of the probe"),
            Self::Turned => Some("frames turned against each other"),
            Self::Slipped => Some("a slipped probe"),
            Self::Offset => Some("first contacts off"),
            Self::HalfNoise => Some("half the noise told"),
        }
    }

    /// Radius of the probe that is told, mm.
    pub(super) fn radius(self, draws: &mut Draws) -> f64 {
        match self {
            Self::Gain => RADIUS * draws.between(GAINS),
            _ => RADIUS,
        }
    }

    /// Share of the noise that is told.
    pub(super) const fn told(self) -> f64 {
        match self {
            Self::HalfNoise => 0.5,
            _ => 1.0,
        }
    }

    /// Changes readings without noise.
    pub(super) fn spoil(self, readings: &mut [ProbeReading], draws: &mut Draws) {
        match self {
            Self::None | Self::Gain | Self::HalfNoise => (),
            Self::Turned => {
                let (sine, cosine) = libm::sincos(draws.between(TURNS).to_radians());
                let turn = Matrix2::new(cosine, -sine, sine, cosine);
                readings
                    .iter_mut()
                    .for_each(|one| one.rotation = turn * one.rotation);
            }
            Self::Slipped => {
                let probe = draws.between([0.0, readings.len() as f64]) as usize;
                let left = 1.0 - draws.between(SLIPS);
                if let Some(reading) = readings.get_mut(probe) {
                    reading.shift *= left;
                }
            }
            Self::Offset => {
                let (sine, cosine) = libm::sincos(draws.between([0.0, std::f64::consts::TAU]));
                let off = Vector2::new(cosine, sine) * draws.log_between(OFFSETS);
                readings.iter_mut().for_each(|one| one.shift += off);
            }
        }
    }
}
