//! Curvatures from many recorded rolls at once.

use palpate_ep1::{Ep1Error, SetRow, Sets};
use palpate_geometry::CurvatureForm;
use palpate_statistics::Number;
use pulp::{Simd, WithSimd};

use super::error::RecordedError;
use super::roll_recording::{RollOptions, RollRecording};
use super::source::same_length;
use pulp::Arch;

/// Sets of readings with the same number of probes each, one set after the other.
///
/// ```
/// use palpate_recorded::{RollOptions, RollSets, SetRow};
///
/// // Two probes of radius 10 turn by 0.3; their contacts move over 2 on a ball of radius 20, over 1.5 on one of 10.
/// let rotations = [[0.0, -0.3], [0.3, 0.0]];
/// let shifts = [[2.0, 0.0], [0.0, 2.0], [1.5, 0.0], [0.0, 1.5]];
/// let sets = RollSets::new(2, 2, &rotations, &shifts)?;
/// let mut rows: [SetRow; 2] = Default::default();
/// sets.estimate(&RollOptions::new(10.0), 0, &mut rows)?;
/// assert!((rows[0][4] - 0.05).abs() < 1e-15 && (rows[1][4] - 0.1).abs() < 1e-15);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub struct RollSets<'a> {
    sets: usize,
    probes: usize,
    rotations: &'a [[f64; 2]],
    shifts: &'a [[f64; 2]],
}

/// Estimation of sets with the widest vector instructions of the processor.
struct Together<'s, 'r> {
    sets: Sets<'s>,
    first: usize,
    rows: &'r mut [SetRow],
}

impl WithSimd for Together<'_, '_> {
    type Output = Result<(), (usize, Ep1Error)>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> Self::Output {
        self.sets.estimate(self.first, self.rows)
    }
}

impl<'a> RollSets<'a> {
    /// `sets` sets of `probes` probes each; if `rotations` or `shifts` has one set only, all sets share it.
    ///
    /// # Errors
    /// [`RecordedError::Array`] for arrays of another length.
    pub fn new(
        sets: usize,
        probes: usize,
        rotations: &'a [[f64; 2]],
        shifts: &'a [[f64; 2]],
    ) -> Result<Self, RecordedError> {
        let all = sets.saturating_mul(probes);
        for (array, numbers) in [("rotations", rotations), ("shifts", shifts)] {
            if numbers.len() != probes {
                same_length((array, numbers.len()), ("the sets together", all))?;
            }
        }
        Ok(Self {
            sets,
            probes,
            rotations,
            shifts,
        })
    }

    /// Number of sets.
    pub fn len(&self) -> usize {
        self.sets
    }

    /// Whether there is no set.
    pub fn is_empty(&self) -> bool {
        self.sets == 0
    }

    /// Estimates of the sets from `first` on, a row each, with the bits of [`estimate_roll`](super::estimate_roll). A
    /// set that does not determine the curvature gives a row of NaN; an unknown standard deviation is NaN.
    ///
    /// # Errors
    /// [`RecordedError::Array`] for a number that is not finite.
    ///
    /// # Panics
    /// If there are fewer than `first + rows.len()` sets.
    pub fn estimate(
        &self,
        options: &RollOptions,
        first: usize,
        rows: &mut [SetRow],
    ) -> Result<(), RecordedError> {
        let sets = Sets {
            radius: options.probe_radius,
            noise: options.noise,
            probes: self.probes,
            rotations: self.rotations,
            shifts: self.shifts,
        };
        let estimated = Arch::new().dispatch(Together { sets, first, rows });
        estimated.map_err(|(set, error)| match error {
            Ep1Error::NotFinite { probe } => self.not_finite(set, probe),
            error => RecordedError::Readings {
                file: format!("set {set}"),
                message: error.to_string(),
            },
        })
    }

    /// Smallest and largest normal curvature of a row, 1/length, and the direction of the largest, from +u towards +v,
    /// degrees.
    pub fn principal(row: &SetRow) -> [f64; 3] {
        let [k_uu, k_vv, k_uv, ..] = *row;
        let principal = CurvatureForm { k_uu, k_uv, k_vv }.principal();
        let angle_deg = principal.angle_of_max_rad.to_degrees() + 0.0;
        [principal.k_min, principal.k_max, angle_deg]
    }

    /// Readings of one set.
    ///
    /// # Errors
    /// [`RecordedError::Array`] for a number that is not finite.
    ///
    /// # Panics
    /// If there is no such set.
    pub fn readings(&self, set: usize) -> Result<RollRecording, RecordedError> {
        let [rotations, shifts] = [self.rotations, self.shifts].map(|all| self.of(all, set));
        RollRecording::new(rotations, shifts, None)
    }

    fn of(&self, numbers: &'a [[f64; 2]], set: usize) -> &'a [[f64; 2]] {
        match numbers.len() == self.probes {
            true => numbers,
            false => &numbers[set * self.probes..][..self.probes],
        }
    }

    /// Error of the first number of a probe that is not finite.
    fn not_finite(&self, set: usize, probe: usize) -> RecordedError {
        let bad = |array, numbers| {
            let pair = self.of(numbers, set)[probe];
            let column = pair.iter().position(|number| !number.is_finite())?;
            let value = pair[column];
            let is_shared = numbers.len() == self.probes && self.sets > 1;
            let place = [set, probe, column];
            Some(RecordedError::Array {
                array,
                index: place[usize::from(is_shared)..].to_vec(),
                value: Some(value),
                message: format!("must be finite, is {}", Number(value)),
            })
        };
        let bad = bad("rotations", self.rotations).or_else(|| bad("shifts", self.shifts));
        bad.unwrap_or(RecordedError::Readings {
            file: format!("set {set}"),
            message: Ep1Error::NotFinite { probe }.to_string(),
        })
    }
}
