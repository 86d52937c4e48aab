//! Models by which a roll is computed, and their errors.

use palpate_geometry::SurfaceError;
use palpate_statistics::Number;
use thiserror::Error;

use crate::{Chart, Motion, RollFault};

/// Tolerances that are tried where one has to be found, largest first.
pub const TOLERANCES: [f64; 14] = [
    1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10, 1e-11, 1e-12, 1e-13, 1e-14,
];

/// A model by which rolls are computed: a rung of the ladder, or the choice among them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Model {
    /// The cheapest rung whose error, relative to the contact's length scale, is within
    /// `tolerance`.
    Auto {
        /// Tolerance, from [`Model::SMALLEST_TOLERANCE`] to [`Model::LARGEST_TOLERANCE`].
        tolerance: f64,
        /// Form of the equations for the integrators, if one is taken.
        chart: Chart,
    },
    /// The closed form alone; an error where there is none.
    ClosedForm,
    /// The meridian rung alone; an error where it does not apply.
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
    /// Smallest tolerance that can be asked for; rounding errors are about as large.
    pub const SMALLEST_TOLERANCE: f64 = 1e-14;
    /// Largest tolerance that can be asked for; a larger one promises nothing.
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

/// The rung that was taken, and why.
#[derive(Clone, Debug, PartialEq)]
pub struct Choice<M = Model> {
    /// `closed form`, `meridian`, `RK4`, `DOP853`, with its setting.
    pub rung: String,
    /// The model that names this rung: never `Auto`.
    pub model: M,
    /// Reason for the choice, in words.
    pub reason: String,
    /// Bound on the error of the contact without noise, relative to its length scale (of a glide, the
    /// tip's radius), on top of the rounding of its coordinates; `None` for RK4 on demand.
    pub error_bound: Option<f64>,
}

/// The noiseless rolls for which a rung is chosen: for each roll, one or more motions in a row.
#[derive(Clone, Copy, Debug)]
pub struct Rolls<'a> {
    /// Motions of each roll, in their order.
    pub rolls: &'a [Vec<Motion>],
}

/// A roll that cannot be set up.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum InvalidRoll {
    /// No first contact there.
    #[error("no first contact: {0}")]
    FirstContact(#[from] SurfaceError),
    /// The first contact is no single point.
    #[error("no rolling contact: {0}")]
    Fault(#[from] RollFault),
    /// A rung was asked for that cannot do this.
    #[error("the {rung} rung cannot do this: {reason}")]
    Unsupported {
        /// Name of the rung.
        rung: &'static str,
        /// Reason for which the rung cannot, in words.
        reason: String,
    },
    /// A tolerance that means nothing.
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

impl Rolls<'_> {
    fn motions(&self) -> impl Iterator<Item = &Motion> {
        self.rolls.iter().flatten()
    }

    /// Whether every motion is made of numbers and lasts.
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
