//! Frames of all sizes and contents.

use std::num::NonZeroU8;

use image::{Rgb, RgbImage};
use palpate_tracking::{
    Finder, FinderSettings, Ground, HueWindow, Mask, SizesDiffer, TrackingError, difference,
};
use palpate_verdict::{Answer, rows};

const FIND: &str = "tracking::Finder::find";
const DIFFERENCE: &str = "tracking::difference";
const LEAST: f64 = f64::from_bits(1);
/// Colour of a pixel: its column, its row, and the side of the frame.
type Content = fn(u32, u32, u32) -> Rgb<u8>;
const BLACK: Content = |_, _, _| Rgb([0; 3]);
const WHITE: Content = |_, _, _| Rgb([255; 3]);
/// Frames without a marker that stands alone: rows of discs that touch, and a disc that fills all but the corners,
/// among others.
const NO_MARKERS: [(&str, Content); 8] = [
    ("Black", BLACK),
    ("White", WHITE),
    ("Grey", |_, _, _| Rgb([127; 3])),
    ("Random", random),
    ("Stripes", |x, _, _| magenta(x.is_multiple_of(2))),
    ("Chequered", |x, y, _| magenta((x + y).is_multiple_of(2))),
    ("Merged", |x, y, size| {
        let pitch = 0.1 * f64::from(size);
        let centre = [x, y].map(|at| (f64::from(at) / pitch).round() * pitch);
        magenta(within(0.52 * pitch, centre, x, y))
    }),
    ("Filled", |x, y, size| {
        let size = f64::from(size);
        magenta(within(0.6 * size, [0.5 * size; 2], x, y))
    }),
];
/// The middle of [`disc`], as shares of the frame's side.
const MIDDLE: [f64; 2] = [0.45, 0.55];

rows! {
    FIND, "{name}, {size} px; in all settings too small" => all_settings(content, size, 0, "too-small"),
        for (name, content) in NO_MARKERS.into_iter().chain([("Disc", disc as Content)]), for size in [1, 2, 15];
    FIND, "{name}, {size} px; in all settings without markers" => all_settings(content, size, 0, "no-markers"),
        for (name, content) in NO_MARKERS, for size in [16, 17, 40, 128];
    FIND, "Disc, {size} px; in {answered} of 9 settings" => all_settings(disc, size, answered, "no-markers"),
        for (size, answered) in [(16, 0), (17, 0), (40, 6), (128, 6)];
    FIND, "{name}, 1024 px", "no-markers" => found(&frame(content, 1024), FinderSettings::default()),
        for (name, content) in NO_MARKERS;
    FIND, "one disc, {size} px: its centroid" => of_disc(size, diameter(0.1 * f64::from(size))),
        for size in [40, 64, 200, 512, 4096];
    FIND, "{width} × {height} px", "empty-image" => found(&RgbImage::new(width, height), FinderSettings::default()),
        for (width, height) in [(0, 0), (0, 100), (100, 0)];
    FIND, "{width} × {height} px", "too-small" => found(&RgbImage::new(width, height), FinderSettings::default()),
        for (width, height) in [(4096, 1), (1, 4096), (15, 4096)];
    FIND, "32769 × 16 px", "too-large" => found(&RgbImage::new(32_769, 16), FinderSettings::default());
    FIND, "random, {width} × {height} px", "no-markers" =>
        found(&RgbImage::from_fn(width, height, |x, y| random(x, y, 1)), FinderSettings::default()),
        for (width, height) in [(16, 4096), (4096, 16)];
    FIND, "one disc, 128 px, diameter said to be 12.8: its centroid" => of_disc(128, diameter(12.8));
    FIND, "one disc, 128 px, diameter said to be {said}", "no-markers" => of_disc(128, diameter(said)),
        for said in [3.0, 1000.0, 32_768.0];
    FIND, "image circle of radius {radius:e} px: the disc's centroid" => of_disc(128, masked(64.0, radius)),
        for radius in [1e9, f64::MAX];
    FIND, "image circle of radius {radius:e} px", "no-markers" => of_disc(128, masked(64.0, radius)),
        for radius in [LEAST, 0.1, 5.0];
    FIND, "image circle of radius {radius:e} px", "mask-outside" => of_disc(128, masked(64.0, radius)),
        for radius in [f64::NAN, 0.0, f64::INFINITY];
    FIND, "image circle about {centre}, of 128 px", "mask-outside" => of_disc(128, masked(centre, 50.0)),
        for centre in [f64::NAN, -1.0, 128.0];
    "tracking::Finder::new", "diameter of {bad:e} px", "diameter" => Finder::new(diameter(bad)),
        for bad in [f64::NAN, f64::INFINITY, 0.0, -1.0, 2.9, 1e9, LEAST];
    DIFFERENCE, "white from black, full at {levels}: all green" => green(2, levels), for levels in [1, 255];
    DIFFERENCE, "two frames without pixels" =>
        difference(&frame(BLACK, 0), &frame(WHITE, 0), NonZeroU8::MIN)
            .map(|picture| Answer::holds(picture.dimensions() == (0, 0)));
    DIFFERENCE, "frames of 1 and 2 px", "sizes-differ" =>
        difference(&frame(BLACK, 1), &frame(WHITE, 2), NonZeroU8::MIN);
}

const fn magenta(is_marker: bool) -> Rgb<u8> {
    Rgb(if is_marker { [250, 60, 170] } else { [245; 3] })
}

fn within(radius: f64, centre: [f64; 2], x: u32, y: u32) -> bool {
    libm::hypot(f64::from(x) - centre[0], f64::from(y) - centre[1]) <= radius
}

fn random(x: u32, y: u32, _: u32) -> Rgb<u8> {
    let mut bits = u64::from(x) << 32 | u64::from(y);
    bits = (bits ^ (bits >> 29)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    bits = (bits ^ (bits >> 32)).wrapping_mul(0x94d0_49bb_1331_11eb);
    let [red, green, blue, ..] = bits.to_le_bytes();
    Rgb([red, green, blue])
}

/// One magenta disc on white.
fn disc(x: u32, y: u32, size: u32) -> Rgb<u8> {
    let size = f64::from(size);
    magenta(within(0.05 * size, MIDDLE.map(|share| share * size), x, y))
}

fn frame(content: Content, size: u32) -> RgbImage {
    RgbImage::from_fn(size, size, |x, y| content(x, y, size))
}

fn masked(x: f64, radius_px: f64) -> FinderSettings {
    let centre_px = [x, 64.0];
    FinderSettings {
        mask: Some(Mask {
            centre_px,
            radius_px,
        }),
        ..FinderSettings::default()
    }
}

fn diameter(diameter: f64) -> FinderSettings {
    FinderSettings {
        marker_diameter_px: Some(diameter),
        ..FinderSettings::default()
    }
}

/// All numbers of what is found, that of a marker's centroid first.
fn found(frame: &RgbImage, settings: FinderSettings) -> Result<Vec<f64>, TrackingError> {
    let found = Finder::new(settings)?.find(frame)?;
    let markers = found.markers.iter().chain(&found.cut);
    let of_marker = markers.flat_map(|marker| {
        let [x, y] = marker.centroid_px;
        [x, y, marker.hue_turns, marker.size_px2]
    });
    Ok(of_marker.chain([found.mask.radius_px]).collect())
}

/// Centroid of the only marker in a frame of a single disc, to a fifth of a pixel: its edge is drawn in whole ones.
fn of_disc(size: u32, settings: FinderSettings) -> Result<Answer, TrackingError> {
    let numbers = found(&frame(disc, size), settings)?;
    let truth = MIDDLE.map(|share| share * f64::from(size));
    let pairs = numbers.iter().copied().zip(truth);
    let pairs = pairs.chain([(numbers.len() as f64, 5.0)]);
    Ok(Answer::all_at_scale(pairs, 1.0).within(0.2).also(numbers))
}

fn all_settings(content: Content, size: u32, answered: u32, error: &str) -> Result<Answer, String> {
    let frame = frame(content, size);
    let windows = [
        HueWindow::ByGround,
        HueWindow::Any,
        HueWindow::MagentaToYellow,
    ];
    let grounds = [None, Some(Ground::Bright), Some(Ground::Dark)];
    let asked = grounds
        .into_iter()
        .flat_map(|ground| windows.map(|hues| (ground, hues)));
    let calls = asked.map(|(ground, hues)| {
        let settings = FinderSettings {
            ground,
            hues,
            ..FinderSettings::default()
        };
        found(&frame, settings)
    });
    Answer::counted(calls, answered, &[error])
}

fn green(size: u32, levels: u8) -> Result<Answer, SizesDiffer> {
    let levels = NonZeroU8::new(levels).unwrap();
    let picture = difference(&frame(BLACK, size), &frame(WHITE, size), levels)?;
    let red = picture.pixels().map(|pixel| (f64::from(pixel.0[0]), 0.0));
    Ok(Answer::all_at_scale(red, 255.0))
}
