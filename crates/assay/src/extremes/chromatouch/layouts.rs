//! Layouts of markers, and the flat patterns that they are cut from.

use palpate_chromatouch::{Discs, FoldStrain, Layout, LayoutError, Pattern, PatternError};

use crate::extremes::Precise;
use crate::extremes::{Answer, Case};

/// Radii of the sensor, length.
const RADII: [f64; 5] = [1e-60, 1e-9, 1.0, 1e9, 1e60];
const NUMBERS: [(&str, f64); 6] = [
    ("NaN", f64::NAN),
    ("infinite", f64::INFINITY),
    ("-infinite", f64::NEG_INFINITY),
    ("0", 0.0),
    ("-0", -0.0),
    ("subnormal and negative", -f64::from_bits(1)),
];

pub(super) fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    for markers in [2, 3, 1000, 100_000] {
        for share in [1e-12, 0.5, 0.999_999] {
            cases.push(Case::value(
                "chromatouch::Layout::places",
                format!("{markers} markers along {share:e} of half a turn, radii 1e-60 to 1e60"),
                move || radius(markers, share),
            ));
        }
    }
    for pitch in [0.01, 0.1, 1.0, 2.0] {
        for cap_deg in [1.0, 90.0, 180.0] {
            cases.push(Case::new(
                "chromatouch::Layout::places",
                format!("lattice of pitch {pitch} radii within {cap_deg}°: markers"),
                move || lattice(pitch, cap_deg).into(),
            ));
        }
    }
    for (gores, rows) in [(1, 1), (100_000, 1), (1, 1000)] {
        cases.push(Case::value(
            "chromatouch::Layout::places",
            format!("{gores} gores of {rows} rows of a marker, but for the apex: latitudes"),
            move || gored(gores, rows),
        ));
    }
    for (name, number) in NUMBERS {
        let layouts = [
            Layout::Lattice {
                pitch: number,
                cap_deg: 60.0,
            },
            Layout::Lattice {
                pitch: 0.1,
                cap_deg: number,
            },
            Layout::Line {
                markers: 5,
                length: number,
            },
            Layout::Radius {
                markers: 5,
                length: number,
            },
            Layout::Gores {
                gores: 4,
                rows: vec![1, 2],
                row_spacing_deg: number,
            },
        ];
        for layout in layouts {
            cases.push(Case::refusal(
                "chromatouch::Layout::places",
                format!("{layout:?} ({name})"),
                move || layout.places(1.0),
            ));
        }
        cases.push(Case::refusal(
            "chromatouch::Layout::places",
            format!("radius {name}"),
            move || Layout::published().places(number),
        ));
        cases.push(Case::refusal(
            "chromatouch::Pattern::new",
            format!("radius {name}"),
            move || Pattern::new(4, 10, number),
        ));
    }
    for radius in [f64::from_bits(1), 1e-300, 1e300, f64::MAX] {
        cases.push(Case::new(
            "chromatouch::Layout::places",
            format!(
                "the published layout on a radius of {radius:e}: as many times that of radius 1"
            ),
            move || published(radius).into(),
        ));
    }
    patterns(&mut cases);
    cases
}

fn patterns(cases: &mut Vec<Case>) {
    for gores in [3, 4, 8, 360, 1_000_000, u32::MAX] {
        cases.push(Case::value(
            "chromatouch::FoldStrain::greatest",
            format!("{gores} gores"),
            move || greatest_strain(gores),
        ));
    }
    for gores in [0, 1, 2] {
        cases.push(Case::refusal(
            "chromatouch::FoldStrain::of",
            format!("{gores} gores"),
            move || FoldStrain::of(gores),
        ));
    }
    for (gores, samples) in [(3, 1), (3, 1000), (360, 1), (360, 1000)] {
        cases.push(Case::value(
            "chromatouch::Pattern::gore",
            format!(
                "{gores} gores in {samples} steps: width at the equator, radii 1e-100 to 1e100"
            ),
            move || gore(gores, samples),
        ));
    }
    for (gores, samples) in [
        (2, 10),
        (361, 10),
        (u32::MAX, 10),
        (4, 0),
        (4, 1001),
        (4, u32::MAX),
    ] {
        cases.push(Case::refusal(
            "chromatouch::Pattern::new",
            format!("{gores} gores in {samples} steps"),
            move || Pattern::new(gores, samples, 1.0),
        ));
    }
    for angle in [0.0, 1e-300, 1e-12, 0.5, 1.57, std::f64::consts::FRAC_PI_2] {
        cases.push(Case::value(
            "chromatouch::Pattern::flatten",
            format!("a place {angle:e} rad from the apex, all around: its distance from the apex"),
            move || flattened(angle),
        ));
    }
    for number in [f64::NAN, f64::INFINITY, -f64::MAX, 1.571] {
        cases.push(Case::refusal(
            "chromatouch::Pattern::flatten",
            format!("place {number:e}"),
            move || Pattern::new(4, 10, 1.0)?.flatten([number, 0.0]),
        ));
        cases.push(Case::refusal(
            "chromatouch::FoldStrain::at",
            format!("longitude {number:e}"),
            move || FoldStrain::of(4)?.at(number, 0.1),
        ));
        cases.push(Case::refusal(
            "chromatouch::CuttingSheet::svg",
            format!("disc of diameter {number:e} of the radius"),
            move || sheet(number, 1.0),
        ));
    }
    for unit_mm in [f64::NAN, 0.0, -1.0, f64::INFINITY, f64::from_bits(1)] {
        cases.push(Case::refusal(
            "chromatouch::CuttingSheet::svg",
            format!("unit of {unit_mm:e} mm"),
            move || sheet(0.1, unit_mm),
        ));
    }
    for unit_mm in [1e-12, 1e-3, 1.0, 1e3, 1e12] {
        cases.push(Case::new(
            "chromatouch::CuttingSheet::svg",
            format!("unit of {unit_mm:e} mm: whether NaN or inf is written"),
            move || sheet(0.1, unit_mm).into(),
        ));
    }
}

/// Subnormal places are whole multiples of the least number.
fn published(radius: f64) -> Result<Answer, LayoutError> {
    let [places, of_one] = [
        Layout::published().places(radius)?,
        Layout::published().places(1.0)?,
    ];
    let pairs = places
        .into_iter()
        .flatten()
        .zip(of_one.into_iter().flatten());
    let scaled = pairs.map(|(place, of_one)| (place, of_one * radius));
    Ok(Answer::all_at_scale(scaled, radius.max(f64::MIN_POSITIVE)).within(1e-14))
}

/// Positions of markers on a radius, in equal steps from the first marker to the last.
fn radius(markers: u32, share: f64) -> Result<Answer, LayoutError> {
    let mut pairs = Vec::new();
    for radius in RADII {
        let length = share * std::f64::consts::PI * radius;
        let places = Layout::Radius { markers, length }.places(radius)?;
        for marker in [0, 1, markers - 1] {
            let truth = length * f64::from(marker) / f64::from(markers - 1);
            pairs.push((places[marker as usize][0] / length, truth / length));
        }
        assert_eq!(places.len(), markers as usize, "one place each");
    }
    Ok(Answer::all_at_scale(pairs, 1.0).within(1e-15))
}

/// One marker per square of the pitch, to within one.
fn lattice(pitch: f64, cap_deg: f64) -> Result<Answer, LayoutError> {
    let half = 0.5 * f64::to_radians(cap_deg);
    let area = 4.0 * std::f64::consts::PI * libm::sin(half) * libm::sin(half);
    let mut pairs = Vec::new();
    let mut numbers = Vec::new();
    for radius in RADII {
        let layout = Layout::Lattice {
            pitch: pitch * radius,
            cap_deg,
        };
        let places = layout.places(radius)?;
        pairs.push((places.len() as f64, area / (pitch * pitch)));
        numbers.extend(places.into_iter().flatten().map(|number| number / radius));
    }
    Ok(Answer::all_at_scale(pairs, 1.0).also(numbers).within(1.0))
}

/// One marker in each row, at its latitude.
fn gored(gores: u32, rows: usize) -> Result<Answer, LayoutError> {
    let spacing = 179.0 / rows as f64;
    let rows = vec![u32::from(gores < 100_000); rows];
    let places = Layout::Gores {
        gores,
        rows,
        row_spacing_deg: spacing,
    }
    .places(1.0)?;
    let latitudes = places.iter().enumerate().map(|(row, [x, y])| {
        let truth = (row as f64 * spacing).to_radians();
        (libm::hypot(*x, *y), truth)
    });
    Ok(Answer::all_at_scale(latitudes, 1.0).within(1e-14))
}

/// σ − 1 of the shear s = π/n, where σ = s/2 + √(1 + s²/4).
fn greatest_strain(gores: u32) -> Result<Answer, PatternError> {
    let half = Precise::pi() / Precise::new(2.0 * f64::from(gores));
    let truth = (&half + (half.squared() + 1.0).sqrt() - 1.0).to_f64();
    let strain = FoldStrain::of(gores)?;
    let edge = strain.at(
        std::f64::consts::PI / f64::from(gores),
        std::f64::consts::FRAC_PI_2,
    )?;
    Ok(
        Answer::all_near([(strain.greatest(), truth), (edge, truth)])
            .within(1e-15)
            .also([strain.rms()]),
    )
}

/// Half the width of a gore at the equator, which is πR/n.
fn gore(gores: u32, samples: u32) -> Result<Answer, PatternError> {
    let mut pairs = Vec::new();
    let mut numbers = Vec::new();
    for radius in [1e-100, 1.0, 1e100] {
        let outline = Pattern::new(gores, samples, radius)?.gore();
        let truth = Precise::pi() * radius / Precise::new(f64::from(gores));
        pairs.push((outline[0][0], truth.to_f64()));
        numbers.extend(outline.into_iter().flatten());
    }
    Ok(Answer::all_near(pairs).also(numbers).within(1e-15))
}

fn flattened(angle: f64) -> Result<Answer, PatternError> {
    let mut pairs = Vec::new();
    let mut numbers = Vec::new();
    for radius in [1e-90, 1.0, 1e90] {
        let pattern = Pattern::new(5, 10, radius)?;
        for (sine, cosine) in [0.0_f64, 1.0, 2.513, -3.0].map(libm::sincos) {
            let reach = angle * radius;
            let flat = pattern.flatten([reach * cosine, reach * sine]);
            // Rounding may take a place on the equator beyond it.
            let Ok(flat) = flat else { continue };
            numbers.extend([flat.across, flat.assembled[0], flat.assembled[1]]);
            pairs.push((flat.from_apex / radius, angle));
        }
    }
    Ok(Answer::all_at_scale(pairs, angle.max(1e-200))
        .within(1e-15)
        .also(numbers))
}

fn sheet(diameter: f64, unit_mm: f64) -> Result<Answer, PatternError> {
    let layout = Layout::Gores {
        gores: 4,
        rows: vec![1, 1],
        row_spacing_deg: 20.0,
    };
    let discs = Discs {
        magenta: diameter,
        yellow: diameter,
    };
    let sheet = Pattern::new(4, 10, 1.0)?.sheet(&layout, discs)?;
    let (svg, dxf) = (sheet.svg(unit_mm)?, sheet.dxf(unit_mm)?);
    let is_bad = |text: &str| text.contains("NaN") || text.contains("inf");
    Ok(Answer::at_scale(
        f64::from(u8::from(is_bad(&svg) || is_bad(&dxf))),
        0.0,
        1.0,
    ))
}
