//! Finds the markers in a frame.

use image::RgbImage;

use crate::binning::LARGEST_BIN;
use crate::ground_mask::GroundMask;
use crate::image_circle::Rim;
use crate::lighting::Lighting;
use crate::marker_features::{MarkerErrors, errors, marker};
use crate::measure::Scene;
use crate::selection::{self, Selection};
use crate::shapes::{Shape, shapes};
use crate::{Ground, Marker, Mask, TrackingError};

/// The markers that were found in a frame.
#[derive(Clone, Debug, PartialEq)]
pub struct Found {
    /// The image circle (the part of the frame that shows the sensor). It was stated by the caller or found in the
    /// frame. Otherwise, it is a circle around the whole frame.
    pub mask: Mask,
    /// Whether the background of the markers is bright or dark.
    pub ground: Ground,
    /// The markers that are completely visible, sorted by their distance from the middle of the image circle.
    pub markers: Vec<Marker>,
    /// Standard errors and covariances of the measured features of the markers, in the order of `markers`. They are
    /// computed from the noise of the frame's pixels.
    pub errors: Vec<MarkerErrors>,
    /// Markers that are cut off by the edge of the image circle or of the frame, sorted by their distance from the
    /// middle of the image circle. Only the visible part of these markers is measured.
    pub cut: Vec<Marker>,
}

impl Found {
    /// Errors of the features of `marker`; `None` if `marker` is not in the list `markers` of completely visible
    /// markers.
    pub fn errors_of(&self, marker: &Marker) -> Option<MarkerErrors> {
        let place = self.markers.iter().position(|one| one == marker)?;
        self.errors.get(place).copied()
    }
}

const MIN_SIDE: u32 = 16;
const MAX_SIDE: u32 = 32_768;
/// Approximate number of bins (squares of pixels) along the diameter of the image circle. With this number, even the
/// smallest accepted markers cover enough bins to be found.
const BINS_PER_DIAMETER: f64 = 256.0;
const MAX_SHAPES: usize = 16_384;

/// Finds the markers of frames. The diameter of a marker may be from 1/50 to 1/8 of the image circle's diameter. The
/// finder reuses its memory, which saves time for frames of the same size.
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
/// // They are sorted from the middle of the frame outward.
/// assert!(found.markers[0].centroid_px.iter().all(|place| (*place - 120.0).abs() < 0.01));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, Default)]
pub struct Finder {
    circle: Option<Mask>,
    ground: Option<Ground>,
    mask: GroundMask,
}

impl Finder {
    /// Creates a finder for frames with the image circle `circle` and the background `ground`. If an argument is
    /// `None`, it is estimated from each frame. The image circle is fitted to the rim of the sensor's image. The rim is
    /// found only if the frame outside of the rim has the colour of the frame's corners. If the rim is not
    /// approximately a circle, the whole frame is used. The kind of background is estimated from the green and blue
    /// values of the frame. The background is bright if the darkest values are farther from the median than the
    /// brightest values.
    pub fn new(circle: Option<Mask>, ground: Option<Ground>) -> Self {
        Self {
            circle,
            ground,
            ..Self::default()
        }
    }

    /// Finds the markers of a frame.
    ///
    /// # Errors
    /// - [`TrackingError::EmptyImage`], [`TrackingError::TooSmall`], [`TrackingError::TooLarge`] unless the frame is
    ///   from 16 to 32,768 px wide and high,
    /// - [`TrackingError::MaskOutside`] for a circle without a positive radius or with its centre outside the frame,
    /// - [`TrackingError::NoMarkers`] if no shape is a marker,
    /// - [`TrackingError::TooMany`] if there are more than 16,384 shapes.
    pub fn find(&mut self, frame: &RgbImage) -> Result<Found, TrackingError> {
        let (width, height) = frame.dimensions();
        check(width, height)?;
        let given = self.circle.map(|mask| mask.check(width, height));
        let given = given.transpose()?;
        let circle = given.map_or(f64::INFINITY, |mask| 2.0 * mask.radius_px);
        self.mask
            .frame
            .read(frame, bin(circle.min(f64::from(width.min(height)))));
        let rim = match given {
            Some(_) => None,
            None => Rim::find(&self.mask.frame),
        };
        let rim = rim.and_then(|rim| Some((Mask::fit(&rim, &self.mask.frame)?, rim)));
        let mask = given
            .or(rim.as_ref().map(|(circle, _)| *circle))
            .unwrap_or_else(|| Mask::whole(width, height));
        self.mask
            .set_inside(&mask, rim.as_ref().map(|(_, rim)| rim));
        let ground = self.ground.unwrap_or_else(|| self.mask.estimate_ground());
        self.mask
            .set_top_hat(ground, &mask, self.half(&mask, frame));
        let Some(classes) = self.mask.classes() else {
            return Err(TrackingError::NoMarkers { shapes: 0 });
        };
        let shapes = self.shapes(classes.limit)?;
        let count = shapes.len();
        let selection = selection::select(
            shapes,
            &self.mask.top_hat,
            classes.limit,
            self.mask.frame.width,
            &self.mask.inside,
        );
        let found = self.measure(frame, mask, ground, classes.limit, &selection);
        if found.markers.is_empty() && found.cut.is_empty() {
            return Err(TrackingError::NoMarkers { shapes: count });
        }
        Ok(found)
    }

    /// Half the side (in bins) of the square that the top-hat transform moves over the frame (its structuring element).
    fn half(&self, mask: &Mask, frame: &RgbImage) -> usize {
        let circle = (2.0 * mask.radius_px).min(f64::from(frame.width().min(frame.height())));
        let half = (circle / 16.0 / self.mask.frame.bin as f64).ceil() as usize;
        half.clamp(2, self.mask.frame.width.max(self.mask.frame.height))
    }

    fn shapes(&self, limit: u8) -> Result<Vec<Shape>, TrackingError> {
        shapes(&self.mask.top_hat, self.mask.frame.width, limit, MAX_SHAPES).ok_or(
            TrackingError::TooMany {
                shapes: MAX_SHAPES + 1,
                most: MAX_SHAPES,
            },
        )
    }

    fn measure(
        &mut self,
        frame: &RgbImage,
        mask: Mask,
        ground: Ground,
        limit: u8,
        selection: &Selection,
    ) -> Found {
        self.mask.set_is_ground(limit, selection);
        let lighting = Lighting::fit(&self.mask.frame, &self.mask.is_ground, &mask);
        let rows = self.mask.rows(frame.height() as usize);
        let scene = Scene {
            frame,
            ground,
            rows: &rows,
            lighting: &lighting,
            bin: self.mask.frame.bin,
            diameter_px: selection.diameter * self.mask.frame.bin as f64,
        };
        let shapes: Vec<Shape> = selection.shapes().cloned().collect();
        let pixels = self.mask.frame.pixels();
        let markers: Vec<Option<(Marker, MarkerErrors)>> = scene
            .measure(&shapes)
            .iter()
            .zip(&shapes)
            .map(|(sums, shape)| {
                let marker = marker(sums, ground, shape.area() * pixels)?;
                Some((marker, errors(sums, ground, &marker)))
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

/// Side (px) of the bins (squares of pixels) in which markers are searched. `circle_px` is the diameter of the image
/// circle.
fn bin(circle_px: f64) -> usize {
    ((circle_px / BINS_PER_DIAMETER) as usize)
        .clamp(1, LARGEST_BIN.min(circle_px as usize / 16).max(1))
}

fn check(width: u32, height: u32) -> Result<(), TrackingError> {
    if width == 0 || height == 0 {
        Err(TrackingError::EmptyImage { width, height })
    } else if width.min(height) < MIN_SIDE {
        Err(TrackingError::TooSmall {
            width,
            height,
            least: MIN_SIDE,
        })
    } else if width.max(height) > MAX_SIDE {
        Err(TrackingError::TooLarge {
            width,
            height,
            most: MAX_SIDE,
        })
    } else {
        Ok(())
    }
}
