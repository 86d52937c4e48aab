//! One row of pixels of a frame. The levels of the pixels are proportional to the light.

use std::ops::Range;

use palpate_sensing::Stream;

use super::super::{Camera, Optics};
use super::blemishes::SeamLines;
use super::marker_raster::{Cover, MarkerRaster};

/// Levels of red, green and blue of each pixel, from 0 to 255, before rounding.
#[derive(Clone)]
pub(super) struct Row {
    levels: Vec<f32>,
}

impl Row {
    pub(super) fn new(size: usize) -> Self {
        Self {
            levels: vec![0.0; 3 * size],
        }
    }

    fn fill(&mut self, colour: [f32; 3]) {
        for pixel in self.levels.chunks_exact_mut(3) {
            pixel.copy_from_slice(&colour);
        }
    }

    fn pixel(&mut self, column: usize) -> &mut [f32] {
        &mut self.levels[3 * column..3 * column + 3]
    }

    fn filter(&mut self, column: usize, shares: [f32; 3]) {
        for (level, share) in self.pixel(column).iter_mut().zip(shares) {
            *level *= share;
        }
    }

    pub(super) fn set(&mut self, other: &Self, weight: f32) {
        for (level, other) in self.levels.iter_mut().zip(&other.levels) {
            *level = weight * other;
        }
    }

    pub(super) fn add(&mut self, other: &Self, weight: f32) {
        for (level, other) in self.levels.iter_mut().zip(&other.levels) {
            *level += weight * other;
        }
    }

    /// Blurs this row along its direction into `blurred`. The first of the `weights` is for the pixel itself, the other
    /// weights are for its neighbours on both sides, in the order of distance.
    pub(super) fn blur_into(&self, weights: &[f32], blurred: &mut Self) {
        blurred.set(self, weights[0]);
        let last = self.levels.len() / 3 - 1;
        for (step, &weight) in weights.iter().enumerate().skip(1) {
            let (ahead, behind) = (self.levels.iter().skip(3 * step), &self.levels);
            for (level, other) in blurred.levels.iter_mut().zip(ahead) {
                *level += weight * other;
            }
            for (level, other) in blurred.levels.iter_mut().skip(3 * step).zip(behind) {
                *level += weight * other;
            }
            // Beyond an end of the row, use the value of the last pixel at this end.
            for column in 0..step.min(last + 1) {
                for channel in 0..3 {
                    blurred.levels[3 * column + channel] += weight * self.levels[channel];
                    blurred.levels[3 * (last - column) + channel] +=
                        weight * self.levels[3 * last + channel];
                }
            }
        }
    }

    pub(super) fn add_noise(&mut self, columns: Range<usize>, std: f32, stream: &mut Stream) {
        let levels = &mut self.levels[3 * columns.start..3 * columns.end];
        let (whole, rest) = levels.as_chunks_mut::<{ Stream::NORMALS }>();
        for levels in whole {
            for (level, normal) in levels.iter_mut().zip(stream.standard_normals()) {
                *level += std * normal;
            }
        }
        if !rest.is_empty() {
            for (level, normal) in rest.iter_mut().zip(stream.standard_normals()) {
                *level += std * normal;
            }
        }
    }

    pub(super) fn write(&self, bytes: &mut [u8]) {
        for (byte, level) in bytes.iter_mut().zip(&self.levels) {
            // Adding 2²³ to a single-precision level rounds the level to a whole number, which is then in the lowest
            // bits of the sum.
            *byte = (level.clamp(0.0, 255.0) + 8_388_608.0).to_bits() as u8;
        }
    }
}

/// Renders the rows of a frame one after another, from the first row to the last.
pub(super) struct Rows<'a> {
    camera: &'a Camera,
    markers: &'a [MarkerRaster],
    active: Vec<usize>,
    /// Number of markers whose first row is the current row or an earlier row.
    started: usize,
    ground: [f32; 3],
    outside: [f32; 3],
    /// Shares of red, green and blue light that a completely covered pixel absorbs. The first entry is for the magenta
    /// disc, the second for the yellow disc. The third entry is the product of both, a correction for places where the
    /// discs overlap.
    absorbed: [[f64; 3]; 3],
    light_at_rim: f64,
    seams: Option<SeamLines>,
}

impl<'a> Rows<'a> {
    pub(super) fn new(optics: &'a Optics, markers: &'a [MarkerRaster]) -> Self {
        let levels = |colour: [f64; 3]| colour.map(|share| (255.0 * share) as f32);
        let (magenta, yellow) = (optics.colours.magenta, optics.colours.yellow);
        Self {
            camera: &optics.camera,
            markers,
            active: Vec::new(),
            started: 0,
            ground: levels(optics.colours.white),
            outside: levels(optics.colours.outside),
            absorbed: [
                magenta.map(|share| 1.0 - share),
                yellow.map(|share| 1.0 - share),
                std::array::from_fn(|channel| (1.0 - magenta[channel]) * (1.0 - yellow[channel])),
            ],
            light_at_rim: optics.blemishes.light_at_rim,
            seams: SeamLines::new(optics),
        }
    }

    /// Half the length (px) of a row's part inside the circle with the radius `radius` around the centre of the image.
    /// It is negative if the circle does not reach the row.
    fn half_chord(&self, radius: f64, number: usize) -> f64 {
        let y = self.camera.centre_px()[1] - number as f64;
        let square = radius * radius - y * y;
        if square < 0.0 || radius < 0.0 {
            return -1.0;
        }
        square.sqrt()
    }

    /// Columns of the pixels in a row whose distance from the column of the image's centre is at most `half` (px).
    fn columns(&self, half: f64) -> Range<usize> {
        if half < 0.0 {
            return 0..0;
        }
        let size = self.camera.size_px() as usize;
        let [middle, _] = self.camera.centre_px();
        let first = (middle - half).ceil().max(0.0) as usize;
        first..((middle + half).floor() as usize + 1).min(size).max(first)
    }

    pub(super) fn inside(&self, number: usize) -> Range<usize> {
        self.columns(self.half_chord(self.camera.rim_px(), number))
    }

    pub(super) fn paint(&mut self, number: usize, row: &mut Row) {
        let rim = self.camera.rim_px();
        let touched = self.columns(self.half_chord(rim + 0.5, number));
        row.fill(self.ground);
        self.paint_markers(number, &touched, row);
        let y = self.camera.centre_px()[1] - number as f64;
        if let Some(seams) = &mut self.seams {
            seams.paint(self.camera, y, &touched, |column, shares| {
                row.filter(column, shares);
            });
        }
        if self.light_at_rim < 1.0 {
            self.light(y, &touched, row);
        }
        self.cut(number, &touched, row);
    }

    fn paint_markers(&mut self, number: usize, touched: &Range<usize>, row: &mut Row) {
        let markers = self.markers;
        self.active
            .retain(|&marker| markers[marker].rows.end > number);
        while let Some(marker) = markers.get(self.started) {
            if marker.rows.start > number {
                break;
            }
            if marker.rows.end > number {
                self.active.push(self.started);
            }
            self.started += 1;
        }
        let [middle_column, middle_row] = self.camera.centre_px();
        let y = middle_row - number as f64;
        for &marker in &self.active {
            let paint = |column: usize, cover: &Cover| row.filter(column, self.through(cover));
            markers[marker].cover(self.camera, y, middle_column, touched, paint);
        }
    }

    #[inline]
    fn through(&self, cover: &Cover) -> [f32; 3] {
        let [magenta, yellow, both] = &self.absorbed;
        std::array::from_fn(|channel| {
            let absorbed = cover.magenta * magenta[channel] + cover.yellow * yellow[channel]
                - cover.both * both[channel];
            (1.0 - absorbed) as f32
        })
    }

    fn light(&self, y: f64, touched: &Range<usize>, row: &mut Row) {
        let [middle, _] = self.camera.centre_px();
        let fall = (1.0 - self.light_at_rim) / (self.camera.rim_rad * self.camera.rim_rad);
        let per_square = 1.0 / (self.camera.px_per_rad * self.camera.px_per_rad);
        for column in touched.clone() {
            let x = column as f64 - middle;
            let square = (x * x + y * y) * per_square;
            let light = (1.0 - fall * self.camera.polar_square(square)).max(0.0) as f32;
            row.filter(column, [light; 3]);
        }
    }

    /// Paints the part of a row that is outside of the image circle. A pixel on the rim mixes the light from inside and
    /// outside of the circle.
    fn cut(&self, number: usize, touched: &Range<usize>, row: &mut Row) {
        let rim = self.camera.rim_px();
        let [middle, middle_row] = self.camera.centre_px();
        let y = middle_row - number as f64;
        let whole = self.columns(self.half_chord(rim - 0.5, number));
        let whole = if whole.is_empty() {
            touched.end..touched.end
        } else {
            whole
        };
        let outside = self.outside;
        for column in (0..touched.start).chain(touched.end..self.camera.size_px() as usize) {
            row.pixel(column).copy_from_slice(&outside);
        }
        for column in (touched.start..whole.start).chain(whole.end..touched.end) {
            let x = column as f64 - middle;
            let share = (0.5 + rim - libm::hypot(x, y)).clamp(0.0, 1.0) as f32;
            for (level, outside) in row.pixel(column).iter_mut().zip(outside) {
                *level = outside + share * (*level - outside);
            }
        }
    }
}
