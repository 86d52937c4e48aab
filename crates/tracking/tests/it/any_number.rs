//! Whatever the numbers and the pixels: a finite answer or a named error.

use image::RgbImage;
use palpate_tracking::{
    Calibration, Change, Displaced, Equidistant, Field, Finder, FinderSettings, Ground, HueWindow,
    LateralCalibration, LateralPoint, Line, Marker, Mask, NormalCalibration, NormalFrom,
    NormalPoint, Status, Track, match_markers,
};
use proptest::prelude::*;

/// Any double, those of everyday size as often as all the others.
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
        size_px2,
        pixels,
    });
    prop::collection::vec(marker, 0..12)
}

fn parts(change: &Change) -> [f64; 4] {
    let [x, y] = change.shift_px;
    [x, y, change.hue_turns, change.growth]
}

fn assert_line(line: &Line) {
    let optional = [line.slope_std, line.intercept, line.residual_std];
    let mut all = [line.slope, line.r_squared, line.residual_rms].to_vec();
    all.extend(optional.into_iter().flatten());
    assert!(all.iter().all(|number| number.is_finite()), "{line:?}");
}

/// Shares of a shift too small to be multiplied.
#[test]
fn the_shortest_shifts_are_not_lost() {
    let camera = Equidistant::new([0.0; 2], 1.0).unwrap();
    assert_eq!(camera.shift([0.0, 0.0], [1e-200, 0.0]), [1e-200, 0.0]);
}

#[test]
fn what_is_no_place_does_not_shift() {
    let camera = Equidistant::new([1.0; 2], 1e-6).unwrap();
    for number in [f64::NAN, f64::INFINITY, f64::MAX] {
        assert_eq!(camera.shift([number, 0.0], [2.0, 3.0]), [0.0; 2]);
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
        if let Ok(camera) = Equidistant::new(centre, scale) {
            let changes: Vec<Change> = tracks.iter().filter_map(|track| camera.change(track)).collect();
            prop_assert!(changes.iter().flat_map(parts).all(|number| number.is_finite()), "{changes:?}");
            for marker in &rest {
                let shift = camera.shift(marker.centroid_px, centre);
                prop_assert!(shift.iter().all(|number| number.is_finite()), "{marker:?} {shift:?}");
            }
        }
    }

    #[test]
    fn any_field(
        numbers in prop::collection::vec((pair(), pair(), any_number()), 0..20),
        place in pair(),
        std in any_number(),
    ) {
        let displaced = |&(place, tangential, normal): &([f64; 2], [f64; 2], f64)| {
            Displaced { place, tangential, normal }
        };
        let markers: Vec<Displaced> = numbers.iter().map(displaced).collect();
        let Ok(field) = Field::new(&markers) else { return Ok(()) };
        let mut found = field.grid(4);
        found.extend(field.at(place));
        if let Ok(smooth) = field.smoothed(std) {
            found.extend_from_slice(smooth.markers());
        }
        prop_assert!(found.iter().all(|one| (one.normal + one.tangential[0]).is_finite()), "{found:?}");
        let outward = field.outward();
        prop_assert!(outward.of_marker.iter().chain(&outward.mean).all(|one| one.is_finite()));
    }

    #[test]
    fn any_calibration(
        points in prop::collection::vec((any_number(), any_number(), any_number(), 0..3_usize), 0..12),
        change in prop::array::uniform4(any_number()),
        which in 0..3_usize,
    ) {
        let pairs: Vec<[f64; 2]> = points.iter().map(|&(x, y, ..)| [x, y]).collect();
        for line in [Line::with_intercept(&pairs), Line::through_rest(&pairs)].into_iter().flatten() {
            assert_line(&line);
        }
        let normal: Vec<NormalPoint> = points.iter().map(|&(normal, hue_turns, growth, marker)| {
            NormalPoint { marker: Some(marker), normal, hue_turns, growth }
        }).collect();
        let lateral: Vec<LateralPoint> = points.iter().map(|&(x, y, normal, _)| LateralPoint {
            tangential: [x, y], shift_px: [y, normal], normal: Some(x),
        }).collect();
        let normal = NormalCalibration::fit(&normal, NormalFrom::ALL[which]).ok();
        let lateral = LateralCalibration::fit(&lateral).ok();
        if let Some(lateral) = &lateral {
            assert_line(&lateral.line);
            prop_assert!(lateral.slope(change[3]).is_finite());
        }
        let Ok(calibration) = Calibration::new(normal, lateral, None) else { return Ok(()) };
        let [x, y, hue_turns, growth] = change;
        let change = Change { shift_px: [x, y], hue_turns, growth };
        let mut read = calibration.tangential([x, y], growth).map_or(vec![], Vec::from);
        read.extend(calibration.normal(1, &change));
        prop_assert!(read.iter().all(|number| number.is_finite()));
    }

    #[test]
    fn any_frame(
        bytes in prop::collection::vec(any::<u8>(), 64),
        (width, height) in (1..80_u32, 1..80_u32),
        mask in prop::option::of((pair(), any_number())),
        diameter in prop::option::of(any_number()),
        (ground, hues) in (0..3_usize, 0..3_usize),
    ) {
        let settings = FinderSettings {
            mask: mask.map(|([x, y], radius)| Mask { centre_px: [40.0 * x, 40.0 * y], radius_px: 40.0 * radius }),
            ground: [None, Some(Ground::Bright), Some(Ground::Dark)][ground],
            hues: [HueWindow::ByGround, HueWindow::Any, HueWindow::MagentaToYellow][hues],
            marker_diameter_px: diameter,
        };
        let Ok(mut finder) = Finder::new(settings) else { return Ok(()) };
        let frame = RgbImage::from_fn(width, height, |x, y| {
            let at = ((x / 5) * 7 + (y / 5) * 13) as usize;
            image::Rgb([0, 1, 2].map(|channel| bytes[(at + channel) % bytes.len()]))
        });
        if let Ok(found) = finder.find(&frame) {
            for marker in found.markers.iter().chain(&found.cut) {
                let [x, y] = marker.centroid_px;
                prop_assert!((x + y + marker.size_px2).is_finite(), "{marker:?}");
                prop_assert!((0.0..1.0).contains(&marker.hue_turns));
            }
        }
    }
}
