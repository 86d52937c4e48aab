//! Glides, and what is wrong with them.

use palpate_sensing::Distribution;

use super::super::case::Case;
use super::flaw::Flaw;

/// Noise of positions, in distances between fingers, and of normals, degrees.
const LEVELS: [(f64, Option<f64>); 4] = [
    (0.005, Some(0.5)),
    (0.02, Some(1.0)),
    (0.1, Some(5.0)),
    (0.02, None),
];

/// Glides of one kind.
#[derive(Clone, Copy, Debug)]
pub(super) struct Family {
    pub(super) case: Case,
    pub(super) flaw: Flaw,
}

impl Family {
    /// All families.
    pub(super) fn all() -> Vec<Self> {
        let mut all = Vec::new();
        for flaw in Flaw::ALL {
            for (is_told, fingers) in [(true, 3), (true, 5), (false, 5)] {
                for (position_std, normal_std_deg) in LEVELS {
                    let case = Case {
                        fingers,
                        position_std,
                        distribution: Distribution::Gaussian,
                        normal_std_deg,
                        is_told,
                    };
                    if flaw.can_be_in(&case) {
                        all.push(Self { case, flaw });
                    }
                }
            }
        }
        all
    }

    /// The family in words.
    pub(super) fn name(&self) -> String {
        let flaw = self.flaw.name().map(|name| format!(", {name}"));
        format!("{}{}", self.case.name(), flaw.unwrap_or_default())
    }
}
