//! The page and the scorecard.

use crate::fixture::{self, Cells, Numbers, STATISTICS, angular_velocity, config};
use palpate_report::{ReportError, page, score, scorecard_lines};
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
    // One plot from a config, and the default plot of the study without a `[[plot]]`.
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
    let distinct: BTreeSet<&str> = ids.iter().copied().collect();
    assert_eq!(distinct.len(), ids.len(), "{ids:?}");
    for id in [
        "claims",
        "study-1",
        "study-2",
        "words",
        "word-unresolved",
        "word-IFD",
    ] {
        assert!(distinct.contains(id), "{id}");
    }
    let links = html.split("href=\"#").skip(1);
    let links: BTreeSet<&str> = links.map(|rest| rest.split('"').next().unwrap()).collect();
    assert!(links.is_subset(&distinct), "{links:?}");
    assert!(links.is_superset(&BTreeSet::from([
        "claims",
        "study-1",
        "words",
        "word-unresolved"
    ])));
    // The tables of these studies have no coverage of intervals.
    assert!(!html.contains("Calibration of intervals"));
}

#[test]
fn intervals_are_held_against_what_they_say() {
    let table = |rows: &[(f64, [&str; 3], u64)]| {
        let mut text = format!("cell,scene.object.radius_cm,quantity,unit,{STATISTICS}\n");
        for (cell, (radius, shares, failures)) in rows.iter().enumerate() {
            text += &format!(
                "{cell},{radius},normal_curvature_u,1/cm,0.2,100,{failures},,,,,,,,,,,,,{}\n",
                shares.join(",")
            );
        }
        let estimator = "[scene.estimator]\nkind = \"least-squares\"\n";
        let config = config("sphere", "") + estimator;
        fixture::study(&config, &text, fixture::NO_FAILURES, &[])
    };
    let first = table(&[
        (5.0, ["0.5", "0.8", "0.95"], 0),
        (50.0, ["0.3", "0.6", "0.75"], 98),
        // A cell with a single trial is left out, and so is one without coverage.
        (500.0, ["0", "0", "0"], 99),
        (900.0, ["", "", ""], 0),
    ]);
    let second = table(&[(5.0, ["0.6", "0.9", "1"], 0)]);
    let html = page(&[first, second]).unwrap();
    for part in [
        "<section id=\"calibration-of-intervals\">",
        "roll: least-squares: 46.7 % of 50 %, 76.7 % of 80 %, 90.0 % of 95 %; 1 of 3 fall short",
        "<td><a href=\"#study-1\">study</a></td><td class=\"number\">2</td><td class=\"number\">40.0 %</td>",
        "<td>75.0 %<span class=\"why\">normal curvature along u, object radius 50 cm</span></td>",
        "<td><a href=\"#study-2\">study</a></td><td class=\"number\">1</td><td class=\"number\">60.0 %</td>",
        "Do intervals hold the truth as often as they say?",
    ] {
        assert!(html.contains(part), "{part}\n{html}");
    }
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
    let text = scorecard_lines(&score(&[study]));
    for (line, number, verdict) in [(1, "  1", "holds"), (2, "  2", "not testable")] {
        let line = text.lines().nth(line).unwrap();
        assert!(line.starts_with(number) && line.contains(verdict), "{text}");
    }
    assert!(
        text.ends_with("1 hold, 0 differ, 1 not testable\n"),
        "{text}"
    );
    assert_eq!(scorecard_lines(&[]), "");
}
