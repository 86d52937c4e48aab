//! Trials of all kinds of scenes.

use palpate_study::Quantity;
use palpate_study::config::LengthUnit;

use crate::ladder::Ladder;
use crate::need::Need;
use crate::trace::{Trace, TraceError};
use palpate_study::FieldError;
use palpate_study::MapTable;

/// One trial's estimate of a quantity, and its truth, in the quantity's unit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Outcome {
    /// The estimate, or the value of a quantity that is measured directly.
    pub estimate: f64,
    /// The truth.
    pub truth: f64,
    /// The standard deviation that the estimator states; `None` if it states none.
    pub std: Option<f64>,
    /// Whether the stated 50, 80 and 95 % intervals contain the truth; `None` if they are the estimate ± 0.67, 1.28
    /// and 1.96 std.
    pub interval_holds: Option<[bool; 3]>,
}

impl Outcome {
    /// An estimate that comes without a standard deviation.
    pub(crate) const fn plain(estimate: f64, truth: f64) -> Self {
        Self {
            estimate,
            truth,
            std: None,
            interval_holds: None,
        }
    }

    /// An exact value: it is not estimated and has no error.
    pub(crate) const fn exact(value: f64) -> Self {
        Self::plain(value, value)
    }
}

/// Trials of a scene: from true values to readings to estimates.
///
/// ```
/// use palpate_scene::Scenes;
/// use palpate_study::config::parse;
///
/// let text = r#"
///     name = "roll-on-a-ball"
///     scene.kind = "roll"
///     scene.probe = { kind = "sphere", radius = 1.0 }
///     scene.object = { kind = "sphere", radius = 4.0 }
///     scene.motion = { rate_rad_per_s = 0.1, duration_s = 1.0 }
/// "#;
/// let scene = parse("study.toml", text)?.estimable_scene(0)?;
/// // Nothing is random: one trial tells all.
/// assert_eq!(scene.trials(1000), 1);
/// let last = scene.quantities().len() - 1;
/// assert_eq!(scene.quantities()[last].name, "arc_length");
/// assert!((scene.truth(last).ok_or("the same everywhere")? - 0.08).abs() < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub trait Trials {
    /// Quantities that a trial reports, in the order of the indices of [`Trials::trial`].
    fn quantities(&self) -> &'static [Quantity];

    /// Whether trials differ.
    fn is_random(&self) -> bool;

    /// How many trials make sense: `wanted`, or one if nothing is random.
    fn trials(&self, wanted: u64) -> u64 {
        if self.is_random() { wanted } else { 1 }
    }

    /// Checks that readings without noise determine the quantities.
    ///
    /// # Errors
    /// [`FieldError`] at the field that prevents it: fewer than two probes, or all parallel; too few contacts, or all
    /// on a line; too few markers.
    fn estimable(&self) -> Result<(), FieldError> {
        Ok(())
    }

    /// Runs trial number `trial` and reports outcomes, each with the index of its quantity: one of each quantity, or
    /// one at each point of a patch.
    ///
    /// # Errors
    /// The stable name of the failure; outcomes of a failed trial do not count.
    fn trial(
        &self,
        trial: u64,
        observe: &mut dyn FnMut(usize, Outcome),
    ) -> Result<(), &'static str>;

    /// The true value of the quantity with this index, if it is the same everywhere.
    fn truth(&self, quantity: usize) -> Option<f64>;

    /// Name of the true shape class at more than half of the points of a patch; `None` if there is no such class, and
    /// for other scenes.
    fn true_class(&self) -> Option<&'static str> {
        None
    }

    /// The Cramér–Rao bound on the standard deviation of an estimate of the quantity with this index. It is available
    /// for presses with noise.
    fn std_bound(&self, _quantity: usize) -> Option<f64> {
        None
    }

    /// The models that the scene needs with the reasons, and warnings.
    fn needs(&self) -> Vec<Need>;

    /// Measures the errors of the models that can compute the true values; `None` if there is no choice.
    ///
    /// # Errors
    /// [`FieldError`] if the model cannot simulate the scene.
    fn ladder(&self) -> Result<Option<Ladder>, FieldError> {
        Ok(None)
    }

    /// Records one pass: in trial number `trial`, or without noise if it is `None`.
    ///
    /// # Errors
    /// [`TraceError`] if there is no pass, or if it ends early.
    fn trace(&self, _trial: Option<u64>, _unit: LengthUnit) -> Result<Trace, TraceError> {
        Err(TraceError::Untouched)
    }

    /// Empty table for the maps of scenes of this kind.
    ///
    /// # Errors
    /// Reason why there is no map, in words.
    fn map_table(&self, unit: LengthUnit) -> Result<MapTable, &'static str>;

    /// Adds the map of trial number `trial` to a table made with [`Trials::map_table`], in rows that begin with the number
    /// of their cell.
    ///
    /// # Errors
    /// The stable name of the failure; the map then lacks the items that [`MapTable::lacks`] names.
    fn map(&self, _cell: usize, _trial: u64, _table: &mut MapTable) -> Result<(), &'static str> {
        Ok(())
    }
}
