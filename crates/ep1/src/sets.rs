//! Many sets of readings, several of which are fitted at once.

use nalgebra::Vector2;

use crate::least_squares::{Law, LeastSquares, Solution};
use crate::symmetric::{Symmetric, Symmetric3};
use crate::{Ep1Error, Moments, PadStart, ProbeReading, ReadingNoise};

/// Row of estimates from one set of readings: normal curvature along u and v, twist k_uv, Gaussian and mean curvature; their
/// standard deviations in the same order, except for the twist; mean length of the shifts; root mean square residual of a
/// component of a shift.
pub type SetRow = [f64; 11];

/// Consecutive sets of readings, each of the same number of probes.
///
/// ```
/// use palpate_ep1::{ReadingNoise, SetRow, Sets};
///
/// // Two probes of radius 1 turn equally in both sets. The objects are balls of radius 3 and 1.
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
    /// Noise of the readings. If none is stated, standard deviations follow from the residuals of each set.
    pub noise: ReadingNoise,
    /// Number of probes of each set.
    pub probes: usize,
    /// `(Δθ_x, Δθ_y)` of the probes of each set, rad; or of a single set, if the rotations of all sets are equal.
    pub rotations: &'a [[f64; 2]],
    /// `(Δp_u, Δp_v)` of the probes of each set, length; or of a single set likewise.
    pub shifts: &'a [[f64; 2]],
}

/// Number of sets that are fitted at once: a vector of sets, so that sums over their probes stay in registers.
const GROUP: usize = 8;

/// A number for each set of a group.
type Group = [f64; GROUP];

impl Sets<'_> {
    /// Estimates of the sets from `first` on, one row for each. They equal those of [`LeastSquares`] to the last bit. If a set
    /// does not determine the curvature, its row is NaN. Standard deviations are NaN if neither noise nor residuals
    /// determine them.
    ///
    /// It is compiled for the vector instructions of its caller.
    ///
    /// # Errors
    /// [`Ep1Error::NotFinite`] with set and probe, if a number is not finite. Rows after this set are not written.
    #[inline(always)]
    pub fn estimate(&self, first: usize, rows: &mut [SetRow]) -> Result<(), (usize, Ep1Error)> {
        let law = self.law();
        let is_shared = self.rotations.len() == self.probes;
        let mut cache = [[[0.0; GROUP]; 4]; CACHED];
        for (group, rows) in rows.chunks_mut(GROUP).enumerate() {
            let first = first + group * GROUP;
            let mut is_valid = [0; GROUP];
            if let (Some(law), Ok(rows)) = (law, <&mut [SetRow; GROUP]>::try_from(&mut *rows)) {
                is_valid = match (is_shared, self.noise.is_stated()) {
                    (true, true) => self.fit_group::<true, true>(first, law, rows, &mut cache),
                    (true, false) => self.fit_group::<true, false>(first, law, rows, &mut cache),
                    (false, true) => self.fit_group::<false, true>(first, law, rows, &mut cache),
                    (false, false) => self.fit_group::<false, false>(first, law, rows, &mut cache),
                };
            }
            for (place, row) in rows.iter_mut().enumerate() {
                if is_valid[place] == 1 {
                    continue;
                }
                *row = match self.fit_one(first + place) {
                    Ok(row) => row,
                    Err(error @ Ep1Error::NotFinite { .. }) => return Err((first + place, error)),
                    Err(_) => [f64::NAN; 11],
                };
            }
        }
        Ok(())
    }

    /// The law for groups: for the shared rotations, or without rotations, which are added later. `None` if the sets must be
    /// fitted one by one.
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
        // If rotations differ between sets, their noise must be included set by set.
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
    fn set_of<'n>(&self, numbers: &'n [[f64; 2]], set: usize) -> &'n [[f64; 2]] {
        match numbers.len() == self.probes {
            true => numbers,
            false => &numbers[set * self.probes..][..self.probes],
        }
    }

    /// Readings of a group of sets, starting with this one.
    #[inline(always)]
    fn group_of<'n>(&self, numbers: &'n [[f64; 2]], set: usize) -> Probes<'n> {
        std::array::from_fn(
            #[inline(always)]
            |place| self.set_of(numbers, set + place),
        )
    }

    /// Sets the rows of a group. Returns 1 for each set whose curvature is determined. The other rows are invalid; these sets
    /// must be fitted alone.
    #[inline(always)]
    fn fit_group<const IS_SHARED: bool, const IS_STATED: bool>(
        &self,
        first: usize,
        law: Law,
        rows: &mut [SetRow; GROUP],
        cache: &mut [Probe; CACHED],
    ) -> [u64; GROUP] {
        let readings = Readings::<IS_SHARED> {
            rotations: self.group_of(self.rotations, first),
            shifts: self.group_of(self.shifts, first),
        };
        let sums = Sums::of(self.radius, &readings, cache);
        let half_turn = std::f64::consts::PI * self.radius;
        let half_turn_squared = half_turn * half_turn;
        let mut is_valid = [0; GROUP];
        let mut mobility = [[0.0; GROUP]; 3];
        let mut columns = [[0.0; GROUP]; 11];
        for place in 0..GROUP {
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
            let is_determined =
                spans & moved & in_range & (sums.longest[place] <= half_turn_squared);
            is_valid[place] = u64::from(is_determined);
            mobility[0][place] = self.radius * travel.uu;
            mobility[1][place] = self.radius * travel.uv;
            mobility[2][place] = self.radius * travel.vv;
            let [u, v, gaussian, mean] = curvatures;
            for (column, value) in columns.iter_mut().zip([u, v, curvature.uv, gaussian, mean]) {
                column[place] = value;
            }
            for (column, std) in columns[5..].iter_mut().zip(stds) {
                column[place] = std;
            }
            columns[9][place] = law.arc_length(&moments);
        }
        columns[10] = readings.residuals(&mobility, cache);
        if !IS_STATED {
            for place in 0..GROUP {
                // The noise is estimated from the residuals. Without residuals it is unknown.
                let (inverse, spans) = Symmetric3::inverse_of_normal(&sums.gram(place));
                let residual = columns[10][place];
                let known = if residual > 0.0 { 1.0 } else { f64::NAN };
                let law = Law::of_shifts(self.radius, residual, self.probes, &inverse);
                let solution = law.solve::<true>(&sums.moments(place));
                is_valid[place] &= u64::from(spans & solution.in_range);
                for (column, std) in columns[5..].iter_mut().zip(solution.stds) {
                    column[place] = known * std;
                }
            }
        }
        for (place, row) in rows.iter_mut().enumerate() {
            for (number, column) in row.iter_mut().zip(&columns) {
                *number = column[place];
            }
        }
        is_valid
    }

    /// The row of a single set.
    #[cold]
    #[inline(never)]
    fn fit_one(&self, set: usize) -> Result<SetRow, Ep1Error> {
        let rotations = self.set_of(self.rotations, set).iter();
        let readings: Vec<ProbeReading> = rotations
            .zip(self.set_of(self.shifts, set))
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

/// Rotations, or shifts, of the probes of a group.
type Probes<'n> = [&'n [[f64; 2]]; GROUP];

/// Rotation, x and y, and shift, u and v, of one probe in all sets of a group.
type Probe = [Group; 4];

/// Number of probes whose readings are stored for the residuals. They fit into the L1 cache.
const CACHED: usize = 16;

/// Readings of a group of sets. If the rotations are shared, those of the first set are used.
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
        let mut all = [[0.0; GROUP]; 4];
        if IS_SHARED {
            let [x, y] = self.rotations[0][probe];
            all[0] = [x; GROUP];
            all[1] = [y; GROUP];
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
    fn residuals(&self, mobility: &[Group; 3], cache: &[Probe; CACHED]) -> Group {
        let freedom = (2 * self.probes()).saturating_sub(3) as f64;
        let mut squares = [0.0; GROUP];
        for probe in cache.iter().take(self.probes()) {
            add_squares(&mut squares, mobility, probe);
        }
        for probe in CACHED..self.probes() {
            add_squares(&mut squares, mobility, &self.of(probe));
        }
        let mut roots = [0.0; GROUP];
        for place in 0..GROUP {
            roots[place] = (squares[place] / freedom).sqrt();
        }
        roots
    }
}

#[inline(always)]
fn add_squares(squares: &mut Group, [uu, uv, vv]: &[Group; 3], [x, y, u, v]: &Probe) {
    for place in 0..GROUP {
        let (x, y) = (x[place], y[place]);
        let left_u = u[place] - (uv[place] * x - uu[place] * y);
        let left_v = v[place] - (vv[place] * x - uv[place] * y);
        squares[place] += left_u * left_u + left_v * left_v;
    }
}

/// Sums over the probes of a group of sets.
#[derive(Clone, Copy, Debug)]
struct Sums {
    deviations: [Group; 3],
    lengths: Group,
    /// Entries uu, uv, vv of the rotations' Gram matrix.
    gram: [Group; 3],
    /// Square of the longest shift.
    longest: Group,
}

impl Sums {
    /// Sums over the readings. The first readings are stored in `cache`.
    #[inline(always)]
    fn of<const IS_SHARED: bool>(
        radius: f64,
        readings: &Readings<'_, IS_SHARED>,
        cache: &mut [Probe; CACHED],
    ) -> Self {
        let zero = [0.0; GROUP];
        let mut sums = Self {
            deviations: [zero; 3],
            lengths: zero,
            gram: [zero; 3],
            longest: zero,
        };
        for probe in 0..readings.probes() {
            let all = readings.of(probe);
            if let Some(cache) = cache.get_mut(probe) {
                *cache = all;
            }
            sums.add(radius, &all);
        }
        sums
    }

    #[inline(always)]
    fn add(&mut self, radius: f64, [x, y, u, v]: &Probe) {
        for place in 0..GROUP {
            let (x, y, u, v) = (x[place], y[place], u[place], v[place]);
            // The same as `Moments::add_shifts`, written out, so that it is compiled for the caller's vector instructions.
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
        Moments::of_set(&self.deviations, &self.lengths, place)
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
