//! Calibrations and frames in files.

use image::{ImageFormat, Rgb, RgbImage};
use palpate_scene::recorded::{
    Calibration, Frame, RecordedError, RecordedFile, parse_calibration, parse_frame,
};
use palpate_verdict::{Answer, rows};

const CALIBRATION: &str = "scene::recorded::parse_calibration";
const FRAME: &str = "scene::recorded::parse_frame";
const BAD_SLOPES: [&str; 7] = ["nan", "inf", "-inf", "0.0", "-0.0", "5e-324", "1e999"];
const NO_CALIBRATIONS: [&str; 6] = [
    "",
    "\0",
    "length_unit = \"mm\"",
    "markers = -1",
    "[normal]",
    "\u{feff}[",
];

rows! {
    CALIBRATION, "a slope of {slope}", "file" => calibration(slope, "1.0"), for slope in BAD_SLOPES;
    CALIBRATION, "a weight of {weight}", "file" => calibration("0.5", weight), for weight in ["nan", "inf", "-inf"];
    CALIBRATION, "a slope of {slope:e}: the same again" => again(slope), for slope in [1e-50, -1e-9, 0.5, 1e9, 1e50];
    CALIBRATION, "{text:?}", "file" => parsed(text), for text in NO_CALIBRATIONS;
    FRAME, "{width} × {height} px: the same pixels again" => pixels(width, height),
        for (width, height) in [(1, 1), (1, 4096), (4096, 1), (8192, 2), (640, 480)];
    FRAME, "{width} × {height} px", "file" => frame(png(width, height)), for (width, height) in [(8193, 1), (1, 8193)];
    FRAME, "the first {kept} bytes of a PNG image", "file" => frame(png(64, 64)[..kept].to_vec()),
        for kept in [0, 1, 7, 8, 20, 33, 60];
    FRAME, "a header that says {side} px", "file" => frame(of_side(side)), for side in [0, u32::MAX];
}

fn parsed(text: &str) -> Result<Calibration, RecordedError> {
    let file = RecordedFile::new("calibration.toml", text.into());
    parse_calibration(&file).map(|(found, _)| found)
}

fn calibration(slope: &str, weight: &str) -> Result<Calibration, RecordedError> {
    parsed(&format!(
        "length_unit = \"mm\"\n[normal]\nfrom = \"hue\"\nhue_weight = {weight}\nnearness_weight = 0.0\n\
         range = [0.0, 1.0]\nper_marker = false\n\
         [normal.line]\nslope = {slope}\nr_squared = 1.0\nresidual_rms = 0.0\npoints = 9\n"
    ))
}

fn again(slope: f64) -> Result<Answer, RecordedError> {
    let found = calibration(&format!("{slope:e}"), "1.0")?;
    Ok(Answer::near(found.normal_part().unwrap().line.slope, slope))
}

fn pixel(x: u32, y: u32) -> Rgb<u8> {
    let [first, second, ..] = (x.wrapping_mul(31) ^ y.wrapping_mul(17)).to_le_bytes();
    Rgb([first, second, 255 - first])
}

fn png(width: u32, height: u32) -> Vec<u8> {
    let mut bytes = std::io::Cursor::new(Vec::new());
    let image = RgbImage::from_fn(width, height, pixel);
    image.write_to(&mut bytes, ImageFormat::Png).unwrap();
    bytes.into_inner()
}

/// An image whose width, in bytes 16 to 19, is not that of its checksum.
fn of_side(side: u32) -> Vec<u8> {
    let mut bytes = png(64, 64);
    bytes[16..20].copy_from_slice(&side.to_be_bytes());
    bytes
}

fn frame(bytes: Vec<u8>) -> Result<Frame, RecordedError> {
    parse_frame(&RecordedFile::new("frame.png", bytes))
}

fn pixels(width: u32, height: u32) -> Result<Answer, RecordedError> {
    let found = frame(png(width, height))?.image;
    Ok(Answer::holds(
        found == RgbImage::from_fn(width, height, pixel),
    ))
}
