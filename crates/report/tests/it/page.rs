//! The page and the scorecard.

use crate::fixture::{Cells, Numbers, angular_velocity, config};
use palpate_report::{ReportError, page, score, scorecard_text};
use std::collections::BTreeSet;

const PLOT: &str = "\n[[plot]]\nx = \"scene.object.radius\"\ny = \"rms_error\"\n";

#[test]
fn the_page_stands_alone_and_tells_everything() {
    let mut cells = Cells::new("scene.object.radius_cm");
    cells.push(
        "5",
        Numbers {
            failures: 1234,
            trials: 20_000,
            ..Numbers::new(0.2, 0.1)
        },
    );
    let text = config("sphere", "claims = [2, 99]").replace("A question?", "Is <b> & c?") + PLOT;
    let first = cells.study(&text);
    let second = angular_velocity("claims = [1]");
    let html = page(&[first, second]).unwrap();
    for part in [
        "Is &lt;b&gt; &amp; c?",
        "seed 7",
        "20,000 trials per cell",
        "1,234",
        "unresolved",
        "not testable",
        "holds",
        "<details>",
        "claims = [2, 99]",
        "prefers-color-scheme: dark",
        "3 rows on 3 claims: 1 holds, 2 not testable.",
        "<span class=\"why\">somewhere</span>",
        "<figure style=\"--least: 586.0px\">",
        "<details class=\"contents\">",
    ] {
        assert!(html.contains(part), "{part}");
    }
    // A plot that is asked for, and the usual one of the study that asks for none.
    assert_eq!(html.matches("<svg").count(), 2);
    for part in ["<script", "<link", "<img", "@import", "url(", "<b>", "src="] {
        assert!(!html.contains(part), "{part}");
    }
    let addresses: BTreeSet<&str> = html
        .split("http")
        .skip(1)
        .map(|rest| rest.split('"').next().unwrap())
        .collect();
    assert_eq!(addresses, BTreeSet::from(["://www.w3.org/2000/svg"]));
    let ids: Vec<&str> = html
        .split(" id=\"")
        .skip(1)
        .map(|rest| rest.split('"').next().unwrap())
        .collect();
    assert_eq!(ids, ["study-1", "study-2"]);
    assert!(
        ids.iter()
            .all(|id| html.contains(&format!("href=\"#{id}\"")) || *id == "study-2")
    );
}

#[test]
fn a_page_of_nothing_is_still_a_page() {
    assert!(page(&[]).unwrap().contains("0 studies"));
}

#[test]
fn a_failing_plot_makes_no_page() {
    let study = angular_velocity("plot = [{ x = \"truth\", y = \"nothing\" }]");
    let page = page(&[study]);
    assert!(matches!(page, Err(ReportError::UnknownColumn { .. })));
}

#[test]
fn the_terminal_gets_the_same_verdicts() {
    let study = angular_velocity("claims = [1, 2]");
    let text = scorecard_text(&score(&[study]));
    assert!(text.contains("Claim  1  HOLDS  (study)"), "{text}");
    assert!(text.contains("Claim  2  NOT TESTABLE  (study)"), "{text}");
    assert!(text.lines().all(|line| line.chars().count() <= 100));
}
