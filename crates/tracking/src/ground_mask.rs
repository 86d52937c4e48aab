//! Works on a frame at lower resolution, whose points are bins (squares of pixels). Finds the bins that show the
//! sensor, and the bins that show the background between the markers. Also computes the top-hat transform of the frame,
//! in which only the markers are bright.

use crate::Mask;
use crate::binning::BinnedFrame;
use crate::image_circle::Rim;
use crate::opening::Opening;
use crate::selection::Selection;

/// The rim of the sensor may lie in a band around the edge of the image circle. This value is half the width of the
/// band, relative to the radius of the circle.
const RIM_BAND: f64 = 0.08;
/// Smallest accepted contrast between the markers and the background in the top-hat transform of a frame, as a multiple
/// of the background's standard deviation in this transform.
const MIN_CONTRAST_STDS: f64 = 4.0;
/// Smallest accepted contrast between the markers and the background of a frame in the top-hat transform, in levels (0
/// to 255).
const MIN_CONTRAST: f64 = 10.0;
/// Smallest brightness of a bright background, in levels (0 to 255). On a darker background, dark markers are not
/// found.
const MIN_GROUND_BRIGHTNESS: usize = 12;

/// Brightness of the background between the markers. The markers are darker than a bright background, and brighter than
/// a dark background.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Ground {
    /// The markers are dark on a bright background: they absorb light.
    Bright,
    /// The markers are bright on a dark background: they add light.
    Dark,
}

/// A frame at lower resolution (in bins of pixels), with masks and intermediate images of the same size.
#[derive(Clone, Debug, Default)]
pub(crate) struct GroundMask {
    pub(crate) frame: BinnedFrame,
    pub(crate) inside: Vec<bool>,
    /// Top-hat transform of the frame: for each bin, the difference between its brightness and the brightness of the
    /// background around it.
    pub(crate) top_hat: Vec<u8>,
    /// For each bin, whether it shows only background: no marker, and nothing near a marker.
    pub(crate) is_ground: Vec<bool>,
    middles: Vec<bool>,
    plane: Vec<u8>,
    opening: Opening,
}

impl GroundMask {
    /// Marks the bins that show the sensor: the bins inside `rim` or, if no rim was found, inside the image circle
    /// `mask`.
    pub(crate) fn set_inside(&mut self, mask: &Mask, rim: Option<&Rim>) {
        let circle = mask.coarse(self.frame.bin);
        let band = RIM_BAND * circle.radius_px;
        let size = [self.frame.width, self.frame.height];
        let Some(rim) = rim else {
            return circle.fill(0.75, size, &mut self.inside);
        };
        circle.fill(-band, size, &mut self.inside);
        for (row, line) in self.inside.chunks_exact_mut(size[0]).enumerate() {
            let (left, right) = circle.columns(row as f64, band, size[0]);
            for (column, inside) in line.iter_mut().enumerate() {
                *inside &= (left..right).contains(&column) || !rim.excludes(column, row);
            }
        }
    }

    pub(crate) fn estimate_ground(&self) -> Ground {
        let (mut dark, mut bright) = ([0; 256], [0; 256]);
        let share = share_of(self.frame.pixels());
        // Use only every third bin, because a third of the bins is enough to estimate the quantiles of the brightness.
        let squares = self.frame.sums.iter().zip(&self.inside).step_by(3);
        for (colour, _) in squares.filter(|(_, inside)| **inside) {
            let [red, green, blue] = colour.map(&share);
            dark[usize::from(green.min(blue))] += 1;
            bright[usize::from(red.max(green).max(blue))] += 1;
        }
        let below = quantile(&dark, 0.5) - quantile(&dark, 0.002);
        let above = quantile(&bright, 0.998) - quantile(&bright, 0.5);
        if below >= above {
            Ground::Bright
        } else {
            Ground::Dark
        }
    }

    /// Computes a grey image of the frame in which markers are bright. On a dark background, the grey value of a bin is
    /// the largest of red, green and blue. On a bright background, it is 255 minus the smaller of green and blue.
    fn set_plane(&mut self, ground: Ground) {
        let share = share_of(self.frame.pixels());
        let sums = self.frame.sums.iter();
        self.plane.clear();
        match ground {
            Ground::Bright => self
                .plane
                .extend(sums.map(|&[_, green, blue]| !share(green.min(blue)))),
            Ground::Dark => self
                .plane
                .extend(sums.map(|&[red, green, blue]| share(red.max(green).max(blue)))),
        }
    }

    /// Computes the top-hat transform of the grey image. The structuring element is a square of `2 half + 1` bins a
    /// side. On a bright background, the result in each bin is divided by the brightness of the background.
    pub(crate) fn set_top_hat(&mut self, ground: Ground, mask: &Mask, half: usize) {
        self.set_plane(ground);
        let size = [self.frame.width, self.frame.height];
        mask.coarse(self.frame.bin)
            .fill(-0.5 * half as f64, size, &mut self.middles);
        let opened = self
            .opening
            .open(&self.plane, size[0], &self.inside, &self.middles, half);
        let scale = scales();
        let planes = self.plane.iter().zip(opened).zip(&self.inside);
        self.top_hat.clear();
        self.top_hat
            .extend(planes.map(|((&plane, &opened), &inside)| {
                let above = if inside { plane - opened } else { 0 };
                match ground {
                    Ground::Bright => {
                        ((u32::from(above) * scale[usize::from(!opened)]) >> 16) as u8
                    }
                    Ground::Dark => above,
                }
            }));
    }

    /// Divides the values of the top-hat transform into two classes: background and markers. The result is `None` if
    /// the contrast between the two classes is too small.
    pub(crate) fn classes(&self) -> Option<Classes> {
        let mut histogram = [0u32; 256];
        let squares = self.top_hat.iter().zip(&self.inside);
        for (&value, _) in squares.filter(|(_, inside)| **inside) {
            histogram[usize::from(value)] += 1;
        }
        let classes = Classes::of(&histogram)?;
        let contrast = classes.markers - classes.ground;
        let is_clear =
            contrast >= MIN_CONTRAST && contrast >= MIN_CONTRAST_STDS * classes.ground_std;
        is_clear.then_some(classes)
    }

    pub(crate) fn set_is_ground(&mut self, limit: u8, selection: &Selection) {
        self.is_ground.clear();
        self.is_ground.extend(
            self.top_hat
                .iter()
                .zip(&self.inside)
                .map(|(&top_hat, &inside)| inside && top_hat <= limit / 4),
        );
        let width = self.frame.width;
        let margin = ((0.25 * selection.diameter) as usize).max(2);
        for run in selection.shapes().flat_map(|shape| &shape.runs) {
            let columns = run.first.saturating_sub(margin)..(run.last + margin + 1).min(width);
            let rows =
                run.row.saturating_sub(margin)..(run.row + margin + 1).min(self.frame.height);
            for row in rows {
                self.is_ground[row * width..][columns.clone()].fill(false);
            }
        }
    }

    pub(crate) fn rows(&self, height: usize) -> Vec<(i32, i32)> {
        let bin = self.frame.bin;
        let mut rows = Vec::with_capacity(height);
        for line in self.inside.chunks_exact(self.frame.width) {
            let first = line.iter().position(|&inside| inside);
            let last = line.iter().rposition(|&inside| inside);
            let row = first
                .zip(last)
                .map_or((i32::MAX, i32::MIN), |(first, last)| {
                    ((first * bin) as i32, ((last + 1) * bin) as i32 - 1)
                });
            rows.extend(std::iter::repeat_n(row, bin));
        }
        rows.resize(height, (i32::MAX, i32::MIN));
        rows
    }
}

/// Returns a function that computes the mean of `pixels` brightness values (0 to 255) from their sum.
fn share_of(pixels: usize) -> impl Fn(u16) -> u8 {
    let scale = 65_536_u32.div_ceil(pixels as u32);
    move |sum| ((u32::from(sum) * scale) >> 16).min(255) as u8
}

/// Table of factors, one for each brightness of the background (0 to 255). The factor, divided by 65,536, converts a
/// brightness difference to a share of the background's light, in units of 1/255. It is 0 if the background is too
/// dark.
fn scales() -> [u32; 256] {
    std::array::from_fn(|light| {
        if light < MIN_GROUND_BRIGHTNESS {
            0
        } else {
            255 * 65_536 / light as u32
        }
    })
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Classes {
    pub(crate) limit: u8,
    pub(crate) ground: f64,
    pub(crate) ground_std: f64,
    pub(crate) markers: f64,
}

impl Classes {
    /// Divides the grey values of a histogram into two classes with the largest variance between the classes (Otsu,
    /// 1979). Then moves the limit between the classes to the middle between their means. The result is `None` if all
    /// values are equal.
    pub(crate) fn of(histogram: &[u32; 256]) -> Option<Self> {
        let count: f64 = histogram.iter().map(|&count| f64::from(count)).sum();
        let sum: f64 = weighted(histogram);
        let (mut below, mut sum_below, mut best) = (0.0, 0.0, (0.0, 0));
        for (value, &at) in histogram.iter().enumerate() {
            below += f64::from(at);
            sum_below += f64::from(at) * value as f64;
            let above = count - below;
            if below > 0.0 && above > 0.0 {
                let distance = sum_below / below - (sum - sum_below) / above;
                let between = below * above * distance * distance;
                if between > best.0 {
                    best = (between, value + 1);
                }
            }
        }
        if best.1 == 0 {
            return None;
        }
        let (low, high) = histogram.split_at(best.1);
        let total = |part: &[u32]| part.iter().copied().map(f64::from).sum::<f64>();
        let ground = weighted(low) / total(low);
        let markers = best.1 as f64 + weighted(high) / total(high);
        let spread: f64 = low
            .iter()
            .enumerate()
            .map(|(value, &count)| f64::from(count) * (value as f64 - ground).powi(2))
            .sum();
        Some(Self {
            limit: (0.5 * (ground + markers)) as u8,
            ground,
            ground_std: (spread / total(low)).sqrt(),
            markers,
        })
    }
}

fn weighted(histogram: &[u32]) -> f64 {
    histogram
        .iter()
        .enumerate()
        .map(|(value, &count)| value as f64 * f64::from(count))
        .sum()
}

/// Quantile of a histogram of grey values: the share `share` of the counted pixels is at or below the result.
pub(crate) fn quantile(histogram: &[u32; 256], share: f64) -> u8 {
    let count: u64 = histogram.iter().map(|&count| u64::from(count)).sum();
    let wanted = share * count as f64;
    let mut below = 0.0;
    for (value, &at) in (0..=u8::MAX).zip(histogram) {
        below += f64::from(at);
        if below >= wanted && at > 0 {
            return value;
        }
    }
    u8::MAX
}
