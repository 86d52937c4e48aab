//! Sums over the probes.

use nalgebra::Vector2;

use crate::{Number, ProbeReading};

/// Sums over the probes from which [`LeastSquares`](crate::LeastSquares) estimates: of one set of readings, or of
/// several side by side.
///
/// ```
/// use nalgebra::Vector2;
/// use palpate_ep1::{LeastSquares, Moments, ProbeRotation, ReadingNoise};
///
/// let rotations = [Vector2::new(0.0, -0.1), Vector2::new(0.1, 0.0)];
/// let fit = LeastSquares::new(1.0, ReadingNoise::default(), &rotations)?;
/// let mut moments: Moments = Moments::default();
/// for (rotation, shift) in rotations.iter().zip([[0.075, 0.0], [0.0, 0.075]]) {
///     moments.add_shifts(&ProbeRotation::new(1.0, rotation), shift);
/// }
/// // A ball of radius 3.
/// let gaussian = fit.estimate(&moments)?.gaussian_curvature.value;
/// assert!((gaussian - 1.0 / 9.0).abs() < 1e-13);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Moments<N = f64> {
    /// Sums of `g₁ d₁`, `g₂ d₂`, `g₂ d₁ + g₁ d₂` with the deviations `d = Δp − R₁ g`.
    pub(crate) deviations: [N; 3],
    /// Sum of the lengths of the shifts.
    pub(crate) lengths: N,
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
}

impl<N: Number> Moments<N> {
    /// Takes one more probe into account, with its shifts along u and v.
    #[inline(always)]
    pub fn add_shifts(&mut self, rotation: &ProbeRotation, [p1, p2]: [N; 2]) {
        let ([g1, g2], [flat1, flat2]) = (rotation.drive.map(N::of), rotation.flat.map(N::of));
        let (d1, d2) = (p1 - flat1, p2 - flat2);
        self.deviations[0] += g1 * d1;
        self.deviations[1] += g2 * d2;
        self.deviations[2] += g2 * d1 + g1 * d2;
        self.lengths += (p1 * p1 + p2 * p2).sqrt();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{LANES, Lanes};

    #[test]
    fn side_by_side_is_one_after_the_other() {
        let reading = |k: f64, shift: f64| ProbeReading {
            rotation: Vector2::new(k, 1.0 - k * k),
            shift: Vector2::new(0.8 * shift, 0.6 * shift),
        };
        let mut apart = [Moments::<f64>::default(); LANES];
        let mut together = Moments::<Lanes>::default();
        for k in [1.0, 2.0, 3.0, 4.0, 5.0] {
            let readings: [_; LANES] = std::array::from_fn(|lane| reading(k, k + lane as f64));
            for (moments, reading) in apart.iter_mut().zip(&readings) {
                moments.add(2.0, reading);
            }
            let rotation = ProbeRotation::new(2.0, &readings[0].rotation);
            let along_u = Lanes(readings.map(|reading| reading.shift.x));
            let along_v = Lanes(readings.map(|reading| reading.shift.y));
            together.add_shifts(&rotation, [along_u, along_v]);
        }
        for (lane, apart) in apart.iter().enumerate() {
            let lane = |sum: Lanes| sum.0[lane];
            assert_eq!(together.deviations.map(lane), apart.deviations);
            assert_eq!(lane(together.lengths), apart.lengths);
        }
        approx::assert_relative_eq!(apart[0].lengths, 15.0, max_relative = 1e-15);
    }
}
