//! Models that compute rolls, and errors that occur when a [`crate::Roller`] is created.

use palpate_geometry::SurfaceError;
use palpate_statistics::BadSetting;
use thiserror::Error;

use crate::{Chart, Motion, RollFault};

/// Tolerances that are tried, from the largest to the smallest, until one of them is accurate enough.
pub const TOLERANCES: [f64; 14] = [
    1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10, 1e-11, 1e-12, 1e-13, 1e-14,
];

/// A model that computes rolls, or the automatic choice of such a model.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Model {
    /// The cheapest model whose error is within `tolerance`. The error of a contact is relative to the contact's length
    /// scale, which is the smallest displacement of the contact per radian of rolling at the start.
    Auto {
        /// Tolerance for the error of a contact, relative to its length scale, from [`Model::SMALLEST_TOLERANCE`] to
        /// 0.1.
        tolerance: f64,
        /// Form of the contact equations that is used if the chosen model is an integrator.
        chart: Chart,
    },
    /// Exact formulas for the contact. [`crate::Roller::new`] returns an error if there are no exact formulas for the
    /// rolls.
    ClosedForm,
    /// The meridian model. [`crate::Roller::new`] returns an error if the model is not valid for the rolls.
    Meridian,
    /// The integrator RK4 with a fixed number of steps per motion.
    Rk4 {
        /// Number of steps per motion, at least 1.
        steps: usize,
        /// Form of the contact equations that are integrated.
        chart: Chart,
    },
    /// The integrator DOP853, which adapts its steps to a tolerance.
    Dop853 {
        /// Tolerance for the error of a contact, relative to its length scale, from [`Model::SMALLEST_TOLERANCE`] to
        /// 0.1.
        tolerance: f64,
        /// Form of the contact equations that are integrated.
        chart: Chart,
    },
}

impl Model {
    /// Smallest allowed tolerance for the error of a contact. Rounding errors are about as large as this tolerance.
    pub const SMALLEST_TOLERANCE: f64 = 1e-14;
    /// Largest allowed tolerance for the error of a contact. A larger error would not be useful.
    const LARGEST_TOLERANCE: f64 = 0.1;

    pub(crate) fn checked(tolerance: f64) -> Result<f64, BadSetting> {
        let is_valid = (Self::SMALLEST_TOLERANCE..=Self::LARGEST_TOLERANCE).contains(&tolerance);
        BadSetting::unless(is_valid, "tolerance", tolerance, "from 1e-14 to 0.1")
    }

    pub(crate) fn name(&self) -> String {
        match self {
            Self::Auto { tolerance, .. } => format!("auto, tolerance {tolerance:e}"),
            Self::ClosedForm => "closed form".to_owned(),
            Self::Meridian => "meridian".to_owned(),
            Self::Rk4 { steps, chart } => {
                let plural = if *steps == 1 { "" } else { "s" };
                format!("RK4, {steps} step{plural}, {}", chart.name())
            }
            Self::Dop853 { tolerance, chart } => {
                format!("DOP853, tolerance {tolerance:e}, {}", chart.name())
            }
        }
    }
}

/// The chosen model, and the reason for the choice.
#[derive(Clone, Debug, PartialEq)]
pub struct Choice<M = Model> {
    /// Displayed name of the model, such as `closed form` or `meridian`. It includes the number of steps or the
    /// tolerance of an integrator.
    pub rung: String,
    /// The chosen model; never `Auto`.
    pub model: M,
    /// Reason for the choice of the model, as text.
    pub reason: String,
    /// Upper bound on the error of the contact without noise, in addition to the rounding errors of the contact's
    /// coordinates. The bound is relative to the contact's length scale; for a glide, to the tip's radius. `None` if
    /// the user has set RK4.
    pub error_bound: Option<f64>,
}

/// The rolls without noise, for which a model is chosen. Each roll consists of one or more consecutive motions.
#[derive(Clone, Copy, Debug)]
pub struct Rolls<'a> {
    /// For each roll, its motions in the order of time.
    pub rolls: &'a [Vec<Motion>],
    /// Whether the actual rolls differ from these rolls because of noise.
    pub has_noise: bool,
}

/// Reasons why a roll cannot be set up.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum InvalidRoll {
    /// The probe cannot touch the object at the place of the first contact.
    #[error("no first contact: {0}")]
    FirstContact(#[from] SurfaceError),
    /// The contact at the start of the rolls is not a single point.
    #[error("no rolling contact: {0}")]
    Fault(#[from] RollFault),
    /// The model that the user has set cannot compute the rolls.
    #[error("the model `{rung}` cannot compute this: {reason}")]
    Unsupported {
        /// Name of the model that the user has set.
        rung: &'static str,
        /// Reason why the model cannot compute the rolls, as text.
        reason: String,
    },
    /// The stated tolerance is out of its range.
    #[error("{0}")]
    Tolerance(BadSetting),
}

impl<'a> Rolls<'a> {
    /// Rolls that have no noise.
    pub const fn exact(rolls: &'a [Vec<Motion>]) -> Self {
        Self {
            rolls,
            has_noise: false,
        }
    }

    pub(crate) fn motions(&self) -> impl Iterator<Item = &Motion> {
        self.rolls.iter().flatten()
    }

    pub(crate) fn all_run(&self) -> bool {
        self.motions()
            .all(|motion| motion.is_finite() && motion.duration_s >= 0.0)
    }

    pub(crate) fn turns(&self) -> f64 {
        let turns = |motion: &Motion| {
            let angle = motion.in_unit_time().angular_velocity.norm();
            angle / std::f64::consts::TAU
        };
        let rolls = self.rolls.iter();
        rolls
            .map(|roll| roll.iter().map(turns).sum())
            .fold(0.0, f64::max)
    }

    pub(crate) fn spin(&self) -> bool {
        self.motions().any(Motion::spins)
    }

    pub(crate) fn slide(&self) -> bool {
        self.motions().any(Motion::slides)
    }
}
