//! Claim 18: the number of gores and the strain of folding them (2020 paper, section III.A, Fig. 3).

use super::evidence::percent;
use super::finding::Finding;
use super::presses::{number, rows_of};
use crate::Study;

/// The numbers of gores that the claim compares.
const GORES: [f64; 3] = [4.0, 6.0, 8.0];

/// Claim 18.
pub(super) fn more_distort_less(study: &Study) -> Result<Finding, String> {
    let greatest = strains(study, "greatest_fold_strain")?;
    let rms = strains(study, "rms_fold_strain")?;
    let falls = |[four, six, eight]: [f64; 3]| six < four && eight < four && eight < six;
    let told = |strains: [f64; 3]| strains.map(percent).join(", ");
    Ok(Finding {
        holds: falls(greatest) && falls(rms),
        measured: format!(
            "Folding {} gores strains them by at most {}, by {} in the rms.",
            GORES.map(|count| count.to_string()).join(", "),
            told(greatest),
            told(rms)
        ),
        why: "Holds if both strains are less for 6 and 8 gores than for 4, and less for 8 than for 6.".to_owned(),
    })
}

/// The strain `quantity` for each of [`GORES`].
fn strains(study: &Study, quantity: &str) -> Result<[f64; 3], String> {
    let rows = rows_of(study, quantity);
    let strain = |gores: f64| {
        let of_gores = |row: &&usize| {
            number(study, **row, "scene.probe.layout", "gores").is_some_and(|n| n == gores)
        };
        match rows.iter().filter(of_gores).collect::<Vec<_>>()[..] {
            [row] => study
                .cells()
                .statistic(*row, "mean")
                .ok_or_else(|| format!("{quantity} of {gores} gores has no mean")),
            [] => Err(format!("the table has no {quantity} of {gores} gores")),
            _ => Err(format!(
                "the table has several rows of {quantity} of {gores} gores"
            )),
        }
    };
    let [four, six, eight] = GORES.map(strain);
    Ok([four?, six?, eight?])
}
