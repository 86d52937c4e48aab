//! Finds the markers of a frame.

use image::RgbImage;

use crate::binned::{Binned, LARGEST_BIN};
use crate::lighting::Lighting;
use crate::measure::Scene;
use crate::opening::Opening;
use crate::rim::Rim;
use crate::selection::{self, Selection};
use crate::shapes::{Shape, shapes};
use crate::sight::{self, HueWindow};
use crate::threshold::{Classes, quantile};
use crate::{Marker, Mask, TrackingError};

/// What markers are seen on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Ground {
    /// Dark markers on a bright ground: they take light from it.
    Bright,
    /// Bright markers on a dark ground: they add light to it.
    Dark,
}

/// How to read frames. The default finds out everything from the frame.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FinderSettings {
    /// The image circle. `None`: where the colour of the frame's corners ends, if that is a circle, even a roughly cut out
    /// one; else the whole frame.
    pub mask: Option<Mask>,
    /// What the markers are seen on. `None`: bright if the darkest of green and blue lie further from their median than
    /// the brightest colours from theirs.
    pub ground: Option<Ground>,
    /// Which hues markers have.
    pub hues: HueWindow,
    /// A marker's diameter, px; of one made of two discs that stand apart, the length of both. It sets the size of the
    /// top-hat, 2.2 diameters a side, and how much coarser than the frame the search may be. `None`: up to an eighth of
    /// the circle's diameter, and at least a fiftieth of it.
    pub marker_diameter_px: Option<f64>,
}

/// The markers of a frame.
#[derive(Clone, Debug, PartialEq)]
pub struct Found {
    /// The image circle; if none was given or found, one that holds the whole frame.
    pub mask: Mask,
    /// What the markers are seen on.
    pub ground: Ground,
    /// The markers that are seen whole, from the middle of the circle outward.
    pub markers: Vec<Marker>,
    /// Those cut off by the circle or by the frame's border, in the same order; what is left of them is measured.
    pub cut: Vec<Marker>,
}

/// The least side of a frame, px.
const LEAST_SIDE: u32 = 16;
/// The largest side of a frame, px.
const LARGEST_SIDE: u32 = 32_768;
/// The least diameter of a marker, px.
const LEAST_DIAMETER_PX: f64 = 3.0;
/// Squares across the image circle that suffice to find markers.
const FINE: f64 = 256.0;
/// Squares across a marker that suffice to find it.
const FINE_MARKER: f64 = 6.0;
/// The least radius of an image circle that is looked for, in markers' diameters.
const LEAST_CIRCLE: f64 = 1.5;
/// Share of the circle's radius, at its outside, in which the rim may lie.
const OUTERMOST: f64 = 0.08;
/// Shapes that are looked at.
const MOST_SHAPES: usize = 16_384;
/// How far markers set themselves off from the ground at least, in standard deviations of the ground's own top-hat.
const STANDS_OUT: f64 = 4.0;
/// How far markers set themselves off from the ground at least, of 255.
const LEAST_CONTRAST: f64 = 10.0;
/// The darkest ground, of 255, on which dark markers are looked for.
const DARKEST_GROUND: u8 = 12;

/// Finds markers in one frame after another; frames of the same size reuse its memory.
#[derive(Clone, Debug, Default)]
pub struct Finder {
    settings: FinderSettings,
    binned: Binned,
    inside: Vec<bool>,
    middles: Vec<bool>,
    plane: Vec<u8>,
    top_hat: Vec<u8>,
    is_ground: Vec<bool>,
    opening: Opening,
}

impl Finder {
    /// A finder with these settings.
    ///
    /// # Errors
    /// [`TrackingError::Diameter`] for a diameter that is not a finite length of at least 3 px.
    pub fn new(settings: FinderSettings) -> Result<Self, TrackingError> {
        if let Some(diameter_px) = settings.marker_diameter_px
            && !(LEAST_DIAMETER_PX..=f64::from(LARGEST_SIDE)).contains(&diameter_px)
        {
            return Err(TrackingError::Diameter {
                diameter_px,
                least: LEAST_DIAMETER_PX,
            });
        }
        Ok(Self {
            settings,
            ..Self::default()
        })
    }

    /// The settings.
    pub fn settings(&self) -> &FinderSettings {
        &self.settings
    }

    /// Finds the markers of a frame.
    ///
    /// # Errors
    /// - [`TrackingError::EmptyImage`], [`TrackingError::TooSmall`], [`TrackingError::TooLarge`] for frames that are not
    ///   from 16 to 32,768 px wide and high,
    /// - [`TrackingError::MaskOutside`] for a circle that is none or has its centre outside the frame,
    /// - [`TrackingError::NoMarkers`] if nothing is as a marker,
    /// - [`TrackingError::TooMany`] if more than 16,384 shapes might be.
    pub fn find(&mut self, frame: &RgbImage) -> Result<Found, TrackingError> {
        let (width, height) = frame.dimensions();
        check(width, height)?;
        let given = self
            .settings
            .mask
            .map(|mask| mask.check(width, height))
            .transpose()?;
        let circle = given.map_or(f64::from(width.min(height)), |mask| 2.0 * mask.radius_px);
        self.binned
            .read(frame, self.bin(circle.min(f64::from(width.max(height)))));
        let least = self
            .settings
            .marker_diameter_px
            .map_or(0.0, |diameter| LEAST_CIRCLE * diameter);
        let rim = if given.is_none() {
            Rim::find(&self.binned)
        } else {
            None
        };
        let seen = rim
            .as_ref()
            .and_then(|rim| Some((Mask::of(rim, &self.binned, least)?, rim)));
        let mask = given
            .or(seen.map(|(mask, _)| mask))
            .unwrap_or_else(|| Mask::whole(width, height));
        self.set_inside(&mask, seen.map(|(_, rim)| rim));
        let ground = self.settings.ground.unwrap_or_else(|| self.told_ground());
        self.set_plane(ground);
        self.set_top_hat(&mask, frame);
        let Some(classes) = self.classes() else {
            return Err(TrackingError::NoMarkers { shapes: 0 });
        };
        let shapes = self.shapes(classes.limit)?;
        let count = shapes.len();
        let selection = selection::select(
            shapes,
            &self.top_hat,
            classes.limit,
            self.binned.width,
            &self.inside,
        );
        let found = self.look(frame, mask, ground, classes.limit, &selection);
        if found.markers.is_empty() && found.cut.is_empty() {
            return Err(TrackingError::NoMarkers { shapes: count });
        }
        Ok(found)
    }

    /// Pixels to a side of the squares in which markers are looked for.
    fn bin(&self, circle_px: f64) -> usize {
        let bin = match self.settings.marker_diameter_px {
            Some(diameter_px) => diameter_px / FINE_MARKER,
            None => circle_px / FINE,
        };
        (bin as usize).clamp(1, LARGEST_BIN.min(circle_px as usize / 16).max(1))
    }

    /// Half the side of the top-hat's square, in squares of the coarse frame.
    fn half(&self, mask: &Mask, frame: &RgbImage) -> usize {
        let circle = (2.0 * mask.radius_px).min(f64::from(frame.width().min(frame.height())));
        let side = self
            .settings
            .marker_diameter_px
            .map_or(circle / 8.0, |diameter| 2.2 * diameter);
        let half = (0.5 * side / self.binned.bin as f64).ceil() as usize;
        half.clamp(2, self.binned.width.max(self.binned.height))
    }

    /// What shows the sensor: what lies within the rim near the circle, or else the circle.
    fn set_inside(&mut self, mask: &Mask, rim: Option<&Rim>) {
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

    fn told_ground(&self) -> Ground {
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
            let [red, green, blue] = colour.map(|sum| share(sum));
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

    /// The plane in which markers are bright.
    fn set_plane(&mut self, ground: Ground) {
        let share = share_of(self.binned.pixels());
        self.plane.clear();
        let sums = self.binned.sums.iter();
        match ground {
            Ground::Bright => self
                .plane
                .extend(sums.map(|&[_, green, blue]| !share(green.min(blue)))),
            Ground::Dark => self
                .plane
                .extend(sums.map(|&[red, green, blue]| share(red.max(green).max(blue)))),
        }
        self.top_hat.clear();
        self.top_hat.resize(self.plane.len(), 0);
        self.is_ground.clear();
        self.is_ground
            .resize(self.plane.len(), ground == Ground::Bright);
    }

    /// The top-hat; on a bright ground, which `is_ground` tells for a start, as a share of the ground's light.
    fn set_top_hat(&mut self, mask: &Mask, frame: &RgbImage) {
        let half = self.half(mask, frame);
        let bright = self.is_ground.first() == Some(&true);
        let size = [self.binned.width, self.binned.height];
        mask.coarse(self.binned.bin)
            .fill(-0.5 * half as f64, size, &mut self.middles);
        let opened = self
            .opening
            .open(&self.plane, size[0], &self.inside, &self.middles, half);
        let planes = self.plane.iter().zip(opened).zip(&self.inside);
        for (top_hat, ((&plane, &opened), &inside)) in self.top_hat.iter_mut().zip(planes) {
            let above = if inside { plane - opened } else { 0 };
            let light = if bright { 255 - opened } else { 255 };
            *top_hat = if light < DARKEST_GROUND {
                0
            } else {
                (255.0 * f32::from(above) / f32::from(light)) as u8
            };
        }
    }

    /// Ground and markers in the top-hat, if the two are apart.
    fn classes(&self) -> Option<Classes> {
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

    fn shapes(&self, limit: u8) -> Result<Vec<Shape>, TrackingError> {
        shapes(&self.top_hat, self.binned.width, limit, MOST_SHAPES).ok_or(TrackingError::TooMany {
            shapes: MOST_SHAPES + 1,
            most: MOST_SHAPES,
        })
    }

    /// What is neither a marker nor near one.
    fn set_is_ground(&mut self, limit: u8, selection: &Selection) {
        for (is_ground, (&top_hat, &inside)) in self
            .is_ground
            .iter_mut()
            .zip(self.top_hat.iter().zip(&self.inside))
        {
            *is_ground = inside && top_hat <= limit / 4;
        }
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
    fn rows(&self, height: usize) -> Vec<(i32, i32)> {
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

    /// Measures the selected shapes and keeps those that look like markers.
    fn look(
        &mut self,
        frame: &RgbImage,
        mask: Mask,
        ground: Ground,
        limit: u8,
        selection: &Selection,
    ) -> Found {
        self.set_is_ground(limit, selection);
        let lighting = Lighting::fit(&self.binned, &self.is_ground, &mask);
        let rows = self.rows(frame.height() as usize);
        let scene = Scene {
            frame,
            ground,
            rows: &rows,
            lighting: &lighting,
            bin: self.binned.bin,
            diameter_px: selection.diameter * self.binned.bin as f64,
        };
        let shapes: Vec<Shape> = selection.shapes().cloned().collect();
        let hues = self.settings.hues;
        let pixels = self.binned.pixels();
        let markers: Vec<Option<Marker>> = scene
            .measure(&shapes)
            .iter()
            .zip(&shapes)
            .map(|(sums, shape)| sight::marker(sums, ground, hues, shape.area() * pixels))
            .collect();
        let (whole, cut) = markers.split_at(selection.whole.len());
        let ordered = |markers: &[Option<Marker>]| {
            let mut markers: Vec<Marker> = markers.iter().flatten().copied().collect();
            let away = |marker: &Marker| {
                let [x, y] = [0, 1].map(|axis| marker.centroid_px[axis] - mask.centre_px[axis]);
                x.hypot(y)
            };
            markers.sort_by(|a, b| away(a).total_cmp(&away(b)));
            markers
        };
        Found {
            mask,
            ground,
            markers: ordered(whole),
            cut: ordered(cut),
        }
    }
}

fn check(width: u32, height: u32) -> Result<(), TrackingError> {
    if width == 0 || height == 0 {
        Err(TrackingError::EmptyImage { width, height })
    } else if width.min(height) < LEAST_SIDE {
        Err(TrackingError::TooSmall {
            width,
            height,
            least: LEAST_SIDE,
        })
    } else if width.max(height) > LARGEST_SIDE {
        Err(TrackingError::TooLarge {
            width,
            height,
            most: LARGEST_SIDE,
        })
    } else {
        Ok(())
    }
}

/// The mean of a sum over `pixels` bytes.
fn share_of(pixels: usize) -> impl Fn(u16) -> u8 {
    let scale = 65_536_u32.div_ceil(pixels as u32);
    move |sum| ((u32::from(sum) * scale) >> 16).min(255) as u8
}
