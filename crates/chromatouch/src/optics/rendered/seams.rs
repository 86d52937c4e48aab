//! Seams between gores.

use std::f64::consts::{FRAC_PI_2, TAU};
use std::ops::Range;

use super::super::{Camera, Optics};

/// Seams as lines from the image's centre outward.
pub(super) struct SeamLines {
    /// Unit vectors along them, y up.
    lines: Vec<[f64; 2]>,
    /// Sine of the angle that half a seam spans, seen from the sensor's centre.
    half_width: f64,
    /// Half the width in the image, px, at most.
    widest: f64,
    taken: [f64; 3],
    /// How much of each pixel of the row is covered.
    covers: Vec<f64>,
}

impl SeamLines {
    /// Seams of a sensor; `None` if there are none.
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
            taken: optics.colours.seam.map(|share| 1.0 - share),
            covers: vec![0.0; camera.size_px() as usize],
        })
    }

    /// Calls `filter` with the share of light that passes each pixel of a row that a seam touches, y up from the
    /// image's centre.
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
                // Around the axis a pixel spans the angle that the seam's width is counted in.
                let half = self.half_width / camera.ray(x, y).lateral_rad.max(f64::MIN_POSITIVE);
                // Seams narrower than a pixel cover their share of it.
                let share = (0.5 + half - aside).clamp(0.0, (2.0 * half).min(1.0));
                let cover = &mut self.covers[column];
                *cover = cover.max(share);
            }
        }
        for column in touched.clone() {
            let cover = self.covers[column];
            if cover > 0.0 {
                filter(column, self.taken.map(|taken| (1.0 - taken * cover) as f32));
            }
        }
    }
}

/// Columns of a row, within a range, that lie within a distance of a line from the image's centre, or that may.
fn crossed(
    line: &[f64; 2],
    y: f64,
    distance: f64,
    middle: f64,
    within: &Range<usize>,
) -> Range<usize> {
    // |x sin φ − y cos φ| ≤ distance.
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
