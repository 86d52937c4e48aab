//! The drawing as DXF R12: pairs of lines, a group code and its value.

use super::layers::{CUT, FOLD, MAGENTA, YELLOW, millimetres};
use crate::CuttingSheet;

/// Layers with AutoCAD's numbers of their colours: white (black on paper), blue, magenta, yellow.
const LAYERS: [(&str, u8); 4] = [(CUT, 7), (FOLD, 5), (MAGENTA, 6), (YELLOW, 2)];

#[derive(Default)]
struct Writer {
    text: String,
}

/// DXF text of a sheet whose lengths are in millimetres.
pub(super) fn written(sheet: &CuttingSheet) -> String {
    let mut writer = Writer::default();
    writer.header(sheet.half_side());
    writer.layers();
    writer.entities(sheet);
    writer.pair(0, "EOF");
    writer.text
}

impl Writer {
    fn pair(&mut self, code: u16, value: &str) {
        self.text.push_str(&format!("{code:>3}\n{value}\n"));
    }

    fn section(&mut self, name: &str) {
        self.pair(0, "SECTION");
        self.pair(2, name);
    }

    /// Codes 10 and 20 for a place, 11 and 21 for a second one.
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
        // Alignment "A", no dashes, pattern length 0.
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
        // Vertices follow; elevation 0; closed.
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
