//! Frames of all sizes and contents.

use std::num::NonZeroU8;

use image::{Rgb, RgbImage};
use palpate_tracking::{
    Finder, FinderSettings, Found, Ground, HueWindow, Mask, TrackingError, difference,
};

use crate::extremes::{Answer, Case, Outcome};

/// Contents of a frame, by pixel.
#[derive(Clone, Copy, Debug)]
enum Content {
    Black,
    White,
    Grey,
    Random,
    Stripes,
    Chequered,
    /// One magenta disc on white.
    Disc,
    /// Rows of discs that touch.
    Merged,
    /// One marker that fills all but the corners.
    Filled,
}

const CONTENTS: [Content; 9] = [
    Content::Black,
    Content::White,
    Content::Grey,
    Content::Random,
    Content::Stripes,
    Content::Chequered,
    Content::Disc,
    Content::Merged,
    Content::Filled,
];

const MAGENTA: Rgb<u8> = Rgb([250, 60, 170]);
const WHITE: Rgb<u8> = Rgb([245, 245, 245]);

impl Content {
    fn pixel(self, x: u32, y: u32, size: u32) -> Rgb<u8> {
        let within = |radius: f64, centre: [f64; 2]| {
            libm::hypot(f64::from(x) - centre[0], f64::from(y) - centre[1]) <= radius
        };
        let size = f64::from(size);
        match self {
            Self::Black => Rgb([0; 3]),
            Self::White => Rgb([255; 3]),
            Self::Grey => Rgb([127; 3]),
            Self::Random => {
                let mut bits = u64::from(x) << 32 | u64::from(y);
                bits = (bits ^ (bits >> 29)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
                bits = (bits ^ (bits >> 32)).wrapping_mul(0x94d0_49bb_1331_11eb);
                let [red, green, blue, ..] = bits.to_le_bytes();
                Rgb([red, green, blue])
            }
            Self::Stripes if x.is_multiple_of(2) => MAGENTA,
            Self::Chequered if (x + y).is_multiple_of(2) => MAGENTA,
            Self::Disc if within(0.05 * size, DISC.map(|share| share * size)) => MAGENTA,
            Self::Merged => {
                let pitch = 0.1 * size;
                let centre = [x, y].map(|at| (f64::from(at) / pitch).round() * pitch);
                if within(0.52 * pitch, centre) {
                    MAGENTA
                } else {
                    WHITE
                }
            }
            Self::Filled if within(0.6 * size, [0.5 * size; 2]) => MAGENTA,
            _ => WHITE,
        }
    }

    fn frame(self, size: u32) -> RgbImage {
        RgbImage::from_fn(size, size, |x, y| self.pixel(x, y, size))
    }
}

/// The middle of [`Content::Disc`], as shares of the frame's side.
const DISC: [f64; 2] = [0.45, 0.55];

pub(super) fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    for content in CONTENTS {
        for size in [1, 2, 15, 16, 17, 40, 128] {
            cases.push(Case::new(
                "tracking::Finder::find",
                format!("{content:?}, {size} px; in all settings"),
                move || all_settings(content, size),
            ));
        }
    }
    for content in [Content::Black, Content::Random, Content::Merged] {
        cases.push(Case::new(
            "tracking::Finder::find",
            format!("{content:?}, 1024 px; finite"),
            move || found(&content.frame(1024), FinderSettings::default()).into(),
        ));
    }
    cases.push(Case::value(
        "tracking::Finder::find",
        "one disc, 4096 px: its centroid",
        || disc(4096),
    ));
    for size in [40, 64, 200, 512] {
        cases.push(Case::value(
            "tracking::Finder::find",
            format!("one disc, {size} px: its centroid"),
            move || disc(size),
        ));
    }
    for (width, height) in [
        (0, 0),
        (0, 100),
        (100, 0),
        (4096, 1),
        (1, 4096),
        (15, 4096),
        (32_769, 16),
    ] {
        cases.push(Case::refusal(
            "tracking::Finder::find",
            format!("{width} × {height} px"),
            move || Finder::default().find(&RgbImage::new(width, height)),
        ));
    }
    for (width, height) in [(16, 4096), (4096, 16)] {
        cases.push(Case::new(
            "tracking::Finder::find",
            format!("random, {width} × {height} px; finite"),
            move || {
                let frame = RgbImage::from_fn(width, height, |x, y| Content::Random.pixel(x, y, 1));
                found(&frame, FinderSettings::default()).into()
            },
        ));
    }
    for diameter in [
        f64::NAN,
        f64::INFINITY,
        0.0,
        -1.0,
        2.9,
        1e9,
        f64::from_bits(1),
    ] {
        cases.push(Case::refusal(
            "tracking::Finder::new",
            format!("diameter of {diameter:e} px"),
            move || {
                Finder::new(FinderSettings {
                    marker_diameter_px: Some(diameter),
                    ..FinderSettings::default()
                })
            },
        ));
    }
    for diameter in [3.0, 12.8, 1000.0, 32_768.0] {
        cases.push(Case::new(
            "tracking::Finder::find",
            format!("one disc, 128 px, diameter said to be {diameter}: its centroid"),
            move || {
                let settings = FinderSettings {
                    marker_diameter_px: Some(diameter),
                    ..FinderSettings::default()
                };
                found_of_disc(128, settings).into()
            },
        ));
    }
    for (name, centre, radius) in [
        ("of radius NaN", 64.0, f64::NAN),
        ("of radius 0", 64.0, 0.0),
        ("of infinite radius", 64.0, f64::INFINITY),
        ("about NaN", f64::NAN, 50.0),
        ("about -1", -1.0, 50.0),
        ("about a place right of the frame", 128.0, 50.0),
    ] {
        cases.push(Case::refusal(
            "tracking::Finder::find",
            format!("image circle {name}"),
            move || masked(centre, radius),
        ));
    }
    for radius in [f64::from_bits(1), 0.1, 5.0, 1e9, f64::MAX] {
        cases.push(Case::new(
            "tracking::Finder::find",
            format!("image circle of radius {radius:e} px: the disc's centroid"),
            move || masked(64.0, radius).into(),
        ));
    }
    for levels in [1, 255] {
        cases.push(Case::value(
            "tracking::difference",
            format!("white from black, full at {levels}: all green"),
            move || {
                let levels = NonZeroU8::new(levels).unwrap_or(NonZeroU8::MIN);
                let picture =
                    difference(&Content::Black.frame(2), &Content::White.frame(2), levels)?;
                let green = picture.pixels().map(|pixel| (f64::from(pixel.0[0]), 0.0));
                Ok::<_, palpate_tracking::SizesDiffer>(Answer::all_at_scale(green, 255.0))
            },
        ));
    }
    cases.push(Case::value(
        "tracking::difference",
        "two frames without pixels",
        || {
            let picture = difference(&RgbImage::new(0, 0), &RgbImage::new(0, 0), NonZeroU8::MIN)?;
            Ok::<_, palpate_tracking::SizesDiffer>(Answer::at_scale(
                f64::from(picture.width()),
                0.0,
                1.0,
            ))
        },
    ));
    cases.push(Case::refusal(
        "tracking::difference",
        "frames of 1 and 2 px",
        || difference(&RgbImage::new(1, 1), &RgbImage::new(2, 2), NonZeroU8::MIN),
    ));
    cases
}

fn masked(centre: f64, radius_px: f64) -> Result<Answer, TrackingError> {
    let settings = FinderSettings {
        mask: Some(Mask {
            centre_px: [centre, 64.0],
            radius_px,
        }),
        ..FinderSettings::default()
    };
    found_of_disc(128, settings)
}

fn numbers(found: &Found) -> Vec<f64> {
    let markers = found.markers.iter().chain(&found.cut);
    let of_marker = markers.flat_map(|marker| {
        let [x, y] = marker.centroid_px;
        [x, y, marker.hue_turns, marker.size_px2]
    });
    of_marker.chain([found.mask.radius_px]).collect()
}

fn found(frame: &RgbImage, settings: FinderSettings) -> Result<Answer, TrackingError> {
    let found = Finder::new(settings)?.find(frame)?;
    Ok(Answer::finite(numbers(&found)))
}

/// Markers found in a frame of a single disc; if there are any, their middles must be within a fifth of a pixel of the
/// disc's.
fn found_of_disc(size: u32, settings: FinderSettings) -> Result<Answer, TrackingError> {
    let found = Finder::new(settings)?.find(&Content::Disc.frame(size))?;
    let truth = DISC.map(|share| share * f64::from(size));
    let centroids = found.markers.iter().map(|marker| marker.centroid_px);
    let pairs = centroids.flat_map(|[x, y]| [(x, truth[0]), (y, truth[1])]);
    let answer = Answer::all_at_scale(pairs, 1.0).within(0.2);
    Ok(answer.also(numbers(&found)))
}

fn all_settings(content: Content, size: u32) -> Outcome {
    let frame = content.frame(size);
    let grounds = [None, Some(Ground::Bright), Some(Ground::Dark)];
    let windows = [
        HueWindow::ByGround,
        HueWindow::Any,
        HueWindow::MagentaToYellow,
    ];
    let asked = grounds
        .into_iter()
        .flat_map(|ground| windows.map(|hues| (ground, hues)));
    Outcome::of_all(asked.map(|(ground, hues)| {
        let settings = FinderSettings {
            ground,
            hues,
            ..FinderSettings::default()
        };
        found(&frame, settings).map(|answer| answer.values)
    }))
}

/// The centroid of a disc, to a fifth of a pixel: its edge is drawn in whole ones.
fn disc(size: u32) -> Result<Answer, TrackingError> {
    let settings = FinderSettings {
        marker_diameter_px: Some(0.1 * f64::from(size)),
        ..FinderSettings::default()
    };
    found_of_disc(size, settings)
}
