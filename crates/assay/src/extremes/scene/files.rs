//! Calibrations and frames in files.

use image::{ImageFormat, Rgb, RgbImage};
use palpate_scene::recorded::{RecordedError, RecordedFile, parse_calibration, parse_frame};

use crate::extremes::{Answer, Case};

const CALIBRATION: &str = "scene::recorded::parse_calibration";
const FRAME: &str = "scene::recorded::parse_frame";

fn file(name: &str, bytes: Vec<u8>) -> RecordedFile {
    RecordedFile::new(name, bytes)
}

pub(super) fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    for slope in ["nan", "inf", "-inf", "0.0", "-0.0", "5e-324", "1e999"] {
        cases.push(Case::refusal(
            CALIBRATION,
            format!("a slope of {slope}"),
            move || calibration(slope, "1.0"),
        ));
    }
    for weight in ["nan", "inf", "-inf"] {
        cases.push(Case::refusal(
            CALIBRATION,
            format!("a weight of {weight}"),
            move || calibration("0.5", weight),
        ));
    }
    for slope in [1e-50, -1e-9, 0.5, 1e9, 1e50] {
        cases.push(Case::value(
            CALIBRATION,
            format!("a slope of {slope:e}: the same again"),
            move || {
                let found = calibration(&format!("{slope:e}"), "1.0")?;
                let found = found.normal_part().map_or(f64::NAN, |part| part.line.slope);
                Ok::<_, RecordedError>(Answer::near(found, slope))
            },
        ));
    }
    for text in [
        "",
        "\0",
        "length_unit = \"mm\"",
        "markers = -1",
        "[normal]",
        "\u{feff}[",
    ] {
        cases.push(Case::refusal(CALIBRATION, format!("{text:?}"), move || {
            parse_calibration(&file("calibration.toml", text.into()))
        }));
    }
    for (width, height) in [(1, 1), (1, 4096), (4096, 1), (8192, 2), (640, 480)] {
        cases.push(Case::value(
            FRAME,
            format!("{width} × {height} px: the same pixels again"),
            move || pixels(width, height),
        ));
    }
    for (width, height) in [(8193, 1), (1, 8193)] {
        cases.push(Case::refusal(
            FRAME,
            format!("{width} × {height} px"),
            move || parse_frame(&file("frame.png", png(width, height))),
        ));
    }
    for kept in [0, 1, 7, 8, 20, 33, 60] {
        cases.push(Case::refusal(
            FRAME,
            format!("the first {kept} bytes of a PNG image"),
            move || {
                let mut bytes = png(64, 64);
                bytes.truncate(kept);
                parse_frame(&file("frame.png", bytes))
            },
        ));
    }
    // Width and height stand in bytes 16 to 23, before their checksum.
    for side in [0, u32::MAX] {
        cases.push(Case::refusal(
            FRAME,
            format!("a header that says {side} px"),
            move || {
                let mut bytes = png(64, 64);
                bytes[16..20].copy_from_slice(&side.to_be_bytes());
                parse_frame(&file("frame.png", bytes))
            },
        ));
    }
    cases
}

fn calibration(slope: &str, weight: &str) -> Result<palpate_tracking::Calibration, RecordedError> {
    let text = format!(
        "length_unit = \"mm\"\n[normal]\nfrom = \"hue\"\nhue_weight = {weight}\nnearness_weight = 0.0\n\
         range = [0.0, 1.0]\nper_marker = false\n\
         [normal.line]\nslope = {slope}\nr_squared = 1.0\nresidual_rms = 0.0\npoints = 9\n"
    );
    parse_calibration(&file("calibration.toml", text.into_bytes())).map(|(found, _)| found)
}

fn pixel(x: u32, y: u32) -> Rgb<u8> {
    let [first, second, ..] = (x.wrapping_mul(31) ^ y.wrapping_mul(17)).to_le_bytes();
    Rgb([first, second, 255 - first])
}

fn png(width: u32, height: u32) -> Vec<u8> {
    let mut bytes = std::io::Cursor::new(Vec::new());
    RgbImage::from_fn(width, height, pixel)
        .write_to(&mut bytes, ImageFormat::Png)
        .expect("memory takes all bytes");
    bytes.into_inner()
}

fn pixels(width: u32, height: u32) -> Result<Answer, RecordedError> {
    let frame = parse_frame(&file("frame.png", png(width, height)))?;
    let same = frame
        .image
        .enumerate_pixels()
        .filter(|(x, y, found)| **found == pixel(*x, *y));
    let wanted = f64::from(width) * f64::from(height);
    Ok(Answer::near(same.count() as f64, wanted))
}
