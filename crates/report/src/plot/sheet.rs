//! The sheet on which a figure is drawn. Title, subtitle and key (legend) are above the figure's content, and the notes
//! are below it.

use super::drawing::{Drawing, Figure, LEADING};
use super::lettering::{width, wrap};
use super::style::{Colour, FRAME, INK, QUIET};
use super::symbol::{Placed, Symbol};
use crate::ReportError;
use plotters::coord::Shift;
use plotters::drawing::{DrawingArea, DrawingAreaErrorKind};
use plotters::element::{DashedPathElement, PathElement, Rectangle};
use plotters::style::text_anchor::{HPos, Pos, VPos};
use plotters::style::{Color, FontDesc, FontFamily, ShapeStyle, TextStyle};
use std::cell::RefCell;
use std::convert::Infallible;
use std::rc::Rc;
use std::vec;

// All lengths are in drawing units, which are 1/3 of a pixel.

/// Font size of the title, in drawing units (1/3 px).
const TITLE: i32 = 75;
/// Font size of all text except the title, in drawing units (1/3 px).
pub(crate) const TEXT: i32 = 54;
/// Distance between lines of text, in drawing units (1/3 px).
pub(crate) const LINE: i32 = 73;
/// Margin around the figure, in drawing units (1/3 px).
pub(crate) const EDGE: i32 = 66;
/// Gap between a panel and the labels of its ticks, in drawing units (1/3 px).
pub(crate) const TICK_GAP: i32 = 30;
/// Gap between a symbol of a key (legend) and its text, in drawing units (1/3 px).
pub(crate) const SAMPLE_GAP: i32 = 24;
/// Horizontal gap between entries of a key (legend), in drawing units (1/3 px).
const ENTRY_GAP: i32 = 78;
/// Smallest width of a figure, in drawing units (1/3 px).
pub(crate) const WIDTH: i32 = 2880;
/// Width of thin lines, such as grid lines, in drawing units (1/3 px).
pub(crate) const HAIR: u32 = 3;
/// Width of lines that show data, in drawing units (1/3 px).
pub(crate) const STROKE: u32 = 8;
/// Radius of markers, in drawing units (1/3 px).
pub(crate) const MARKER: f64 = 18.0;
/// Length of dashes, in drawing units (1/3 px).
const DASH: i32 = 24;
/// Length of the gaps between dashes, in drawing units (1/3 px).
const DASH_GAP: i32 = 15;

pub(crate) type Drawn<T = ()> = Result<T, DrawingAreaErrorKind<Infallible>>;
/// A position in drawing units (1/3 px), from the upper left corner.
pub(crate) type Point = (i32, i32);

/// Texts above and below the content of a figure.
#[derive(Debug, Clone, Default)]
pub(crate) struct Words {
    /// Name of the figure's files, without extension.
    pub(crate) name: String,
    pub(crate) title: String,
    pub(crate) subtitle: String,
    /// Lines of text below the content of the figure, for example about points that are not drawn.
    pub(crate) notes: Vec<String>,
}

impl Words {
    pub(crate) fn new(name: &str, title: &str, subtitle: &str, notes: &[String]) -> Self {
        Self {
            name: name.to_owned(),
            title: title.to_owned(),
            subtitle: subtitle.to_owned(),
            notes: notes.to_vec(),
        }
    }
}

pub(crate) struct Sheet {
    drawing: Rc<RefCell<Drawing>>,
    pub(crate) area: DrawingArea<Drawing, Shift>,
    pub(crate) width: i32,
    /// Distance from the top of the sheet to the lower edge of everything that is already drawn, in drawing units
    /// (1/3 px).
    pub(crate) top: i32,
}

/// Symbol beside a text of a key (legend). It consists of a filled rectangle, a line on the rectangle, and a marker on
/// the line. Each part may be missing.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Sample {
    pub(crate) ground: Option<Colour>,
    pub(crate) line: Option<ShapeStyle>,
    pub(crate) is_dashed: bool,
    pub(crate) symbol: Option<Symbol>,
}

/// Entries of a key (legend): symbol and text of each entry.
pub(crate) type Key = Vec<(Sample, String)>;

/// Draws a figure from top to bottom: title and subtitle, then the content, then the notes. The function `draw` draws
/// the content.
pub(crate) fn figure(
    words: Words,
    width: i32,
    draw: impl FnOnce(&mut Sheet) -> Drawn,
) -> Result<Figure, ReportError> {
    // The width is rounded up to whole pixels.
    let width = width.unsigned_abs().next_multiple_of(3) as i32;
    let drawing = Rc::new(RefCell::new(Drawing::new(width)));
    let mut sheet = Sheet {
        area: DrawingArea::from(&drawing),
        drawing,
        width,
        top: EDGE,
    };
    let drawn = sheet.around(&words, draw);
    drawn.map_err(|error| ReportError::Draw {
        path: format!("{}.svg", words.name).into(),
        message: error.to_string(),
    })?;
    let mut drawing = sheet.drawing.borrow().clone();
    drawing.size.1 = (sheet.top + EDGE - 18).unsigned_abs().next_multiple_of(3);
    Figure::new(words.name, words.title, drawing)
}

/// Style of a text with this colour, centred vertically on its position.
pub(crate) fn letters(em: i32, colour: Colour, horizontal: HPos) -> TextStyle<'static> {
    let font = FontDesc::from((FontFamily::SansSerif, em));
    font.color(&colour).pos(Pos::new(horizontal, VPos::Center))
}

pub(crate) fn dashed<C: Clone>(
    points: Vec<C>,
    style: ShapeStyle,
) -> DashedPathElement<vec::IntoIter<C>, i32> {
    DashedPathElement::new(points, DASH, DASH_GAP, style)
}

impl Sheet {
    fn around(&mut self, words: &Words, draw: impl FnOnce(&mut Self) -> Drawn) -> Drawn {
        self.paragraph(&words.title, TITLE, INK)?;
        self.paragraph(&words.subtitle, TEXT, QUIET)?;
        draw(self)?;
        if !words.notes.is_empty() {
            self.top += 30;
        }
        let mut notes = words.notes.iter();
        notes.try_for_each(|note| self.paragraph(note, TEXT, QUIET))
    }

    fn paragraph(&mut self, text: &str, em: i32, colour: Colour) -> Drawn {
        for line in wrap(text, em, self.width - 2 * EDGE) {
            let place = (EDGE, self.top + em / 2);
            let style = letters(em, colour, HPos::Left);
            self.area.draw_text(&line, &style, place)?;
            self.top += (f64::from(em) * LEADING) as i32;
        }
        Ok(())
    }

    pub(crate) fn text(&self, text: &str, place: Point, anchor: HPos, colour: Colour) -> Drawn {
        self.area
            .draw_text(text, &letters(TEXT, colour, anchor), place)
    }

    pub(crate) fn path(&self, points: Vec<Point>, style: ShapeStyle) -> Drawn {
        self.area.draw(&PathElement::new(points, style))
    }

    pub(crate) fn heading(&mut self, text: &str, left: i32, limit: i32) -> Drawn {
        for line in wrap(text, TEXT, limit) {
            self.text(&line, (left, self.top + TEXT / 2), HPos::Left, INK)?;
            self.top += LINE;
        }
        Ok(())
    }

    /// Draws the entries of a key (legend) side by side, in as many lines as necessary. The symbol of each entry is
    /// `sample` wide.
    pub(crate) fn key(&mut self, sample: i32, entries: &Key) -> Drawn {
        self.top += 36;
        let mut x = EDGE;
        for (kind, text) in entries {
            let wide = sample + SAMPLE_GAP + width(text, TEXT);
            if x > EDGE && x + wide > self.width - EDGE {
                (x, self.top) = (EDGE, self.top + LINE + 12);
            }
            self.entry((x, self.top + TEXT / 2), sample, kind, text)?;
            x += wide + ENTRY_GAP;
        }
        if !entries.is_empty() {
            self.top += TEXT / 2 + 80;
        }
        Ok(())
    }

    /// Draws an entry of a key (legend): the symbol `sample` and, to its right, the text. The symbol has the width
    /// `wide` and its left end at (x, y).
    pub(crate) fn entry(&self, (x, y): Point, wide: i32, sample: &Sample, text: &str) -> Drawn {
        if let Some(ground) = sample.ground {
            let corners = [(x, y - TEXT / 2), (x + wide, y + TEXT / 2)];
            self.area.draw(&Rectangle::new(corners, ground.filled()))?;
            self.area
                .draw(&Rectangle::new(corners, FRAME.stroke_width(HAIR)))?;
        }
        let ends = vec![(x, y), (x + wide, y)];
        match sample.line {
            Some(style) if sample.is_dashed => self.area.draw(&dashed(ends, style))?,
            Some(style) => self.path(ends, style)?,
            None => {}
        }
        if let Some(symbol) = sample.symbol {
            self.area.draw(&Placed((x + wide / 2, y), symbol))?;
        }
        self.text(text, (x + wide + SAMPLE_GAP, y), HPos::Left, INK)
    }

    /// Sets the tooltip of the shape that was drawn last.
    pub(crate) fn title(&self, words: &str) {
        self.drawing.borrow_mut().title(words);
    }
}

impl Sample {
    pub(crate) fn ground(colour: Colour) -> Self {
        Self {
            ground: Some(colour),
            ..Self::default()
        }
    }

    pub(crate) fn line(style: ShapeStyle) -> Self {
        Self {
            line: Some(style),
            ..Self::default()
        }
    }

    pub(crate) fn dashed(style: ShapeStyle) -> Self {
        Self {
            is_dashed: true,
            ..Self::line(style)
        }
    }

    pub(crate) fn symbol(symbol: Symbol) -> Self {
        Self {
            symbol: Some(symbol),
            ..Self::default()
        }
    }

    pub(crate) fn with(self, symbol: Symbol) -> Self {
        Self {
            symbol: Some(symbol),
            ..self
        }
    }
}
