//! Sets of readings side by side.

use crate::Moments;

/// Most sets of readings side by side: few enough for all that is made of them to stay in the nearest cache.
pub const MOST: usize = 128;

/// [`Moments`] of up to [`MOST`] sets of readings with the same rotations.
#[derive(Clone, Debug)]
pub struct ManyMoments {
    deviations: [[f64; MOST]; 3],
    lengths: [f64; MOST],
}

impl Default for ManyMoments {
    fn default() -> Self {
        Self {
            deviations: [[0.0; MOST]; 3],
            lengths: [0.0; MOST],
        }
    }
}

impl ManyMoments {
    /// The moments of the set of readings at a place below [`MOST`].
    #[inline(always)]
    pub fn at(&self, place: usize) -> Moments {
        Moments {
            deviations: [
                self.deviations[0][place],
                self.deviations[1][place],
                self.deviations[2][place],
            ],
            lengths: self.lengths[place],
        }
    }

    /// Sets the moments of the set of readings at a place below [`MOST`].
    #[inline(always)]
    pub fn put(&mut self, place: usize, moments: Moments) {
        let Moments {
            deviations: [along_u, along_v, mixed],
            lengths,
        } = moments;
        self.deviations[0][place] = along_u;
        self.deviations[1][place] = along_v;
        self.deviations[2][place] = mixed;
        self.lengths[place] = lengths;
    }
}

/// Estimates from up to [`MOST`] sets of readings.
#[derive(Clone, Debug)]
pub struct ManyEstimates {
    /// Normal curvature along u and along v, Gaussian curvature, mean curvature, as in [`Estimate`](crate::Estimate), and
    /// the mean length of the shifts.
    pub values: [[f64; MOST]; 5],
    /// Standard deviations of the curvatures, if `have_stds`.
    pub stds: [[f64; MOST]; 4],
    /// Whether noise was stated.
    pub have_stds: bool,
    /// 1 where the fit told a curvature, else 0.
    told: [u64; MOST],
}

impl Default for ManyEstimates {
    fn default() -> Self {
        Self {
            values: [[0.0; MOST]; 5],
            stds: [[0.0; MOST]; 4],
            have_stds: false,
            told: [0; MOST],
        }
    }
}

impl ManyEstimates {
    #[inline(always)]
    pub(crate) fn put<const HAS_STDS: bool>(
        &mut self,
        place: usize,
        told: bool,
        curvatures: [f64; 4],
        stds: [f64; 4],
        arc_length: f64,
    ) {
        self.told[place] = u64::from(told);
        self.values[0][place] = curvatures[0];
        self.values[1][place] = curvatures[1];
        self.values[2][place] = curvatures[2];
        self.values[3][place] = curvatures[3];
        self.values[4][place] = arc_length;
        if HAS_STDS {
            self.stds[0][place] = stds[0];
            self.stds[1][place] = stds[1];
            self.stds[2][place] = stds[2];
            self.stds[3][place] = stds[3];
        }
    }

    /// Number of the first `count` before the first that the fit did not tell.
    #[inline(always)]
    pub(crate) fn told(&self, count: usize) -> usize {
        let told = &self.told[..count.min(MOST)];
        // Nearly always all of them.
        match told.iter().sum::<u64>() as usize {
            all if all == told.len() => all,
            _ => told.iter().take_while(|&&told| told == 1).count(),
        }
    }
}
