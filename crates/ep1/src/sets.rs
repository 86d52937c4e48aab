//! Many sets of readings, several of them side by side.

use nalgebra::Vector2;

use crate::least_squares::{Law, LeastSquares, Solution};
use crate::symmetric::Symmetric;
use crate::{Ep1Error, Moments, ProbeReading, ReadingNoise};

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

/// Number of sets side by side: few enough for the readings of some probes to stay in the nearest cache.
const ABREAST: usize = 32;

/// A number of each of the sets side by side.
type Abreast = [f64; ABREAST];

/// Standard deviation of shifts that others are a multiple of, over the probe's radius.
const UNIT_STD: f64 = 1e-3;

impl Sets<'_> {
    /// Estimates of the sets from `first` on, as [`LeastSquares`] finds them one by one, but for rounding: a row each. A
    /// set that tells no curvature has a row of NaN; standard deviations are NaN where neither noise nor residuals tell
    /// them.
    ///
    /// Compiled for the vectors of whoever calls it.
    ///
    /// # Errors
    /// [`Ep1Error::NotFinite`] with the set and the probe, for a number that is not finite; rows after it are not written.
    #[inline(always)]
    pub fn estimate(&self, first: usize, rows: &mut [SetRow]) -> Result<(), (usize, Ep1Error)> {
        let shared = self.shared();
        // Noise of rotations that differ from set to set has to be told set by set.
        let can_be_abreast = match &shared {
            Some(_) => true,
            None => {
                let noise = self.told();
                noise.relative_rotation_std == 0.0 && noise.rotation_std_rad == 0.0
            }
        };
        let mut abreast = SideBySide::new(if can_be_abreast { self.probes } else { 0 });
        for (group, rows) in rows.chunks_mut(ABREAST).enumerate() {
            let first = first + group * ABREAST;
            abreast.told = [0; ABREAST];
            if can_be_abreast && rows.len() == ABREAST {
                abreast.gather(self, first, group == 0);
                abreast.sum(self.radius);
                match &shared {
                    Some(fit) => abreast.fit::<true>(self, fit.law),
                    None => abreast.fit::<false>(
                        self,
                        Law::of_shifts(self.radius, self.told().shift_std, self.probes),
                    ),
                }
                abreast.measure_residuals(self.radius);
            }
            for (place, row) in rows.iter_mut().enumerate() {
                *row = match abreast.told[place] {
                    1 => std::array::from_fn(|column| abreast.columns[column][place]),
                    _ => match self.alone(first + place) {
                        Ok(row) => row,
                        Err(error @ Ep1Error::NotFinite { .. }) => {
                            return Err((first + place, error));
                        }
                        Err(_) => [f64::NAN; 11],
                    },
                };
                self.with_stds(row);
            }
        }
        Ok(())
    }

    /// Noise that the fits are told.
    fn told(&self) -> ReadingNoise {
        match self.noise.is_stated() {
            true => self.noise,
            false => ReadingNoise {
                shift_std: UNIT_STD * self.radius,
                ..self.noise
            },
        }
    }

    /// Scales the standard deviations of a row to its residuals, where no noise was stated.
    #[inline(always)]
    fn with_stds(&self, row: &mut SetRow) {
        if self.noise.is_stated() {
            return;
        }
        let residual = row[10];
        let factor = match residual == 0.0 {
            true => f64::NAN,
            false => residual / (UNIT_STD * self.radius),
        };
        row[5..9].iter_mut().for_each(|std| *std *= factor);
    }

    /// Fit of the rotations that all sets share.
    fn shared(&self) -> Option<LeastSquares> {
        let is_shared = self.rotations.len() == self.probes;
        let rotations: Vec<Vector2<f64>> = match is_shared {
            true => self.rotations.iter().map(|one| (*one).into()).collect(),
            false => return None,
        };
        LeastSquares::new(self.radius, self.told(), &rotations).ok()
    }

    /// Readings of one set.
    fn of_set<'n>(&self, numbers: &'n [[f64; 2]], set: usize) -> &'n [[f64; 2]] {
        match numbers.len() == self.probes {
            true => numbers,
            false => &numbers[set * self.probes..][..self.probes],
        }
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
        let estimate = LeastSquares::of(self.radius, self.told(), &readings)?;
        let most = std::f64::consts::PI * self.radius * (1.0 + 1e-9);
        let is_short = |reading: &ProbeReading| reading.shift.norm() <= most;
        if !readings.iter().all(is_short) {
            return Err(Ep1Error::OutOfRange);
        }
        let (residual, _) = estimate.residual(&readings);
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

/// Rotation and shift of one probe of sets side by side.
#[derive(Clone, Copy, Debug)]
struct SetProbe {
    rotation: [Abreast; 2],
    shift: [Abreast; 2],
}

impl SetProbe {
    const ZERO: Self = Self {
        rotation: [[0.0; ABREAST]; 2],
        shift: [[0.0; ABREAST]; 2],
    };
}

/// Sets side by side.
#[derive(Clone, Debug)]
struct SideBySide {
    probes: Vec<SetProbe>,
    sums: Sums,
    /// `K₁ B`: its entries uu, uv, vv.
    travel: [Abreast; 3],
    /// Columns of [`SetRow`].
    columns: [Abreast; 11],
    /// 1 where a set tells a curvature, else 0: then it may tell one alone.
    told: [u64; ABREAST],
}

impl SideBySide {
    fn new(probes: usize) -> Self {
        Self {
            probes: vec![SetProbe::ZERO; probes],
            sums: Sums::ZERO,
            travel: [[0.0; ABREAST]; 3],
            columns: [[0.0; ABREAST]; 11],
            told: [0; ABREAST],
        }
    }

    /// Puts the readings of the sets from `first` on side by side.
    #[inline(always)]
    fn gather(&mut self, sets: &Sets<'_>, first: usize, is_first: bool) {
        // What all sets share stands there from the first group on.
        let is_new = |numbers: &[[f64; 2]]| is_first || numbers.len() != sets.probes;
        if is_new(sets.rotations) {
            for place in 0..ABREAST {
                let of_set = sets.of_set(sets.rotations, first + place);
                for (probe, [x, y]) in self.probes.iter_mut().zip(of_set) {
                    probe.rotation[0][place] = *x;
                    probe.rotation[1][place] = *y;
                }
            }
        }
        if is_new(sets.shifts) {
            for place in 0..ABREAST {
                let of_set = sets.of_set(sets.shifts, first + place);
                for (probe, [u, v]) in self.probes.iter_mut().zip(of_set) {
                    probe.shift[0][place] = *u;
                    probe.shift[1][place] = *v;
                }
            }
        }
    }

    /// Sums over the probes of each set.
    #[inline(always)]
    fn sum(&mut self, radius: f64) {
        let sums = &mut self.sums;
        *sums = Sums::ZERO;
        for probe in &self.probes {
            for place in 0..ABREAST {
                let (x, y) = (probe.rotation[0][place], probe.rotation[1][place]);
                let (u, v) = (probe.shift[0][place], probe.shift[1][place]);
                // As `Moments` does, in the open: what is not inlined lacks the vectors of what calls it.
                let (d_u, d_v) = (u + radius * y, v - radius * x);
                sums.deviations[0][place] -= y * d_u;
                sums.deviations[1][place] += x * d_v;
                sums.deviations[2][place] += x * d_u - y * d_v;
                sums.lengths[place] += (u * u + v * v).sqrt();
                sums.gram[0][place] += y * y;
                sums.gram[1][place] -= x * y;
                sums.gram[2][place] += x * x;
                let (longest, length) = (sums.longest[place], u * u + v * v);
                sums.longest[place] = if length > longest { length } else { longest };
            }
        }
    }

    /// Fits the sets, by the law that they share or each by its own: all of their columns but the residuals.
    #[inline(always)]
    fn fit<const IS_SHARED: bool>(&mut self, sets: &Sets<'_>, shared: Law) {
        let half_turn = std::f64::consts::PI * sets.radius;
        let half_turn_squared = half_turn * half_turn;
        for place in 0..ABREAST {
            let (moments, gram) = (self.sums.moments(place), self.sums.gram(place));
            let (law, spans) = match IS_SHARED {
                true => (shared, true),
                false => shared.with_rotations(&gram),
            };
            let Solution {
                travel,
                curvature,
                curvatures,
                stds,
                moved,
                in_range,
            } = law.solve::<true>(&moments);
            let told = spans & moved & in_range & (self.sums.longest[place] <= half_turn_squared);
            self.told[place] = u64::from(told);
            self.travel[0][place] = travel.uu;
            self.travel[1][place] = travel.uv;
            self.travel[2][place] = travel.vv;
            self.columns[0][place] = curvatures[0];
            self.columns[1][place] = curvatures[1];
            self.columns[2][place] = curvature.uv;
            self.columns[3][place] = curvatures[2];
            self.columns[4][place] = curvatures[3];
            self.columns[5][place] = stds[0];
            self.columns[6][place] = stds[1];
            self.columns[7][place] = stds[2];
            self.columns[8][place] = stds[3];
            self.columns[9][place] = law.arc_length(&moments);
        }
    }

    /// Root mean squares of the residuals `Δp − B g` per component; 0 of sets without a degree of freedom.
    #[inline(always)]
    fn measure_residuals(&mut self, radius: f64) {
        let freedom = (2 * self.probes.len()).saturating_sub(3);
        let per_freedom = match freedom {
            0 => 0.0,
            freedom => 1.0 / freedom as f64,
        };
        let [uu, uv, vv] = &self.travel;
        let squares = &mut self.columns[10];
        *squares = [0.0; ABREAST];
        for probe in &self.probes {
            for place in 0..ABREAST {
                let [x, y] = [probe.rotation[0][place], probe.rotation[1][place]];
                let left_u = probe.shift[0][place] - radius * (uv[place] * x - uu[place] * y);
                let left_v = probe.shift[1][place] - radius * (vv[place] * x - uv[place] * y);
                squares[place] += left_u * left_u + left_v * left_v;
            }
        }
        for square in squares {
            *square = (*square * per_freedom).sqrt();
        }
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
    const ZERO: Self = Self {
        deviations: [[0.0; ABREAST]; 3],
        lengths: [0.0; ABREAST],
        gram: [[0.0; ABREAST]; 3],
        longest: [0.0; ABREAST],
    };

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
