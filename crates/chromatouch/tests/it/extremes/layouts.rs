//! Layouts of markers, and the flat patterns that they are cut from.

use std::f64::consts::{FRAC_PI_2, PI};

use palpate_chromatouch::{
    Discs, FlatPlace, FoldStrain, Layout, LayoutError, Pattern, PatternError,
};
use palpate_verdict::{Answer, Precise, rows};

const PLACES: &str = "chromatouch::Layout::places";
const PATTERN: &str = "chromatouch::Pattern::new";
const FLATTEN: &str = "chromatouch::Pattern::flatten";
const SVG: &str = "chromatouch::CuttingSheet::svg";
/// Radii of the sensor, length.
const RADII: [f64; 5] = [1e-60, 1e-9, 1.0, 1e9, 1e60];
const LEAST: f64 = f64::from_bits(1);
const NO_LENGTHS: [f64; 6] = [
    f64::NAN,
    f64::INFINITY,
    f64::NEG_INFINITY,
    0.0,
    -0.0,
    -LEAST,
];
const BEYOND: [f64; 4] = [f64::NAN, f64::INFINITY, -f64::MAX, 1.571];
/// Layouts of which one setting is open.
const LAYOUTS: [fn(f64) -> Layout; 5] = [
    |pitch| Layout::Lattice {
        pitch,
        cap_deg: 60.0,
    },
    |cap_deg| Layout::Lattice {
        pitch: 0.1,
        cap_deg,
    },
    |length| Layout::Line { markers: 5, length },
    |length| Layout::Radius { markers: 5, length },
    |row_spacing_deg| Layout::Gores {
        gores: 4,
        rows: vec![1, 2],
        row_spacing_deg,
    },
];

rows! {
    PLACES, "{markers} markers along {share:e} of half a turn, radii 1e-60 to 1e60" => radius(markers, share),
        for markers in [2, 3, 1000, 100_000], for share in [1e-12, 0.5, 0.999_999];
    PLACES, "lattice of pitch {pitch} radii within {cap_deg}°: markers" => lattice(pitch, cap_deg),
        for pitch in [0.1, 1.0, 2.0], for cap_deg in [90.0, 180.0];
    PLACES, "lattice of pitch 0.01 radii within {cap_deg}°: markers" => lattice(0.01, cap_deg),
        for cap_deg in [1.0, 90.0];
    PLACES, "lattice of pitch 0.01 radii within 180°, radius {radius:e}", "too-many-markers" =>
        spread(0.01, 180.0, radius), for radius in RADII;
    PLACES, "lattice of pitch {pitch} radii within 1°, radius {radius:e}", "no-marker" => spread(pitch, 1.0, radius),
        for pitch in [0.1, 1.0, 2.0], for radius in RADII;
    PLACES, "{gores} gores of {rows} rows of a marker, but for the apex: latitudes" => gored(gores, rows),
        for (gores, rows) in [(1, 1), (100_000, 1), (1, 1000)];
    PLACES, "{layout:?}", "bad-setting" => layout.places(1.0),
        for bad in NO_LENGTHS, for layout in LAYOUTS.map(|layout| layout(bad));
    PLACES, "the published layout on a radius of {radius:e}: as many times that of radius 1" => published(radius),
        for radius in [LEAST, 1e-300, 1e300];
    PLACES, "the published layout on a radius of {bad:e}", "bad-setting" => published(bad),
        for bad in NO_LENGTHS.into_iter().chain([f64::MAX]);
    PATTERN, "radius {bad:e}", "bad-setting" => pattern(4, 10, bad), for bad in NO_LENGTHS;
    PATTERN, "{gores} gores in 10 steps", "too-many-gores" => pattern(gores, 10, 1.0), for gores in [361, u32::MAX];
    PATTERN, "2 gores in 10 steps", "too-few-gores" => pattern(2, 10, 1.0);
    PATTERN, "4 gores in {samples} steps", "bad-setting" => pattern(4, samples, 1.0),
        for samples in [0, 1001, u32::MAX];
    "chromatouch::Pattern::gore", "{gores} gores in {samples} steps: width at the equator, radii 1e-100 to 1e100" =>
        gore(gores, samples), for gores in [3, 360], for samples in [1, 1000];
    FLATTEN, "a place {angle:e} rad from the apex, all around: its distance from the apex" => flattened(angle),
        for angle in [0.0, 1e-300, 1e-12, 0.5, 1.57, FRAC_PI_2 * (1.0 - 4.0 * f64::EPSILON)];
    FLATTEN, "12 places on the equator, one of which rounding takes beyond it" =>
        Answer::counted(around(FRAC_PI_2).map(|(_, flat)| flat.map(numbers)), 11, &["beyond-the-equator"]);
    FLATTEN, "place {beyond:e}", "beyond-the-equator" => pattern(4, 10, 1.0).unwrap().flatten([beyond, 0.0]),
        for beyond in BEYOND;
    "chromatouch::FoldStrain::greatest", "{gores} gores" => greatest_strain(gores),
        for gores in [3, 4, 8, 360, 1_000_000, u32::MAX];
    "chromatouch::FoldStrain::of", "{gores} gores", "too-few-gores" => FoldStrain::of(gores), for gores in 0..3;
    "chromatouch::FoldStrain::at", "longitude {beyond:e}", "bad-setting" =>
        FoldStrain::of(4).unwrap().at(beyond, 0.1).map_err(named), for beyond in BEYOND;
    SVG, "disc of diameter {bad:e} of the radius", "bad-setting" => sheet(bad, 1.0),
        for bad in [f64::NAN, f64::INFINITY, -f64::MAX];
    SVG, "disc of diameter 1.571 of the radius", "discs-overlap" => sheet(1.571, 1.0);
    SVG, "unit of {unit_mm:e} mm: neither NaN nor inf is written" => sheet(0.1, unit_mm), for unit_mm in [1.0, 1e3];
    SVG, "unit of {unit_mm:e} mm", "not-drawable" => sheet(0.1, unit_mm),
        for unit_mm in [f64::NAN, 0.0, -1.0, f64::INFINITY, LEAST, 1e-12, 1e-3, 1e12];
}

/// The name of an error, that of the layout's where it wraps one.
fn named(error: PatternError) -> &'static str {
    error.name()
}

/// Subnormal places are whole multiples of the least number.
fn published(radius: f64) -> Result<Answer, LayoutError> {
    let numbers = |radius| {
        Ok::<_, palpate_chromatouch::LayoutError>(
            Layout::published().places(radius)?.into_iter().flatten(),
        )
    };
    let truths = numbers(1.0)?.map(|of_one| of_one * radius);
    let pairs = numbers(radius)?.zip(truths);
    Ok(Answer::all_at_scale(pairs, radius.max(f64::MIN_POSITIVE)).within(1e-14))
}

/// Positions of markers on a radius, in equal steps from the first marker to the last.
fn radius(markers: u32, share: f64) -> Result<Answer, LayoutError> {
    let mut pairs = Vec::new();
    for radius in RADII {
        let length = share * PI * radius;
        let places = Layout::Radius { markers, length }.places(radius)?;
        for marker in [0, 1, markers - 1] {
            let truth = length * f64::from(marker) / f64::from(markers - 1);
            pairs.push((places[marker as usize][0] / length, truth / length));
        }
        pairs.push((places.len() as f64, markers.into()));
    }
    Ok(Answer::all_at_scale(pairs, 1.0).within(1e-15))
}

fn spread(pitch: f64, cap_deg: f64, radius: f64) -> Result<Vec<[f64; 2]>, LayoutError> {
    let pitch = pitch * radius;
    Layout::Lattice { pitch, cap_deg }.places(radius)
}

/// One marker per square of the pitch, to within one.
fn lattice(pitch: f64, cap_deg: f64) -> Result<Answer, LayoutError> {
    let half = 0.5 * f64::to_radians(cap_deg);
    let area = 4.0 * PI * libm::sin(half) * libm::sin(half);
    let mut pairs = Vec::new();
    let mut numbers = Vec::new();
    for radius in RADII {
        let places = spread(pitch, cap_deg, radius)?;
        pairs.push((places.len() as f64, area / (pitch * pitch)));
        numbers.extend(places.into_iter().flatten().map(|number| number / radius));
    }
    Ok(Answer::all_at_scale(pairs, 1.0).also(numbers).within(1.0))
}

/// One marker in each row, at its latitude.
fn gored(gores: u32, rows: usize) -> Result<Answer, LayoutError> {
    let spacing = 179.0 / rows as f64;
    let layout = Layout::Gores {
        gores,
        rows: vec![u32::from(gores < 100_000); rows],
        row_spacing_deg: spacing,
    };
    let places = layout.places(1.0)?;
    let truths = (0..).map(|row| (f64::from(row) * spacing).to_radians());
    let latitudes = places.iter().map(|[x, y]| libm::hypot(*x, *y));
    Ok(Answer::all_at_scale(latitudes.zip(truths), 1.0).within(1e-14))
}

/// σ − 1 of the shear s = π/n, where σ = s/2 + √(1 + s²/4).
fn greatest_strain(gores: u32) -> Result<Answer, PatternError> {
    let half = Precise::pi() / (2.0 * f64::from(gores));
    let truth = (&half + (half.squared() + 1.0).sqrt() - 1.0).to_f64();
    let strain = FoldStrain::of(gores)?;
    let edge = strain.at(PI / f64::from(gores), FRAC_PI_2)?;
    let answer = Answer::all_near([(strain.greatest(), truth), (edge, truth)]);
    Ok(answer.within(1e-15).also([strain.rms()]))
}

fn pattern(gores: u32, samples: u32, radius: f64) -> Result<Pattern, &'static str> {
    Pattern::new(gores, samples, radius).map_err(named)
}

/// Half the width of a gore at the equator, which is πR/n.
fn gore(gores: u32, samples: u32) -> Result<Answer, &'static str> {
    let mut pairs = Vec::new();
    let mut numbers = Vec::new();
    for radius in [1e-100, 1.0, 1e100] {
        let outline = pattern(gores, samples, radius)?.gore();
        let truth = Precise::pi() * radius / f64::from(gores);
        pairs.push((outline[0][0], truth.to_f64()));
        numbers.extend(outline.into_iter().flatten());
    }
    Ok(Answer::all_near(pairs).also(numbers).within(1e-15))
}

/// Radii, and places on spheres of such radii, so far from the apex and in four directions from it.
fn around(angle: f64) -> impl Iterator<Item = (f64, Result<FlatPlace, PatternError>)> {
    let directions = || [0.0_f64, 1.0, 2.513, -3.0].map(libm::sincos);
    [1e-90, 1.0, 1e90].into_iter().flat_map(move |radius| {
        let (pattern, reach) = (Pattern::new(5, 10, radius).unwrap(), angle * radius);
        directions().map(|(sine, cosine)| (radius, pattern.flatten([reach * cosine, reach * sine])))
    })
}

fn numbers(flat: FlatPlace) -> [f64; 4] {
    let [x, y] = flat.assembled;
    [flat.from_apex, flat.across, x, y]
}

fn flattened(angle: f64) -> Result<Answer, PatternError> {
    let mut pairs = Vec::new();
    let mut all = Vec::new();
    for (radius, flat) in around(angle) {
        let flat = flat?;
        pairs.push((flat.from_apex / radius, angle));
        all.extend(numbers(flat));
    }
    Ok(Answer::all_at_scale(pairs, angle.max(1e-200))
        .within(1e-15)
        .also(all))
}

fn sheet(diameter: f64, unit_mm: f64) -> Result<Answer, &'static str> {
    let layout = Layout::Gores {
        gores: 4,
        rows: vec![1, 1],
        row_spacing_deg: 20.0,
    };
    let discs = Discs {
        magenta: diameter,
        yellow: diameter,
    };
    let sheet = pattern(4, 10, 1.0)?.sheet(&layout, discs).map_err(named)?;
    let drawn = sheet.svg(unit_mm).map_err(named)? + &sheet.dxf(unit_mm).map_err(named)?;
    Ok(Answer::holds(
        !drawn.contains("NaN") && !drawn.contains("inf"),
    ))
}
