//! Sums of products of rotations and shifts over the probes. The least-squares fit computes its estimates from these
//! sums. A batch stores the sums of many sets of readings whose probes make the same rotations.

use nalgebra::Vector2;

use crate::ProbeReading;

/// Largest number of sets of readings in a batch. With this number, all data of a batch fit into the L1 cache of the
/// processor.
pub const BATCH_SIZE: usize = 128;

/// Sums of products of rotations and shifts over the probes of one set of readings.
/// [`LeastSquares`](crate::LeastSquares) computes the estimate from these sums.
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
    /// Sums of `g₁ d₁`, `g₂ d₂` and `g₂ d₁ + g₁ d₂` over the probes. The drive `g = (−Δθ_y, Δθ_x)` of a probe is its
    /// rotation vector, turned by 90° into the direction of rolling. `d = Δp − R₁ g` is the deviation of its shift `Δp`
    /// from the shift on a plane.
    pub(crate) deviations: [f64; 3],
    /// Sum of the lengths of the contact's shifts over all rolls (length).
    pub(crate) lengths: f64,
}

/// The rotation of one probe, and the shift that it would cause on a plane. Both are computed once and used for many
/// sets of readings.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ProbeRotation {
    /// Drive `g = (−Δθ_y, Δθ_x)` (rad) of the probe: its rotation vector, turned by 90° into the direction of rolling.
    drive: [f64; 2],
    /// Shift `R₁ g` (length) of the contact if the object were a plane. R₁ is the radius of the probe and g its drive.
    flat: [f64; 2],
}

impl ProbeRotation {
    /// A probe of `radius` that has rotated by `rotation`, that is, by `(Δθ_x, Δθ_y)` in rad.
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
    /// The sums of the set of readings with index `set`. `deviations` and `lengths` are arrays over `N` sets; each
    /// array contains one of the sums for all sets.
    #[inline(always)]
    pub(crate) fn of_set<const N: usize>(
        deviations: &[[f64; N]; 3],
        lengths: &[f64; N],
        set: usize,
    ) -> Self {
        let [along_u, along_v, mixed] = deviations;
        Self {
            deviations: [along_u[set], along_v[set], mixed[set]],
            lengths: lengths[set],
        }
    }

    /// Adds the reading of a probe of `radius` to the sums.
    #[inline]
    pub(crate) fn add(&mut self, radius: f64, reading: &ProbeReading) {
        let rotation = ProbeRotation::new(radius, &reading.rotation);
        self.add_shifts(&rotation, [reading.shift.x, reading.shift.y]);
    }

    /// Adds the reading of a probe to the sums. The reading consists of the probe's rotation and of the contact's
    /// shifts along u and v (length).
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

/// [`Moments`] of up to [`BATCH_SIZE`] sets of readings with the same rotations.
#[derive(Clone, Debug)]
pub struct BatchMoments {
    deviations: [[f64; BATCH_SIZE]; 3],
    lengths: [f64; BATCH_SIZE],
}

impl Default for BatchMoments {
    fn default() -> Self {
        Self {
            deviations: [[0.0; BATCH_SIZE]; 3],
            lengths: [0.0; BATCH_SIZE],
        }
    }
}

impl BatchMoments {
    /// The sums of the set of readings with index `place`, which must be below [`BATCH_SIZE`].
    #[inline(always)]
    pub fn at(&self, place: usize) -> Moments {
        Moments::of_set(&self.deviations, &self.lengths, place)
    }

    /// Stores the sums of the set of readings with index `place`, which must be below [`BATCH_SIZE`].
    #[inline(always)]
    pub fn put(&mut self, place: usize, moments: Moments) {
        for (sums, sum) in self.deviations.iter_mut().zip(moments.deviations) {
            sums[place] = sum;
        }
        self.lengths[place] = moments.lengths;
    }
}

/// Estimates from up to [`BATCH_SIZE`] sets of readings.
#[derive(Clone, Debug)]
pub struct BatchEstimates {
    /// Five values for each set of readings. The first four are the curvatures of an [`Estimate`](crate::Estimate):
    /// normal curvature along u, normal curvature along v, Gaussian curvature and mean curvature. The fifth is the mean
    /// length of the contacts' shifts.
    pub values: [[f64; BATCH_SIZE]; 5],
    /// Standard errors of the four curvatures; only valid if `have_stds` is true.
    pub stds: [[f64; BATCH_SIZE]; 4],
    /// Whether the noise of the readings was stated. If it was not, the standard errors are not computed.
    pub have_stds: bool,
    /// For each set of readings, 1 if the readings determine a curvature, otherwise 0.
    is_determined: [u64; BATCH_SIZE],
}

impl Default for BatchEstimates {
    fn default() -> Self {
        Self {
            values: [[0.0; BATCH_SIZE]; 5],
            stds: [[0.0; BATCH_SIZE]; 4],
            have_stds: false,
            is_determined: [0; BATCH_SIZE],
        }
    }
}

impl BatchEstimates {
    #[inline(always)]
    pub(crate) fn put<const HAS_STDS: bool>(
        &mut self,
        place: usize,
        is_determined: bool,
        curvatures: [f64; 4],
        stds: [f64; 4],
        arc_length: f64,
    ) {
        self.is_determined[place] = u64::from(is_determined);
        for (values, value) in self.values.iter_mut().zip(curvatures) {
            values[place] = value;
        }
        self.values[4][place] = arc_length;
        if HAS_STDS {
            for (column, std) in self.stds.iter_mut().zip(stds) {
                column[place] = std;
            }
        }
    }

    /// Index of the first set of readings that does not determine a curvature; `count` if the first `count` sets all
    /// determine one.
    #[inline(always)]
    pub(crate) fn determined(&self, count: usize) -> usize {
        let all = &self.is_determined[..count.min(BATCH_SIZE)];
        // A flag is 1 if its set of readings determines a curvature. Nearly always, all flags are 1, and their sum
        // equals their number. Compute the sum first, because this is faster than a search for the first 0.
        match all.iter().sum::<u64>() as usize {
            sum if sum == all.len() => sum,
            _ => all.iter().take_while(|&&one| one == 1).count(),
        }
    }
}
