//! Draws a cutting sheet as SVG and DXF files.

use svg::Document;
use svg::node::element::{Circle, Group, Line, Polygon};

use super::{CuttingSheet, PatternError};

/// Drawing layer of the gores' outlines.
const CUT: &str = "CUT";
/// Drawing layer of the middle meridians and the seam marks.
const FOLD: &str = "FOLD";
/// Drawing layer of the inner (magenta) discs.
const MAGENTA: &str = "MAGENTA";
/// Drawing layer of the outer (yellow) discs.
const YELLOW: &str = "YELLOW";

/// Drawing layers with their colour numbers in AutoCAD: white (black on paper), blue, magenta, yellow.
const LAYERS: [(&str, u8); 4] = [(CUT, 7), (FOLD, 5), (MAGENTA, 6), (YELLOW, 2)];

/// Smallest and largest allowed radius (mm) of the sphere whose pattern is drawn. The limits follow from the resolution
/// of the files: coordinates are written in steps of 1e-6 mm.
const DRAWABLE_MM: [f64; 2] = [0.01, 1e6];

impl CuttingSheet {
    /// The drawing as SVG in millimetres. The y axis points up the page. The SVG groups are `CUT`, `FOLD`, `MAGENTA`
    /// and `YELLOW`. `unit_mm` is the pattern's unit of length in millimetres.
    ///
    /// # Errors
    /// [`PatternError::NotDrawable`] if the drawing is too small or too large.
    pub fn svg(&self, unit_mm: f64) -> Result<String, PatternError> {
        Ok(svg_text(&self.in_millimetres(unit_mm)?))
    }

    /// The drawing as DXF R12 in millimetres, with the layers `CUT`, `FOLD`, `MAGENTA` and `YELLOW`. `unit_mm` is the
    /// pattern's unit of length in millimetres.
    ///
    /// # Errors
    /// [`PatternError::NotDrawable`] if the drawing is too small or too large.
    pub fn dxf(&self, unit_mm: f64) -> Result<String, PatternError> {
        Ok(DxfWriter::text_of(&self.in_millimetres(unit_mm)?))
    }

    fn in_millimetres(&self, unit_mm: f64) -> Result<Self, PatternError> {
        let radius_mm = self.radius() * unit_mm;
        let [least, most] = DRAWABLE_MM;
        if (least..=most).contains(&radius_mm) {
            return Ok(self.scaled(unit_mm));
        }
        Err(PatternError::NotDrawable {
            radius_mm,
            least,
            most,
        })
    }
}

fn millimetres(value: f64) -> String {
    let text = format!("{value:.6}");
    match text.strip_prefix('-') {
        Some(size) if size.bytes().all(|byte| matches!(byte, b'0' | b'.')) => size.to_owned(),
        _ => text,
    }
}

/// SVG text of a cutting sheet whose lengths are in millimetres. The y axis of SVG points down the page, while the y
/// axis of the sheet points up.
fn svg_text(sheet: &CuttingSheet) -> String {
    let half_side = sheet.half_side();
    let corner = millimetres(-half_side);
    let side = millimetres(2.0 * half_side);
    Document::new()
        .set("width", format!("{side}mm"))
        .set("height", format!("{side}mm"))
        .set("viewBox", format!("{corner} {corner} {side} {side}"))
        .add(discs(sheet, YELLOW, sheet.discs().yellow).set("fill", "yellow"))
        .add(discs(sheet, MAGENTA, sheet.discs().magenta).set("fill", "magenta"))
        .add(marks(sheet))
        .add(cuts(sheet))
        .to_string()
}

fn discs(sheet: &CuttingSheet, layer: &str, diameter: f64) -> Group {
    let group = Group::new().set("id", layer).set("fill-opacity", "0.5");
    sheet.centres().iter().fold(group, |group, [x, y]| {
        let disc = Circle::new()
            .set("cx", millimetres(*x))
            .set("cy", millimetres(-y))
            .set("r", millimetres(0.5 * diameter));
        group.add(disc)
    })
}

fn lines(sheet: &CuttingSheet, layer: &str, colour: &str) -> Group {
    Group::new()
        .set("id", layer)
        .set("fill", "none")
        .set("stroke", colour)
        .set("stroke-width", millimetres(0.005 * sheet.radius()))
}

fn marks(sheet: &CuttingSheet) -> Group {
    let group = lines(sheet, FOLD, "blue");
    sheet.marks().iter().fold(group, |group, [[x, y], [u, v]]| {
        let mark = Line::new()
            .set("x1", millimetres(*x))
            .set("y1", millimetres(-y))
            .set("x2", millimetres(*u))
            .set("y2", millimetres(-v));
        group.add(mark)
    })
}

fn cuts(sheet: &CuttingSheet) -> Group {
    let group = lines(sheet, CUT, "black");
    sheet.cuts().iter().fold(group, |group, outline| {
        let points: Vec<String> = outline
            .iter()
            .map(|[x, y]| format!("{},{}", millimetres(*x), millimetres(-y)))
            .collect();
        group.add(Polygon::new().set("points", points.join(" ")))
    })
}

/// Writer of DXF R12 files, which consist of pairs of lines: a group code and its value.
#[derive(Default)]
struct DxfWriter {
    text: String,
}

impl DxfWriter {
    fn text_of(sheet: &CuttingSheet) -> String {
        let mut writer = Self::default();
        writer.header(sheet.half_side());
        writer.layers();
        writer.entities(sheet);
        writer.pair(0, "EOF");
        writer.text
    }

    fn pair(&mut self, code: u16, value: &str) {
        self.text.push_str(&format!("{code:>3}\n{value}\n"));
    }

    fn section(&mut self, name: &str) {
        self.pair(0, "SECTION");
        self.pair(2, name);
    }

    /// Writes a point. The coordinates of an entity's first point have the group codes 10 and 20, those of the second
    /// point 11 and 21.
    fn place(&mut self, code: u16, [x, y]: [f64; 2]) {
        self.pair(code, &millimetres(x));
        self.pair(code + 10, &millimetres(y));
    }

    fn entity(&mut self, kind: &str, layer: &str) {
        self.pair(0, kind);
        self.pair(8, layer);
    }

    fn header(&mut self, half_side: f64) {
        self.pair(999, "Lengths in millimetres");
        self.section("HEADER");
        self.pair(9, "$ACADVER");
        self.pair(1, "AC1009");
        for (variable, corner) in [("$EXTMIN", -half_side), ("$EXTMAX", half_side)] {
            self.pair(9, variable);
            self.place(10, [corner; 2]);
        }
        self.pair(0, "ENDSEC");
    }

    fn layers(&mut self) {
        self.section("TABLES");
        self.pair(0, "TABLE");
        self.pair(2, "LTYPE");
        self.pair(70, "1");
        self.pair(0, "LTYPE");
        for (code, value) in [(2, "CONTINUOUS"), (70, "0"), (3, "Solid line")] {
            self.pair(code, value);
        }
        // These DXF group codes and values define a line type: alignment "A", no dashes, pattern length 0.
        for (code, value) in [(72, "65"), (73, "0"), (40, "0.0"), (0, "ENDTAB")] {
            self.pair(code, value);
        }
        self.pair(0, "TABLE");
        self.pair(2, "LAYER");
        self.pair(70, &LAYERS.len().to_string());
        for (layer, colour) in LAYERS {
            self.pair(0, "LAYER");
            self.pair(2, layer);
            self.pair(70, "0");
            self.pair(62, &colour.to_string());
            self.pair(6, "CONTINUOUS");
        }
        self.pair(0, "ENDTAB");
        self.pair(0, "ENDSEC");
    }

    fn entities(&mut self, sheet: &CuttingSheet) {
        self.section("ENTITIES");
        for outline in sheet.cuts() {
            self.closed_line(outline);
        }
        for [start, end] in sheet.marks() {
            self.entity("LINE", FOLD);
            self.place(10, *start);
            self.place(11, *end);
        }
        for (layer, diameter) in [
            (MAGENTA, sheet.discs().magenta),
            (YELLOW, sheet.discs().yellow),
        ] {
            for centre in sheet.centres() {
                self.entity("CIRCLE", layer);
                self.place(10, *centre);
                self.pair(40, &millimetres(0.5 * diameter));
            }
        }
        self.pair(0, "ENDSEC");
    }

    fn closed_line(&mut self, outline: &[[f64; 2]]) {
        self.entity("POLYLINE", CUT);
        // These DXF group codes and values define a closed polyline at the elevation 0, whose vertices follow.
        self.pair(66, "1");
        self.place(10, [0.0, 0.0]);
        self.pair(30, "0.0");
        self.pair(70, "1");
        for corner in outline {
            self.entity("VERTEX", CUT);
            self.place(10, *corner);
        }
        self.entity("SEQEND", CUT);
    }
}
