//! Sums over the probes.

use nalgebra::Vector2;

use crate::ProbeReading;

/// Sums over the probes from which [`LeastSquares`](crate::LeastSquares) estimates.
///
/// ```
/// use nalgebra::Vector2;
/// use palpate_ep1::{LeastSquares, Moments, ProbeRotation, ReadingNoise};
///
/// let rotations = [Vector2::new(0.0, -0.1), Vector2::new(0.1, 0.0)];
/// let fit = LeastSquares::new(1.0, ReadingNoise::default(), &rotations)?;
/// let mut moments = Moments::default();
/// for (rotation, shift) in rotations.iter().zip([[0.075, 0.0], [0.0, 0.075]]) {
///     moments.add_shifts(&ProbeRotation::new(1.0, rotation), shift);
/// }
/// // A ball of radius 3.
/// let gaussian = fit.estimate(&moments)?.gaussian_curvature.value;
/// assert!((gaussian - 1.0 / 9.0).abs() < 1e-13);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Moments {
    /// Sums of `g₁ d₁`, `g₂ d₂`, `g₂ d₁ + g₁ d₂` with the deviations `d = Δp − R₁ g`.
    pub(crate) deviations: [f64; 3],
    /// Sum of the lengths of the shifts.
    pub(crate) lengths: f64,
}

/// The rotation of one probe, in the form in which [`Moments`] need it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ProbeRotation {
    /// Drive `g = (−Δθ_y, Δθ_x)`, rad.
    drive: [f64; 2],
    /// `R₁ g`, the shift on a plane.
    flat: [f64; 2],
}

impl ProbeRotation {
    /// The rotation of a probe of `radius` that turned by `rotation`, `(Δθ_x, Δθ_y)` in rad, in every set of
    /// readings.
    #[inline]
    pub fn new(radius: f64, rotation: &Vector2<f64>) -> Self {
        let drive = [-rotation.y, rotation.x];
        Self {
            drive,
            flat: drive.map(|drive| radius * drive),
        }
    }
}

impl Moments {
    /// Takes one more probe of `radius` into account.
    #[inline]
    pub fn add(&mut self, radius: f64, reading: &ProbeReading) {
        let rotation = ProbeRotation::new(radius, &reading.rotation);
        self.add_shifts(&rotation, [reading.shift.x, reading.shift.y]);
    }

    /// Takes one more probe into account, with its shifts along u and v.
    #[inline(always)]
    pub fn add_shifts(&mut self, rotation: &ProbeRotation, [p1, p2]: [f64; 2]) {
        let ([g1, g2], [flat1, flat2]) = (rotation.drive, rotation.flat);
        let (d1, d2) = (p1 - flat1, p2 - flat2);
        self.deviations[0] += g1 * d1;
        self.deviations[1] += g2 * d2;
        self.deviations[2] += g2 * d1 + g1 * d2;
        self.lengths += (p1 * p1 + p2 * p2).sqrt();
    }
}
