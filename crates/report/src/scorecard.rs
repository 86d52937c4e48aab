//! The scorecard as text for a terminal.

use crate::{Score, Verdict};

const WIDTH: usize = 100;
const INDENT: usize = 14;

/// The scores as text of at most 100 columns, with a line of totals at the end; empty without scores.
///
/// ```
/// use palpate_report::{Score, Verdict, scorecard_text};
///
/// let score = Score {
///     claim: 19,
///     study: "lenses".to_owned(),
///     paper_says: "The fisheye lens gives all markers a similar area in the image.".to_owned(),
///     measured: "The largest area is 1.2 times the smallest.".to_owned(),
///     verdict: Verdict::Holds,
///     why: "Holds if the ratio is at most 1.5.".to_owned(),
/// };
/// let text = scorecard_text(&[score]);
/// assert!(text.starts_with("Claim 19  HOLDS  (lenses)\n"));
/// assert!(text.ends_with("1 hold, 0 differ, 0 not testable\n"));
/// ```
pub fn scorecard_text(scores: &[Score]) -> String {
    if scores.is_empty() {
        return String::new();
    }
    let mut text = String::new();
    for score in scores {
        let verdict = score.verdict.to_string().to_uppercase();
        text += &format!("Claim {:>2}  {verdict}  ({})\n", score.claim, score.study);
        for (name, what) in [
            ("paper", &score.paper_says),
            ("measured", &score.measured),
            ("why", &score.why),
        ] {
            if !what.is_empty() {
                text += &paragraph(name, what);
            }
        }
        text.push('\n');
    }
    let count = |verdict: Verdict| {
        scores
            .iter()
            .filter(|score| score.verdict == verdict)
            .count()
    };
    text += &format!(
        "{} hold, {} differ, {} not testable\n",
        count(Verdict::Holds),
        count(Verdict::Differs),
        count(Verdict::NotTestable)
    );
    text
}

/// A named paragraph with a hanging indent.
fn paragraph(name: &str, words: &str) -> String {
    let mut text = String::new();
    let mut line = format!("  {name:<0$}", INDENT - 2);
    let mut empty = true;
    for word in words.split_whitespace() {
        let wide = line.chars().count() + usize::from(!empty) + word.chars().count();
        if !empty && wide > WIDTH {
            text += line.trim_end();
            text.push('\n');
            line = " ".repeat(INDENT);
            empty = true;
        }
        if !empty {
            line.push(' ');
        }
        line += word;
        empty = false;
    }
    text + line.trim_end() + "\n"
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_line_is_wider_than_100_columns_and_no_word_is_lost() {
        let words = "µ ".repeat(300) + &"word ".repeat(200);
        let score = |verdict| Score {
            claim: 1,
            study: "s".to_owned(),
            paper_says: words.clone(),
            measured: String::new(),
            verdict,
            why: "because".to_owned(),
        };
        let text = scorecard_text(&[score(Verdict::Holds), score(Verdict::NotTestable)]);
        assert!(
            text.lines().all(|line| line.chars().count() <= WIDTH),
            "{text}"
        );
        assert_eq!(text.matches("word").count(), 400);
        assert!(
            text.ends_with("1 hold, 0 differ, 1 not testable\n"),
            "{text}"
        );
        assert!(!text.contains("measured"));
    }

    #[test]
    fn nothing_scored_is_nothing_said() {
        assert_eq!(scorecard_text(&[]), "");
    }
}
