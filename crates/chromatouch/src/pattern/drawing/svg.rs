//! The drawing as SVG.

use svg::Document;
use svg::node::element::{Circle, Group, Line, Polygon};

use super::layers::{CUT, FOLD, MAGENTA, YELLOW, millimetres};
use crate::CuttingSheet;

/// SVG text of a sheet whose lengths are in millimetres. SVG's y runs down the page, the sheet's up.
pub(super) fn written(sheet: &CuttingSheet) -> String {
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
