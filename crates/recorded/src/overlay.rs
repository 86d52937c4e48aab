//! Draws the tracking status of each marker on the pressed frame.

use image::{Rgb, RgbImage};
use palpate_tracking::{Marker, Status};

use super::frame_pair::FramePair;

/// Smallest length of the drawing's longer side, px. Smaller frames are enlarged, so that numbers are legible.
const SIDE: u32 = 1000;

const ARROW_SCALE: f64 = 5.0;

/// Smallest diameter of a marker, in pixels of the drawing, for which its number is drawn. In smaller markers, the
/// number would not be legible.
const LEGIBLE: f64 = 12.0;

const CUT: Colour = [120, 120, 120];
const ARROW: Colour = [0, 0, 0];

const fn colour(status: Status) -> Colour {
    match status {
        Status::Tracked => [0, 70, 220],
        Status::Lost => [220, 0, 0],
        Status::Merged => [255, 120, 0],
        Status::Split => [140, 0, 200],
        Status::New => [0, 150, 150],
    }
}

/// The pressed frame, with a circle, a number and an arrow at each marker. The arrow shows the shift of the marker
/// since the frame at rest, 5 times enlarged. The colour of a circle shows the status of the marker: blue (tracked),
/// red (lost), orange (merged), violet (split), cyan (new) or grey (only partly in the frame at rest). Small frames are
/// enlarged by an integer factor.
pub fn overlay(pressed: &RgbImage, frames: &FramePair) -> RgbImage {
    let mut canvas = Canvas::new(pressed, SIDE);
    for marker in &frames.cut {
        canvas.circle(marker.centroid_px, radius(marker), CUT);
    }
    for (number, track) in frames.tracks.iter().enumerate() {
        let Some(marker) = track.pressed.or(track.rest) else {
            continue;
        };
        let radius = radius(&marker);
        canvas.circle(marker.centroid_px, radius, colour(track.status));
        let across = 2.0 * radius * f64::from(SIDE) / f64::from(pressed.width().max(1));
        if across.max(2.0 * radius) >= LEGIBLE {
            let above = [marker.centroid_px[0], marker.centroid_px[1] - radius];
            canvas.number(number, above, 10, colour(track.status));
        }
        if let (Some(rest), Some(change)) = (track.rest, track.change()) {
            let shift = change.shift_px.map(|shift| ARROW_SCALE * shift);
            canvas.arrow(rest.centroid_px, shift, ARROW);
        }
    }
    canvas.into_picture()
}

/// Radius (px) of the circle around a marker, with a small gap between the marker and the circle.
fn radius(marker: &Marker) -> f64 {
    let area = f64::from(marker.pixels).max(4.0);
    1.2 * (area / std::f64::consts::PI).sqrt()
}

type Colour = [u8; 3];

/// Image to draw on. `scale` is the width of one pixel of the frame, in pixels of this image.
struct Canvas {
    picture: RgbImage,
    scale: u32,
}

/// Bitmaps of the digits 0 to 9: five rows of three bits each.
const DIGITS: [[u8; 5]; 10] = [
    [7, 5, 5, 5, 7],
    [2, 6, 2, 2, 7],
    [7, 1, 7, 4, 7],
    [7, 1, 3, 1, 7],
    [5, 5, 7, 1, 1],
    [7, 4, 7, 1, 7],
    [7, 4, 7, 5, 7],
    [7, 1, 1, 2, 2],
    [7, 5, 7, 5, 7],
    [7, 5, 7, 1, 7],
];

impl Canvas {
    fn new(frame: &RgbImage, side: u32) -> Self {
        let (width, height) = frame.dimensions();
        let scale = side.div_ceil(width.max(height).max(1)).max(1);
        let pixel = |x, y| *frame.get_pixel(x / scale, y / scale);
        let picture = RgbImage::from_fn(width * scale, height * scale, pixel);
        Self { picture, scale }
    }

    fn into_picture(self) -> RgbImage {
        self.picture
    }

    /// Position on the canvas of a point in the frame. In the frame, (0, 0) is the centre of the first pixel.
    fn at(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let scale = f64::from(self.scale);
        [(x + 0.5) * scale - 0.5, (y + 0.5) * scale - 0.5]
    }

    fn dot(&mut self, [x, y]: [f64; 2], colour: Colour) {
        let (width, height) = self.picture.dimensions();
        let [x, y] = [x.round(), y.round()];
        if x >= 0.0 && y >= 0.0 && x < f64::from(width) && y < f64::from(height) {
            self.picture.put_pixel(x as u32, y as u32, Rgb(colour));
        }
    }

    fn stroke(&mut self, from: [f64; 2], to: [f64; 2], colour: Colour) {
        let [dx, dy] = [to[0] - from[0], to[1] - from[1]];
        let steps = dx.abs().max(dy.abs()).ceil().clamp(1.0, 1e5);
        for step in 0..=steps as u32 {
            let share = f64::from(step) / steps;
            self.dot([from[0] + share * dx, from[1] + share * dy], colour);
        }
    }

    /// Draws a circle around a point of the frame. `radius` is in pixels of the frame.
    fn circle(&mut self, centre: [f64; 2], radius: f64, colour: Colour) {
        let [x, y] = self.at(centre);
        let radius = radius * f64::from(self.scale);
        let steps = (7.0 * radius).ceil().clamp(8.0, 1e5) as u32;
        for step in 0..steps {
            let (sine, cosine) =
                libm::sincos(std::f64::consts::TAU * f64::from(step) / f64::from(steps));
            for width in [0.0, 1.0] {
                let radius = radius + width;
                self.dot([x + radius * cosine, y + radius * sine], colour);
            }
        }
    }

    /// Draws an arrow from a point of the frame along `shift`, in pixels of the frame.
    fn arrow(&mut self, from: [f64; 2], shift: [f64; 2], colour: Colour) {
        let start = self.at(from);
        let [dx, dy] = shift.map(|one| one * f64::from(self.scale));
        let length = libm::hypot(dx, dy);
        if length < 1.0 {
            return;
        }
        let tip = [start[0] + dx, start[1] + dy];
        self.stroke(start, tip, colour);
        let barb = (0.35 * length).min(8.0) / length;
        for side in [-0.5, 0.5] {
            let back = [
                tip[0] - barb * (dx + side * dy),
                tip[1] - barb * (dy - side * dx),
            ];
            self.stroke(tip, back, colour);
        }
    }

    /// Draws a number centred at a point of the frame. The height of its digits is `height` pixels of the canvas,
    /// rounded down to a multiple of 5.
    fn number(&mut self, number: usize, middle: [f64; 2], height: u32, colour: Colour) {
        let size = f64::from((height / 5).max(1));
        let text = number.to_string();
        let width = size * (4.0 * text.len() as f64 - 1.0);
        let [x, y] = self.at(middle);
        let [left, top] = [x - 0.5 * (width - 1.0), y - 0.5 * (5.0 * size - 1.0)];
        for (place, digit) in text.bytes().enumerate() {
            let rows = DIGITS[usize::from(digit - b'0')];
            for (row, bits) in (0..).zip(rows) {
                for column in (0..3_u8).filter(|column| bits & (4 >> column) != 0) {
                    let corner = [
                        left + size * (4.0 * place as f64 + f64::from(column)),
                        top + size * f64::from(row),
                    ];
                    self.square(corner, size, colour);
                }
            }
        }
    }

    fn square(&mut self, [x, y]: [f64; 2], side: f64, colour: Colour) {
        for row in 0..side as u32 {
            for column in 0..side as u32 {
                self.dot([x + f64::from(column), y + f64::from(row)], colour);
            }
        }
    }
}
