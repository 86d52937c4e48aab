//! Models by which a roll is computed, and their errors.

use palpate_geometry::SurfaceError;
use palpate_statistics::Number;
use thiserror::Error;

use crate::{Chart, Motion, RollFault};

/// Tolerances that a search for a sufficient tolerance tries, largest first.
pub const TOLERANCES: [f64; 14] = [
    1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10, 1e-11, 1e-12, 1e-13, 1e-14,
];

/// A model by which rolls are computed: a rung of the ladder, or the choice among them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Model {
    /// The cheapest rung whose error is within `tolerance`, relative to the contact's length scale.
    Auto {
        /// Tolerance, from [`Model::SMALLEST_TOLERANCE`] to [`Model::LARGEST_TOLERANCE`].
        tolerance: f64,
        /// Form of the equations, if the chosen rung is an integrator.
        chart: Chart,
    },
    /// The closed form only. Fails if there is none.
    ClosedForm,
    /// The meridian rung only. Fails if it does not apply.
    Meridian,
    /// RK4 with this many steps per motion.
    Rk4 {
        /// Number of steps per motion, at least 1.
        steps: usize,
        /// Form of the equations.
        chart: Chart,
    },
    /// DOP853 with this tolerance.
    Dop853 {
        /// Tolerance, from [`Model::SMALLEST_TOLERANCE`] to [`Model::LARGEST_TOLERANCE`].
        tolerance: f64,
        /// Form of the equations.
        chart: Chart,
    },
}

impl Model {
    /// Smallest tolerance that can be set. Rounding errors are about as large.
    pub const SMALLEST_TOLERANCE: f64 = 1e-14;
    /// Largest tolerance that can be set. A larger error would not be useful.
    pub const LARGEST_TOLERANCE: f64 = 0.1;

    /// The rung with its setting, in words.
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

/// The chosen rung, and the reason for the choice.
#[derive(Clone, Debug, PartialEq)]
pub struct Choice<M = Model> {
    /// Name of the rung and its setting: `closed form`, `meridian`, `RK4` or `DOP853`.
    pub rung: String,
    /// The chosen model with its setting: never `Auto`.
    pub model: M,
    /// Reason for the choice, in words.
    pub reason: String,
    /// Bound on the error of the contact without noise, in addition to the rounding of its coordinates. It is relative
    /// to the contact's length scale (for a glide, to the tip's radius). `None` for RK4 that was set by the user.
    pub error_bound: Option<f64>,
}

/// The noiseless rolls for which a rung is chosen: for each roll, one or more motions in a row.
#[derive(Clone, Copy, Debug)]
pub struct Rolls<'a> {
    /// Motions of each roll, in their order.
    pub rolls: &'a [Vec<Motion>],
    /// Whether noise will make the actual rolls differ from these.
    pub has_noise: bool,
}

/// Reasons why a roll cannot be set up.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum InvalidRoll {
    /// There is no first contact at this place.
    #[error("no first contact: {0}")]
    FirstContact(#[from] SurfaceError),
    /// The bodies do not touch at a single point.
    #[error("no rolling contact: {0}")]
    Fault(#[from] RollFault),
    /// The set rung cannot compute these rolls.
    #[error("the {rung} rung cannot do this: {reason}")]
    Unsupported {
        /// Name of the rung.
        rung: &'static str,
        /// The reason, in words.
        reason: String,
    },
    /// The tolerance is out of range.
    #[error(
        "tolerance is {tolerance}; it must be from {} to {}",
        Number(Model::SMALLEST_TOLERANCE),
        Number(Model::LARGEST_TOLERANCE),
        tolerance = Number(*tolerance)
    )]
    Tolerance {
        /// Its value.
        tolerance: f64,
    },
}

impl<'a> Rolls<'a> {
    /// Rolls without noise.
    pub const fn exact(rolls: &'a [Vec<Motion>]) -> Self {
        Self {
            rolls,
            has_noise: false,
        }
    }

    pub(crate) fn motions(&self) -> impl Iterator<Item = &Motion> {
        self.rolls.iter().flatten()
    }

    /// Whether the numbers of all motions are finite and their durations at least 0.
    pub(crate) fn all_run(&self) -> bool {
        self.motions()
            .all(|motion| motion.is_finite() && motion.duration_s >= 0.0)
    }

    /// Number of turns of the probe in the longest roll.
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

    pub(crate) fn in_pieces(&self) -> bool {
        self.rolls.iter().any(|roll| roll.len() > 1)
    }
}
