//! Tests rendered frames. The features of markers that are measured in rendered frames are compared with the projected
//! features.

use image::RgbImage;
use palpate_chromatouch::{
    Blemishes, Camera, Colours, DiscMotion, Layout, Lens, MarkerArray, MarkerMotion, OddTerms,
    Optics, Seams, SeenMarker,
};

use crate::optics::{DISCS, depths, discs};

/// Colours for which all regions of a marker have integer pixel levels, so that rounding causes no error.
const WHOLE_LEVELS: Colours = Colours {
    white: [240.0 / 255.0; 3],
    magenta: [0.95, 0.40, 0.60],
    yellow: [1.0, 0.75, 0.25],
    seam: [0.5, 0.5, 0.5],
    outside: [0.0; 3],
};

fn array(places: &[[f64; 2]], misalignment: f64) -> MarkerArray {
    let array = MarkerArray::new(20.0, places, DISCS, depths(3.0, 1.0)).unwrap();
    array.misaligned(misalignment, 11, 0).unwrap()
}

fn published() -> MarkerArray {
    array(&Layout::published().places(20.0).unwrap(), 0.3)
}

fn optics(array: MarkerArray, size_px: u32, blemishes: Blemishes) -> Optics {
    let camera = Camera::new(Lens::Fisheye, size_px, 70.0).unwrap();
    Optics::new(array, camera, WHOLE_LEVELS, blemishes).unwrap()
}

fn at_rest(optics: &Optics) -> Vec<Option<MarkerMotion>> {
    vec![Some(MarkerMotion::default()); optics.array().places().len()]
}

/// Features of the marker in a square of the frame. They are computed from the levels of the square's pixels, as the
/// documentation of [`SeenMarker`] defines them. The background is white.
fn measured(frame: &RgbImage, middle: [f64; 2], half_side: f64) -> SeenMarker {
    let ground = 240.0;
    let range = |middle: f64| (middle - half_side) as u32..=(middle + half_side) as u32;
    let (mut size, mut moment, mut colour) = (0.0, [0.0; 2], [0.0; 3]);
    for row in range(middle[1]) {
        for column in range(middle[0]) {
            let [red, green, blue] = frame.get_pixel(column, row).0.map(f64::from);
            let taken = 2.0 - (green + blue) / ground;
            size += taken;
            moment[0] += taken * f64::from(column);
            moment[1] += taken * f64::from(row);
            for (sum, light) in colour.iter_mut().zip([red, green, blue]) {
                *sum += light;
            }
        }
    }
    SeenMarker {
        centroid_px: moment.map(|sum| sum / size),
        hue_turns: hue_of_a_red(colour),
        mean_hue_turns: 0.0,
        size_px2: size,
    }
}

/// Hue (turns) of a colour whose largest component is red.
fn hue_of_a_red([red, green, blue]: [f64; 3]) -> f64 {
    assert!(red > green && red > blue);
    ((green - blue) / (red - green.min(blue)) / 6.0).rem_euclid(1.0)
}

/// Largest differences, over several markers, between the projected features and the features measured in rendered
/// frames: centroid (px), hue (turns), and size (relative).
fn differences(lens: Lens, size_px: u32, misalignment: f64, moves: bool) -> [f64; 3] {
    let polar = [0.0_f64, 0.02, 20.0, 40.0, 60.0, 60.0];
    let azimuth = [0.0_f64, 0.0, 100.0, 200.0, 300.0, 45.0];
    // The first two markers would overlap in one frame, so they are rendered in two separate frames.
    let places: Vec<[f64; 2]> = std::iter::zip(polar, azimuth)
        .map(|(polar, azimuth)| {
            let (sine, cosine) = libm::sincos(azimuth.to_radians());
            [cosine, sine].map(|share| 20.0 * polar.to_radians() * share)
        })
        .collect();
    let field_deg = match lens {
        Lens::Fisheye | Lens::Odd(_) => 80.0,
        Lens::Pinhole => 72.0,
    };
    let camera = Camera::new(lens, size_px, field_deg).unwrap();
    let mut largest = [0.0_f64; 3];
    for places in [&places[1..], &places[..1]] {
        let array = array(places, misalignment);
        let optics = Optics::new(array, camera, WHOLE_LEVELS, Blemishes::default()).unwrap();
        let disc = |normal, x, y| DiscMotion {
            normal,
            tangential: [x, y],
            ..DiscMotion::default()
        };
        let motion = if moves {
            MarkerMotion {
                magenta: disc(0.4, 0.1, -0.2),
                yellow: disc(0.9, 0.3, 0.1),
            }
        } else {
            MarkerMotion::default()
        };
        let motions = vec![Some(motion); places.len()];
        let frame = optics.render(&motions, None).unwrap();
        for marker in optics.project(&motions).unwrap() {
            let marker = marker.unwrap();
            let [column, row] = marker.centroid_px;
            let [middle, _] = camera.centre_px();
            let from_centre = libm::hypot(column - middle, row - middle) / camera.px_per_rad();
            // Half-width of a square that contains this marker but no other marker, divided by the focal length.
            let half_side = match lens {
                Lens::Fisheye | Lens::Odd(_) => 0.16,
                Lens::Pinhole => 0.15 * (1.0 + from_centre * from_centre),
            };
            let found = measured(&frame, marker.centroid_px, half_side * camera.px_per_rad());
            let turn = found.hue_turns - marker.hue_turns;
            let [x, y] = [0, 1].map(|axis| found.centroid_px[axis] - marker.centroid_px[axis]);
            let differences = [
                libm::hypot(x, y),
                (turn - turn.round()).abs(),
                (found.size_px2 / marker.size_px2 - 1.0).abs(),
            ];
            for (largest, difference) in largest.iter_mut().zip(differences) {
                *largest = largest.max(difference);
            }
        }
    }
    largest
}

#[test]
fn frames_show_what_is_projected_the_better_the_larger() {
    // The tolerance is largest for a pinhole lens. With this lens, the overlap of the discs causes the largest error of
    // the projected centroid: up to 2e-4 focal lengths at 60°.
    let odd = |k3, k5| Lens::from(OddTerms { k3, k5 });
    for (lens, bound_px) in [
        (Lens::Fisheye, 0.01),
        (odd(0.1, -0.01), 0.01),
        (Lens::Pinhole, 0.06),
    ] {
        for (misalignment, moves) in [(0.0, false), (0.5, true)] {
            let differences = |size_px| differences(lens, size_px, misalignment, moves);
            let [small, large] = [256, 2048].map(differences);
            let bounds = [bound_px, 1e-4, 1e-3];
            assert!(
                std::iter::zip(large, bounds).all(|(one, bound)| one < bound),
                "{large:?}"
            );
            // Check that errors decrease with the size of the frame. The errors of hue and size are compared directly,
            // and the error of the centroid relative to the size of the frame. The centroid of the pinhole lens is not
            // compared. Its error comes mostly from the overlap of the discs, so it does not depend on the size of the
            // frame.
            assert!(
                lens == Lens::Pinhole || large[0] / 2048.0 < 0.5 * small[0] / 256.0,
                "{small:?} {large:?}"
            );
            assert!(
                large[1] < 0.25 * small[1] && large[2] < 0.25 * small[2],
                "{small:?} {large:?}"
            );
        }
    }
}

#[test]
fn discs_much_smaller_than_a_pixel_take_their_share() {
    // The frame has many markers, so that their positions relative to the pixel grid differ.
    let layout = Layout::Lattice {
        pitch: 0.4,
        cap_deg: 35.0,
    };
    let places = layout.places(20.0).unwrap();
    let discs = discs(0.2, 0.2);
    let depths = depths(1.0, 1.0);
    let array = MarkerArray::new(20.0, &places, discs, depths).unwrap();
    // In these frames, the discs have radii of 0.2 to 1.6 px.
    for size_px in [100, 200, 400, 800] {
        let optics = optics(array.clone(), size_px, Blemishes::default());
        let motions = at_rest(&optics);
        let seen = optics.project(&motions).unwrap().into_iter().flatten();
        let expected: f64 = seen.map(|marker| marker.size_px2).sum();
        let half = 0.33 * f64::from(size_px);
        let [middle, _] = optics.camera().centre_px();
        let frame = optics.render(&motions, None).unwrap();
        // The total size is measured in a square that contains all markers and lies inside of the image circle.
        let found = measured(&frame, [middle; 2], half).size_px2;
        assert!(
            (found / expected - 1.0).abs() < 0.03,
            "{size_px}: {found} {expected}"
        );
    }
}

#[test]
fn blemishes_that_are_off_change_no_byte() {
    let motions = at_rest(&optics(published(), 265, Blemishes::default()));
    let frame = |blemishes, noise| {
        let optics = optics(published(), 265, blemishes);
        optics.render(&motions, noise).unwrap()
    };
    let clean = frame(Blemishes::default(), None);
    assert!(frame(Blemishes::default(), Some((1, 0))) == clean);
    let hidden = Seams {
        gores: 4,
        width: 0.0,
    };
    let off = Blemishes {
        seams: Some(hidden),
        ..Blemishes::default()
    };
    assert!(frame(off, None) == clean);
    let noise = Blemishes {
        pixel_std: 2.0,
        ..Blemishes::default()
    };
    assert!(frame(noise, None) == clean);
    let noisy = |trial| frame(noise, Some((1, trial)));
    assert!(noisy(0) == noisy(0) && noisy(0) != noisy(1) && noisy(0) != clean);
}

fn empty(size_px: u32, blemishes: Blemishes, noise: Option<u64>) -> RgbImage {
    let optics = optics(array(&[], 0.0), size_px, blemishes);
    optics.render(&[], noise.map(|seed| (seed, 0))).unwrap()
}

fn level(frame: &RgbImage, column: u32, row: u32) -> f64 {
    f64::from(frame.get_pixel(column, row).0[1])
}

#[test]
fn the_image_circle_is_cut_out_of_what_surrounds_it() {
    for size_px in [1, 2, 33, 200] {
        let frame = empty(size_px, Blemishes::default(), None);
        let sum: f64 = frame.pixels().map(|pixel| f64::from(pixel.0[1])).sum();
        let area = std::f64::consts::PI * f64::from(size_px).powi(2) / 4.0;
        let error = (sum / 240.0 - area) / f64::from(size_px);
        // If the frame has few pixels, the number of pixels inside the circle is a bad estimate of the circle's area.
        // For example, a frame of one pixel counts completely, because the centre of the pixel is in the circle.
        assert!(
            error.abs() < if size_px < 3 { 0.3 } else { 0.05 },
            "{size_px}: {error}"
        );
    }
    assert_eq!(level(&empty(200, Blemishes::default(), None), 0, 0), 0.0);
}

#[test]
fn light_falls_with_the_square_of_the_polar_angle() {
    let blemishes = Blemishes {
        light_at_rim: 0.5,
        ..Blemishes::default()
    };
    let frame = empty(201, blemishes, None);
    for column in [100, 120, 150, 190] {
        let share = f64::from(column - 100) / 100.5;
        let expected = 240.0 * (1.0 - 0.5 * share * share);
        let found = level(&frame, column, 100);
        assert!((found - expected).abs() <= 0.5, "{found} {expected}");
    }
    // Through a pinhole, the distance from the image centre is proportional to tan θ, where θ is the polar angle.
    let camera = Camera::new(Lens::Pinhole, 201, 60.0).unwrap();
    let optics = Optics::new(array(&[], 0.0), camera, WHOLE_LEVELS, blemishes).unwrap();
    let frame = optics.render(&[], None).unwrap();
    let polar = libm::atan(50.0 / 100.5 * libm::tan(60.0_f64.to_radians()));
    let expected = 240.0 * (1.0 - 0.5 * (polar / 60.0_f64.to_radians()).powi(2));
    assert!((level(&frame, 150, 100) - expected).abs() <= 0.5);
}

#[test]
fn seams_are_as_wide_on_the_skin_everywhere() {
    for width in [0.01, 1.0] {
        let blemishes = Blemishes {
            seams: Some(Seams { gores: 3, width }),
            ..Blemishes::default()
        };
        let frame = empty(1001, blemishes, None);
        let focal = 500.5 / 70.0_f64.to_radians();
        let taken = |columns: &mut dyn Iterator<Item = (u32, u32)>| -> f64 {
            columns
                .map(|(column, row)| 1.0 - level(&frame, column, row) / 240.0)
                .sum()
        };
        for polar_deg in [20.0_f64, 60.0] {
            let polar = polar_deg.to_radians();
            // This column of pixels crosses the seam that runs from the apex along +x. A seam absorbs half of the
            // light.
            let column = (500.0 + focal * polar).round() as u32;
            let found = 2.0 * taken(&mut (400..600).map(|row| (column, row)));
            let expected = 2.0 * libm::sin(0.025 * width) * focal * polar / libm::sin(polar);
            assert!((found / expected - 1.0).abs() < 0.03, "{found} {expected}");
            // This column of pixels is on the −x side of the apex. No seam runs along −x, so the column crosses the two
            // other seams, which run obliquely at ±120° from +x.
            let column = (500.0 - 0.5 * focal * polar).round() as u32;
            let found = taken(&mut (0..1001).filter_map(|row| {
                let inside = libm::hypot(f64::from(row) - 500.0, f64::from(column) - 500.0) < 499.0;
                inside.then_some((column, row))
            }));
            assert!(
                (found / (2.0 * expected) - 1.0).abs() < 0.03,
                "{found} {expected}"
            );
        }
    }
}

#[test]
fn a_blur_is_a_gaussian_and_keeps_the_light() {
    let clean = Blemishes::default();
    let blurred = Blemishes {
        blur_px: 3.0,
        ..clean
    };
    let sum = |frame: &RgbImage| -> f64 { frame.pixels().map(|one| f64::from(one.0[0])).sum() };
    let [sharp, soft] = [clean, blurred].map(|blemishes| {
        let optics = optics(published(), 400, blemishes);
        optics.render(&at_rest(&optics), None).unwrap()
    });
    assert!((sum(&soft) / sum(&sharp) - 1.0).abs() < 1e-3);
    // This sensor has one straight seam, which covers a large part of the field of view. The blur turns the seam's edge
    // into an error function, whose values at 0.5, 1 and 2 standard deviations from the edge are tabulated.
    let wide = Seams {
        gores: 1,
        width: 20.0,
    };
    let frame = empty(
        401,
        Blemishes {
            seams: Some(wide),
            ..blurred
        },
        None,
    );
    let column = 300;
    let edge = {
        let focal = 200.5 / 70.0_f64.to_radians();
        let polar = |row: f64| libm::hypot(row - 200.0, 100.0) / focal;
        // Find the row of the seam's edge by bisection: there, the distance from the middle of the seam equals the
        // half-width of the seam in the image.
        let off = |row: f64| {
            row - 200.0 - libm::sin(0.5_f64) * focal * polar(row) / libm::sin(polar(row))
        };
        let (mut low, mut high) = (200.0, 380.0);
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if off(middle) < 0.0 {
                low = middle;
            } else {
                high = middle;
            }
        }
        low
    };
    let at = |row: f64| {
        let (first, share) = (row.floor(), row.fract());
        let [low, high] = [0, 1].map(|step| level(&frame, column, first as u32 + step));
        (low + share * (high - low)) / 240.0
    };
    for (deviations, step) in [(0.5, 0.6915), (1.0, 0.8413), (2.0, 0.9772), (-1.0, 0.1587)] {
        let found = at(edge + 3.0 * deviations);
        assert!(
            (found - (0.5 + 0.5 * step)).abs() < 0.012,
            "{deviations}: {found}"
        );
    }
}

#[test]
fn markers_that_are_not_there_leave_the_ground_and_those_on_the_rim_are_cut() {
    let optics = optics(published(), 265, Blemishes::default());
    let frame = optics.render(&vec![None; 77], None).unwrap();
    assert!(frame == empty(265, Blemishes::default(), None));
    // The middle of the marker is on the rim, 70° from the apex, so that half of the marker is visible.
    let reach = 20.0 * 70.0_f64.to_radians();
    let camera = Camera::new(Lens::Fisheye, 801, 70.0).unwrap();
    let rim = Optics::new(
        array(&[[reach, 0.0]], 0.0),
        camera,
        WHOLE_LEVELS,
        Blemishes::default(),
    );
    let rim = rim.unwrap();
    assert_eq!(rim.project(&at_rest(&rim)).unwrap(), [None]);
    let cut = rim.render(&at_rest(&rim), None).unwrap();
    let without = empty(801, Blemishes::default(), None);
    let pairs = std::iter::zip(cut.pixels(), without.pixels());
    let changed = pairs.filter(|(one, other)| one != other).count() as f64;
    let wide = Camera::new(Lens::Fisheye, 801, 80.0).unwrap();
    let scale = (camera.px_per_rad() / wide.px_per_rad()).powi(2);
    let whole = scale
        * wide
            .disc_area(libm::atan(1.0_f64 / 17.0), 70.0_f64.to_radians())
            .unwrap();
    assert!((changed / whole - 0.5).abs() < 0.05, "{changed} {whole}");
}

#[test]
fn frames_of_any_size_are_rendered() {
    for size_px in [1, 2, 17, 1024] {
        let optics = optics(published(), size_px, Blemishes::default());
        let frame = optics.render(&at_rest(&optics), None).unwrap();
        assert_eq!(frame.dimensions(), (size_px, size_px));
        let largest = frame.pixels().map(|pixel| pixel.0[0]).max().unwrap();
        assert!((100..=240).contains(&largest), "{size_px}: {largest}");
    }
    let all = Blemishes {
        light_at_rim: 0.0,
        blur_px: 16.0,
        seams: Some(Seams {
            gores: 360,
            width: 1e300,
        }),
        pixel_std: 255.0,
    };
    for (lens, field) in [(Lens::Fisheye, 180.0), (Lens::Pinhole, 89.9999)] {
        for size_px in [1, 2, 40] {
            let camera = Camera::new(lens, size_px, field).unwrap();
            let optics = Optics::new(published(), camera, WHOLE_LEVELS, all).unwrap();
            optics.render(&at_rest(&optics), Some((1, 0))).unwrap();
        }
    }
}
