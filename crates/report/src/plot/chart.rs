//! Charts. A chart is a group of panels with the same axes, and a legend.

use super::drawing::{Drawing, Figure};
use super::lettering::{width, wrap};
use super::scale::Scale;
use super::sheet::{
    self, Drawn, EDGE, HAIR, Key, LINE, Point, SAMPLE_GAP, Sample, Sheet, TEXT, TICK_GAP, WIDTH,
    Words, letters,
};
use super::style::{Colour, FAINT, FRAME, GRID, INK};
use crate::ReportError;
use plotters::chart::{ChartBuilder, ChartContext, LabelAreaPosition};
use plotters::coord::cartesian::Cartesian2d;
use plotters::element::{PathElement, Rectangle};
use plotters::style::Color;
use plotters::style::text_anchor::HPos;

/// Gap between panels, and between the panels and the legend, in drawing units (1/3 px).
const GAP: i32 = 90;
const PANEL_HEIGHT: i32 = 1170;
/// Largest width of a row of panels, in drawing units (1/3 px). If long names below the x axis need space, panels are
/// widened until their row has this width.
const LARGEST_WIDTH: i32 = 4500;
/// Gap between neighbouring names of values below the x axis, in drawing units (1/3 px).
const BESIDE: i32 = 36;
/// Length of the symbol beside each text of the legend, in drawing units (1/3 px).
const SAMPLE: i32 = 120;
/// Length of the symbol beside each text in the line of explanations (the key) above the panels, in drawing units (1/3
/// px).
const KEY_SAMPLE: i32 = 78;
/// Largest width of a line of text in the legend, in drawing units (1/3 px).
const LIMIT: i32 = 750;

/// Function that draws the content of a panel. Its second argument is the index of the panel.
type Draw<'a> = Box<dyn Fn(&mut Panel<'_>, usize) -> Drawn + 'a>;

pub(crate) struct Chart<'a> {
    /// Label of the x axis; may be empty.
    pub(crate) x_label: String,
    pub(crate) y_label: String,
    pub(crate) x: Scale,
    pub(crate) y: Scale,
    /// Titles of the panels; there is at least one panel. A title may be empty.
    pub(crate) titles: Vec<String>,
    pub(crate) key: Key,
    pub(crate) legend: Legend,
    pub(crate) draw: Draw<'a>,
}

/// Legend beside the panels: a heading, and symbols with their labels. The heading and the symbols may be missing.
#[derive(Default)]
pub(crate) struct Legend {
    pub(crate) title: String,
    pub(crate) entries: Key,
}

pub(crate) fn figure(words: Words, charts: &[Chart<'_>]) -> Result<Figure, ReportError> {
    // All charts get the same margins, so that their panels align.
    let margins = charts.iter().map(Chart::margins);
    let margins = margins.fold([0; 2], |[a, b], [c, d]| [a.max(c), b.max(d)]);
    let layouts = charts.iter().map(|chart| PanelLayout::of(chart, margins));
    let layouts: Vec<PanelLayout> = layouts.collect();
    let width = layouts
        .iter()
        .map(|layout| layout.total)
        .max()
        .unwrap_or(WIDTH);
    sheet::figure(words, width, |sheet| {
        for (at, (chart, layout)) in charts.iter().zip(&layouts).enumerate() {
            sheet.top += if at > 0 { EDGE - 18 } else { 0 };
            chart.draw(sheet, layout)?;
        }
        Ok(())
    })
}
impl Chart<'_> {
    fn margins(&self) -> [i32; 2] {
        let rows = self.legend.rows();
        let widths = rows.iter().map(|(sample, text)| {
            let indent = sample.map_or(0, |_| SAMPLE + SAMPLE_GAP);
            indent + width(text, TEXT)
        });
        let right = widths.max().map_or(30, |widest| GAP + widest);
        [EDGE + self.y.widest() + TICK_GAP + 6, right + EDGE]
    }

    /// Smallest width of a panel in which the longest word below the x axis fits, at most `LARGEST_WIDTH`; in drawing
    /// units (1/3 px). It is 0 if the x axis shows numbers instead of names.
    fn named_width(&self) -> i32 {
        let names = self.x.names();
        let words = names.iter().flat_map(|name| name.split_whitespace());
        let widest = words.map(|word| width(word, TEXT)).max().unwrap_or(0);
        (names.len() as i32 * (widest + BESIDE)).min(LARGEST_WIDTH)
    }

    /// Number of panels per row, chosen to meet two conditions: the names below the x axes fit, and all rows have
    /// nearly the same number of panels.
    fn columns(&self, margins: i32) -> i32 {
        let count = self.titles.len() as i32;
        let room = (LARGEST_WIDTH - margins + GAP) / (self.named_width() + GAP);
        // Four panels are arranged in two rows of two, because each panel is then larger than in a single row.
        let most = match count {
            0..=3 => count,
            4 => 2,
            5 | 6 => 3,
            _ => 4,
        };
        let rows = (count as u32).div_ceil(most.min(room).max(1) as u32);
        (count as u32).div_ceil(rows.max(1)).max(1) as i32
    }

    fn draw(&self, sheet: &mut Sheet, layout: &PanelLayout) -> Drawn {
        if !self.key.is_empty() {
            sheet.key(KEY_SAMPLE, &self.key)?;
        }
        let [left, right] = layout.margins;
        let top = sheet.top + 60 + LINE;
        let y_label = (EDGE, sheet.top + 42 + TEXT / 2);
        sheet.text(&self.y_label, y_label, HPos::Left, INK)?;
        for (at, title) in self.titles.iter().enumerate() {
            let (row, column) = (at as i32 / layout.columns, at as i32 % layout.columns);
            let corner = (
                left + column * (layout.panel.0 + GAP),
                top + row * layout.row + layout.heading,
            );
            let middle = (corner.0 + layout.panel.0 / 2, corner.1 - TEXT / 2 - 18);
            sheet.text(title, middle, HPos::Center, INK)?;
            let place = Place {
                corner,
                size: layout.panel,
                labelled: [true, column == 0],
            };
            (self.draw)(&mut place.panel(sheet, &layout.x, &self.y)?, at)?;
        }
        let corner = (layout.total - right + GAP, top + layout.heading);
        let legend = self.legend.draw(sheet, corner)?;
        let rows = self.titles.len().div_ceil(layout.columns as usize) as i32;
        let mut bottom = top + rows * layout.row;
        if !self.x_label.is_empty() {
            let place = ((left + layout.total - right) / 2, bottom + TEXT / 2 - 6);
            sheet.text(&self.x_label, place, HPos::Center, INK)?;
            bottom += LINE;
        }
        sheet.top = bottom.max(legend);
        Ok(())
    }
}

impl Legend {
    /// Symbol and text of each line of the legend. The heading has no symbol; the second line of a long label has an
    /// empty symbol.
    fn rows(&self) -> Vec<(Option<Sample>, String)> {
        let heading = wrap(&self.title, TEXT, LIMIT).into_iter();
        let entries = self.entries.iter().flat_map(|(sample, text)| {
            let samples = std::iter::once(*sample).chain(std::iter::repeat(Sample::default()));
            let lines = wrap(text, TEXT, LIMIT - SAMPLE).into_iter();
            samples.map(Some).zip(lines)
        });
        heading.map(|line| (None, line)).chain(entries).collect()
    }

    fn draw(&self, sheet: &Sheet, (left, top): Point) -> Drawn<i32> {
        let mut y = top + TEXT / 2;
        for (sample, text) in self.rows() {
            match sample {
                None => sheet.text(&text, (left, y), HPos::Left, INK)?,
                Some(sample) => sheet.entry((left, y), SAMPLE, &sample, &text)?,
            }
            y += LINE;
        }
        Ok(y - TEXT / 2)
    }
}

struct PanelLayout {
    total: i32,
    margins: [i32; 2],
    panel: Point,
    columns: i32,
    /// Height that is reserved for the title above each panel, in drawing units (1/3 px).
    heading: i32,
    /// Distance from the top of a row of panels to the top of the next row, in drawing units (1/3 px).
    row: i32,
    x: Scale,
}

impl PanelLayout {
    fn of(chart: &Chart<'_>, margins: [i32; 2]) -> Self {
        let around = margins[0] + margins[1];
        let columns = chart.columns(around);
        let gaps = GAP * (columns - 1);
        let narrowest = match columns {
            1 => 1680,
            2 => 1140,
            _ => 900,
        };
        let wide = (WIDTH - around - gaps) / columns;
        let wide = wide.max(narrowest).max(chart.named_width());
        let x = chart.x.clone().fitted(wide, BESIDE);
        let titled = chart.titles.iter().any(|title| !title.is_empty());
        let heading = if titled { LINE + 12 } else { 0 };
        Self {
            total: around + columns * wide + gaps,
            margins,
            panel: (wide, PANEL_HEIGHT),
            columns,
            heading,
            row: heading + PANEL_HEIGHT + TICK_GAP + x.lines() * LINE + 30,
            x,
        }
    }
}

/// Length of a tick mark, and also the gap between the mark and its label, in drawing units (1/3 px).
const TICK: i32 = 15;
/// Width and height of the areas that the plotters library reserves for labels, in drawing units (1/3 px). Labels may
/// extend beyond these areas.
const LABELS: i32 = 60;

/// A chart of the plotters library whose axes have the type [`Scale`].
pub(crate) type Panel<'a> = ChartContext<'a, Drawing, Cartesian2d<Scale, Scale>>;

#[derive(Debug, Clone, Copy)]
pub(crate) struct Place {
    pub(crate) corner: Point,
    pub(crate) size: Point,
    /// Whether the ticks of the x axis, and of the y axis, have labels.
    pub(crate) labelled: [bool; 2],
}

impl Place {
    pub(crate) fn panel<'a>(&self, sheet: &Sheet, x: &Scale, y: &Scale) -> Drawn<Panel<'a>> {
        let [below, beside] = self.labelled.map(|labelled| LABELS * i32::from(labelled));
        let corner = (self.corner.0 - beside, self.corner.1);
        let size = (self.size.0 + beside, self.size.1 + below);
        ChartBuilder::on(&sheet.area.clone().shrink(corner, size))
            .set_label_area_size(LabelAreaPosition::Left, beside)
            .set_label_area_size(LabelAreaPosition::Bottom, below)
            .build_cartesian_2d(x.clone(), y.clone())
    }
}

/// Draws a panel's grid and outline, and the ticks of both axes with their labels.
pub(crate) fn mesh(panel: &mut Panel<'_>) -> Drawn {
    let frame = FRAME.stroke_width(HAIR);
    panel
        .configure_mesh()
        .light_line_style(FAINT.stroke_width(HAIR))
        .bold_line_style(GRID.stroke_width(HAIR))
        .axis_style(frame)
        .label_style(letters(TEXT, INK, HPos::Left))
        .set_all_tick_mark_size(TICK)
        .draw()?;
    outline(panel)
}

pub(crate) fn outline(panel: &Panel<'_>) -> Drawn {
    let area = panel.plotting_area().strip_coord_spec();
    let (wide, high) = area.dim_in_pixel();
    let corners = [(0, 0), (wide as i32, high as i32)];
    area.draw(&Rectangle::new(corners, FRAME.stroke_width(HAIR)))
}

/// Draws a vertical error bar at `x`, between the two `ends`. A bar that the marker of the point would cover completely
/// is not drawn; `hidden` is the height of this marker, in drawing units (1/3 px). An end outside the panel has no cap
/// (short cross line).
pub(crate) fn bar(panel: &Panel<'_>, x: f64, ends: [f64; 2], hidden: i32, colour: Colour) -> Drawn {
    const HALF_CAP: i32 = 12;
    let area = panel.plotting_area().use_screen_coord();
    let (_, down) = area.get_pixel_range();
    let [low, high] = ends.map(|end| panel.backend_coord(&(x, end)));
    if low.1.min(down.end) - high.1.max(down.start) <= hidden {
        return Ok(());
    }
    let style = colour.stroke_width(4);
    area.draw(&PathElement::new([low, high], style))?;
    for (x, y) in [low, high] {
        if down.contains(&y) {
            let cap = [(x - HALF_CAP, y), (x + HALF_CAP, y)];
            area.draw(&PathElement::new(cap, style))?;
        }
    }
    Ok(())
}
