//! Draws frames of a small camera sensor. To keep it simple, each marker is a magenta disc and a yellow disc on a
//! white ground.

use std::io::Cursor;

use image::{DynamicImage, ImageFormat, Rgb, RgbImage};

use super::desk::Desk;

/// Number of columns and of rows of a frame, px.
pub(crate) const SIDE: u32 = 400;
/// Scale f of the fisheye lens, px per rad.
pub(crate) const PX_PER_RAD: f64 = 151.3;
/// Distance of the markers from the camera, mm. The camera is at the centre of the skin, whose radius is 20 mm. The
/// markers are 2 mm under the skin.
pub(crate) const DISTANCE: f64 = 18.0;
/// Angle between neighbouring markers, rad.
const SPACING: f64 = 0.2;
/// Radius of the image circle, px.
const RIM: f64 = 190.0;
/// Angular radius of a marker, rad.
const RADIUS: f64 = 0.045;

/// Positions of the markers on a square grid within a circle, rad.
pub(crate) fn places() -> Vec<[f64; 2]> {
    let steps = || (-5..=5).map(|step| f64::from(step) * SPACING);
    let net = steps().flat_map(|y| steps().map(move |x| [x, y]));
    net.filter(|[x, y]| libm::hypot(*x, *y) < 1.05).collect()
}

/// A frame with markers, each displaced inward by `inward(position)` mm. The markers whose numbers are in `without`
/// are missing.
pub(crate) fn frame(inward: impl Fn([f64; 2]) -> f64, without: &[usize]) -> RgbImage {
    let middle = 0.5 * (f64::from(SIDE) - 1.0);
    let mut image = RgbImage::from_fn(SIDE, SIDE, |column, row| {
        let [x, y] = [column, row].map(|at| f64::from(at) - middle);
        Rgb([if libm::hypot(x, y) < RIM { 255 } else { 0 }; 3])
    });
    for (marker, place) in places().into_iter().enumerate() {
        if without.contains(&marker) {
            continue;
        }
        let [x, y] = place;
        let radius = RADIUS * DISTANCE / (DISTANCE - inward(place)) * PX_PER_RAD;
        let centre = [middle + PX_PER_RAD * x, middle - PX_PER_RAD * y];
        // The magenta disc absorbs green light. The yellow disc, which is drawn slightly to the side, absorbs blue
        // light.
        disc(&mut image, centre, radius, 1);
        disc(&mut image, [centre[0] + 0.3 * radius, centre[1]], radius, 2);
    }
    image
}

/// Darkens one colour channel in a disc whose edge is one pixel wide.
fn disc(image: &mut RgbImage, [x, y]: [f64; 2], radius: f64, channel: usize) {
    let within = |column: u32, row: u32| {
        let distance = libm::hypot(f64::from(column) - x, f64::from(row) - y);
        (radius - distance + 0.5).clamp(0.0, 1.0)
    };
    let near = |at: f64| {
        let first = (at - radius - 1.0).max(0.0) as u32;
        first..((at + radius + 2.0) as u32).min(SIDE)
    };
    for row in near(y) {
        for column in near(x) {
            let pixel = &mut image.get_pixel_mut(column, row).0[channel];
            *pixel = (f64::from(*pixel) * (1.0 - 0.8 * within(column, row))).round() as u8;
        }
    }
}

pub(crate) fn write(desk: &Desk, name: &str, image: impl Into<DynamicImage>) {
    desk.write(name, png(image));
}

pub(crate) fn png(image: impl Into<DynamicImage>) -> Vec<u8> {
    let mut bytes = Cursor::new(Vec::new());
    image.into().write_to(&mut bytes, ImageFormat::Png).unwrap();
    bytes.into_inner()
}

/// Beginning of a PNG file of this size: signature and header, but no pixels.
pub(crate) fn png_header(width: u32, height: u32) -> Vec<u8> {
    let mut header = b"IHDR".to_vec();
    header.extend(width.to_be_bytes());
    header.extend(height.to_be_bytes());
    header.extend([8, 2, 0, 0, 0]);
    let crc = !header.iter().fold(u32::MAX, |crc, byte| {
        (0..8).fold(crc ^ u32::from(*byte), |crc, _| {
            (crc >> 1) ^ (0xEDB8_8320 * (crc & 1))
        })
    });
    let mut bytes = b"\x89PNG\r\n\x1a\n\0\0\0\x0d".to_vec();
    bytes.extend(header);
    bytes.extend(crc.to_be_bytes());
    bytes.extend(b"\0\0\0\x04IDAT");
    bytes
}
