//! Imperfections of a camera's image: uneven light, blur, seams and pixel noise.

use std::f64::consts::{FRAC_PI_2, TAU};
use std::ops::Range;

use super::super::{Camera, Optics, OpticsError};
use super::row::Row;
use crate::pattern::MOST_GORES;

/// Imperfections of the image. By default, there are no imperfections. An imperfection whose value is 0 costs no
/// computing time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Blemishes {
    /// Light at the rim of the image circle, relative to the light at the apex. The light decreases with the square of
    /// the polar angle. The value 1 means even light.
    pub light_at_rim: f64,
    /// Standard deviation of a Gaussian blur of the whole frame, px; 0 means no blur.
    pub blur_px: f64,
    /// Seams between the gores (flat pieces) of the skin; `None` if there are no seams.
    pub seams: Option<Seams>,
    /// Standard deviation of the Gaussian noise of each channel of each pixel in the image circle, in levels (0 to
    /// 255).
    pub pixel_std: f64,
}

/// Seams between gores, the flat pieces of the skin. Each seam is a meridian that starts at the apex. The first seam is
/// along +x.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Seams {
    /// Number of gores (flat pieces of the skin) around the sphere.
    pub gores: u32,
    /// Width of a seam on the skin (length).
    pub width: f64,
}

impl Default for Blemishes {
    fn default() -> Self {
        Self {
            light_at_rim: 1.0,
            blur_px: 0.0,
            seams: None,
            pixel_std: 0.0,
        }
    }
}

impl Blemishes {
    pub(in super::super) fn checked(self) -> Result<Self, OpticsError> {
        for (setting, value, most, expected) in [
            ("light_at_rim", self.light_at_rim, 1.0, "from 0 to 1"),
            ("blur_px", self.blur_px, 16.0, "from 0 to 16"),
            ("pixel_std", self.pixel_std, 255.0, "from 0 to 255"),
        ] {
            OpticsError::unless((0.0..=most).contains(&value), setting, value, expected)?;
        }
        if let Some(Seams { gores, width }) = self.seams {
            let good = (1..=MOST_GORES).contains(&gores);
            OpticsError::unless(good, "gores", f64::from(gores), "from 1 to 360")?;
            let good = width >= 0.0 && width.is_finite();
            OpticsError::unless(good, "seam_width", width, "finite and at least 0")?;
        }
        Ok(self)
    }
}

/// A Gaussian blur of a frame, computed row by row. The most recently painted rows are stored; each of them is already
/// blurred along the row.
pub(super) struct Blur {
    /// Weights of the blur: for a pixel, and for its neighbours on one side up to a distance of 3.5 standard
    /// deviations. The neighbours on the other side have the same weights. The weights of the pixel and of both sides
    /// add up to 1.
    weights: Vec<f32>,
    rows: Vec<Row>,
    rows_read: usize,
    size: usize,
    source: Row,
}

impl Blur {
    pub(super) fn new(std_px: f64, size: usize) -> Option<Self> {
        if std_px <= 0.0 {
            return None;
        }
        let reach = (3.5 * std_px).ceil() as usize;
        let bell = |step: usize| libm::exp(-0.5 * (step as f64 / std_px).powi(2));
        let total: f64 = bell(0) + 2.0 * (1..=reach).map(bell).sum::<f64>();
        Some(Self {
            weights: (0..=reach)
                .map(|step| (bell(step) / total) as f32)
                .collect(),
            rows: vec![Row::new(size); 2 * reach + 1],
            rows_read: 0,
            size,
            source: Row::new(size),
        })
    }

    /// Computes a row of the blurred frame. The caller requests the rows in order, starting with the first; `paint`
    /// paints the unblurred rows. Outside the frame, the values of the pixels at the edge are used.
    pub(super) fn blur(
        &mut self,
        number: usize,
        row: &mut Row,
        mut paint: impl FnMut(usize, &mut Row),
    ) {
        let reach = self.weights.len() - 1;
        let last = self.size - 1;
        let count = self.rows.len();
        while self.rows_read <= (number + reach).min(last) {
            paint(self.rows_read, &mut self.source);
            self.source
                .blur_into(&self.weights, &mut self.rows[self.rows_read % count]);
            self.rows_read += 1;
        }
        let at = |number: usize| &self.rows[number % count];
        row.set(at(number), self.weights[0]);
        for (step, &weight) in self.weights.iter().enumerate().skip(1) {
            row.add(at(number.saturating_sub(step)), weight);
            row.add(at((number + step).min(last)), weight);
        }
    }
}

pub(super) struct SeamLines {
    lines: Vec<[f64; 2]>,
    /// Sine of half the angle that the width of a seam covers at the sensor's centre.
    half_width: f64,
    /// Upper bound of half the width of a seam in the image, px.
    widest: f64,
    absorbed: [f64; 3],
    covers: Vec<f64>,
}

impl SeamLines {
    pub(super) fn new(optics: &Optics) -> Option<Self> {
        let seams = optics.blemishes.seams.filter(|seams| seams.width > 0.0)?;
        let camera = &optics.camera;
        let half_angle = 0.5 * seams.width / optics.array.radius();
        let half_width = libm::sin(half_angle.min(FRAC_PI_2));
        let widest = half_width * camera.most_px_per_rad(camera.rim_rad);
        Some(Self {
            lines: (0..seams.gores)
                .map(|gore| TAU * f64::from(gore) / f64::from(seams.gores))
                .map(|azimuth| [libm::cos(azimuth), libm::sin(azimuth)])
                .collect(),
            half_width,
            widest: widest.min(f64::from(camera.size_px())),
            absorbed: optics.colours.seam.map(|share| 1.0 - share),
            covers: vec![0.0; camera.size_px() as usize],
        })
    }

    /// For each pixel of a row that a seam covers at least partly, calls `filter` with the share of light that the seam
    /// transmits. The row is `y` px above the centre of the image.
    pub(super) fn paint(
        &mut self,
        camera: &Camera,
        y: f64,
        touched: &Range<usize>,
        mut filter: impl FnMut(usize, [f32; 3]),
    ) {
        self.covers[touched.clone()].fill(0.0);
        let [middle, _] = camera.centre_px();
        for line in &self.lines {
            for column in crossed(line, y, self.widest + 1.0, middle, touched) {
                let x = column as f64 - middle;
                let along = x * line[0] + y * line[1];
                let aside = if along > 0.0 {
                    (x * line[1] - y * line[0]).abs()
                } else {
                    libm::hypot(x, y)
                };
                // `half` is half the width of the seam in pixels. It is the angular half-width of the seam at the
                // sensor's centre, divided by `lateral_rad`, the angle that one pixel covers across the seam.
                let half = self.half_width / camera.ray(x, y).lateral_rad.max(f64::MIN_POSITIVE);
                // A seam that is narrower than a pixel covers only a share of the pixel.
                let share = (0.5 + half - aside).clamp(0.0, (2.0 * half).min(1.0));
                let cover = &mut self.covers[column];
                *cover = cover.max(share);
            }
        }
        for column in touched.clone() {
            let cover = self.covers[column];
            if cover > 0.0 {
                filter(
                    column,
                    self.absorbed.map(|share| (1.0 - share * cover) as f32),
                );
            }
        }
    }
}

/// Columns of a row whose pixels are within `distance` (px) of a line through the centre of the image. `line` contains
/// the cosine and the sine of the line's angle. Only columns in the range `within` are returned.
fn crossed(
    line: &[f64; 2],
    y: f64,
    distance: f64,
    middle: f64,
    within: &Range<usize>,
) -> Range<usize> {
    // The pixels within `distance` of the line satisfy |x sin φ − y cos φ| ≤ distance, where φ is the angle of the
    // line. This limits the columns x of the row.
    let [cosine, sine] = *line;
    let ends = [y * cosine - distance, y * cosine + distance].map(|end| end / sine);
    let [low, high] = [ends[0].min(ends[1]), ends[0].max(ends[1])];
    if sine.abs() < 1e-12 {
        return if y.abs() <= distance {
            within.clone()
        } else {
            0..0
        };
    }
    let column = |x: f64| (x + middle).clamp(0.0, within.end as f64) as usize;
    let first = column(low.ceil()).max(within.start);
    first..(column(high) + 1).min(within.end).max(first)
}
