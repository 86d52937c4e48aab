//! The base's share of the displacement as a sum over wavenumbers.

use std::sync::OnceLock;

use super::pressure::{Pressure, wavenumbers};
use super::reflection;
use crate::Field;

/// Distance beyond the contact's edge, in thicknesses, from which on the layer moves by less than 1e-9 of its most: it
/// falls off as e^{−0.739 r}, where cos 0.739 = 0.739.
pub(super) const BEYOND: f64 = 30.0;

/// Distances up to which the sums are good, the shortest; each following one reaches twice as far.
const NEAR: f64 = 4.0;

/// The sums over the wavenumbers that a pressure's reflection takes at some depth.
#[derive(Clone, Debug)]
pub(super) struct Waves {
    pressure: Pressure,
    depth: f64,
    resolution: f64,
    /// Sums for short distances first, each made when first needed.
    bands: Vec<OnceLock<Vec<Wave>>>,
}

/// One wavenumber.
#[derive(Clone, Copy, Debug)]
pub(super) struct Wave {
    pub(super) wavenumber: f64,
    /// Strengths of the displacement: inward, which multiplies J₀, and outward, which multiplies J₁.
    pub(super) strength: [f64; 2],
    /// Strengths of the waves of ∂φ/∂a, likewise.
    pub(super) per_contact: [f64; 2],
}

/// Wavenumbers with their weights, and the transforms of a pressure and of its growth there.
pub(super) struct Spectrum {
    nodes: Vec<[f64; 2]>,
    transforms: Vec<[f64; 2]>,
}

impl Spectrum {
    /// Every wavenumber of this pressure that the base reflects down to a depth, spaced closely enough for distances up to
    /// `reach` at resolution 1.
    pub(super) fn new(pressure: &Pressure, depth: f64, reach: f64, resolution: f64) -> Self {
        let distance = pressure.contact + reach;
        let nodes = wavenumbers(reflection::reach(depth), distance, resolution);
        let transforms = nodes
            .iter()
            .map(|[wavenumber, _]| pressure.transform(*wavenumber));
        Self {
            transforms: transforms.collect(),
            nodes,
        }
    }

    /// Waves at a depth.
    pub(super) fn waves(&self, depth: f64) -> Vec<Wave> {
        let pairs = self.nodes.iter().zip(&self.transforms);
        let waves = pairs.map(|(&[wavenumber, weight], [curved, flat])| {
            let share = reflection::at_depth(wavenumber, depth);
            Wave {
                wavenumber,
                strength: share.map(|share| weight * share * curved),
                per_contact: share.map(|share| weight * share * flat),
            }
        });
        waves.collect()
    }
}

impl Waves {
    pub(super) fn new(pressure: Pressure, depth: f64, resolution: f64) -> Self {
        let count = libm::log2((pressure.contact + BEYOND) / NEAR).ceil() as usize + 1;
        Self {
            pressure,
            depth,
            resolution,
            bands: vec![OnceLock::new(); count],
        }
    }

    /// The base's share at this distance.
    pub(super) fn field(&self, r: f64) -> Field {
        let reaches = std::iter::successors(Some(NEAR), |reach| Some(2.0 * reach));
        let band = self
            .bands
            .iter()
            .zip(reaches)
            .find(|(_, reach)| r <= *reach);
        let Some((waves, reach)) = band else {
            return Field::default();
        };
        let waves = waves.get_or_init(|| {
            Spectrum::new(&self.pressure, self.depth, reach, self.resolution).waves(self.depth)
        });
        let mut field = Field::default();
        for wave in waves {
            let k = wave.wavenumber;
            let [j0, j1, j1_over] = bessel(k * r);
            field.normal += wave.strength[0] * j0;
            field.normal_per_r -= wave.strength[0] * k * j1;
            field.normal_per_a += wave.per_contact[0] * j0;
            field.radial += wave.strength[1] * j1;
            field.radial_per_r += wave.strength[1] * k * (j0 - j1_over);
            field.radial_per_a += wave.per_contact[1] * j1;
        }
        field
    }
}

/// J₀(x), J₁(x) and J₁(x)/x.
pub(super) fn bessel(x: f64) -> [f64; 3] {
    let j1 = libm::j1(x);
    let over = if x < 1e-8 { 0.5 } else { j1 / x };
    [libm::j0(x), j1, over]
}
