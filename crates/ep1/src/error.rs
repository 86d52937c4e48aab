//! Errors of readings that do not determine the curvature.

use palpate_statistics::Number;
use strum::{IntoStaticStr, VariantNames};
use thiserror::Error;

/// Reasons why a set of probes does not determine a curvature.
#[derive(Clone, Copy, Debug, Error, IntoStaticStr, PartialEq, VariantNames)]
#[strum(serialize_all = "kebab-case")]
pub enum Ep1Error {
    /// Fewer than two probes: a curvature form has three components, a probe measures two.
    #[error("{probes} probe(s); at least 2 in different directions are needed")]
    TooFewProbes {
        /// Number of probes.
        probes: usize,
    },
    /// The rotations do not span the tangent plane.
    #[strum(serialize = "unresolvable-set")]
    #[error(
        "the {probes} probes do not span the tangent plane: across their main direction they turn \
         {} times as far as along it; add a probe across it",
        Number::rounded(*spread)
    )]
    Unresolvable {
        /// Number of probes.
        probes: usize,
        /// Root-mean-square rotation across the main axis over that along it.
        spread: f64,
    },
    /// In some direction, measurement errors are more than half of the mean squared rotation.
    #[error(
        "errors of the measured rotations are {} of the squared rotations in some direction, more than 0.5: roll further, \
         or measure the rotations more exactly",
        Number::rounded(*share)
    )]
    NoisyRotations {
        /// Share of measurement errors in the mean squared rotation.
        share: f64,
    },
    /// The contact did not move in some direction: the object is too sharp to resolve.
    #[error("{}", unresolved(*direction_rad, *radius_below))]
    Unresolved {
        /// Direction, from u towards v, rad.
        direction_rad: f64,
        /// Upper bound on the radius of curvature in that direction, length; `None` without a
        /// stated resolution, or where even a flat object would not have moved the contact.
        radius_below: Option<f64>,
    },
    /// The contact moved against the roll in some direction, which no rolling contact does.
    #[error(
        "at {:.1} degrees from u the contact moved {} per radian, against the roll: not a rolling \
         contact",
        direction_rad.to_degrees(),
        Number::rounded(*travel_per_radian)
    )]
    NotRolling {
        /// Direction, from u towards v, rad.
        direction_rad: f64,
        /// Travel of the contact per radian, length; negative.
        travel_per_radian: f64,
    },
    /// A reading, or what follows from it, is not a finite number.
    #[error("probe {probe} (counting from 0): the reading is not finite")]
    NotFinite {
        /// Number of the probe, counted from 0.
        probe: usize,
    },
    /// The numbers leave the range of doubles.
    #[error("the readings are too large or too small to be worked with")]
    OutOfRange,
}

impl Ep1Error {
    /// The stable name of this kind of error.
    pub fn name(&self) -> &'static str {
        self.into()
    }
}

fn unresolved(direction_rad: f64, radius_below: Option<f64>) -> String {
    let direction = direction_rad.to_degrees();
    let bound = match radius_below {
        Some(radius) => format!("radius below {}", Number(radius)),
        None => "the radius is too small to say".to_owned(),
    };
    format!("at {direction:.1} degrees from u the contact did not move: {bound}")
}
