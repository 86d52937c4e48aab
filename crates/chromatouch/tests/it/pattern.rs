//! Tests cutting sheets and the SVG and DXF files of their drawings.

use std::collections::BTreeMap;
use std::f64::consts::{FRAC_PI_2, PI};

use approx::assert_relative_eq;
use palpate_chromatouch::{CuttingSheet, Discs, Layout, Pattern};
use svg::node::element::tag::Type;
use svg::parser::Event;

use crate::optics::discs;

/// Diameters of the discs, cm.
const DISCS: Discs = discs(0.2, 0.15);

fn published() -> CuttingSheet {
    let pattern = Pattern::new(4, 40, 2.0).unwrap();
    pattern.sheet(&Layout::published(), DISCS).unwrap()
}

fn rows(gores: u32, rows: &[u32], row_spacing_deg: f64) -> Layout {
    Layout::Gores {
        gores,
        rows: rows.to_vec(),
        row_spacing_deg,
    }
}

fn area(outline: &[[f64; 2]]) -> f64 {
    let next = outline.iter().cycle().skip(1);
    let sides = outline.iter().zip(next);
    sides.map(|([x, y], [u, v])| 0.5 * (x * v - u * y)).sum()
}

fn length([[x, y], [u, v]]: [[f64; 2]; 2]) -> f64 {
    libm::hypot(u - x, v - y)
}

/// A drawing that was read from a file. Coordinates are in millimetres, and y points up.
#[derive(Default)]
struct Drawing {
    outlines: Vec<Vec<[f64; 2]>>,
    lines: Vec<[[f64; 2]; 2]>,
    circles: BTreeMap<String, Vec<([f64; 2], f64)>>,
}

fn read_svg(text: &str) -> (Drawing, [f64; 4], Vec<String>) {
    let mut drawing = Drawing::default();
    let mut frame = [f64::NAN; 4];
    let mut open: Vec<String> = Vec::new();
    let mut layers = Vec::new();
    for event in svg::read(text).unwrap() {
        let Event::Tag(name, kind, attributes) = event else {
            continue;
        };
        if matches!(kind, Type::End) {
            assert_eq!(open.pop().as_deref(), Some(name));
            continue;
        }
        let text = |key: &str| attributes[key].to_string();
        let number = |key: &str| text(key).parse::<f64>().unwrap();
        let layer = layers.last().cloned().unwrap_or_default();
        match name {
            "svg" => {
                let numbers = text("viewBox");
                let mut numbers = numbers.split(' ').map(|word| word.parse().unwrap());
                frame = [(); 4].map(|()| numbers.next().unwrap());
                for (size, side) in [("width", frame[2]), ("height", frame[3])] {
                    let size: f64 = text(size).strip_suffix("mm").unwrap().parse().unwrap();
                    assert_eq!(size, side);
                }
            }
            "g" => layers.push(text("id")),
            "polygon" => {
                assert_eq!(layer, "CUT");
                let corner = |word: &str| {
                    let (x, y) = word.split_once(',').unwrap();
                    [x.parse().unwrap(), -y.parse::<f64>().unwrap()]
                };
                drawing
                    .outlines
                    .push(text("points").split(' ').map(corner).collect());
            }
            "line" => {
                assert_eq!(layer, "FOLD");
                let end = |x: &str, y: &str| [number(x), -number(y)];
                drawing.lines.push([end("x1", "y1"), end("x2", "y2")]);
            }
            "circle" => {
                let centre = [number("cx"), -number("cy")];
                let circles = drawing.circles.entry(layer).or_default();
                circles.push((centre, number("r")));
            }
            other => panic!("{other}"),
        }
        if matches!(kind, Type::Start) {
            open.push(name.to_owned());
        }
    }
    assert!(open.is_empty());
    (drawing, frame, layers)
}

/// Entities of a DXF file, as group codes and values. Checks that all sections are closed.
fn entities(text: &str) -> Vec<Vec<(u16, &str)>> {
    let lines: Vec<&str> = text.lines().collect();
    assert_eq!(lines.len() % 2, 0);
    let pairs = lines
        .chunks(2)
        .map(|pair| (pair[0].trim().parse().unwrap(), pair[1]));
    let mut groups: Vec<Vec<(u16, &str)>> = Vec::new();
    for pair in pairs {
        if pair.0 == 0 {
            groups.push(Vec::new());
        }
        if let Some(group) = groups.last_mut() {
            group.push(pair);
        }
    }
    let kind = |group: &[(u16, &str)], name: &str| group[0].1 == name;
    let count = |name: &str| groups.iter().filter(|group| kind(group, name)).count();
    assert_eq!((count("SECTION"), count("ENDSEC")), (3, 3));
    assert_eq!((count("TABLE"), count("ENDTAB")), (2, 2));
    assert_eq!(groups.last().unwrap(), &[(0, "EOF")]);
    let start = groups
        .iter()
        .position(|group| group.contains(&(2, "ENTITIES")));
    groups[start.unwrap() + 1..groups.len() - 2].to_vec()
}

fn read_dxf(text: &str) -> Drawing {
    let mut drawing = Drawing::default();
    for entity in entities(text) {
        let value = |code: u16| entity.iter().find(|pair| pair.0 == code).unwrap().1;
        let number = |code: u16| value(code).parse::<f64>().unwrap();
        let place = |code: u16| [number(code), number(code + 10)];
        match (entity[0].1, entity.get(1).map(|layer| layer.1)) {
            ("POLYLINE", Some("CUT")) => {
                assert_eq!((value(66), value(70)), ("1", "1"));
                drawing.outlines.push(Vec::new());
            }
            ("VERTEX", Some("CUT")) => drawing.outlines.last_mut().unwrap().push(place(10)),
            ("SEQEND", Some("CUT")) => {}
            ("LINE", Some("FOLD")) => drawing.lines.push([place(10), place(11)]),
            ("CIRCLE", Some(layer)) => {
                let circles = drawing.circles.entry(layer.to_owned()).or_default();
                circles.push((place(10), number(40)));
            }
            other => panic!("{other:?}"),
        }
    }
    drawing
}

#[test]
fn svg_draws_the_sheet_in_millimetres() {
    let text = published().svg(10.0).unwrap();
    assert_eq!(text, published().svg(10.0).unwrap());
    let (drawing, _, layers) = read_svg(&text);
    assert_eq!(layers, ["YELLOW", "MAGENTA", "FOLD", "CUT"]);
    assert_eq!(drawing.outlines.len(), 4);
    for outline in &drawing.outlines {
        // The four gores (flat pieces of the skin) cover a hemisphere, so the area of a gore is a quarter of 2πR². It
        // is corrected, because the drawn outline of a gore has 40 straight steps per quarter circle.
        let half_step: f64 = PI / 160.0;
        let expected = 2.0 * PI * 400.0 / 4.0 * half_step / libm::tan(half_step);
        assert_relative_eq!(area(outline), expected, max_relative = 1e-6);
        let touches_apex = outline
            .iter()
            .filter(|place| place.map(f64::abs) == [0.0; 2]);
        assert_eq!(touches_apex.count(), 1);
    }
    // On each gore (flat piece of the skin), a middle meridian and four marks are drawn. The length of the meridian is
    // a quarter circle.
    assert_eq!(drawing.lines.len(), 20);
    let meridians = drawing.lines.iter().step_by(5);
    for meridian in meridians {
        assert_relative_eq!(length(*meridian), 10.0 * PI, epsilon = 1e-5);
    }
    assert_eq!(drawing.circles.len(), 2);
    for (circles, radius) in drawing.circles.values().zip([1.0, 0.75]) {
        assert_eq!(circles.len(), 77);
        assert!(circles.iter().all(|(_, drawn)| *drawn == radius));
        // The first marker is at the apex. The second marker is 11.9° from the apex, in the middle of the first gore
        // (flat piece of the skin).
        assert_eq!(circles[0].0, [0.0; 2]);
        let along = 20.0 * 11.9_f64.to_radians() * 0.5_f64.sqrt();
        assert_relative_eq!(circles[1].0[..], [along; 2][..], epsilon = 1e-6);
    }
}

#[test]
fn dxf_draws_the_same_as_svg() {
    let text = published().dxf(10.0).unwrap();
    assert_eq!(text, published().dxf(10.0).unwrap());
    assert!(!text.contains("-0.000000"));
    for line in ["AC1009", "CUT", "FOLD", "MAGENTA", "YELLOW"] {
        assert!(text.lines().any(|other| other == line));
    }
    let dxf = read_dxf(&text);
    let (svg, _, _) = read_svg(&published().svg(10.0).unwrap());
    assert_eq!(svg.outlines, dxf.outlines);
    assert_eq!(svg.lines, dxf.lines);
    assert_eq!(svg.circles, dxf.circles);
}

/// Seam marks begin on the edges of the gores and run along parallels, so that they meet when the pattern is folded.
#[test]
fn seam_marks_begin_on_the_drawn_edges() {
    for samples in [1, 2, 3, 7] {
        let pattern = Pattern::new(3, samples, 2.0).unwrap();
        let sheet = pattern.sheet(&rows(3, &[], 15.0), DISCS).unwrap();
        let (drawing, _, _) = read_svg(&sheet.svg(1.0).unwrap());
        let outline = &drawing.outlines[0];
        for (count, [start, end]) in drawing.lines[1..5].iter().enumerate() {
            let next = outline.iter().cycle().skip(1);
            let nearest = outline
                .iter()
                .zip(next)
                .map(|(from, to)| off_segment(*start, *from, *to))
                .fold(f64::INFINITY, f64::min);
            assert!(nearest < 2e-6, "{samples}: {nearest}");
            // The marks are at one third and two thirds of the middle meridian of the gore (flat piece of the skin),
            // whose length is a quarter circle. Here, the middle meridian is at 60° from +x.
            let (sin, cos) = libm::sincos(PI / 3.0);
            let share = if count < 2 { 1.0 / 3.0 } else { 2.0 / 3.0 };
            let across = |[x, y]: [f64; 2]| y * cos - x * sin;
            assert_relative_eq!(across(*end), 0.95 * across(*start), epsilon = 4e-6);
            for [x, y] in [start, end] {
                let along = x * cos + y * sin;
                assert_relative_eq!(along, share * 2.0 * FRAC_PI_2, epsilon = 4e-6);
            }
        }
    }
}

fn off_segment([x, y]: [f64; 2], [u, v]: [f64; 2], [s, t]: [f64; 2]) -> f64 {
    let along = ((x - u) * (s - u) + (y - v) * (t - v)) / ((s - u).powi(2) + (t - v).powi(2));
    let along = along.clamp(0.0, 1.0);
    libm::hypot(x - u - along * (s - u), y - v - along * (t - v))
}

/// The diameter of the discs may be as large as the smallest distance between two centres. The test finds this distance
/// by comparing all pairs.
#[test]
fn discs_overlap_from_the_least_distance_on() {
    let pattern = Pattern::new(4, 40, 2.0).unwrap();
    let sheet = |layout: &Layout, diameter| {
        let discs = discs(0.5 * diameter, diameter);
        pattern.sheet(layout, discs)
    };
    for markers in [&[1][..], &[1, 5, 5], &[0, 3, 9]] {
        let layout = rows(4, markers, 15.0);
        let (small, _, _) = read_svg(&sheet(&layout, 1e-3).unwrap().svg(1.0).unwrap());
        let discs = &small.circles["YELLOW"];
        let pairs = discs.iter().enumerate().flat_map(|(count, first)| {
            let others = discs[..count].iter();
            others.map(|second| length([first.0, second.0]))
        });
        let least = pairs.fold(f64::INFINITY, f64::min);
        let overlap =
            |diameter| sheet(&layout, diameter).is_err_and(|e| <&str>::from(&e) == "discs-overlap");
        assert!(overlap(1.0001 * least));
        assert!(!overlap(0.9999 * least));
    }
}

#[test]
fn sheets_that_do_not_fit_are_named() {
    let pattern = Pattern::new(4, 40, 20.0).unwrap();
    let alike = |diameter| discs(diameter, diameter);
    for (layout, discs, name) in [
        (Layout::published(), alike(0.0), "bad-setting"),
        (Layout::published(), alike(f64::NAN), "bad-setting"),
        (Layout::published(), alike(f64::INFINITY), "bad-setting"),
        // The distance between neighbours is smallest in the last row of the published layout, which has seven markers:
        // 3.87 mm. In the first row of three markers, the outer markers are 1.71 mm from the edge of the gore (flat
        // piece of the skin).
        (Layout::published(), alike(4.2), "discs-overlap"),
        (Layout::published(), alike(1e300), "discs-overlap"),
        (Layout::published(), alike(3.43), "disc-across-edge"),
        (rows(4, &[1; 4], 25.0), alike(2.0), "beyond-the-equator"),
        (rows(4, &[1], 89.0), alike(2.0), "disc-across-edge"),
        (rows(4, &[], 10.0), alike(63.0), "disc-across-edge"),
        // The layout has two gores (flat pieces of the skin), but the pattern has four. So the marker in the middle of
        // a gore of the layout lies on a seam of the pattern.
        (rows(2, &[1], 30.0), alike(0.1), "disc-across-edge"),
        (rows(0, &[1], 30.0), alike(0.1), "bad-setting"),
        (rows(4, &[1, 1], 90.0), alike(0.1), "around-the-sphere"),
    ] {
        let error = pattern.sheet(&layout, discs).unwrap_err();
        assert_eq!(<&str>::from(&error), name, "{error}");
    }
    pattern.sheet(&Layout::published(), alike(3.4)).unwrap();
    assert!(pattern.sheet(&Layout::published(), alike(1e-300)).is_ok());
    let sheet = published();
    for unit_mm in [0.0, -1.0, 1e-9, 1e9, f64::NAN, f64::INFINITY] {
        assert_eq!(
            <&str>::from(sheet.svg(unit_mm).unwrap_err()),
            "not-drawable"
        );
        assert_eq!(
            <&str>::from(sheet.dxf(unit_mm).unwrap_err()),
            "not-drawable"
        );
    }
}
