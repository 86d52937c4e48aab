//! Room for the panels of a chart, in pixels.

use super::content::Chart;
use super::legend::{Entry, entries};
use crate::plot::frame::{EDGE, LINE, TEXT, TICK_GAP, WIDTH, widest};
use crate::plot::lettering::{width, wrap};
use crate::plot::scale::Tick;

/// Gap between panels, and between them and the legend.
pub(super) const GAP: f64 = 30.0;
const PANEL_HEIGHT: f64 = 390.0;
/// Width of a panel, and of a row of panels, up to which names along x widen it.
const LARGEST_WIDTH: f64 = 1500.0;
/// Gap between names along x.
const BESIDE: f64 = 12.0;

/// Sizes of a chart's parts.
pub(super) struct Room {
    /// Width of the picture.
    pub(super) total: f64,
    /// Room to the left and right of the panels.
    pub(super) margins: (f64, f64),
    /// Width and height of each panel.
    pub(super) panel: (f64, f64),
    /// Panels in a row.
    pub(super) columns: usize,
    /// Room for the title above each panel.
    pub(super) heading: f64,
    /// Distance from row to row of panels.
    pub(super) row: f64,
    /// Places along x, and the lines of their labels.
    pub(super) x_ticks: Vec<(f64, Vec<String>)>,
    pub(super) y_ticks: Vec<Tick>,
    pub(super) legend: Vec<Entry>,
}

impl Room {
    /// Room for charts below each other, whose panels stand one above the other.
    pub(super) fn for_all(charts: &[Chart]) -> Vec<Self> {
        let wider = |(left, right): (f64, f64), chart: &Chart| {
            let margins = margins(chart);
            (margins.0.max(left), margins.1.max(right))
        };
        let margins = charts.iter().fold((0.0, 0.0), wider);
        charts
            .iter()
            .map(|chart| Self::beside(margins, chart))
            .collect()
    }

    fn beside(margins: (f64, f64), chart: &Chart) -> Self {
        let around = margins.0 + margins.1;
        let named = named_width(chart);
        let columns = columns(chart.panels.len(), around, named);
        let gaps = GAP * (columns - 1) as f64;
        let narrowest = narrowest(columns).max(named);
        let wide = ((WIDTH - around - gaps) / columns as f64).max(narrowest);
        let x_ticks = x_ticks(chart, wide);
        let tick_lines = largest(x_ticks.iter().map(|(_, lines)| lines.len() as f64));
        let titled = chart.panels.iter().any(|panel| panel.title.is_some());
        let heading = if titled { LINE + 4.0 } else { 0.0 };
        Self {
            total: margins.0 + columns as f64 * wide + gaps + margins.1,
            margins,
            panel: (wide, PANEL_HEIGHT),
            columns,
            heading,
            row: heading + PANEL_HEIGHT + TICK_GAP + tick_lines * LINE + 10.0,
            x_ticks,
            y_ticks: chart.y.ticks(6),
            legend: entries(&chart.legend),
        }
    }
}

fn largest(values: impl Iterator<Item = f64>) -> f64 {
    values.fold(0.0, f64::max)
}

/// Room to the left and right of the panels.
fn margins(chart: &Chart) -> (f64, f64) {
    let left = EDGE + widest(&chart.y.ticks(6)) + TICK_GAP + 2.0;
    let entries = entries(&chart.legend);
    let right = match entries.is_empty() {
        true => EDGE + 10.0,
        false => GAP + largest(entries.iter().map(Entry::width)) + EDGE,
    };
    (left, right)
}

/// Panels in a row: as many as make rows of nearly the same length, and of names along x as leave room for them.
fn columns(count: usize, margins: f64, named: f64) -> usize {
    let even = |per_row: usize| count.div_ceil(count.div_ceil(per_row).max(1)).max(1);
    let room = (LARGEST_WIDTH - margins + GAP) / (named + GAP);
    // Four in a square are larger than four in a row.
    let most = match count {
        0..=3 => count,
        4 => 2,
        5 | 6 => 3,
        _ => 4,
    };
    even(most.min(room as usize).max(1))
}

/// The least width of a panel.
fn narrowest(columns: usize) -> f64 {
    match columns {
        1 => 560.0,
        2 => 380.0,
        _ => 300.0,
    }
}

/// The width of a panel in which every word of the names along x has room beside its neighbours, as far as may be; 0 if
/// there are none.
fn named_width(chart: &Chart) -> f64 {
    let names = chart.x.categories();
    let words = names.iter().flat_map(|name| name.split_whitespace());
    let widest = largest(words.map(|word| width(word, TEXT)));
    (names.len() as f64 * (widest + BESIDE)).min(LARGEST_WIDTH)
}

/// Largest set of ticks along x whose labels have room, each with the lines of its label.
fn x_ticks(chart: &Chart, panel_width: f64) -> Vec<(f64, Vec<String>)> {
    let labelled = |about: usize| {
        let ticks = chart.x.ticks(about);
        let slot = panel_width / ticks.len().max(1) as f64;
        let label = |tick: Tick| (tick.at, wrap(&tick.label, TEXT, slot - BESIDE));
        ticks.into_iter().map(label).collect::<Vec<_>>()
    };
    let fits = |ticks: &Vec<(f64, Vec<String>)>| {
        let mut end = f64::NEG_INFINITY;
        ticks.iter().all(|(at, lines)| {
            let half = largest(lines.iter().map(|line| width(line, TEXT))) / 2.0;
            let middle = chart.x.place(*at) * panel_width;
            let free = middle - half >= end + 8.0;
            end = middle + half;
            free
        })
    };
    let found = (3..=6).rev().map(labelled).find(fits);
    found.unwrap_or_else(|| labelled(2))
}
