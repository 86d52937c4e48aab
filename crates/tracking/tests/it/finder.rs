//! Tests the search for markers in frames whose true markers are known.

use image::{Rgb, RgbImage};
use palpate_tracking::{Finder, Ground, Marker, Mask, TrackingError};

use crate::frames::{self, Bright, Truth};

fn find(frame: &RgbImage) -> palpate_tracking::Found {
    Finder::default().find(frame).unwrap()
}

fn away(marker: &Marker, place: [f64; 2]) -> f64 {
    libm::hypot(
        marker.centroid_px[0] - place[0],
        marker.centroid_px[1] - place[1],
    )
}

/// Root mean square errors of the found markers: in the centroid (px), in the hue (turns) and in the size (relative).
/// Panics unless each true marker was found exactly once, and nothing else was found.
fn errors(found: &[Marker], truth: &[Truth], reach: f64) -> [f64; 3] {
    assert_eq!(found.len(), truth.len());
    let mut squares = [0.0; 3];
    for known in truth {
        let near: Vec<&Marker> = found
            .iter()
            .filter(|marker| away(marker, known.centroid_px) < reach)
            .collect();
        assert_eq!(near.len(), 1, "{known:?}");
        let turn = near[0].hue_turns - known.hue_turns;
        let errors = [
            away(near[0], known.centroid_px),
            turn - turn.round(),
            near[0].size_px2 / known.size_px2 - 1.0,
        ];
        for (square, error) in squares.iter_mut().zip(errors) {
            *square += error * error;
        }
    }
    squares.map(|square| (square / truth.len() as f64).sqrt())
}

#[test]
fn discs_of_any_hue_on_a_dark_ground() {
    for (size, centroid, degrees) in [(640, 0.020, 0.15), (1024, 0.020, 0.08)] {
        let (frame, truth) = frames::dark(size, 5);
        let circle = Mask {
            centre_px: [0.5 * size as f64; 2],
            radius_px: 0.48 * size as f64,
        };
        for mask in [Some(circle), None] {
            let found = Finder::new(mask, None).find(&frame).unwrap();
            let [place, hue, _] = errors(&found.markers, &truth, 0.02 * size as f64);
            assert_eq!((found.ground, found.cut.len()), (Ground::Dark, 0));
            assert!(
                place < centroid && 360.0 * hue < degrees,
                "{size} {mask:?}: {place} {hue}"
            );
            assert!((found.mask.radius_px - circle.radius_px).abs() < 2.0);
        }
    }
}

#[test]
fn misaligned_discs_on_a_bright_ground() {
    let clean = Bright {
        size: 640,
        disc_px: 32.0,
        apart: 0.0,
        blur_px: 0.0,
        falloff: 0.0,
        // Add a little noise. Without noise, all pixels of one colour would have the same rounding error of up to half
        // a level.
        noise: 0.5,
    };
    let worst = Bright {
        apart: 0.3,
        blur_px: 2.0,
        falloff: 0.5,
        noise: 2.0,
        ..clean
    };
    let places = frames::rings(640, 56.0, 4);
    for how in [clean, worst] {
        let (frame, truth) = frames::bright(how, &places, 9);
        let found = find(&frame);
        let [place, hue, size] = errors(&found.markers, &truth, 16.0);
        assert_eq!((found.ground, found.cut.len()), (Ground::Bright, 0));
        assert!(
            place < 0.03 && hue < 2e-4 && size < 2e-3,
            "{how:?}: {place} {hue} {size}"
        );
    }
}

#[test]
fn a_photograph() {
    // The list of the true markers was made by eye from enlargements of the photograph with a grid. `clear` markers are
    // away from the rim, `touching` markers reach or nearly reach the rim, and `cut` markers are partly beyond the rim.
    // The position of a marker is the centre of both discs together, accurate to about 2 px.
    let data = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data/camera-frame-265px");
    let frame = image::open(format!("{data}.png")).unwrap().to_rgb8();
    let list = std::fs::read_to_string(format!("{data}-markers.csv")).unwrap();
    let found = find(&frame);
    let mut explained = 0;
    for line in list.lines().skip(1) {
        let [x, y, rim] = line.split(',').collect::<Vec<_>>()[..] else {
            panic!("{line}")
        };
        let place = [x, y].map(|at| at.parse::<f64>().unwrap());
        let near = |markers: &[Marker]| {
            markers
                .iter()
                .filter(|marker| away(marker, place) < 4.5)
                .count()
        };
        let (whole, cut) = (near(&found.markers), near(&found.cut));
        match rim {
            "clear" => assert_eq!((whole, cut), (1, 0), "{line}"),
            "touching" => assert_eq!(whole + cut, 1, "{line}"),
            _ => assert!(whole == 0 && cut <= 1, "{line}"),
        }
        explained += whole + cut;
    }
    assert_eq!(
        explained,
        found.markers.len() + found.cut.len(),
        "nothing else is found"
    );
}

#[test]
fn order_is_from_the_middle_outward_and_memory_is_not_kept() {
    let how = Bright {
        size: 300,
        disc_px: 16.0,
        apart: 0.2,
        blur_px: 1.0,
        falloff: 0.2,
        noise: 2.0,
    };
    let (frame, _) = frames::bright(how, &frames::rings(300, 40.0, 3), 1);
    let (other, _) = frames::dark(240, 2);
    let mut finder = Finder::default();
    let once = finder.find(&frame).unwrap();
    finder.find(&other).unwrap();
    assert_eq!(finder.find(&frame).unwrap(), once);
    let outward: Vec<f64> = once
        .markers
        .iter()
        .map(|marker| away(marker, once.mask.centre_px))
        .collect();
    assert!(outward.is_sorted() && outward.len() == 37);
}

#[test]
fn grey_dust_and_blue_stains_are_no_markers() {
    let how = Bright {
        size: 320,
        disc_px: 20.0,
        apart: 0.2,
        blur_px: 0.0,
        falloff: 0.0,
        noise: 1.0,
    };
    let (mut frame, truth) = frames::bright(how, &frames::rings(320, 44.0, 2), 4);
    for (middle, colour) in [([40, 40], [60, 60, 60]), ([280, 60], [60, 120, 220])] {
        for (x, y, pixel) in frame.enumerate_pixels_mut() {
            if x.abs_diff(middle[0]).pow(2) + y.abs_diff(middle[1]).pow(2) < 100 {
                *pixel = Rgb(colour);
            }
        }
    }
    errors(&find(&frame).markers, &truth, 8.0);
}

/// Name of the error of the search for markers; `found` if the search succeeds and all numbers of the markers are
/// valid.
fn name(frame: &RgbImage, mut finder: Finder) -> &'static str {
    match finder.find(frame) {
        Ok(found) => {
            for marker in found.markers.iter().chain(&found.cut) {
                let [x, y] = marker.centroid_px;
                let numbers = [x, y, marker.hue_turns, marker.size_px2];
                assert!(numbers.iter().all(|value| value.is_finite()));
                assert!((0.0..1.0).contains(&marker.hue_turns) && marker.size_px2 > 0.0);
            }
            "found"
        }
        Err(error) => {
            let is_named = matches!(error, TrackingError::MaskOutside { .. });
            assert!(is_named || !error.to_string().contains("NaN"), "{error}");
            error.into()
        }
    }
}

#[test]
fn frames_without_markers_have_names() {
    let auto = Finder::default;
    let flat = |width, height, grey| RgbImage::from_pixel(width, height, Rgb([grey; 3]));
    assert_eq!(name(&flat(0, 0, 0), auto()), "empty-image");
    assert_eq!(name(&flat(0, 9, 0), auto()), "empty-image");
    for (width, height) in [(1, 1), (2, 2), (1, 500), (500, 1), (15, 900)] {
        assert_eq!(name(&flat(width, height, 7), auto()), "too-small");
    }
    assert_eq!(name(&flat(40_000, 16, 7), auto()), "too-large");
    // The first frame shows a grid of discs that touch each other. The second frame shows one disc that fills the frame
    // except for the corners.
    let discs = |pitch: f64, share: f64| {
        let is_in = move |x: u32, y: u32| {
            let off = [x, y].map(|at| {
                let at = f64::from(at) / pitch - 0.5;
                at - at.round()
            });
            libm::hypot(off[0], off[1]) < share
        };
        RgbImage::from_fn(128, 128, move |x, y| {
            Rgb(if is_in(x, y) {
                [250, 60, 170]
            } else {
                [245; 3]
            })
        })
    };
    assert_eq!(name(&discs(12.8, 0.52), auto()), "no-markers");
    assert_eq!(name(&discs(128.0, 0.6), auto()), "no-markers");
    for ground in [None, Some(Ground::Bright), Some(Ground::Dark)] {
        for (width, height) in [(16, 16), (17, 300), (300, 17), (256, 256)] {
            for grey in [0, 1, 128, 254, 255] {
                assert_eq!(
                    name(&flat(width, height, grey), Finder::new(None, ground)),
                    "no-markers"
                );
            }
        }
    }
}

#[test]
fn impossible_settings_have_names() {
    let frame = RgbImage::from_pixel(100, 80, Rgb([200; 3]));
    let circle = |x: f64, y: f64, radius_px: f64| {
        let centre_px = [x, y];
        Finder::new(
            Some(Mask {
                centre_px,
                radius_px,
            }),
            None,
        )
    };
    for finder in [
        circle(50.0, 40.0, 0.0),
        circle(50.0, 40.0, f64::NAN),
        circle(50.0, 40.0, f64::INFINITY),
        circle(f64::NAN, 40.0, 30.0),
        circle(100.0, 40.0, 30.0),
        circle(50.0, -900.0, 1000.0),
    ] {
        assert_eq!(name(&frame, finder), "mask-outside");
    }
    for finder in [
        circle(50.0, 40.0, 1e-300),
        circle(0.0, 0.0, 1.0),
        circle(99.9, 79.9, 1e300),
    ] {
        assert_eq!(name(&frame, finder), "no-markers");
    }
}
