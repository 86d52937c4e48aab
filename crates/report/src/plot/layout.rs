//! Room for the parts of a figure, in pixels.

use super::canvas::Point;
use super::figure::Figure;
use super::lettering::{width, wrap};
use super::scale::Tick;

/// Size of the title.
pub(crate) const TITLE: f64 = 25.0;
/// Size of all other text.
pub(crate) const TEXT: f64 = 18.0;
/// Distance between lines of text, in sizes of the text.
pub(crate) const LEADING: f64 = 1.35;
/// Margin around the picture.
pub(crate) const EDGE: f64 = 22.0;
/// Length of a line's sample in the legend.
pub(crate) const SAMPLE: f64 = 40.0;
/// Gap between a panel and the labels of its ticks, pixels.
pub(crate) const TICK_GAP: f64 = 10.0;

const GAP: f64 = 30.0;
const SMALLEST_WIDTH: f64 = 960.0;
const PANEL_HEIGHT: f64 = 390.0;
const LEGEND_LIMIT: f64 = 250.0;
/// Width of a panel, and of a row of panels, up to which names along x widen it, pixels.
const LARGEST_WIDTH: f64 = 1500.0;
/// Gap between names along x, pixels.
const BESIDE: f64 = 12.0;
/// More panels than this make several rows.
const PER_ROW: usize = 4;

/// Sizes and places of a figure's parts. Places of text are the middle of its height.
pub(crate) struct Layout {
    /// Width of the picture, and how far down it reaches.
    pub(crate) size: (f64, f64),
    /// Top of the title.
    pub(crate) top: f64,
    pub(crate) title: Vec<String>,
    pub(crate) subtitle: Vec<String>,
    pub(crate) notes: Vec<String>,
    /// Top of the first note.
    pub(crate) notes_at: f64,
    pub(crate) legend: Vec<Entry>,
    pub(crate) legend_at: Point,
    /// Upper left corners of the panels.
    pub(crate) panels: Vec<Point>,
    /// Width and height of each panel.
    pub(crate) panel: (f64, f64),
    /// Panels in a row.
    pub(crate) columns: usize,
    /// Places along x, and the lines of their labels.
    pub(crate) x_ticks: Vec<(f64, Vec<String>)>,
    pub(crate) y_ticks: Vec<Tick>,
    pub(crate) x_label_at: Point,
    pub(crate) y_label_at: Point,
}

/// Line of the legend: a text, and the sample before it.
pub(crate) struct Entry {
    pub(crate) text: String,
    pub(crate) sample: Sample,
}

/// Sample before a line of the legend.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Sample {
    /// None, and no room for one: the line is a heading.
    Heading,
    /// None, but room for one: the line continues the one above.
    Continued,
    /// Line and marker of this entry of the figure's legend.
    Series(usize),
    /// A solid line, for the first of two statistics.
    Solid,
    /// A dashed line, for the second of two statistics.
    Dashed,
    /// The open marker of this entry of the figure's legend.
    Points(usize),
}

impl Entry {
    /// Distance from the legend's left edge to the text, pixels.
    pub(crate) fn indent(&self) -> f64 {
        if self.sample == Sample::Heading {
            0.0
        } else {
            SAMPLE + 8.0
        }
    }
}

impl Layout {
    /// Finds room for everything.
    pub(crate) fn of(figure: &Figure) -> Self {
        Self::within(figure, margins(figure))
    }

    /// Figures below each other, their panels one above the other.
    pub(crate) fn stack(figures: Vec<Figure>) -> Vec<(Figure, Self)> {
        let wider = |(left, right): (f64, f64), figure: &Figure| {
            let margins = margins(figure);
            (margins.0.max(left), margins.1.max(right))
        };
        let margins = figures.iter().fold((0.0, 0.0), wider);
        let mut top = 0.0;
        let place = |figure: Figure| {
            let layout = Self::within(&figure, margins).moved_down(top);
            top = layout.size.1 - EDGE;
            (figure, layout)
        };
        figures.into_iter().map(place).collect()
    }

    /// Moves everything down by `by`, the height of a picture above.
    fn moved_down(mut self, by: f64) -> Self {
        let places = [
            &mut self.legend_at,
            &mut self.x_label_at,
            &mut self.y_label_at,
        ];
        for place in places.into_iter().chain(&mut self.panels) {
            place.1 += by;
        }
        self.top += by;
        self.notes_at += by;
        self.size.1 += by;
        self
    }

    /// Finds room for everything beside margins of these widths, left and right.
    fn within(figure: &Figure, (left, right): (f64, f64)) -> Self {
        let y_ticks = figure.y.ticks(6);
        let legend = legend(figure);
        let count = figure.panels.len();
        let named = named_width(figure);
        let columns = columns(count, left + right, named);
        let rows = count.div_ceil(columns);
        let gaps = GAP * (columns - 1) as f64;
        let narrowest = narrowest(columns).max(named);
        let panel_width = ((SMALLEST_WIDTH - left - right - gaps) / columns as f64).max(narrowest);
        let total = left + columns as f64 * panel_width + gaps + right;

        let lines = |text: &String, size| wrap(text, size, total - 2.0 * EDGE);
        let title = lines(&figure.title, TITLE);
        let subtitle = lines(&figure.subtitle, TEXT);
        let notes: Vec<String> = figure
            .notes
            .iter()
            .flat_map(|note| lines(note, TEXT))
            .collect();
        let x_ticks = x_ticks(figure, panel_width);
        let tick_lines = largest(x_ticks.iter().map(|(_, lines)| lines.len() as f64));

        let line = TEXT * LEADING;
        let mut y =
            EDGE + title.len() as f64 * TITLE * LEADING + subtitle.len() as f64 * line + 14.0;
        let y_label_at = (EDGE, y + TEXT / 2.0);
        y += line + 6.0;
        let titled = figure.panels.iter().any(|panel| panel.title.is_some());
        let heading = if titled { line + 4.0 } else { 0.0 };
        let row_height = heading + PANEL_HEIGHT + TICK_GAP + tick_lines * line + 10.0;
        let corner = |at: usize| {
            let (row, column) = ((at / columns) as f64, (at % columns) as f64);
            (
                left + column * (panel_width + GAP),
                y + row * row_height + heading,
            )
        };
        let panels: Vec<Point> = (0..count).map(corner).collect();
        let legend_at = (total - right + GAP, y + heading);
        let legend_bottom = legend_at.1 + legend.len() as f64 * line;
        y += rows as f64 * row_height;
        let x_label_at = (left + (total - right - left) / 2.0, y + TEXT / 2.0 - 2.0);
        let x_label = if figure.x_label.is_empty() { 0.0 } else { line };
        y = (y + x_label).max(legend_bottom);
        let notes_at = y + 10.0;
        if !notes.is_empty() {
            y = notes_at + notes.len() as f64 * line;
        }
        Self {
            top: EDGE,
            size: (total.ceil(), (y + EDGE - 6.0).ceil()),
            title,
            subtitle,
            notes,
            notes_at,
            legend,
            legend_at,
            panels,
            panel: (panel_width, PANEL_HEIGHT),
            columns,
            x_ticks,
            y_ticks,
            x_label_at,
            y_label_at,
        }
    }
}

fn largest(values: impl Iterator<Item = f64>) -> f64 {
    values.fold(0.0, f64::max)
}

/// Room to the left and right of the panels.
fn margins(figure: &Figure) -> (f64, f64) {
    let ticks = figure.y.ticks(6);
    let left = EDGE + largest(ticks.iter().map(|tick| width(&tick.label, TEXT))) + TICK_GAP + 2.0;
    let entries = legend(figure);
    let width_of = |entry: &Entry| entry.indent() + width(&entry.text, TEXT);
    let right = if entries.is_empty() {
        EDGE + 10.0
    } else {
        GAP + largest(entries.iter().map(width_of)) + EDGE
    };
    (left, right)
}

/// Panels in a row: as many as make rows of nearly the same length, and of names along x as leave room for them.
fn columns(count: usize, margins: f64, named: f64) -> usize {
    let even = |per_row: usize| count.div_ceil(count.div_ceil(per_row).max(1)).max(1);
    let room = (LARGEST_WIDTH - margins + GAP) / (named + GAP);
    even(PER_ROW.min(room as usize).max(1))
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
fn named_width(figure: &Figure) -> f64 {
    let names = figure.x.categories();
    let words = names.iter().flat_map(|name| name.split_whitespace());
    let widest = largest(words.map(|word| width(word, TEXT)));
    (names.len() as f64 * (widest + BESIDE)).min(LARGEST_WIDTH)
}

/// Largest set of ticks along x whose labels have room, each with the lines of its label.
fn x_ticks(figure: &Figure, panel_width: f64) -> Vec<(f64, Vec<String>)> {
    let labelled = |about: usize| {
        let ticks = figure.x.ticks(about);
        let slot = panel_width / ticks.len().max(1) as f64;
        let label = |tick: Tick| (tick.at, wrap(&tick.label, TEXT, slot - BESIDE));
        ticks.into_iter().map(label).collect::<Vec<_>>()
    };
    let fits = |ticks: &Vec<(f64, Vec<String>)>| {
        let mut end = f64::NEG_INFINITY;
        ticks.iter().all(|(at, lines)| {
            let half = largest(lines.iter().map(|line| width(line, TEXT))) / 2.0;
            let middle = figure.x.place(*at) * panel_width;
            let free = middle - half >= end + 8.0;
            end = middle + half;
            free
        })
    };
    (3..=6)
        .rev()
        .map(labelled)
        .find(fits)
        .unwrap_or_else(|| labelled(2))
}

fn legend(figure: &Figure) -> Vec<Entry> {
    let mut entries = Vec::new();
    let mut push = |text: &str, sample: Sample| {
        let limit = if sample == Sample::Heading {
            LEGEND_LIMIT
        } else {
            LEGEND_LIMIT - SAMPLE
        };
        for (at, line) in wrap(text, TEXT, limit).into_iter().enumerate() {
            let sample = if at == 0 || sample == Sample::Heading {
                sample
            } else {
                Sample::Continued
            };
            entries.push(Entry { text: line, sample });
        }
    };
    push(&figure.legend.title, Sample::Heading);
    for (at, (text, _)) in figure.legend.entries.iter().enumerate() {
        push(text, Sample::Series(at));
    }
    if let Some((solid, dashed)) = &figure.legend.compared {
        push(solid, Sample::Solid);
        push(dashed, Sample::Dashed);
    }
    for (at, (text, _)) in figure.legend.points.iter().enumerate() {
        push(text, Sample::Points(at));
    }
    entries
}
