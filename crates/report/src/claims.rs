//! Published claims, each held against the tables of a study that tests it.

mod angular_velocity;
mod edge;
mod effective_radius;
mod evidence;
mod finding;
mod fisheye;
mod gaussian_profile;
mod gores;
mod hue;
mod pads;
mod patches;
mod presses;
mod regimes;
mod roll_length;
mod second_fit;
mod shape_classes;
mod slopes;
mod straight_line;
mod turned_cylinder;
mod wrist;

use crate::Study;
use finding::Finding;
use palpate_study::Table;
use std::fmt;

/// Verdict on a claim by the tables.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Verdict {
    /// The tables show what the paper says, within the stated thresholds.
    Holds,
    /// The tables show something else.
    Differs,
    /// The tables lack what the claim is about.
    NotTestable,
}

impl fmt::Display for Verdict {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Self::Holds => "holds",
            Self::Differs => "differs",
            Self::NotTestable => "not testable",
        })
    }
}

/// Outcome of holding one claim against the tables of one study.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Score {
    /// Number of the claim.
    pub claim: u32,
    /// Name of the study.
    pub study: String,
    /// Claim of the paper, in short; empty if no claim has this number.
    pub paper_says: String,
    /// Finding in the tables, with units; empty if the claim is not testable.
    pub measured: String,
    /// The verdict.
    pub verdict: Verdict,
    /// Thresholds behind the verdict, and further remarks; for a claim that is not testable, the reason.
    pub why: String,
}

/// Whether a published claim has this number.
pub fn is_claim(number: u32) -> bool {
    CLAIMS.iter().any(|claim| claim.number == number)
}

/// A claim and the function that reads the tables for it: a finding, or what they lack.
struct Claim {
    number: u32,
    paper_says: &'static str,
    judge: fn(&Study) -> Result<Finding, String>,
}

const CLAIMS: [Claim; 22] = [
    Claim {
        number: 1,
        paper_says: "The error for a given noise in angular velocity grows as the relative curvature falls, dramatically from R₂ of about 50 R₁ up.",
        judge: angular_velocity::grows_as_rcr_falls,
    },
    Claim {
        number: 2,
        paper_says: "On a sphere the length of the roll does not matter for noise in angular velocity.",
        judge: angular_velocity::length_does_not_matter,
    },
    Claim {
        number: 3,
        paper_says: "On a paraboloid the error grows rapidly with the length of the roll; c = 5 cannot be estimated at a reasonable length even without noise.",
        judge: roll_length::grows_rapidly,
    },
    Claim {
        number: 4,
        paper_says: "Paraboloids of c from 1 to 0.01 are estimated within about 15 %.",
        judge: roll_length::within_15_percent,
    },
    Claim {
        number: 5,
        paper_says: "The error grows with the size of the pads, more so at low relative curvature.",
        judge: pads::error_grows_with_pitch,
    },
    Claim {
        number: 6,
        paper_says: "In many cases the estimate is zero curvature for R₂ above 5 cm and pads coarser than 0.1 mm (R₁ = 1 cm).",
        judge: pads::zeros,
    },
    Claim {
        number: 7,
        paper_says: "A longer roll reduces the error from pads.",
        judge: pads::longer_rolls_help,
    },
    Claim {
        number: 8,
        paper_says: "With 0.5 mm pads a roll of 0.5 rad gives a reasonable estimate for spheres from 5 to 0.2 cm (R₁ = 1 cm).",
        judge: pads::half_millimetre_pads,
    },
    Claim {
        number: 9,
        paper_says: "The second iteration of fitting a smoothing spline increases the accuracy dramatically.",
        judge: second_fit::improves_dramatically,
    },
    Claim {
        number: 10,
        paper_says: "The classes of shape are well estimated for noise of 5 % of the inter-finger distance or less.",
        judge: shape_classes::well_estimated_up_to_5_percent,
    },
    Claim {
        number: 11,
        paper_says: "For noise of 10 % only the sphere is classified accurately; the mean curvature is still good on the other surfaces, the Gaussian curvature worse.",
        judge: shape_classes::only_the_sphere_at_10_percent,
    },
    Claim {
        number: 12,
        paper_says: "With noise of 5 % the segmentation of the saddle by shape corresponds nearly perfectly with the actual surface.",
        judge: shape_classes::saddle_segmentation_nearly_perfect,
    },
    Claim {
        number: 13,
        paper_says: "Noisy data show tensor-product effects on cylinders: a cylinder turned against the fingers is fitted worse.",
        judge: turned_cylinder::is_fitted_worse,
    },
    Claim {
        number: 14,
        paper_says: "A marker's hue is linear in its normal displacement, its centroid in the tangential one.",
        judge: hue::and_centroid_are_linear,
    },
    Claim {
        number: 15,
        paper_says: "A Gaussian fits the displacement that Hertz's theory gives under a layer of skin with R² of 0.96.",
        judge: gaussian_profile::fits_the_filtered_profile,
    },
    Claim {
        number: 16,
        paper_says: "The estimated effective radius converges to the true 26.7, 20 and 16 mm by an indentation of 1.4 mm; below 1 mm noise dominates.",
        judge: effective_radius::converges,
    },
    Claim {
        number: 17,
        paper_says: "Contact is at a point where the relative curvature is positive, ill-defined where it is zero, at the edge where it is negative; so a small sensor is the most versatile.",
        judge: regimes::go_by_relative_curvature,
    },
    Claim {
        number: 18,
        paper_says: "A skin cut into 6 or 8 gores is distorted less than one of 4.",
        judge: gores::more_distort_less,
    },
    Claim {
        number: 19,
        paper_says: "The fisheye lens gives all markers a similar area in the image.",
        judge: fisheye::keeps_the_area,
    },
    Claim {
        number: 20,
        paper_says: "An edge can be sensed, but not its radius.",
        judge: edge::is_a_bound,
    },
    Claim {
        number: 21,
        paper_says: "A wrist sensor's contact error of 0.54 mm (2.7 % of a probe of R₁ = 10 mm across) acts like pads of that size.",
        judge: wrist::acts_like_pads,
    },
    Claim {
        number: 22,
        paper_says: "A marker's hue changes by 0.0258 turns per millimetre of indentation, its centroid by 7.0 px per millimetre of shift, in frames of 265 px.",
        judge: slopes::are_the_published,
    },
];

/// Scores the claims that each study names, in order of the claims' numbers, then of the studies.
///
/// ```
/// use palpate_report::{Study, Verdict, score};
///
/// # let root = tempfile::tempdir()?;
/// # let dir = root.path().join("ball");
/// # std::fs::create_dir(&dir)?;
/// # let config = "name = \"ball\"\ntitle = \"How round is the ball?\"\nclaims = [99]\n";
/// # std::fs::write(dir.join("run.toml"), config)?;
/// # std::fs::write(dir.join("failures.csv"), "cell,kind,count,first_trial\n")?;
/// # let statistics = "truth,trials,failures,mean,std,bias,rms_error,rms_error_std,mean_abs_error,relative_rms_error,\
/// #     relative_mean_abs_error,q05,q50,q95,mean_reported_std,coverage50,coverage80,coverage95";
/// # let row = format!("0,curvature,1/mm,0.2,9,0,0.25{}", ",".repeat(14));
/// # std::fs::write(dir.join("cells.csv"), format!("cell,quantity,unit,{statistics}\n{row}\n"))?;
/// // A study that names a claim of a number that no claim has.
/// let study = Study::load(&dir)?;
/// assert_eq!(study.claims(), [99]);
/// let scores = score(&[study]);
/// assert_eq!((scores[0].claim, scores[0].verdict), (99, Verdict::NotTestable));
/// assert!(scores[0].measured.is_empty() && !scores[0].why.is_empty());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn score(studies: &[Study]) -> Vec<Score> {
    let mut scores: Vec<Score> = studies
        .iter()
        .flat_map(|study| {
            study
                .claims()
                .iter()
                .map(move |number| judge(study, *number))
        })
        .collect();
    scores.sort_by_key(|score| score.claim);
    scores
}

fn judge(study: &Study, number: u32) -> Score {
    let claim = CLAIMS.iter().find(|claim| claim.number == number);
    let outcome = match claim {
        Some(claim) => (claim.judge)(study),
        None => Err("no function scores a claim of this number".to_owned()),
    };
    let (verdict, measured, why) = match outcome {
        Ok(found) if found.holds => (Verdict::Holds, found.measured, found.why),
        Ok(found) => (Verdict::Differs, found.measured, found.why),
        Err(reason) => (Verdict::NotTestable, String::new(), reason),
    };
    let paper_says = claim.map_or("", |claim| claim.paper_says).to_owned();
    Score {
        claim: number,
        study: study.name().to_owned(),
        paper_says,
        measured,
        verdict,
        why,
    }
}

/// Text of `claims.csv`: `claim,verdict,paper_says,measured,why`, one row per score (only the header if there is none).
///
/// ```
/// use palpate_report::claims_csv;
///
/// assert_eq!(claims_csv(&[]), "claim,verdict,paper_says,measured,why\n");
/// ```
pub fn claims_csv(scores: &[Score]) -> String {
    let header = ["claim", "verdict", "paper_says", "measured", "why"];
    let mut table = Table::new(header.map(str::to_owned));
    let row = |score: &Score| {
        let Score {
            paper_says,
            measured,
            why,
            ..
        } = score.clone();
        let (claim, verdict) = (score.claim.to_string(), score.verdict.to_string());
        vec![claim, verdict, paper_says, measured, why]
    };
    table.rows = scores.iter().map(row).collect();
    table.to_csv()
}
