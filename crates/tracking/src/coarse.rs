//! The coarse picture of a frame in which markers are looked for: what shows the sensor, the top-hat, the ground.

use crate::binned::Binned;
use crate::opening::Opening;
use crate::rim::Rim;
use crate::selection::Selection;
use crate::threshold::{Classes, quantile};
use crate::{Ground, Mask};

/// Share of the circle's radius, at its outside, in which the rim may lie.
const OUTERMOST: f64 = 0.08;
/// How far markers set themselves off from the ground at least, in standard deviations of the ground's own top-hat.
const STANDS_OUT: f64 = 4.0;
/// How far markers set themselves off from the ground at least, of 255.
const LEAST_CONTRAST: f64 = 10.0;
/// The darkest ground, of 255, on which dark markers are looked for.
const DARKEST_GROUND: usize = 12;

/// A frame made coarser and planes of the same size.
#[derive(Clone, Debug, Default)]
pub(crate) struct Coarse {
    pub(crate) binned: Binned,
    /// Squares that show the sensor.
    pub(crate) inside: Vec<bool>,
    /// Rise of each square's brightness above the ground about it: the top-hat.
    pub(crate) top_hat: Vec<u8>,
    /// Squares of the ground: neither of a marker nor near one.
    pub(crate) is_ground: Vec<bool>,
    middles: Vec<bool>,
    plane: Vec<u8>,
    opening: Opening,
}

impl Coarse {
    /// Marks the squares that show the sensor: those within the rim near the circle, or else those within the circle.
    pub(crate) fn set_inside(&mut self, mask: &Mask, rim: Option<&Rim>) {
        let circle = mask.coarse(self.binned.bin);
        let band = OUTERMOST * circle.radius_px;
        let size = [self.binned.width, self.binned.height];
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

    /// Ground that markers seem to be seen on.
    pub(crate) fn told_ground(&self) -> Ground {
        let (mut dark, mut bright) = ([0; 256], [0; 256]);
        let share = share_of(self.binned.pixels());
        for (colour, _) in self
            .binned
            .sums
            .iter()
            .zip(&self.inside)
            .step_by(3)
            .filter(|(_, inside)| **inside)
        {
            let [red, green, blue] = colour.map(&share);
            dark[usize::from(green.min(blue))] += 1;
            bright[usize::from(red.max(green).max(blue))] += 1;
        }
        // Every third square tells as much as all.
        let below = quantile(&dark, 0.5) - quantile(&dark, 0.002);
        let above = quantile(&bright, 0.998) - quantile(&bright, 0.5);
        if below >= above {
            Ground::Bright
        } else {
            Ground::Dark
        }
    }

    /// The plane in which markers are bright: a dark ground's brightest colour, what a bright one lacks of its darker one
    /// of green and blue.
    fn set_plane(&mut self, ground: Ground) {
        let share = share_of(self.binned.pixels());
        let sums = self.binned.sums.iter();
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

    /// The top-hat by a square of `2 half + 1` squares a side; on a bright ground as a share of the ground's light.
    pub(crate) fn set_top_hat(&mut self, ground: Ground, mask: &Mask, half: usize) {
        self.set_plane(ground);
        let size = [self.binned.width, self.binned.height];
        mask.coarse(self.binned.bin)
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

    /// Ground and markers in the top-hat, if the two are apart.
    pub(crate) fn classes(&self) -> Option<Classes> {
        let mut histogram = [0u32; 256];
        for (&value, _) in self
            .top_hat
            .iter()
            .zip(&self.inside)
            .filter(|(_, inside)| **inside)
        {
            histogram[usize::from(value)] += 1;
        }
        let classes = Classes::of(&histogram)?;
        let apart = classes.markers - classes.ground;
        (apart >= LEAST_CONTRAST && apart >= STANDS_OUT * classes.ground_std).then_some(classes)
    }

    /// Marks the squares of the ground: neither of a marker nor near one.
    pub(crate) fn set_is_ground(&mut self, limit: u8, selection: &Selection) {
        self.is_ground.clear();
        self.is_ground.extend(
            self.top_hat
                .iter()
                .zip(&self.inside)
                .map(|(&top_hat, &inside)| inside && top_hat <= limit / 4),
        );
        let width = self.binned.width;
        let margin = ((0.25 * selection.diameter) as usize).max(2);
        for run in selection.shapes().flat_map(|shape| &shape.runs) {
            let columns = run.first.saturating_sub(margin)..(run.last + margin + 1).min(width);
            let rows =
                run.row.saturating_sub(margin)..(run.row + margin + 1).min(self.binned.height);
            for row in rows {
                self.is_ground[row * width..][columns.clone()].fill(false);
            }
        }
    }

    /// First and last column of the pixels of each row of the frame that show the sensor.
    pub(crate) fn rows(&self, height: usize) -> Vec<(i32, i32)> {
        let bin = self.binned.bin;
        let mut rows = Vec::with_capacity(height);
        for line in self.inside.chunks_exact(self.binned.width) {
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

/// The mean of a sum over `pixels` bytes.
fn share_of(pixels: usize) -> impl Fn(u16) -> u8 {
    let scale = 65_536_u32.div_ceil(pixels as u32);
    move |sum| ((u32::from(sum) * scale) >> 16).min(255) as u8
}

/// Factors that turn a difference into a share of the ground, in 65,536ths, for each brightness of the ground; 0 for a
/// ground too dark.
fn scales() -> [u32; 256] {
    std::array::from_fn(|light| {
        if light < DARKEST_GROUND {
            0
        } else {
            255 * 65_536 / light as u32
        }
    })
}
