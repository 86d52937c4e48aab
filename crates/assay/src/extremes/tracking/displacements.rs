//! Markers found again, and fields of what they did.

use std::f64::consts::{FRAC_PI_2, PI};

use palpate_tracking::{
    CalibrationError, Displaced, Equidistant, Field, FieldError, Marker, Status, Track,
    match_markers,
};

use crate::extremes::{Answer, Case};

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

pub(super) fn cases() -> Vec<Case> {
    let mut cases = matches();
    cameras(&mut cases);
    fields(&mut cases);
    cases
}

fn matches() -> Vec<Case> {
    let mut cases = Vec::new();
    for pitch in [1e-150, 1e-9, 1.0, 1e9, 1e150] {
        for shift in [0.0, 1e-9, 0.2] {
            cases.push(Case::value(
                "tracking::match_markers",
                format!(
                    "100 markers {pitch:e} px apart, shifted by {shift:e} of that: all are tracked"
                ),
                move || Ok::<_, FieldError>(grid_of_markers(pitch, shift)),
            ));
        }
    }
    for count in [0, 1, 2, 500] {
        cases.push(Case::value(
            "tracking::match_markers",
            format!("{count} markers in one place: as many tracks; finite"),
            move || Ok::<_, FieldError>(in_one_place(count)),
        ));
    }
    for number in [
        f64::NAN,
        f64::INFINITY,
        -f64::MAX,
        f64::MAX,
        f64::from_bits(1),
        -0.0,
    ] {
        for part in ["place", "hue", "size"] {
            cases.push(Case::value(
                "tracking::match_markers",
                format!("a {part} of {number:e} at rest and pressed: the others stay"),
                move || Ok::<_, FieldError>(strange(part, number)),
            ));
        }
    }
    for (from, to, turn) in [
        (0.999_999, 0.0, 1e-6),
        (0.0, 0.999_999, -1e-6),
        (0.25, 0.75, -0.5),
        (0.75, 0.25, -0.5),
        (0.0, 1.0 - f64::EPSILON / 2.0, 0.0),
        (0.4, 0.6, 0.2),
    ] {
        cases.push(Case::value(
            "tracking::Track::change",
            format!("hue from {from} to {to} turns"),
            move || {
                let track = Track {
                    rest: Some(marker(0.0, 0.0, from, 1.0)),
                    pressed: Some(marker(0.0, 0.0, to, 1.0)),
                    status: Status::Tracked,
                };
                let turned = track.change().map_or(f64::NAN, |change| change.hue_turns);
                Ok::<_, FieldError>(Answer::at_scale(turned, turn, 1.0).within(2.0 * f64::EPSILON))
            },
        ));
    }
    cases
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
    Answer::near(tracked.count() as f64, 100.0).also(
        tracks
            .iter()
            .filter_map(Track::change)
            .flat_map(|change| change.shift_px),
    )
}

fn in_one_place(count: usize) -> Answer {
    let markers = vec![marker(3.0, 4.0, 0.5, 2.0); count];
    let tracks = match_markers(&markers, &markers);
    let changes = tracks.iter().filter_map(Track::change);
    let at_rest = tracks.iter().filter(|track| track.rest.is_some()).count();
    Answer::at_scale(at_rest as f64, count as f64, 1.0)
        .also(changes.flat_map(|change| [change.shift_px[0], change.hue_turns, change.growth]))
}

fn strange(part: &str, number: f64) -> Answer {
    let with = |number: f64| match part {
        "place" => marker(number, 30.0, 0.5, 1.0),
        "hue" => marker(50.0, 0.0, number, 1.0),
        _ => marker(50.0, 0.0, 0.5, number),
    };
    let others = [
        marker(0.0, 0.0, 0.5, 1.0),
        marker(10.0, 0.0, 0.5, 1.0),
        marker(0.0, 10.0, 0.5, 1.0),
    ];
    let mut shifts = Vec::new();
    let mut numbers = Vec::new();
    for pressed in [with(1.0), with(number)] {
        let rest: Vec<_> = others.into_iter().chain([with(number)]).collect();
        let pressed: Vec<_> = others.into_iter().chain([pressed]).collect();
        for (rest, pressed) in [(&rest, &pressed), (&pressed, &rest)] {
            let tracks = match_markers(rest, pressed);
            let stay = tracks.iter().filter(|track| {
                let is_other = |marker: &Marker| others.contains(marker);
                track.rest.as_ref().is_some_and(is_other)
            });
            shifts.extend(
                stay.filter_map(Track::change)
                    .flat_map(|change| change.shift_px),
            );
            let camera = Equidistant::new([0.0; 2], 100.0).expect("a camera");
            let plain = tracks.iter().filter_map(Track::change);
            let turned = tracks.iter().filter_map(|track| camera.change(track));
            numbers.extend(plain.chain(turned).flat_map(|change| {
                let [x, y] = change.shift_px;
                [x, y, change.hue_turns, change.growth]
            }));
        }
    }
    // Two numbers each of three markers, four times; one that is not tracked is 1 off.
    shifts.resize(24, 1.0);
    let shifts = shifts.into_iter().map(|shift| (shift, 0.0));
    Answer::all_at_scale(shifts, 1.0).also(numbers)
}

fn cameras(cases: &mut Vec<Case>) {
    for step in [1e-15, 1e-9, 1e-3, 1.0, 2.0] {
        for from in [0.0, 1e-9, 1.0] {
            cases.push(Case::value(
                "tracking::Equidistant::shift",
                format!("outward by {step:e} rad from {from:e}"),
                move || outward(from, step),
            ));
        }
    }
    for (centre, px_per_rad) in [
        (f64::NAN, 1.0),
        (f64::INFINITY, 1.0),
        (0.0, f64::NAN),
        (0.0, 0.0),
        (0.0, f64::INFINITY),
        (0.0, -1.0),
    ] {
        cases.push(Case::refusal(
            "tracking::Equidistant::new",
            format!("centre {centre}, {px_per_rad} px per rad"),
            move || Equidistant::new([centre, 0.0], px_per_rad),
        ));
    }
    for number in [f64::NAN, f64::INFINITY, f64::MAX, f64::from_bits(1)] {
        cases.push(Case::value(
            "tracking::Equidistant::shift",
            format!("from and to ({number:e}, 0) px; finite: no shift where there is no place"),
            move || {
                let camera = Equidistant::new([1.0; 2], 1e-6)?;
                let (there, here) = ([number, 0.0], [2.0, 3.0]);
                let place = camera.place(there);
                let is_place = number < 1.0;
                let truth = |of_0: [f64; 2]| if is_place { of_0 } else { [0.0; 2] };
                let out = truth(camera.shift([0.0; 2], here));
                let back = truth(camera.shift(here, [0.0; 2]));
                let pairs = camera.shift(there, here).into_iter().zip(out);
                let pairs = pairs.chain(camera.shift(here, there).into_iter().zip(back));
                let answer = Answer::all_at_scale(pairs.collect::<Vec<_>>(), 1.0).within(1e-12);
                Ok::<_, CalibrationError>(answer.also(place))
            },
        ));
    }
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
    Ok(Answer::all_at_scale(pairs, 1.0)
        .within(4.0 * f64::EPSILON)
        .conditioned((from + step) / step)
        .or_no_digits())
}

fn fields(cases: &mut Vec<Case>) {
    for size in [1e-25, 1e-9, 1e-3, 1.0] {
        cases.push(Case::value(
            "tracking::Field::at",
            format!("a linear field over places of {size:e} rad, between them"),
            move || linear(size),
        ));
    }
    for (input, markers) in [
        ("no marker", vec![]),
        (
            "two markers in one place",
            vec![displaced(0.1, 0.2, 1.0); 2],
        ),
        (
            "1000 markers in one place",
            vec![displaced(0.1, 0.2, 1.0); 1000],
        ),
        (
            "two markers 1e-40 apart",
            vec![displaced(1e-40, 0.0, 1.0), displaced(0.0, 0.0, 1.0)],
        ),
        ("a place of NaN", vec![displaced(f64::NAN, 0.0, 1.0)]),
        (
            "an infinite place",
            vec![displaced(f64::INFINITY, 0.0, 1.0)],
        ),
        ("a place beyond half a turn", vec![displaced(3.2, 0.0, 1.0)]),
        ("a displacement of NaN", vec![displaced(0.0, 0.0, f64::NAN)]),
        ("a displacement of 1e101", vec![displaced(0.0, 0.0, 1e101)]),
    ] {
        cases.push(Case::refusal("tracking::Field::new", input, move || {
            Field::new(&markers)
        }));
    }
    let on_a_line: Vec<_> = (0..20)
        .map(|step| displaced(0.01 * f64::from(step), 0.0, 1.0))
        .collect();
    let sliver: Vec<_> = (0..20)
        .map(|step| {
            displaced(
                0.01 * f64::from(step),
                1e-17 * f64::from(step % 2),
                f64::from(step),
            )
        })
        .collect();
    let circle: Vec<_> = (0..40)
        .map(|step| libm::sincos(f64::from(step) * PI / 20.0))
        .map(|(sine, cosine)| displaced(cosine, sine, 1e100 * sine))
        .collect();
    let few = [displaced(0.0, 0.0, 1.0), displaced(PI, 0.0, -0.0)];
    for (input, markers) in [
        ("one marker", few[..1].to_vec()),
        ("two markers half a turn apart", few.to_vec()),
        ("20 markers on a line", on_a_line),
        ("20 markers within 1e-17 rad of a line", sliver),
        ("40 markers on a circle, displaced by 1e100", circle),
    ] {
        cases.push(Case::value(
            "tracking::Field",
            format!("{input}: everywhere between the least and the largest displacement"),
            move || everywhere(&markers),
        ));
    }
    for std in [f64::NAN, f64::INFINITY, -1.0] {
        cases.push(Case::refusal(
            "tracking::Field::smoothed",
            format!("over {std} rad"),
            move || Field::new(&[displaced(0.0, 0.0, 1.0)])?.smoothed(std),
        ));
    }
    for std in [0.0, f64::from_bits(1), 1e-300, 1e300, f64::MAX] {
        cases.push(Case::value(
            "tracking::Field::smoothed",
            format!("equal displacements over {std:e} rad: unchanged"),
            move || {
                let markers: Vec<_> = (0..9)
                    .map(|step| displaced(0.1 * f64::from(step), 0.0, 2.0))
                    .collect();
                let smooth = Field::new(&markers)?.smoothed(std)?;
                let normals = smooth.markers().iter().map(|one| (one.normal, 2.0));
                Ok::<_, FieldError>(Answer::all_near(normals).within(1e-15))
            },
        ));
    }
    for count in [0, 1, 2, 200] {
        cases.push(Case::value(
            "tracking::Field::grid",
            format!("{count} × {count} over a linear field"),
            move || {
                let markers = [
                    displaced(0.0, 0.0, 1.0),
                    displaced(1.0, 0.0, 2.0),
                    displaced(0.0, 1.0, 3.0),
                ];
                let grid = Field::new(&markers)?.grid(count);
                let nodes = grid.iter().map(|one| {
                    let [x, y] = one.place;
                    (one.normal, 1.0 + x + 2.0 * y)
                });
                // Of the square the lower left half is between the markers, rounding its diagonal.
                let square = count * count;
                let half = [square - count.min(square), square + count].map(|twice| twice / 2);
                let held = grid.len().clamp(half[0], half[1]);
                let nodes = nodes.chain([(grid.len() as f64, held as f64)]);
                Ok::<_, FieldError>(Answer::all_at_scale(nodes, 1.0).within(1e-12))
            },
        ));
    }
}

/// Natural neighbours reproduce linear fields.
fn linear(size: f64) -> Result<Answer, FieldError> {
    let value = |x: f64, y: f64| 1.0 + 2.0 * x - 0.5 * y;
    let at = |index: usize| [index % 5, index / 5].map(|step| 0.5 * step as f64 - 1.0);
    let markers: Vec<_> = (0..25)
        .map(|index| {
            let [x, y] = at(index);
            displaced(size * x, size * y, value(x, y))
        })
        .collect();
    let field = Field::new(&markers)?;
    let places = [[0.1, 0.2], [-0.77, 0.3], [0.999, -0.999], [0.5, 0.5]];
    let pairs = places.map(|[x, y]| {
        let found = field.at([size * x, size * y]);
        (found.map_or(f64::NAN, |found| found.normal), value(x, y))
    });
    Ok(Answer::all_at_scale(pairs, 1.0).within(1e-9))
}

fn everywhere(markers: &[Displaced]) -> Result<Answer, FieldError> {
    let field = Field::new(markers)?;
    let places = [
        [0.0, 0.0],
        [0.05, 0.0],
        [0.05, 1e-18],
        [FRAC_PI_2, 0.0],
        [0.5, 0.5],
        [f64::NAN, 0.0],
        [f64::MAX, f64::MAX],
        [f64::from_bits(1), -0.0],
    ];
    let at_places = places.iter().filter_map(|place| field.at(*place));
    let smoothed = field.smoothed(0.1)?;
    let found: Vec<f64> = (at_places.chain(field.grid(5)))
        .chain(smoothed.markers().iter().copied())
        .map(|found| found.normal)
        .collect();
    let normals = markers.iter().map(|marker| marker.normal);
    let least = normals.clone().fold(f64::INFINITY, f64::min);
    let largest = normals.fold(f64::NEG_INFINITY, f64::max);
    let pairs = found
        .iter()
        .map(|found| (*found, found.clamp(least, largest)));
    let outward = field.outward();
    Ok(Answer::all_at_scale(pairs, least.abs().max(largest.abs()))
        .within(1e-12)
        .also(outward.of_marker)
        .also(outward.mean))
}
