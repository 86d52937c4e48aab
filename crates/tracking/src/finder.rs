//! Finds the markers of a frame.

use image::RgbImage;

use crate::binned::LARGEST_BIN;
use crate::coarse::Coarse;
use crate::errors::{self, MarkerErrors};
use crate::lighting::Lighting;
use crate::measure::Scene;
use crate::rim::Rim;
use crate::selection::{self, Selection};
use crate::shapes::{Shape, shapes};
use crate::sight::{self, HueWindow};
use crate::{Ground, Marker, Mask, TrackingError};

/// How to read frames. The default finds out everything from the frame.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FinderSettings {
    /// The image circle. `None`: where the colour of the frame's corners ends, if that is a circle, even a roughly cut out
    /// one; else the whole frame.
    pub mask: Option<Mask>,
    /// Background of the markers. `None`: bright if the darkest of green and blue lie further from their median than
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
    /// Background of the markers.
    pub ground: Ground,
    /// The markers that are seen whole, from the middle of the circle outward.
    pub markers: Vec<Marker>,
    /// Errors of each of these, from the noise of the frame's pixels.
    pub errors: Vec<MarkerErrors>,
    /// Markers that are cut off by the circle or by the frame's border, in the same order; what is left of them is
    /// measured.
    pub cut: Vec<Marker>,
}

impl Found {
    /// Errors of a marker, if it is one that is seen whole.
    pub fn errors_of(&self, marker: &Marker) -> Option<MarkerErrors> {
        let place = self.markers.iter().position(|one| one == marker)?;
        self.errors.get(place).copied()
    }
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
/// Shapes that are looked at.
const MOST_SHAPES: usize = 16_384;

/// Finds markers in one frame after another; frames of the same size reuse its memory.
///
/// ```
/// use image::{Rgb, RgbImage};
/// use palpate_tracking::{Finder, Ground};
///
/// // Nine magenta discs of radius 10 px on a light ground, 60 px apart, the middle one at (120, 120).
/// let near = |at: u32| [60, 120, 180].map(|middle| at.abs_diff(middle).pow(2)).into_iter().min().unwrap_or(0);
/// let frame = RgbImage::from_fn(240, 240, |x, y| {
///     if near(x) + near(y) <= 100 { Rgb([223, 59, 200]) } else { Rgb([235, 235, 235]) }
/// });
/// let found = Finder::default().find(&frame)?;
/// assert_eq!((found.ground, found.markers.len()), (Ground::Bright, 9));
/// // They are told from the middle of the frame outward.
/// assert!(found.markers[0].centroid_px.iter().all(|place| (*place - 120.0).abs() < 0.01));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, Default)]
pub struct Finder {
    settings: FinderSettings,
    coarse: Coarse,
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
        self.coarse
            .binned
            .read(frame, self.bin(circle.min(f64::from(width.min(height)))));
        let least = self
            .settings
            .marker_diameter_px
            .map_or(0.0, |diameter| LEAST_CIRCLE * diameter);
        let rim = if given.is_none() {
            Rim::find(&self.coarse.binned)
        } else {
            None
        };
        let seen = rim
            .as_ref()
            .and_then(|rim| Some((Mask::of(rim, &self.coarse.binned, least)?, rim)));
        let mask = given
            .or(seen.map(|(mask, _)| mask))
            .unwrap_or_else(|| Mask::whole(width, height));
        self.coarse.set_inside(&mask, seen.map(|(_, rim)| rim));
        let ground = self
            .settings
            .ground
            .unwrap_or_else(|| self.coarse.told_ground());
        self.coarse
            .set_top_hat(ground, &mask, self.half(&mask, frame));
        let Some(classes) = self.coarse.classes() else {
            return Err(TrackingError::NoMarkers { shapes: 0 });
        };
        let shapes = self.shapes(classes.limit)?;
        let count = shapes.len();
        let selection = selection::select(
            shapes,
            &self.coarse.top_hat,
            classes.limit,
            self.coarse.binned.width,
            &self.coarse.inside,
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
        let half = (0.5 * side / self.coarse.binned.bin as f64).ceil() as usize;
        half.clamp(2, self.coarse.binned.width.max(self.coarse.binned.height))
    }

    fn shapes(&self, limit: u8) -> Result<Vec<Shape>, TrackingError> {
        shapes(
            &self.coarse.top_hat,
            self.coarse.binned.width,
            limit,
            MOST_SHAPES,
        )
        .ok_or(TrackingError::TooMany {
            shapes: MOST_SHAPES + 1,
            most: MOST_SHAPES,
        })
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
        self.coarse.set_is_ground(limit, selection);
        let lighting = Lighting::fit(&self.coarse.binned, &self.coarse.is_ground, &mask);
        let rows = self.coarse.rows(frame.height() as usize);
        let scene = Scene {
            frame,
            ground,
            rows: &rows,
            lighting: &lighting,
            bin: self.coarse.binned.bin,
            diameter_px: selection.diameter * self.coarse.binned.bin as f64,
        };
        let shapes: Vec<Shape> = selection.shapes().cloned().collect();
        let hues = self.settings.hues;
        let pixels = self.coarse.binned.pixels();
        let markers: Vec<Option<(Marker, MarkerErrors)>> = scene
            .measure(&shapes)
            .iter()
            .zip(&shapes)
            .map(|(sums, shape)| {
                let marker = sight::marker(sums, ground, hues, shape.area() * pixels)?;
                Some((marker, errors::errors(sums, ground, &marker)))
            })
            .collect();
        let (whole, cut) = markers.split_at(selection.whole.len());
        let ordered = |markers: &[Option<(Marker, MarkerErrors)>]| {
            let mut markers: Vec<_> = markers.iter().flatten().copied().collect();
            let away = |marker: &Marker| {
                let [x, y] = [0, 1].map(|axis| marker.centroid_px[axis] - mask.centre_px[axis]);
                libm::hypot(x, y)
            };
            markers.sort_by(|a, b| away(&a.0).total_cmp(&away(&b.0)));
            markers.into_iter().unzip::<_, _, Vec<_>, Vec<_>>()
        };
        let (markers, errors) = ordered(whole);
        Found {
            mask,
            ground,
            markers,
            errors,
            cut: ordered(cut).0,
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
