//! Sums over the probes.

use nalgebra::Vector2;

use crate::ProbeReading;

/// Probes that are summed side by side, so that the compiler can use vector instructions.
pub const LANES: usize = 2;
/// A number for each of some probes side by side.
pub type Lanes = [f64; LANES];

/// What the fit needs of the shifts, summed over the probes of each lane.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Moments {
    /// Sums of `g₁ d₁`, `g₂ d₂`, `g₂ d₁`, `g₁ d₂` with the deviations `d = Δp − R₁ g`.
    deviations: [Lanes; 4],
    lengths: Lanes,
}

/// Up to [`LANES`] probes side by side: what the fit needs of their rotations.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ProbeGroup {
    /// `(g₁, g₂)`; zero in the lanes without a probe.
    drive: [Lanes; 2],
    /// `R₁ g`, the shifts on a plane.
    flat: [Lanes; 2],
}

impl ProbeGroup {
    /// The first [`LANES`] of some probes of `radius` that turned by `rotations`. A lane without a
    /// probe needs the shift 0.
    pub fn new(radius: f64, rotations: &[Vector2<f64>]) -> Self {
        let mut group = Self::default();
        for (lane, rotation) in rotations.iter().take(LANES).enumerate() {
            for (axis, drive) in [-rotation.y, rotation.x].into_iter().enumerate() {
                group.drive[axis][lane] = drive;
                group.flat[axis][lane] = radius * drive;
            }
        }
        group
    }
}

impl Moments {
    /// Takes one more probe of `radius` into account.
    #[inline]
    pub fn add(&mut self, radius: f64, reading: &ProbeReading) {
        let group = ProbeGroup::new(radius, std::slice::from_ref(&reading.rotation));
        let mut shifts = [Lanes::default(); 2];
        (shifts[0][0], shifts[1][0]) = (reading.shift.x, reading.shift.y);
        self.add_group(&group, &shifts);
    }

    /// Takes one more group of probes into account, with their shifts along u and v.
    #[inline(always)]
    pub fn add_group(&mut self, group: &ProbeGroup, shifts: &[Lanes; 2]) {
        for lane in 0..LANES {
            let [g1, g2] = group.drive.map(|drive| drive[lane]);
            let [p1, p2] = shifts.map(|shift| shift[lane]);
            let (d1, d2) = (p1 - group.flat[0][lane], p2 - group.flat[1][lane]);
            self.deviations[0][lane] += g1 * d1;
            self.deviations[1][lane] += g2 * d2;
            self.deviations[2][lane] += g2 * d1;
            self.deviations[3][lane] += g1 * d2;
            self.lengths[lane] += (p1 * p1 + p2 * p2).sqrt();
        }
    }

    /// `Σ Aᵀ d` of the normal equations.
    #[inline(always)]
    pub(crate) fn deviations(&self) -> [f64; 3] {
        let [uu, vv, uv, vu] = self.deviations.map(total);
        [uu, vv, uv + vu]
    }

    /// Sum of the lengths of the shifts.
    #[inline(always)]
    pub(crate) fn lengths(&self) -> f64 {
        total(self.lengths)
    }
}

/// Sum over the lanes.
#[inline(always)]
fn total(lanes: Lanes) -> f64 {
    lanes.iter().sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn side_by_side_is_one_after_the_other() {
        let readings = [1.0, 2.0, 3.0, 4.0, 5.0].map(|k| ProbeReading {
            rotation: Vector2::new(k, 1.0 - k * k),
            shift: Vector2::new(8.0 * k, 6.0 * k),
        });
        let (mut one_by_one, mut grouped) = (Moments::default(), Moments::default());
        for readings in readings.chunks(LANES) {
            let rotations: Vec<_> = readings.iter().map(|reading| reading.rotation).collect();
            let mut shifts = [Lanes::default(); 2];
            for (lane, reading) in readings.iter().enumerate() {
                one_by_one.add(2.0, reading);
                (shifts[0][lane], shifts[1][lane]) = (reading.shift.x, reading.shift.y);
            }
            grouped.add_group(&ProbeGroup::new(2.0, &rotations), &shifts);
        }
        // Small integers: every sum is exact.
        assert_eq!(grouped.deviations(), one_by_one.deviations());
        assert_eq!(grouped.lengths(), 150.0);
        assert_eq!(one_by_one.lengths(), 150.0);
    }
}
