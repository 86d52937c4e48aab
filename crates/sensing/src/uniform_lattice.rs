//! A near-uniform lattice of pads on the sphere. The nearest pad is found in constant time.
//!
//! In the spherical Fibonacci lattice, pad `i` of `n` lies at `z = 1 − (2i + 1)/n` and azimuth `2π i (Φ − 1)`, where Φ
//! is the golden ratio. Around any place that is not near a pole, the lattice resembles a plane lattice. Its two basis
//! vectors lead from pad `i` to the pads `i + F_k` and `i + F_{k+1}`. F_k and F_{k+1} are successive Fibonacci numbers
//! that depend on the latitude. The pads nearest to a direction follow from the inverse of this basis (Keinert,
//! Innmann, Sänger and Stamminger, *Spherical Fibonacci Mapping*, 2015). Azimuths are 64-bit fractions of a turn, so
//! that they are accurate even for 10¹³ pads.

use nalgebra::{Matrix2, Vector2, Vector3};
use palpate_statistics::BadSetting;

/// A spherical Fibonacci lattice of pads over the whole sphere.
///
/// ```
/// use palpate_sensing::UniformLattice;
///
/// // One pad per 0.01 steradian: 4π/0.01 = 1256.6.
/// let lattice = UniformLattice::with_pitch(0.1)?;
/// assert_eq!(lattice.pads(), 1257);
/// let pad = lattice.direction(500);
/// assert!((pad.norm() - 1.0).abs() < 1e-14);
/// assert_eq!(lattice.nearest(&pad), 500);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct UniformLattice {
    pads: u64,
}

/// Azimuth from one pad to the next: `Φ − 1` turns, in units of 2⁻⁶⁴ turn. Φ is the golden ratio.
const GOLDEN_TURN: u64 = 0x9E37_79B9_7F4A_7C15;
const GOLDEN_RATIO: f64 = 1.618_033_988_749_895;
/// Largest number of pads on the whole sphere.
const MOST_PADS: f64 = 1e15;

impl UniformLattice {
    /// A lattice on the unit sphere with one pad per area of pitch². `pitch_rad` is the pitch as an angle.
    ///
    /// # Errors
    /// [`BadSetting`] unless the number of pads that follows from this pitch is from 2 to 10¹⁵.
    pub fn with_pitch(pitch_rad: f64) -> Result<Self, BadSetting<String>> {
        let pads = (4.0 * std::f64::consts::PI / (pitch_rad * pitch_rad)).round();
        let holds = pitch_rad > 0.0 && (2.0..=MOST_PADS).contains(&pads);
        BadSetting::unless(
            holds,
            "pitch",
            pitch_rad,
            "between 1.2e-7 and 2.5 of the probe's radius",
        )?;
        Ok(Self { pads: pads as u64 })
    }

    /// Number of pads on the whole sphere.
    pub const fn pads(&self) -> u64 {
        self.pads
    }

    /// Direction of pad `index`, which must be below [`Self::pads`]. Pads are numbered from +z to −z.
    pub fn direction(&self, index: u64) -> Vector3<f64> {
        let below = (2.0 * index as f64 + 1.0) / self.pads as f64;
        // The height of the pad is z = 1 − `below`. Therefore 1 − z² is `below` (2 − `below`), which is computed
        // without cancellation near the pole.
        let sine = (below * (2.0 - below)).max(0.0).sqrt();
        let (sin, cos) = libm::sincos(azimuth(index));
        Vector3::new(sine * cos, sine * sin, 1.0 - below)
    }

    /// Index of the pad that is nearest to the unit vector `direction`. If the length of `direction` is not 1, the
    /// result is arbitrary.
    pub fn nearest(&self, direction: &Vector3<f64>) -> u64 {
        let count = self.pads as f64;
        let sine_squared = direction.x * direction.x + direction.y * direction.y;
        // `depth` is the index, before rounding, that a pad at the height z of `direction` would have. It increases
        // linearly with 1 − z. In the upper half of the sphere, 1 − z is computed from the sine of the polar angle,
        // which loses fewer digits.
        let depth = if direction.z > 0.0 {
            sine_squared / (1.0 + direction.z)
        } else {
            1.0 - direction.z
        } * 0.5
            * count
            - 0.5;
        let azimuth_here = libm::atan2(direction.y, direction.x);

        // `f0` and `f1` are the two Fibonacci numbers that define the basis of the lattice at this latitude.
        let zone = (count * std::f64::consts::PI * 5.0_f64.sqrt() * sine_squared).max(1.0);
        let order = (libm::log(zone) / (2.0 * libm::log(GOLDEN_RATIO)))
            .floor()
            .max(2.0);
        let fibonacci = libm::pow(GOLDEN_RATIO, order) / 5.0_f64.sqrt();
        let (f0, f1) = (fibonacci.round(), (fibonacci * GOLDEN_RATIO).round());
        let basis = Matrix2::new(signed_azimuth(f0 as u64), signed_azimuth(f1 as u64), f0, f1);
        let mut best = Nearest::new(direction);
        if let Some(inverse) = basis.try_inverse() {
            // Numbers of steps along the two basis vectors that lead from pad 0 (azimuth 0, `depth` 0) to `direction`.
            let steps = inverse * Vector2::new(azimuth_here, depth);
            let corner = steps.map(f64::floor);
            for along in -1..=2 {
                for across in -1..=2 {
                    let index =
                        (corner.x + f64::from(along)) * f0 + (corner.y + f64::from(across)) * f1;
                    // An index below 0 or above the last pad lies beyond a pole. It belongs to a pad on the other side
                    // of this pole.
                    let index = if index < 0.0 { -1.0 - index } else { index };
                    let index = if index >= count {
                        2.0 * count - 1.0 - index
                    } else {
                        index
                    };
                    if (0.0..count).contains(&index) {
                        best.consider(index as u64, self);
                    }
                }
            }
        }
        // Near the poles, the lattice does not resemble a plane lattice. Only a few pads are near a pole, so all of
        // these pads are compared with the direction.
        const POLAR: u64 = 12;
        if depth < POLAR as f64 {
            (0..(2 * POLAR).min(self.pads)).for_each(|index| best.consider(index, self));
        }
        if depth > count - 1.0 - POLAR as f64 {
            let first = self.pads.saturating_sub(2 * POLAR);
            (first..self.pads).for_each(|index| best.consider(index, self));
        }
        best.index
    }
}

struct Nearest<'a> {
    direction: &'a Vector3<f64>,
    index: u64,
    distance: f64,
}

impl<'a> Nearest<'a> {
    fn new(direction: &'a Vector3<f64>) -> Self {
        Self {
            direction,
            index: 0,
            distance: f64::INFINITY,
        }
    }

    fn consider(&mut self, index: u64, lattice: &UniformLattice) {
        let distance = (lattice.direction(index) - self.direction).norm_squared();
        if distance < self.distance {
            (self.index, self.distance) = (index, distance);
        }
    }
}

fn azimuth(index: u64) -> f64 {
    let turns = index.wrapping_mul(GOLDEN_TURN) as f64 / 2.0_f64.powi(64);
    std::f64::consts::TAU * turns
}

fn signed_azimuth(index: u64) -> f64 {
    let turns = index.wrapping_mul(GOLDEN_TURN) as i64 as f64 / 2.0_f64.powi(64);
    std::f64::consts::TAU * turns
}
