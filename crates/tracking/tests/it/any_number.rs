//! Tests with random input. Markers at different places must always define a displacement field. For arbitrary numbers
//! and pixels, each result must be finite or an error.

use image::RgbImage;
use palpate_tracking::{
    Calibration, CalibrationError, Change, Displaced, Equidistant, Field, FieldError, Finder,
    Ground, LateralCalibration, LateralPoint, Line, Marker, Mask, NormalCalibration, NormalFrom,
    NormalPoint, Status, Track, match_markers,
};
use proptest::prelude::*;

/// Any floating-point number, including infinities and NaN. Numbers of ordinary size are drawn most frequently.
fn any_number() -> impl Strategy<Value = f64> {
    prop_oneof![
        1 => any::<u64>().prop_map(f64::from_bits),
        3 => -2.0..2.0,
        1 => (-9.0..9.0).prop_map(|power: f64| libm::pow(10f64, power)),
    ]
}

fn pair() -> impl Strategy<Value = [f64; 2]> {
    prop::array::uniform2(any_number())
}

fn markers() -> impl Strategy<Value = Vec<Marker>> {
    let marker = (pair(), any_number(), any_number(), any::<u32>());
    let marker = marker.prop_map(|(centroid_px, hue_turns, size_px2, pixels)| Marker {
        centroid_px,
        hue_turns,
        mean_hue_turns: hue_turns,
        size_px2,
        pixels,
    });
    prop::collection::vec(marker, 0..12)
}

fn parts(change: &Change) -> [f64; 4] {
    let [x, y] = change.shift_px;
    [x, y, change.hue_turns, change.growth]
}

fn pair_within(most: f64) -> impl Strategy<Value = [f64; 2]> {
    [-most..most, -most..most]
}

fn is_sound(marker: &Marker) -> bool {
    let [x, y] = marker.centroid_px;
    let hues = [marker.hue_turns, marker.mean_hue_turns];
    (x + y + marker.size_px2).is_finite() && hues.iter().all(|hue| (0.0..1.0).contains(hue))
}

fn assert_line(line: &Line) {
    let optional = [line.slope_std, line.intercept, line.residual_std];
    let mut all = [line.slope, line.r_squared, line.residual_rms].to_vec();
    all.extend(optional.into_iter().flatten());
    assert!(all.iter().all(|number| number.is_finite()), "{line:?}");
}

#[test]
fn what_is_no_place_does_not_shift() {
    let camera = Equidistant::new([1.0; 2], 1e-6, [0.0; 2]).unwrap();
    for number in [f64::NAN, f64::INFINITY, f64::MAX] {
        assert!(
            camera
                .place([number, 0.0])
                .iter()
                .all(|angle| angle.is_finite())
        );
    }
    let marker = |size_px2| Marker {
        centroid_px: [0.0; 2],
        hue_turns: 0.5,
        mean_hue_turns: 0.5,
        size_px2,
        pixels: 1,
    };
    for size in [f64::NAN, 0.0, -1.0, f64::INFINITY] {
        let track = Track {
            rest: Some(marker(1.0)),
            pressed: Some(marker(size)),
            status: Status::Tracked,
        };
        assert_eq!(track.change(), None);
        assert_eq!(camera.change(&track), None);
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 300, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn any_markers(rest in markers(), pressed in markers(), centre in pair(), scale in any_number()) {
        let tracks = match_markers(&rest, &pressed);
        prop_assert!(tracks.iter().filter(|track| track.rest.is_some()).count() == rest.len());
        let changes: Vec<Change> = tracks.iter().filter_map(Track::change).collect();
        prop_assert!(changes.iter().flat_map(parts).all(|number| number.is_finite()), "{changes:?}");
        let camera = Equidistant::new(centre, scale, [0.0; 2]);
        let is_good = centre.iter().all(|one| one.abs() <= 1e12) && (1e-6..=1e12).contains(&scale);
        prop_assert_eq!(camera.is_ok(), is_good);
        if let Ok(camera) = camera {
            let changes: Vec<Change> = tracks.iter().filter_map(|track| camera.change(track)).collect();
            prop_assert!(changes.iter().flat_map(parts).all(|number| number.is_finite()), "{changes:?}");
            for marker in &rest {
                let place = camera.place(marker.centroid_px);
                prop_assert!(place.iter().all(|number| number.is_finite()), "{marker:?} {place:?}");
            }
        }
    }

    /// Tests that markers define a displacement field in their convex hull if each marker lies in its own square of a
    /// grid. The displacements are arbitrary.
    #[test]
    fn markers_apart_have_a_field(
        numbers in prop::collection::vec((pair_within(0.1), pair_within(2.0), -2.0..2.0), 4..16),
        std in 0.0..1.0,
    ) {
        let displaced = |(index, (off, tangential, normal)): (usize, &([f64; 2], [f64; 2], f64))| Displaced {
            place: [0, 1].map(|axis| 0.5 * (index / [1, 4][axis] % 4) as f64 - 0.75 + off[axis]),
            tangential: *tangential,
            normal: *normal,
        };
        let markers: Vec<Displaced> = numbers.iter().enumerate().map(displaced).collect();
        let field = Field::new(&markers).unwrap();
        prop_assert_eq!(field.markers().len(), markers.len());
        prop_assert_eq!(field.smoothed(std).unwrap().markers().len(), markers.len());
        for marker in &markers {
            let there = field.at(marker.place).unwrap();
            prop_assert!((there.normal - marker.normal).abs() < 1e-9, "{there:?} is not {marker:?}");
        }
    }

    #[test]
    fn any_field_gives_numbers_or_the_error_that_is_due(
        numbers in prop::collection::vec((pair(), pair(), any_number()), 0..20),
        std in any_number(),
    ) {
        let displaced = |&(place, tangential, normal): &([f64; 2], [f64; 2], f64)| {
            Displaced { place, tangential, normal }
        };
        let markers: Vec<Displaced> = numbers.iter().map(displaced).collect();
        let is_sound = |one: &Displaced| {
            let lengths = [one.tangential[0], one.tangential[1], one.normal];
            lengths.iter().all(|length| length.abs() <= 1e100)
                && libm::hypot(one.place[0], one.place[1]) <= std::f64::consts::PI
        };
        let found = Field::new(&markers);
        let unsound = markers.iter().position(|one| !is_sound(one));
        match &found {
            Ok(_) => prop_assert!(!markers.is_empty() && unsound.is_none()),
            Err(FieldError::NoMarkers) => prop_assert!(markers.is_empty()),
            Err(FieldError::OutOfRange { marker }) => prop_assert_eq!(Some(*marker), unsound),
            Err(FieldError::Coincident { marker }) => {
                let [x, y] = markers[*marker].place;
                let is_there = |one: &Displaced| libm::hypot(one.place[0] - x, one.place[1] - y) < 1e-29;
                prop_assert!(markers[..*marker].iter().any(is_there), "{markers:?}");
            }
            Err(error) => return Err(TestCaseError::fail(error.to_string())),
        }
        let Ok(field) = found else { return Ok(()) };
        let mut found = field.grid(4);
        let smooth = field.smoothed(std);
        prop_assert_eq!(smooth.is_ok(), std >= 0.0 && std.is_finite());
        found.extend(smooth.iter().flat_map(|smooth| smooth.markers().to_vec()));
        prop_assert!(found.iter().all(|one| (one.normal + one.tangential[0]).is_finite()), "{found:?}");
        prop_assert!(field.outward().is_none_or(f64::is_finite));
    }

    #[test]
    fn any_calibration_gives_numbers_or_the_error_that_is_due(
        points in prop::collection::vec((any_number(), any_number(), any_number(), 0..3_usize), 0..12),
        change in prop::array::uniform4(any_number()),
        which in 0..3_usize,
    ) {
        let bad = points.iter().position(|&(x, y, z, _)| [x, y, z].iter().any(|one| one.is_nan() || one.abs() > 1e100));
        let normal: Vec<NormalPoint> = points.iter().map(|&(normal, hue_turns, growth, marker)| {
            NormalPoint { marker: Some(marker), normal, hue_turns, growth }
        }).collect();
        let lateral: Vec<LateralPoint> = points.iter().map(|&(x, y, normal, _)| LateralPoint {
            tangential: [x, y], shift_px: [y, normal], normal: Some(x),
        }).collect();
        let normal = NormalCalibration::fit(&normal, NormalFrom::ALL[which]).ok();
        let lateral = LateralCalibration::fit(&lateral);
        match (&lateral, bad) {
            (found, Some(point)) => prop_assert_eq!(found, &Err(CalibrationError::NotFinite { point })),
            (Err(CalibrationError::TooFewPoints { .. }), None) => prop_assert!(points.len() < 2),
            (found, None) => prop_assert!(found.is_err() || points.len() >= 2),
        }
        let lateral = lateral.ok();
        for line in lateral.iter().flat_map(|lateral| lateral.with_intercept.into_iter().chain([lateral.line])) {
            assert_line(&line);
        }
        let has_parts = normal.is_some() || lateral.is_some();
        let calibration = Calibration::new(normal, lateral, None);
        prop_assert_eq!(calibration.is_ok(), has_parts);
        let Ok(calibration) = calibration else { return Ok(()) };
        let [x, y, hue_turns, growth] = change;
        let change = Change { shift_px: [x, y], hue_turns, growth };
        let mut read = calibration.tangential([x, y], growth).map_or(vec![], Vec::from);
        read.extend(calibration.normal(1, &change));
        prop_assert!(read.iter().all(|number| number.is_finite()));
    }

    #[test]
    fn any_frame_gives_numbers_or_the_error_that_is_due(
        bytes in prop::collection::vec(any::<u8>(), 64),
        (width, height) in (1..80_u32, 1..80_u32),
        mask in prop::option::of((pair(), any_number())),
        ground in 0..3_usize,
    ) {
        let mask = mask.map(|([x, y], radius)| Mask { centre_px: [40.0 * x, 40.0 * y], radius_px: 40.0 * radius });
        let ground = [None, Some(Ground::Bright), Some(Ground::Dark)][ground];
        let frame = RgbImage::from_fn(width, height, |x, y| {
            let at = ((x / 5) * 7 + (y / 5) * 13) as usize;
            image::Rgb([0, 1, 2].map(|channel| bytes[(at + channel) % bytes.len()]))
        });
        match Finder::new(mask, ground).find(&frame) {
            Ok(found) => prop_assert!(found.markers.iter().chain(&found.cut).all(is_sound), "{found:?}"),
            Err(error) => {
                let name: &str = error.into();
                let is_due = match width.min(height) < 16 {
                    true => name == "too-small",
                    false => ["no-markers", "mask-outside"].contains(&name),
                };
                prop_assert!(is_due, "{error}");
            }
        }
    }
}
