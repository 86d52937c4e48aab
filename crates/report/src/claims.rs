//! Scores the claims of the papers with the tables of studies, and makes the scorecard.

mod bounds;
mod check;
mod claim;
mod pads;
mod patches;
mod presses;
mod rolls;
mod row;
mod sensors;

use crate::Study;
use claim::{Claim, Finding};
use palpate_study::{Column, Table};
use std::fmt;

/// Whether a claim of a paper agrees with a study.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Verdict {
    /// The tables agree with the paper's statement: all checks of the claim meet their bounds.
    Holds,
    /// The tables contradict the paper's statement.
    Differs,
    /// The tables do not contain the rows or numbers that the claim's checks need.
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

/// Result of testing one claim with the tables of one study.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Score {
    /// Number of the claim in the list of both papers' claims.
    pub claim: u32,
    /// Name of the study whose tables were used to test the claim.
    pub study: String,
    /// The claim in at most six words. The fields `title`, `published` and `paper_says` are empty if no claim has this
    /// number.
    pub title: String,
    /// The value that the paper states, as a short text.
    pub published: String,
    /// The paper's statement, in one sentence.
    pub paper_says: String,
    /// The measured value that the scorecard shows beside the paper's value `published`. Empty if the claim is not
    /// testable.
    pub headline: String,
    /// Sentences with all numbers that the claim's checks compute from the tables, and their units. Empty if the claim
    /// is not testable.
    pub measured: String,
    /// Whether the claim holds, differs or cannot be tested.
    pub verdict: Verdict,
    /// Text that states the bounds on which the verdict depends, with further remarks. If the claim is not testable,
    /// the text states the reason.
    pub why: String,
}

/// Whether there is a claim with this number.
pub fn is_claim(number: u32) -> bool {
    all().iter().any(|claim| claim.number == number)
}

fn all() -> Vec<Claim> {
    let claims = rolls::claims().into_iter().chain(pads::claims());
    let claims = claims.chain(patches::claims()).chain(presses::claims());
    claims.chain(sensors::claims()).collect()
}

/// Tests the claims that each study lists. The scores are sorted by claim number and then by study.
///
/// ```
/// use palpate_report::{Files, Study, Verdict, score};
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
/// // No claim has the number that this study names.
/// let study = Study::read(Files::in_folder(&dir))?;
/// let scores = score(&[study]);
/// assert_eq!((scores[0].claim, scores[0].verdict), (99, Verdict::NotTestable));
/// assert!(scores[0].measured.is_empty() && !scores[0].why.is_empty());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn score(studies: &[Study]) -> Vec<Score> {
    let claims = all();
    let of_study = |study| {
        let numbers = Study::claims(study).iter();
        numbers
            .map(|number| of_claim(&claims, study, *number))
            .collect::<Vec<_>>()
    };
    let mut scores: Vec<Score> = studies.iter().flat_map(of_study).collect();
    scores.sort_by_key(|score| score.claim);
    scores
}

fn of_claim(claims: &[Claim], study: &Study, number: u32) -> Score {
    let claim = claims.iter().find(|claim| claim.number == number);
    let finding = claim
        .ok_or("no claim has this number".to_owned())
        .and_then(|claim| claim.finding(study));
    let verdict = match &finding {
        Ok(finding) if finding.holds => Verdict::Holds,
        Ok(_) => Verdict::Differs,
        Err(_) => Verdict::NotTestable,
    };
    let finding = finding.unwrap_or_else(|lack| Finding {
        why: lack,
        ..Finding::default()
    });
    let text = |of: fn(&Claim) -> &str| claim.map_or("", of).to_owned();
    Score {
        claim: number,
        study: study.name().to_owned(),
        title: text(|claim| claim.title),
        published: text(|claim| claim.published),
        paper_says: text(|claim| claim.paper_says),
        headline: finding.headline,
        measured: finding.measured,
        verdict,
        why: finding.why,
    }
}

/// Table of `claims.csv`, one row per score.
///
/// ```
/// use palpate_report::claims_table;
///
/// assert_eq!(claims_table(&[]).to_csv(), "claim,verdict,paper_says,measured,why\n");
/// ```
pub fn claims_table(scores: &[Score]) -> Table {
    let texts = ["verdict", "paper_says", "measured", "why"].map(Column::text);
    let mut table = Table::new(std::iter::once(Column::count("claim")).chain(texts));
    let row = |score: &Score| {
        let first = [score.claim.to_string(), score.verdict.to_string()];
        let texts = [&score.paper_says, &score.measured, &score.why];
        first
            .into_iter()
            .chain(texts.map(String::clone))
            .collect::<Vec<_>>()
    };
    table.rows = scores.iter().map(row).collect();
    table
}

/// The scores as a text table, with the columns number, claim, published value, measured value, verdict and study. A last
/// line contains the totals. The text is empty if there are no scores.
///
/// ```
/// use palpate_report::{Score, Verdict, scorecard_lines};
///
/// let score = Score {
///     claim: 19,
///     study: "lenses".to_owned(),
///     title: "Fisheye keeps the marker area even".to_owned(),
///     published: "similar area".to_owned(),
///     paper_says: "The fisheye lens gives all markers a similar area in the image.".to_owned(),
///     headline: "ratio 1.2".to_owned(),
///     measured: "The largest area is 1.2 times the smallest.".to_owned(),
///     verdict: Verdict::Holds,
///     why: "Holds if the ratio is at most 1.5.".to_owned(),
/// };
/// assert_eq!(
///     scorecard_lines(&[score]),
///     "No.  Claim                               Published     Measured   Verdict  Study\n \
///       19  Fisheye keeps the marker area even  similar area  ratio 1.2  holds    lenses\n\n\
///      1 hold, 0 differ, 0 not testable\n"
/// );
/// ```
pub fn scorecard_lines(scores: &[Score]) -> String {
    if scores.is_empty() {
        return String::new();
    }
    let header = ["No.", "Claim", "Published", "Measured", "Verdict", "Study"].map(str::to_owned);
    let cells = |score: &Score| {
        let texts = [&score.title, &score.published, &score.headline].map(Clone::clone);
        let [title, published, measured] = texts;
        let (number, verdict) = (format!("{:>3}", score.claim), score.verdict.to_string());
        [
            number,
            title,
            published,
            measured,
            verdict,
            score.study.clone(),
        ]
    };
    let mut lines = vec![header];
    lines.extend(scores.iter().map(cells));
    let length = |text: &String| text.chars().count();
    let width = |column: usize| lines.iter().map(|cells| length(&cells[column])).max();
    let widths = [0, 1, 2, 3, 4, 5].map(|column| width(column).unwrap_or(0));
    let mut text = String::new();
    for cells in &lines {
        let padded = cells
            .iter()
            .zip(widths)
            .map(|(cell, width)| format!("{cell:<width$}"));
        text += padded.collect::<Vec<_>>().join("  ").trim_end();
        text.push('\n');
    }
    text + "\n" + &totals(scores)
}

fn totals(scores: &[Score]) -> String {
    let count = |verdict: Verdict| {
        scores
            .iter()
            .filter(|score| score.verdict == verdict)
            .count()
    };
    let [hold, differ, open] = [Verdict::Holds, Verdict::Differs, Verdict::NotTestable].map(count);
    format!("{hold} hold, {differ} differ, {open} not testable\n")
}
