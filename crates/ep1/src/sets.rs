//! Many sets of readings, several of them side by side.

use nalgebra::Vector2;

use crate::least_squares::{Law, LeastSquares, Solution};
use crate::symmetric::{Symmetric, Symmetric3};
use crate::{Ep1Error, Moments, PadStart, ProbeReading, ReadingNoise};

/// Row of estimates from one set of readings: normal curvature along u and v, twist k_uv, Gaussian and mean curvature; the
/// standard deviations of all but the twist, in the same order; mean length of the shifts; root mean square of the
/// residuals of a component of a shift.
pub type SetRow = [f64; 11];

/// Sets of readings of as many probes each, one after the other.
///
/// ```
/// use palpate_ep1::{ReadingNoise, SetRow, Sets};
///
/// // Two probes of radius 1 turn as far in both sets; their contacts move on balls of radius 3 and 1.
/// let sets = Sets {
///     radius: 1.0,
///     noise: ReadingNoise::default(),
///     probes: 2,
///     rotations: &[[0.0, -0.1], [0.1, 0.0]],
///     shifts: &[[0.075, 0.0], [0.0, 0.075], [0.05, 0.0], [0.0, 0.05]],
/// };
/// let mut rows: [SetRow; 2] = Default::default();
/// sets.estimate(0, &mut rows).map_err(|(_, error)| error)?;
/// assert!((rows[0][4] - 1.0 / 3.0).abs() < 1e-13 && (rows[1][4] - 1.0).abs() < 1e-13);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Sets<'a> {
    /// Radius of the probes, length.
    pub radius: f64,
    /// Noise of the readings; where none is stated, standard deviations follow from the residuals of each set.
    pub noise: ReadingNoise,
    /// Number of probes of each set.
    pub probes: usize,
    /// `(Δθ_x, Δθ_y)` of the probes of each set, rad; of one set alone where all have turned alike.
    pub rotations: &'a [[f64; 2]],
    /// `(Δp_u, Δp_v)` of the probes of each set, length; of one set alone likewise.
    pub shifts: &'a [[f64; 2]],
}

/// Number of sets side by side: those of a vector, so that sums over their probes stay in registers.
const ABREAST: usize = 8;

/// A number of each of the sets side by side.
type Abreast = [f64; ABREAST];

impl Sets<'_> {
    /// Estimates of the sets from `first` on, to the last bit as [`LeastSquares`] finds them one by one: a row each. A set
    /// that tells no curvature has a row of NaN; standard deviations are NaN where neither noise nor residuals tell them.
    ///
    /// Compiled for the vectors of whoever calls it.
    ///
    /// # Errors
    /// [`Ep1Error::NotFinite`] with the set and the probe, for a number that is not finite; rows after it are not written.
    #[inline(always)]
    pub fn estimate(&self, first: usize, rows: &mut [SetRow]) -> Result<(), (usize, Ep1Error)> {
        let law = self.law();
        let is_shared = self.rotations.len() == self.probes;
        let mut kept = [[[0.0; ABREAST]; 4]; KEPT];
        for (group, rows) in rows.chunks_mut(ABREAST).enumerate() {
            let first = first + group * ABREAST;
            let mut told = [0; ABREAST];
            if let (Some(law), Ok(rows)) = (law, <&mut [SetRow; ABREAST]>::try_from(&mut *rows)) {
                told = match (is_shared, self.noise.is_stated()) {
                    (true, true) => self.together::<true, true>(first, law, rows, &mut kept),
                    (true, false) => self.together::<true, false>(first, law, rows, &mut kept),
                    (false, true) => self.together::<false, true>(first, law, rows, &mut kept),
                    (false, false) => self.together::<false, false>(first, law, rows, &mut kept),
                };
            }
            for (place, row) in rows.iter_mut().enumerate() {
                if told[place] == 1 {
                    continue;
                }
                *row = match self.alone(first + place) {
                    Ok(row) => row,
                    Err(error @ Ep1Error::NotFinite { .. }) => return Err((first + place, error)),
                    Err(_) => [f64::NAN; 11],
                };
            }
        }
        Ok(())
    }

    /// Law by which sets are fitted side by side: that of the rotations that all share, or of any rotations, which lacks
    /// these; `None` where the sets have to be fitted one by one.
    fn law(&self) -> Option<Law> {
        if self.rotations.len() == self.probes {
            let rotations = self.rotations.iter().map(|one| (*one).into());
            let rotations: Vec<Vector2<f64>> = rotations.collect();
            return Some(
                LeastSquares::new(self.radius, self.noise, &rotations)
                    .ok()?
                    .law,
            );
        }
        // Noise of rotations that differ from set to set has to be told set by set.
        let noise = self.noise;
        let is_of_shifts = noise.relative_rotation_std == 0.0
            && noise.rotation_std_rad == 0.0
            && noise.pad_start == PadStart::PerRoll;
        let is_sound = self.radius > 0.0 && self.radius.is_finite() && noise.shift_std.is_finite();
        (is_of_shifts && is_sound && self.probes > 0).then(|| {
            Law::of_shifts(
                self.radius,
                noise.shift_std,
                self.probes,
                &Symmetric3::unit(1.0),
            )
        })
    }

    /// Readings of one set.
    #[inline(always)]
    fn of_set<'n>(&self, numbers: &'n [[f64; 2]], set: usize) -> &'n [[f64; 2]] {
        match numbers.len() == self.probes {
            true => numbers,
            false => &numbers[set * self.probes..][..self.probes],
        }
    }

    /// Readings of the sets from this one on.
    #[inline(always)]
    fn of_sets<'n>(&self, numbers: &'n [[f64; 2]], set: usize) -> Probes<'n> {
        std::array::from_fn(
            #[inline(always)]
            |place| self.of_set(numbers, set + place),
        )
    }

    /// Rows of the sets from `first` on, and 1 for each that tells a curvature; of the others, which may tell one alone, the
    /// row is not to be used.
    #[inline(always)]
    fn together<const IS_SHARED: bool, const IS_STATED: bool>(
        &self,
        first: usize,
        law: Law,
        rows: &mut [SetRow; ABREAST],
        kept: &mut [Probe; KEPT],
    ) -> [u64; ABREAST] {
        let readings = Readings::<IS_SHARED> {
            rotations: self.of_sets(self.rotations, first),
            shifts: self.of_sets(self.shifts, first),
        };
        let sums = Sums::of(self.radius, &readings, kept);
        let half_turn = std::f64::consts::PI * self.radius;
        let half_turn_squared = half_turn * half_turn;
        let mut told = [0; ABREAST];
        let mut mobility = [[0.0; ABREAST]; 3];
        let mut columns = [[0.0; ABREAST]; 11];
        for place in 0..ABREAST {
            let moments = sums.moments(place);
            let (law, spans) = match IS_SHARED {
                true => (law, true),
                false => {
                    let (inverse, spans) = Symmetric3::inverse_of_normal(&sums.gram(place));
                    (law.with_rotations(&inverse), spans)
                }
            };
            let Solution {
                travel,
                curvature,
                curvatures,
                stds,
                moved,
                in_range,
            } = law.solve::<IS_STATED>(&moments);
            let is_told = spans & moved & in_range & (sums.longest[place] <= half_turn_squared);
            told[place] = u64::from(is_told);
            mobility[0][place] = self.radius * travel.uu;
            mobility[1][place] = self.radius * travel.uv;
            mobility[2][place] = self.radius * travel.vv;
            columns[0][place] = curvatures[0];
            columns[1][place] = curvatures[1];
            columns[2][place] = curvature.uv;
            columns[3][place] = curvatures[2];
            columns[4][place] = curvatures[3];
            columns[5][place] = stds[0];
            columns[6][place] = stds[1];
            columns[7][place] = stds[2];
            columns[8][place] = stds[3];
            columns[9][place] = law.arc_length(&moments);
        }
        columns[10] = readings.residuals(&mobility, kept);
        if !IS_STATED {
            for place in 0..ABREAST {
                // As noisy as the residuals; residuals of nothing tell nothing.
                let (inverse, spans) = Symmetric3::inverse_of_normal(&sums.gram(place));
                let residual = columns[10][place];
                let known = if residual > 0.0 { 1.0 } else { f64::NAN };
                let law = Law::of_shifts(self.radius, residual, self.probes, &inverse);
                let solution = law.solve::<true>(&sums.moments(place));
                told[place] &= u64::from(spans & solution.in_range);
                columns[5][place] = known * solution.stds[0];
                columns[6][place] = known * solution.stds[1];
                columns[7][place] = known * solution.stds[2];
                columns[8][place] = known * solution.stds[3];
            }
        }
        for (place, row) in rows.iter_mut().enumerate() {
            for (number, column) in row.iter_mut().zip(&columns) {
                *number = column[place];
            }
        }
        told
    }

    /// Row of one set.
    #[cold]
    #[inline(never)]
    fn alone(&self, set: usize) -> Result<SetRow, Ep1Error> {
        let rotations = self.of_set(self.rotations, set).iter();
        let readings: Vec<ProbeReading> = rotations
            .zip(self.of_set(self.shifts, set))
            .map(|(rotation, shift)| ProbeReading {
                rotation: (*rotation).into(),
                shift: (*shift).into(),
            })
            .collect();
        let mut estimate = LeastSquares::of(self.radius, self.noise, &readings)?;
        let most = std::f64::consts::PI * self.radius * (1.0 + 1e-9);
        let is_short = |reading: &ProbeReading| reading.shift.norm() <= most;
        if !readings.iter().all(is_short) {
            return Err(Ep1Error::OutOfRange);
        }
        let (residual, _) = estimate.residual(&readings);
        if !self.noise.is_stated() && residual > 0.0 {
            let noise = ReadingNoise {
                shift_std: residual,
                ..self.noise
            };
            estimate = LeastSquares::of(self.radius, noise, &readings)?;
        }
        let measured = [
            estimate.normal_curvature_u,
            estimate.normal_curvature_v,
            estimate.gaussian_curvature,
            estimate.mean_curvature,
        ];
        let [u, v, gaussian, mean] = measured.map(|one| one.value);
        let [std_u, std_v, of_gaussian, of_mean] = measured.map(|one| one.std.unwrap_or(f64::NAN));
        let (twist, arc_length) = (estimate.curvature.k_uv, estimate.arc_length);
        Ok([
            u,
            v,
            twist,
            gaussian,
            mean,
            std_u,
            std_v,
            of_gaussian,
            of_mean,
            arc_length,
            residual,
        ])
    }
}

/// Rotations, or shifts, of the probes of sets side by side.
type Probes<'n> = [&'n [[f64; 2]]; ABREAST];

/// Rotation, x and y, and shift, u and v, of one probe in all sets side by side.
type Probe = [Abreast; 4];

/// Probes whose readings are kept side by side, in the nearest cache, for the residuals.
const KEPT: usize = 16;

/// Readings of sets side by side, whose rotations are those of the first where they are shared.
struct Readings<'n, const IS_SHARED: bool> {
    rotations: Probes<'n>,
    shifts: Probes<'n>,
}

impl<const IS_SHARED: bool> Readings<'_, IS_SHARED> {
    #[inline(always)]
    fn probes(&self) -> usize {
        self.rotations[0].len()
    }

    /// Readings of one probe.
    #[inline(always)]
    fn of(&self, probe: usize) -> Probe {
        let mut all = [[0.0; ABREAST]; 4];
        if IS_SHARED {
            let [x, y] = self.rotations[0][probe];
            all[0] = [x; ABREAST];
            all[1] = [y; ABREAST];
        } else {
            for (place, rotations) in self.rotations.iter().enumerate() {
                [all[0][place], all[1][place]] = rotations[probe];
            }
        }
        for (place, shifts) in self.shifts.iter().enumerate() {
            [all[2][place], all[3][place]] = shifts[probe];
        }
        all
    }

    /// Root mean squares of the residuals `Δp − B g` per component, of `B` with entries uu, uv, vv.
    #[inline(always)]
    fn residuals(&self, mobility: &[Abreast; 3], kept: &[Probe; KEPT]) -> Abreast {
        let freedom = (2 * self.probes()).saturating_sub(3) as f64;
        let mut squares = [0.0; ABREAST];
        for probe in kept.iter().take(self.probes()) {
            add_squares(&mut squares, mobility, probe);
        }
        for probe in KEPT..self.probes() {
            add_squares(&mut squares, mobility, &self.of(probe));
        }
        let mut roots = [0.0; ABREAST];
        for place in 0..ABREAST {
            roots[place] = (squares[place] / freedom).sqrt();
        }
        roots
    }
}

#[inline(always)]
fn add_squares(squares: &mut Abreast, [uu, uv, vv]: &[Abreast; 3], [x, y, u, v]: &Probe) {
    for place in 0..ABREAST {
        let (x, y) = (x[place], y[place]);
        let left_u = u[place] - (uv[place] * x - uu[place] * y);
        let left_v = v[place] - (vv[place] * x - uv[place] * y);
        squares[place] += left_u * left_u + left_v * left_v;
    }
}

/// Sums over the probes of sets side by side.
#[derive(Clone, Copy, Debug)]
struct Sums {
    deviations: [Abreast; 3],
    lengths: Abreast,
    /// Entries uu, uv, vv of the rotations' Gram matrix.
    gram: [Abreast; 3],
    /// Square of the longest shift.
    longest: Abreast,
}

impl Sums {
    /// Sums over the readings, of which the first are kept.
    #[inline(always)]
    fn of<const IS_SHARED: bool>(
        radius: f64,
        readings: &Readings<'_, IS_SHARED>,
        kept: &mut [Probe; KEPT],
    ) -> Self {
        let zero = [0.0; ABREAST];
        let mut sums = Self {
            deviations: [zero; 3],
            lengths: zero,
            gram: [zero; 3],
            longest: zero,
        };
        for probe in 0..readings.probes() {
            let all = readings.of(probe);
            if let Some(kept) = kept.get_mut(probe) {
                *kept = all;
            }
            sums.add(radius, &all);
        }
        sums
    }

    #[inline(always)]
    fn add(&mut self, radius: f64, [x, y, u, v]: &Probe) {
        for place in 0..ABREAST {
            let (x, y, u, v) = (x[place], y[place], u[place], v[place]);
            // As `Moments` does, in the open: what is not inlined lacks the vectors of what calls it.
            let (d_u, d_v) = (u + radius * y, v - radius * x);
            self.deviations[0][place] -= y * d_u;
            self.deviations[1][place] += x * d_v;
            self.deviations[2][place] += x * d_u - y * d_v;
            let length = u * u + v * v;
            self.lengths[place] += length.sqrt();
            self.gram[0][place] += y * y;
            self.gram[1][place] -= x * y;
            self.gram[2][place] += x * x;
            let longest = self.longest[place];
            self.longest[place] = if length > longest { length } else { longest };
        }
    }

    #[inline(always)]
    fn moments(&self, place: usize) -> Moments {
        Moments {
            deviations: [
                self.deviations[0][place],
                self.deviations[1][place],
                self.deviations[2][place],
            ],
            lengths: self.lengths[place],
        }
    }

    #[inline(always)]
    fn gram(&self, place: usize) -> Symmetric {
        Symmetric {
            uu: self.gram[0][place],
            uv: self.gram[1][place],
            vv: self.gram[2][place],
        }
    }
}
