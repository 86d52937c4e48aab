//! Markers found again, and fields of what they did.

use std::f64::consts::{FRAC_PI_2, PI};

use palpate_tracking::{
    CalibrationError, Displaced, Equidistant, Field, FieldError, Marker, Status, Track,
    match_markers,
};
use palpate_verdict::{Answer, rows};

const MATCH: &str = "tracking::match_markers";
const SHIFT: &str = "tracking::Equidistant::shift";
const CAMERA: &str = "tracking::Equidistant::new";
const FIELD: &str = "tracking::Field::new";
const SMOOTHED: &str = "tracking::Field::smoothed";
const LEAST: f64 = f64::from_bits(1);
/// Changes of hue: from, to, and the shorter way between them, turns.
const TURNS: [[f64; 3]; 6] = [
    [0.999_999, 0.0, 1e-6],
    [0.0, 0.999_999, -1e-6],
    [0.25, 0.75, -0.5],
    [0.75, 0.25, -0.5],
    [0.0, 1.0 - f64::EPSILON / 2.0, 0.0],
    [0.4, 0.6, 0.2],
];
/// A marker with a number as its place, its hue or its size.
type With = fn(f64) -> Marker;
const STRANGE: [(&str, With); 3] = [
    ("place", |x| marker(x, 30.0, 0.5, 1.0)),
    ("hue", |hue| marker(50.0, 0.0, hue, 1.0)),
    ("size", |size| marker(50.0, 0.0, 0.5, size)),
];

rows! {
    MATCH, "100 markers {pitch:e} px apart, shifted by {shift:e} of that: all are tracked" =>
        grid_of_markers(pitch, shift), for pitch in [1e-150, 1e-9, 1.0, 1e9, 1e150], for shift in [0.0, 1e-9, 0.2];
    MATCH, "{count} markers in one place: as many tracks; finite" => in_one_place(count), for count in [0, 1, 2, 500];
    MATCH, "a {part} of {number:e} at rest and pressed: the others stay" => strange(with, number),
        for number in [f64::NAN, f64::INFINITY, -f64::MAX, f64::MAX, LEAST, -0.0], for (part, with) in STRANGE;
    "tracking::Track::change", "hue from {from} to {to} turns" => turned(from, to, turn), for [from, to, turn] in TURNS;
    SHIFT, "outward by {step:e} rad from {from:e}" => outward(from, step),
        for step in [1e-15, 1e-9, 1e-3, 1.0, 2.0], for from in [0.0, 1e-9, 1.0];
    SHIFT, "from and to ({x:e}, 0) px; finite: no shift where there is no place" => nowhere(x),
        for x in [f64::NAN, f64::INFINITY, f64::MAX, LEAST];
    CAMERA, "centre {bad}, 1 px per rad", "out-of-range" => Equidistant::new([bad, 0.0], 1.0),
        for bad in [f64::NAN, f64::INFINITY];
    CAMERA, "centre 0, {bad} px per rad", "out-of-range" => Equidistant::new([0.0; 2], bad),
        for bad in [f64::NAN, 0.0, f64::INFINITY, -1.0];
    "tracking::Field::at", "a linear field over places of {size:e} rad, between them" => linear(size),
        for size in [1e-25, 1e-9, 1e-3, 1.0];
    FIELD, "no marker", "no-markers" => Field::new(&[]);
    FIELD, "{count} markers in one place", "coincident" => Field::new(&vec![displaced(0.1, 0.2, 1.0); count]),
        for count in [2, 1000];
    FIELD, "two markers 1e-40 apart", "coincident" =>
        Field::new(&[displaced(1e-40, 0.0, 1.0), displaced(0.0, 0.0, 1.0)]);
    FIELD, "a place of {bad:e} rad", "out-of-range" => Field::new(&[displaced(bad, 0.0, 1.0)]),
        for bad in [f64::NAN, f64::INFINITY, 3.2];
    FIELD, "a displacement of {bad:e}", "out-of-range" => Field::new(&[displaced(0.0, 0.0, bad)]),
        for bad in [f64::NAN, 1e101];
    "tracking::Field", "{name}: everywhere between the least and the largest displacement" =>
        everywhere(&markers, answered), for (name, markers, answered) in thin();
    SMOOTHED, "over {bad} rad", "bad-filter" => Field::new(&[displaced(0.0, 0.0, 1.0)]).unwrap().smoothed(bad),
        for bad in [f64::NAN, f64::INFINITY, -1.0];
    SMOOTHED, "equal displacements over {std:e} rad: unchanged" => smoothed(std),
        for std in [0.0, LEAST, 1e-300, 1e300, f64::MAX];
    "tracking::Field::grid", "{count} × {count} over a linear field" => grid(count), for count in [0, 1, 2, 200];
}

const fn marker(x: f64, y: f64, hue_turns: f64, size_px2: f64) -> Marker {
    Marker {
        centroid_px: [x, y],
        hue_turns,
        size_px2,
        pixels: 9,
    }
}

const fn displaced(x: f64, y: f64, value: f64) -> Displaced {
    Displaced {
        place: [x, y],
        tangential: [value, -value],
        normal: value,
    }
}

fn grid_of_markers(pitch: f64, shift: f64) -> Answer {
    let at = |index: usize, shift: f64| {
        let [x, y] = [index % 10, index / 10].map(|step| (step as f64 + shift) * pitch);
        marker(x, y, 0.9, 0.3 * pitch * pitch)
    };
    let of = |shift: f64| (0..100).map(|index| at(index, shift)).collect::<Vec<_>>();
    let tracks = match_markers(&of(0.0), &of(shift));
    let tracked = tracks.iter().enumerate().filter(|(index, track)| {
        track.status == Status::Tracked && track.pressed == Some(at(*index, shift))
    });
    let changes = tracks.iter().filter_map(Track::change);
    Answer::near(tracked.count() as f64, 100.0).also(changes.flat_map(|change| change.shift_px))
}

fn in_one_place(count: usize) -> Answer {
    let markers = vec![marker(3.0, 4.0, 0.5, 2.0); count];
    let tracks = match_markers(&markers, &markers);
    let changes = tracks.iter().filter_map(Track::change);
    let at_rest = tracks.iter().filter(|track| track.rest.is_some()).count();
    Answer::at_scale(at_rest as f64, count as f64, 1.0)
        .also(changes.flat_map(|change| [change.shift_px[0], change.hue_turns, change.growth]))
}

fn strange(with: With, number: f64) -> Answer {
    let others = [(0.0, 0.0), (10.0, 0.0), (0.0, 10.0)].map(|(x, y)| marker(x, y, 0.5, 1.0));
    let camera = Equidistant::new([0.0; 2], 100.0).unwrap();
    let and = |one| others.into_iter().chain([one]).collect::<Vec<_>>();
    let (plain, odd) = (and(with(1.0)), and(with(number)));
    let mut shifts = Vec::new();
    let mut numbers = Vec::new();
    for (rest, pressed) in [(&odd, &plain), (&plain, &odd), (&odd, &odd), (&odd, &odd)] {
        let tracks = match_markers(rest, pressed);
        let is_other = |track: &&Track| track.rest.is_some_and(|rest| others.contains(&rest));
        let stay = tracks.iter().filter(is_other).filter_map(Track::change);
        shifts.extend(stay.flat_map(|change| change.shift_px));
        let turned = tracks.iter().filter_map(|track| camera.change(track));
        let changes = tracks.iter().filter_map(Track::change).chain(turned);
        numbers.extend(changes.flat_map(|change| {
            let [x, y] = change.shift_px;
            [x, y, change.hue_turns, change.growth]
        }));
    }
    // Two numbers each of three markers, four times; one that is not tracked is 1 off.
    shifts.resize(24, 1.0);
    let shifts = shifts.into_iter().map(|shift| (shift, 0.0));
    Answer::all_at_scale(shifts, 1.0).also(numbers)
}

fn turned(from: f64, to: f64, turn: f64) -> Option<Answer> {
    let track = Track {
        rest: Some(marker(0.0, 0.0, from, 1.0)),
        pressed: Some(marker(0.0, 0.0, to, 1.0)),
        status: Status::Tracked,
    };
    let answer = Answer::at_scale(track.change()?.hue_turns, turn, 1.0);
    Some(answer.within(2.0 * f64::EPSILON))
}

fn outward(from: f64, step: f64) -> Result<Answer, CalibrationError> {
    let mut pairs = Vec::new();
    for px_per_rad in [1e-6, 1.0, 1e12] {
        let camera = Equidistant::new([0.0; 2], px_per_rad)?;
        let (start, end) = (from * px_per_rad, (from + step) * px_per_rad);
        let [x, y] = camera.shift([start, 0.0], [end, 0.0]);
        let truth = end / px_per_rad - start / px_per_rad;
        pairs.extend([(x / truth, 1.0), (y / truth, 0.0)]);
    }
    let answer = Answer::all_at_scale(pairs, 1.0).within(4.0 * f64::EPSILON);
    Ok(answer.conditioned((from + step) / step).or_no_digits())
}

fn nowhere(x: f64) -> Result<Answer, CalibrationError> {
    let camera = Equidistant::new([1.0; 2], 1e-6)?;
    let (there, here) = ([x, 0.0], [2.0, 3.0]);
    let truth = |of_0: [f64; 2]| if x < 1.0 { of_0 } else { [0.0; 2] };
    let out = truth(camera.shift([0.0; 2], here));
    let back = truth(camera.shift(here, [0.0; 2]));
    let found = camera
        .shift(there, here)
        .into_iter()
        .chain(camera.shift(here, there));
    let pairs = found.zip(out.into_iter().chain(back));
    Ok(Answer::all_at_scale(pairs, 1.0)
        .within(1e-12)
        .also(camera.place(there)))
}

/// Natural neighbours reproduce linear fields.
fn linear(size: f64) -> Result<Answer, FieldError> {
    let value = |x: f64, y: f64| 1.0 + 2.0 * x - 0.5 * y;
    let at = |index: usize| [index % 5, index / 5].map(|step| 0.5 * step as f64 - 1.0);
    let places = (0..25).map(at);
    let markers: Vec<_> = places
        .map(|[x, y]| displaced(size * x, size * y, value(x, y)))
        .collect();
    let field = Field::new(&markers)?;
    let asked = [[0.1, 0.2], [-0.77, 0.3], [0.999, -0.999], [0.5, 0.5]];
    let pairs = asked.map(|[x, y]| (field.at([size * x, size * y]).unwrap().normal, value(x, y)));
    Ok(Answer::all_at_scale(pairs, 1.0).within(1e-9))
}

/// Markers that hardly span an area, and how many of the places of [`everywhere`] lie between them.
fn thin() -> [(&'static str, Vec<Displaced>, usize); 5] {
    let twenty = || (0..20).map(f64::from);
    let circle = (0..40).map(|step| libm::sincos(f64::from(step) * PI / 20.0));
    let few = [displaced(0.0, 0.0, 1.0), displaced(PI, 0.0, -0.0)];
    let line = twenty().map(|step| displaced(0.01 * step, 0.0, 1.0));
    let sliver = twenty().map(|step| displaced(0.01 * step, 1e-17 * (step % 2.0), step));
    let circle = circle.map(|(sine, cosine)| displaced(cosine, sine, 1e100 * sine));
    [
        ("one marker", few[..1].to_vec(), 2),
        ("two markers half a turn apart", few.to_vec(), 4),
        ("20 markers on a line", line.collect(), 3),
        ("20 markers within 1e-17 rad of a line", sliver.collect(), 4),
        (
            "40 markers on a circle, displaced by 1e100",
            circle.collect(),
            5,
        ),
    ]
}

fn everywhere(markers: &[Displaced], answered: usize) -> Result<Answer, FieldError> {
    let field = Field::new(markers)?;
    let places = [
        [0.0, 0.0],
        [0.05, 0.0],
        [0.05, 1e-18],
        [FRAC_PI_2, 0.0],
        [0.5, 0.5],
        [f64::NAN, 0.0],
        [f64::MAX, f64::MAX],
        [LEAST, -0.0],
    ];
    let mut found: Vec<_> = places.iter().filter_map(|place| field.at(*place)).collect();
    assert_eq!(found.len(), answered, "places between the markers");
    found.extend(field.grid(5));
    found.extend(field.smoothed(0.1)?.markers());
    let normals = markers.iter().map(|marker| marker.normal);
    let least = normals.clone().fold(f64::INFINITY, f64::min);
    let largest = normals.fold(f64::NEG_INFINITY, f64::max);
    let pairs = found
        .iter()
        .map(|found| (found.normal, found.normal.clamp(least, largest)));
    let outward = field.outward();
    let answer = Answer::all_at_scale(pairs, least.abs().max(largest.abs())).within(1e-12);
    Ok(answer.also(outward.of_marker).also(outward.mean))
}

fn smoothed(std: f64) -> Result<Answer, FieldError> {
    let markers: Vec<_> = (0..9)
        .map(|step| displaced(0.1 * f64::from(step), 0.0, 2.0))
        .collect();
    let smooth = Field::new(&markers)?.smoothed(std)?;
    let normals = smooth.markers().iter().map(|one| (one.normal, 2.0));
    Ok(Answer::all_near(normals).within(1e-15))
}

fn grid(count: usize) -> Result<Answer, FieldError> {
    let corners = [(0.0, 0.0, 1.0), (1.0, 0.0, 2.0), (0.0, 1.0, 3.0)];
    let grid = Field::new(&corners.map(|(x, y, value)| displaced(x, y, value)))?.grid(count);
    let nodes = grid.iter().map(|one| {
        let [x, y] = one.place;
        (one.normal, 1.0 + x + 2.0 * y)
    });
    // Of the square the lower left half is between the markers, rounding its diagonal.
    let square = count * count;
    let half = [square - count.min(square), square + count].map(|twice| twice / 2);
    let held = grid.len().clamp(half[0], half[1]);
    let nodes = nodes.chain([(grid.len() as f64, held as f64)]);
    Ok(Answer::all_at_scale(nodes, 1.0).within(1e-12))
}
