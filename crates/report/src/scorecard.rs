//! The scorecard as text for a terminal.

use crate::{Score, Verdict};

/// One line per score, under a header: number, claim, published value, measured value, verdict and study; then a line
/// of totals. Returns an empty text if there are no scores.
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
