//! Tests the HTML page and the scorecard.

use crate::fixture::{Cells, Numbers, angular_velocity, config};
use palpate_report::{ReportError, page};
use std::collections::BTreeSet;

const PLOT: &str = "\n[[plot]]\nx = \"scene.object.radius\"\ny = \"rms_error\"\n";

#[test]
fn the_page_is_complete_and_loads_nothing() {
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
        "20,000 trials per cell",
        "1,234",
        "claims = [2, 99]",
        "3 rows on 3 claims: 1 holds, 2 not testable.",
        "<span class=\"why\">somewhere</span>",
    ] {
        assert!(html.contains(part), "{part}");
    }
    // The page has two figures: one config states a plot, and the study without a `[[plot]]` has a default plot.
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
    let links = html.split("href=\"#").skip(1);
    let links: BTreeSet<&str> = links.map(|rest| rest.split('"').next().unwrap()).collect();
    assert!(links.is_subset(&distinct), "{links:?}");
    assert!(links.contains("study-1") && links.contains("word-unresolved"));
    // The tables of these studies do not contain the coverage of intervals.
    assert!(!html.contains("Calibration of intervals"));
}

#[test]
fn no_studies_give_an_empty_page() {
    assert!(page(&[]).unwrap().contains("0 studies"));
}

#[test]
fn a_failing_plot_makes_no_page() {
    let study = angular_velocity("plot = [{ x = \"truth\", y = \"nothing\" }]");
    let page = page(&[study]);
    assert!(matches!(page, Err(ReportError::BadPlot { .. })));
}
