//! Plots of lines and points in panels with the same axes, with a legend and with reference lines.

use super::chart::{self, Chart, Legend, Panel, bar, mesh};
use super::drawing::Figure;
use super::lettering::width;
use super::scale::Scale;
use super::sheet::{Drawn, Key, MARKER, Point, STROKE, Sample, TEXT, Words, dashed, letters};
use super::style::{Colour, INK, Marker, QUIET, Style, WHITE, pale};
use super::symbol::{Placed, Symbol};
use crate::ReportError;
use plotters::element::{Circle, Polygon, Rectangle};
use plotters::series::LineSeries;
use plotters::style::text_anchor::HPos;
use plotters::style::{Color, ShapeStyle};

/// A line with more than this number of points has small markers.
const MANY_POINTS: usize = 25;
/// Size of open markers, in drawing units (1/3 px).
pub(crate) const OPEN_MARKER: f64 = 21.0;
/// Width of the circle around a marker, in drawing units (1/3 px).
const CIRCLE: f64 = 4.5;

#[derive(Debug, Clone)]
pub(crate) struct Plot {
    pub(crate) x_label: String,
    pub(crate) y_label: String,
    pub(crate) x: Scale,
    pub(crate) y: Scale,
    /// Content of each panel. There is at least one panel.
    pub(crate) panels: Vec<Content>,
    pub(crate) key: Key,
    pub(crate) series: SeriesKey,
    pub(crate) marks: Vec<Mark>,
    /// Size of the markers on solid lines, in drawing units (1/3 px); 0 for lines without markers.
    pub(crate) marker: f64,
}

#[derive(Debug, Clone, Default)]
pub(crate) struct Content {
    pub(crate) title: String,
    /// Coloured areas in the background. Each area is a polygon, given by its corners and its colour.
    pub(crate) grounds: Vec<(Vec<(f64, f64)>, Colour)>,
    pub(crate) lines: Vec<Line>,
    pub(crate) points: Vec<PointSet>,
}

impl Content {
    pub(crate) fn places(&self) -> impl Iterator<Item = (f64, f64)> + '_ {
        let lines = self
            .lines
            .iter()
            .flat_map(|line| line.runs.iter().flatten());
        let points = self.points.iter().flat_map(|set| &set.at);
        lines.chain(points).copied()
    }
}

#[derive(Debug, Clone)]
pub(crate) struct PointSet {
    pub(crate) label: String,
    pub(crate) style: Style,
    pub(crate) size: f64,
    pub(crate) at: Vec<(f64, f64)>,
}

/// The points of a line, as a list of uninterrupted parts. Where a value is missing, the line is interrupted.
pub(crate) type Runs = Vec<Vec<(f64, f64)>>;

/// The line of one series in one panel.
#[derive(Debug, Clone)]
pub(crate) struct Line {
    pub(crate) style: Style,
    /// Whether the line is dashed and has no markers. A dashed line shows a second statistic, which is compared with
    /// the statistic of the solid line.
    pub(crate) dashed: bool,
    pub(crate) runs: Runs,
    /// Points with a circle around their marker.
    pub(crate) circled: Vec<(f64, f64)>,
    /// Error bars: the x of each bar, and the y of both ends of the bar.
    pub(crate) bars: Vec<(f64, [f64; 2])>,
}

/// Entries of the legend, which explain the lines and markers of a plot. There are no entries if the plot has only one
/// series and no dashed line.
#[derive(Debug, Clone, Default)]
pub(crate) struct SeriesKey {
    pub(crate) title: String,
    pub(crate) entries: Vec<(String, Style)>,
    /// Labels of the solid and of the dashed lines; `None` if there are no dashed lines.
    pub(crate) compared: Option<(String, String)>,
    /// Labels and styles of the open markers.
    pub(crate) points: Vec<(String, Style)>,
}

#[derive(Debug, Clone)]
pub(crate) struct Mark {
    pub(crate) on_x: bool,
    pub(crate) at: f64,
    pub(crate) label: String,
    pub(crate) style: ShapeStyle,
}

/// Creates the x axis and the y axis, which cover all points and reference lines. `make` creates one axis from its
/// index (0 for x, 1 for y) and from the values that it must cover.
pub(crate) fn scales(
    panels: &[Content],
    marks: &[Mark],
    make: impl Fn(usize, &mut dyn Iterator<Item = f64>) -> Scale,
) -> [Scale; 2] {
    let places: Vec<(f64, f64)> = panels.iter().flat_map(Content::places).collect();
    let marked = |on_x: bool| {
        let on_axis = marks.iter().filter(move |mark| mark.on_x == on_x);
        on_axis.map(|mark| mark.at)
    };
    [
        make(
            0,
            &mut places.iter().map(|place| place.0).chain(marked(true)),
        ),
        make(
            1,
            &mut places.iter().map(|place| place.1).chain(marked(false)),
        ),
    ]
}

pub(crate) fn figure(words: Words, plots: Vec<Plot>) -> Result<Figure, ReportError> {
    let charts: Vec<Chart<'_>> = plots.iter().map(Plot::chart).collect();
    chart::figure(words, &charts)
}

impl Line {
    pub(crate) fn new(style: Style, dashed: bool, runs: Runs) -> Self {
        Self {
            style,
            dashed,
            runs,
            circled: Vec::new(),
            bars: Vec::new(),
        }
    }
}

impl Plot {
    /// A plot without reference lines and without explanations of its lines and colours. `labels` and the pair of
    /// scales are in the order x, y.
    pub(crate) fn new(labels: [String; 2], [x, y]: [Scale; 2], panels: Vec<Content>) -> Self {
        let [x_label, y_label] = labels;
        Self {
            x_label,
            y_label,
            x,
            y,
            panels,
            key: Key::new(),
            series: SeriesKey::default(),
            marks: Vec::new(),
            marker: MARKER,
        }
    }

    fn chart(&self) -> Chart<'_> {
        Chart {
            x_label: self.x_label.clone(),
            y_label: self.y_label.clone(),
            x: self.x.clone(),
            y: self.y.clone(),
            titles: self
                .panels
                .iter()
                .map(|panel| panel.title.clone())
                .collect(),
            key: self.key.clone(),
            legend: self.legend(),
            draw: Box::new(|panel, at| self.draw(panel, at)),
        }
    }

    fn legend(&self) -> Legend {
        let line = |colour: Colour| colour.stroke_width(STROKE);
        let marked = |sample: Sample, style: Style, size: f64| match self.marker > 0.0 {
            true => sample.with(Symbol::new(style, size)),
            false => sample,
        };
        let key = &self.series;
        let series = key.entries.iter().map(|(text, style)| {
            let sample = match self.x.is_named() {
                true => Sample::symbol(Symbol::new(*style, MARKER)),
                false => marked(Sample::line(line(style.colour)), *style, MARKER),
            };
            (sample, text.clone())
        });
        let compared = key.compared.iter().flat_map(|(solid, dashed)| {
            let disc = Style::new(QUIET, Marker::Circle);
            let solid_line = marked(Sample::line(line(QUIET)), disc, MARKER - 3.0);
            [
                (solid_line, solid.clone()),
                (Sample::dashed(line(QUIET)), dashed.clone()),
            ]
        });
        let points = key.points.iter().map(|(text, style)| {
            let symbol = Symbol::new(*style, OPEN_MARKER).open();
            (Sample::symbol(symbol), text.clone())
        });
        Legend {
            title: key.title.clone(),
            entries: series.chain(compared).chain(points).collect(),
        }
    }

    fn draw(&self, panel: &mut Panel<'_>, at: usize) -> Drawn {
        let content = &self.panels[at];
        for (corners, colour) in &content.grounds {
            panel.draw_series([Polygon::new(corners.clone(), *colour)])?;
        }
        mesh(panel)?;
        for mark in &self.marks {
            let label = if at == 0 { mark.label.as_str() } else { "" };
            mark.draw(label, content, panel)?;
        }
        // If the x axis shows names instead of numbers, do not join the points by lines, because names have no order.
        for line in &content.lines {
            if line.dashed || !self.x.is_named() {
                self.stroke(line, panel)?;
            }
        }
        // Draw the markers last, so that lines do not cross them.
        let marked = |line: &&Line| self.marker > 0.0 && !line.dashed;
        let marked: Vec<&Line> = content.lines.iter().filter(marked).collect();
        let size = |line: &Line| {
            let crowded = line.runs.iter().map(Vec::len).sum::<usize>() > MANY_POINTS;
            if crowded { 0.6 * MARKER } else { self.marker }
        };
        for (wider, colour) in [(CIRCLE, INK), (0.0, WHITE)] {
            for line in &marked {
                let radius = 1.7 * size(line) + wider;
                let circled = line.circled.iter();
                let disc = |place: &(f64, f64)| Circle::new(*place, radius, colour.filled());
                panel.draw_series(circled.map(disc))?;
            }
        }
        for line in &marked {
            for (x, ends) in &line.bars {
                bar(panel, *x, *ends, 2 * size(line) as i32, line.style.colour)?;
            }
        }
        for line in marked {
            let symbol = Symbol::new(line.style, size(line));
            let places = line.runs.iter().flatten();
            panel.draw_series(places.map(|place| Placed(*place, symbol)))?;
        }
        for set in &content.points {
            let symbol = Symbol::new(set.style, set.size).open();
            panel.draw_series(set.at.iter().map(|place| Placed(*place, symbol)))?;
        }
        Ok(())
    }

    fn stroke(&self, line: &Line, panel: &mut Panel<'_>) -> Drawn {
        let style = line.style.colour.stroke_width(STROKE);
        // If the plot has dashed lines, solid lines are drawn in a pale colour. Otherwise, a dashed line on top of a
        // solid line would be invisible.
        let behind = pale(line.style.colour).stroke_width(STROKE);
        for run in &line.runs {
            match run.as_slice() {
                [place] if line.dashed => {
                    panel.draw_series([Circle::new(*place, STROKE, style.filled())])?;
                }
                [] | [_] => {}
                _ if line.dashed => {
                    panel.draw_series([dashed(run.clone(), style)])?;
                }
                _ if self.series.compared.is_some() => {
                    panel.draw_series(LineSeries::new(run.iter().copied(), behind))?;
                }
                _ => {
                    panel.draw_series(LineSeries::new(run.iter().copied(), style))?;
                }
            }
        }
        Ok(())
    }
}

impl Mark {
    fn draw(&self, label: &str, content: &Content, panel: &Panel<'_>) -> Drawn {
        const PLACES: [f64; 5] = [0.98, 0.02, 0.5, 0.25, 0.75];
        let area = panel.plotting_area().use_screen_coord();
        let (across, down) = area.get_pixel_range();
        let (wide, half) = (width(label, TEXT), TEXT * 3 / 5);
        let at = if self.on_x {
            (self.at, panel.y_range().start)
        } else {
            (panel.x_range().start, self.at)
        };
        let (x, y) = panel.backend_coord(&at);
        let along = |start: i32, end: i32| {
            PLACES.map(|share| start + (share * f64::from(end - start)) as i32)
        };
        // `ends` are the ends of the reference line. `places` are possible positions of its label. Each entry is a pair
        // of positions: one on each side of the line.
        let (ends, places) = if self.on_x {
            let heights = along(down.end - half, down.start + half);
            let beside = heights.map(|y| [(x + 18, y), (x - 18 - wide, y)]);
            ([(x, down.end), (x, down.start)], beside)
        } else {
            let lefts = along(across.start, across.end - wide);
            let beside = lefts.map(|x| [(x, y - half - 6), (x, y + half + 6)]);
            ([(across.start, y), (across.end, y)], beside)
        };
        area.draw(&dashed(ends.to_vec(), self.style))?;
        let inside = |(x, y): &Point| {
            *x >= across.start
                && x + wide <= across.end
                && y - half >= down.start
                && y + half <= down.end
        };
        let hidden = |(x, y): &Point| {
            let covered = [x - 12..x + wide + 12, y - half..y + half];
            content.crossings(panel, &covered)
        };
        let places = places.into_iter().flatten().filter(inside);
        let Some((x, y)) = places.min_by_key(hidden).filter(|_| !label.is_empty()) else {
            return Ok(());
        };
        if content.grounds.is_empty() {
            let ground = [(x - 9, y - half), (x + wide, y + half)];
            area.draw(&Rectangle::new(ground, WHITE.filled()))?;
        }
        let (left, top) = area.get_base_pixel();
        area.draw_text(
            label,
            &letters(TEXT, QUIET, HPos::Left),
            (x - left, y - top),
        )
    }
}

impl Content {
    /// Measures how much of the drawn data a label would cover (no unit). The label covers the box with the pixel
    /// ranges `across` and `down`. Each data point in the box adds 3 to the result. Each line segment is sampled at 21
    /// positions, and each of them in the box adds 1.
    fn crossings(&self, panel: &Panel<'_>, [across, down]: &[std::ops::Range<i32>; 2]) -> usize {
        let within = |(x, y): &Point| across.contains(x) && down.contains(y);
        let at = |place: &(f64, f64)| panel.backend_coord(place);
        let points = self.points.iter().flat_map(|set| set.at.iter().map(at));
        let mut count = 3 * points.filter(within).count();
        for run in self.lines.iter().flat_map(|line| &line.runs) {
            let places: Vec<Point> = run.iter().map(at).collect();
            count += 3 * places.iter().filter(|place| within(place)).count();
            for pair in places.windows(2) {
                let ((x0, y0), (x1, y1)) = (pair[0], pair[1]);
                let along = |k: i32| (x0 + k * (x1 - x0) / 20, y0 + k * (y1 - y0) / 20);
                count += (0..=20).filter(|k| within(&along(*k))).count();
            }
        }
        count
    }
}
