//! Reads frames of a camera sensor from image files, and tracks the markers from a frame at rest to a pressed frame.

use std::f64::consts::TAU;
use std::num::NonZeroU8;

use image::RgbImage;
use palpate_frames::{Compression, decode};
use palpate_tracking::{
    Change, Finder, Found, Marker, Status, Track, TrackingError, difference, match_markers,
};
use serde::Serialize;

use super::error::RecordedError;
use super::file::RecordedFile;
use palpate_estimators::tracks_table;
use palpate_study::{Table, Warning};

/// A frame of a camera sensor.
#[derive(Clone, Debug, PartialEq)]
pub struct Frame {
    /// Name of the frame's file, for messages.
    pub file: String,
    /// Pixels of the frame.
    pub image: RgbImage,
    /// Lossy compression of the file; `None` if the file's format stores all pixels exactly.
    pub compression: Option<Compression>,
}

impl Frame {
    /// The same frame, with the pixels converted from the sRGB encoding to values that are proportional to the light.
    #[must_use]
    pub fn linearised(mut self) -> Self {
        let linear = |level: u8| {
            let share = f64::from(level) / 255.0;
            let linear = match share <= 0.04045 {
                true => share / 12.92,
                false => libm::pow((share + 0.055) / 1.055, 2.4),
            };
            libm::round(255.0 * linear) as u8
        };
        let levels: Vec<u8> = (0..=u8::MAX).map(linear).collect();
        for pixel in self.image.pixels_mut() {
            pixel.0 = pixel.0.map(|level| levels[usize::from(level)]);
        }
        self
    }

    /// The same frame, cut to the square in its middle. The side of the square is the shorter side of the frame.
    #[must_use]
    pub fn central_square(self) -> Self {
        let (width, height) = self.image.dimensions();
        let side = width.min(height);
        let [left, top] = [width, height].map(|length| (length - side) / 2);
        let view = image::imageops::crop_imm(&self.image, left, top, side, side);
        Self {
            image: view.to_image(),
            ..self
        }
    }
}

/// Decodes a frame as 8-bit RGB. Images with 16 bits or grey levels are converted. Transparent pixels are an
/// error, because they have no colour. An alpha channel without transparent pixels is allowed.
///
/// # Errors
/// [`RecordedError::File`] if the file is no PNG, JPEG, BMP, TIFF or WebP image, if it is broken or truncated, if a
/// side is longer than 8192 px, or if a pixel is transparent.
impl TryFrom<&RecordedFile> for Frame {
    type Error = RecordedError;

    fn try_from(file: &RecordedFile) -> Result<Self, RecordedError> {
        let decoded = decode(&file.bytes);
        let (image, compression) = decoded.map_err(|error| file.error(error.to_string()))?;
        Ok(Frame {
            file: file.name.clone(),
            image,
            compression,
        })
    }
}

/// Tracks of the markers from a frame at rest to a pressed frame.
#[derive(Clone, Debug, PartialEq)]
pub struct FramePair {
    /// Tracks of the markers at rest, from the middle of the frame outward, followed by tracks of new markers.
    pub tracks: Vec<Track>,
    /// Markers at rest that are only partly in the frame; they are not tracked.
    pub cut: Vec<Marker>,
    /// Centre of the image circle, px. It is the apex's position in the frame at rest if the camera looks straight at
    /// the apex.
    pub centre_px: [f64; 2],
    /// Markers found in the frame at rest and in the pressed frame, with their measurement errors.
    pub(super) found: [Found; 2],
    files: [String; 2],
}

/// Number of markers with each tracking status.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct TrackCounts {
    /// Number of markers in the frame at rest.
    pub at_rest: usize,
    /// Number of markers that were found in both frames.
    pub tracked: usize,
    /// Number of markers that were not found in the pressed frame.
    pub lost: usize,
    /// Number of markers that merged with another marker in the pressed frame.
    pub merged: usize,
    /// Number of markers that were found in several pieces in the pressed frame.
    pub split: usize,
    /// Number of markers in the pressed frame without a counterpart in the frame at rest.
    pub new: usize,
    /// Number of markers at rest that are only partly in the frame; these markers are not tracked.
    pub cut_at_rest: usize,
}

/// If more than this share of the markers is not found in the pressed frame, there is a warning.
const MAX_LOST: f64 = 0.1;

impl TrackCounts {
    /// Whether at least half of the markers of the frame at rest were found in the pressed frame. If not, the frames
    /// probably come from two different sensors.
    const fn are_of_one_sensor(&self) -> bool {
        2 * self.tracked >= self.at_rest
    }

    fn warning(&self) -> Option<Warning> {
        let missed = self.at_rest - self.tracked;
        let are_many = missed as f64 > MAX_LOST * self.at_rest as f64;
        (are_many && self.are_of_one_sensor()).then(|| {
            let text = format!(
                "{missed} of {} markers were not found in the pressed frame ({} lost, {} merged, {} split): is it as bright and as sharp as the frame at rest?",
                self.at_rest, self.lost, self.merged, self.split
            );
            let numbers = [("missed", missed as f64), ("markers", self.at_rest as f64)];
            Warning::new("lost-markers", text, numbers)
        })
    }
}

/// Smallest median shift of the markers (px) for which a warning states that all markers moved in the same way.
const MIN_COMMON_PX: f64 = 0.5;
/// A warning states that all markers moved in the same way only if the median of their shifts, divided by the scatter
/// of the shifts, is above this value. The scatter is the median deviation of the shifts from their median. The same
/// limit holds for a rotation of all markers.
const MIN_COMMON_RATIO: f64 = 2.5;
/// A motion that all markers have in common is only computed from at least this number of markers.
const MIN_MARKERS: usize = 8;

/// Difference between the green levels (0 to 255) of two frames at which a pixel of the difference image has the full
/// colour.
const FULL_LEVELS: NonZeroU8 = NonZeroU8::new(128).expect("is not 0");

pub(super) fn find(frame: &Frame) -> Result<Found, RecordedError> {
    let refused = |error: TrackingError| RecordedError::readings(&frame.file, error.to_string());
    Finder::default().find(&frame.image).map_err(refused)
}

/// Finds the markers of both frames and matches them.
///
/// # Errors
/// [`RecordedError::Readings`] if the frames have different sizes, or if no markers can be found in one of them.
pub fn track_frames(rest: &Frame, pressed: &Frame) -> Result<FramePair, RecordedError> {
    let [of_rest, of_pressed] = [rest, pressed].map(|frame| frame.image.dimensions());
    if of_rest != of_pressed {
        let message = format!(
            "has {} x {} px; {} has {} x {}",
            of_pressed.0, of_pressed.1, rest.file, of_rest.0, of_rest.1
        );
        return Err(RecordedError::readings(&pressed.file, message));
    }
    let at_rest = find(rest)?;
    let found = find(pressed)?;
    Ok(FramePair {
        tracks: match_markers(&at_rest.markers, &found.markers),
        cut: at_rest.cut.clone(),
        centre_px: at_rest.mask.centre_px,
        found: [at_rest, found],
        files: [rest, pressed].map(|frame| frame.file.clone()),
    })
}

/// Image of the signed difference between two frames of equal size.
///
/// # Errors
/// [`RecordedError::Readings`] if the frames have different sizes.
pub fn difference_image(rest: &Frame, pressed: &Frame) -> Result<RgbImage, RecordedError> {
    difference(&rest.image, &pressed.image, FULL_LEVELS).ok_or_else(|| {
        let [[width, height], [other_width, other_height]] =
            [rest, pressed].map(|frame| <[u32; 2]>::from(frame.image.dimensions()));
        let text = format!(
            "the frame at rest has {width} x {height} px, the pressed one {other_width} x {other_height}"
        );
        RecordedError::readings(&pressed.file, text)
    })
}

impl FramePair {
    /// Number of markers with each tracking status.
    pub fn counts(&self) -> TrackCounts {
        let of_status = |status| {
            self.tracks
                .iter()
                .filter(move |track| track.status == status)
        };
        let count = |status| of_status(status).count();
        TrackCounts {
            at_rest: self.at_rest(),
            tracked: count(Status::Tracked),
            lost: count(Status::Lost),
            merged: count(Status::Merged),
            split: count(Status::Split),
            new: count(Status::New),
            cut_at_rest: self.cut.len(),
        }
    }

    pub(super) fn at_rest(&self) -> usize {
        let at_rest = self.tracks.iter().filter(|track| track.rest.is_some());
        at_rest.count()
    }

    pub(super) fn hue_at_rest(&self) -> f64 {
        let angles = self.found[0]
            .markers
            .iter()
            .map(|marker| TAU * marker.hue_turns);
        let [sin, cos] = angles.fold([0.0; 2], |[sin, cos], angle| {
            [sin + libm::sin(angle), cos + libm::cos(angle)]
        });
        (libm::atan2(sin, cos) / TAU).rem_euclid(1.0)
    }

    /// Index of the marker for which the function `strength` has the largest absolute value, and this value with its
    /// sign; `None` if `strength` has no value for any marker.
    pub(super) fn strongest(
        &self,
        strength: impl Fn(&Track) -> Option<f64>,
    ) -> Option<(usize, f64)> {
        let strengths = self.tracks.iter().enumerate();
        strengths
            .filter_map(|(marker, track)| Some((marker, strength(track)?)))
            .filter(|(_, strength)| strength.is_finite())
            .max_by(|one, other| one.1.abs().total_cmp(&other.1.abs()))
    }

    /// Table with one row per marker. A row contains the position and the hue at rest and, if the marker was tracked,
    /// their changes in the press. For a new marker, it contains the position and the hue in the press.
    pub fn table(&self) -> Table {
        tracks_table(self.tracks.iter().map(Some))
    }

    /// Checks that the frame at rest and the pressed frame can come from the same sensor.
    ///
    /// # Errors
    /// [`RecordedError::Readings`] if fewer than half of the markers were found again.
    pub fn of_one_sensor(&self) -> Result<(), RecordedError> {
        let counts = self.counts();
        let [rest, pressed] = &self.files;
        if counts.are_of_one_sensor() {
            return Ok(());
        }
        let TrackCounts {
            at_rest, tracked, ..
        } = counts;
        let message = format!(
            "shows {tracked} of the {at_rest} markers of {rest} again: are these frames of one sensor?"
        );
        Err(RecordedError::readings(pressed, message))
    }

    /// Warnings about the tracks of the markers.
    pub fn warnings(&self) -> Vec<Warning> {
        let [rest, pressed] = &self.files;
        let moved = self.moved_together().map(|(median, spacing)| {
            let text = format!(
                "half of the markers of {rest} moved by more than {median:.1} px, but neighbours are {spacing:.1} px apart: is {pressed} of another sensor, or did the camera move?"
            );
            let numbers = [("median_shift_px", median), ("spacing_px", spacing)];
            Warning::new("other-sensor", text, numbers)
        });
        let swapped = self.swapped().map(|growth| {
            let percent = -100.0 * growth;
            let text = format!(
                "the marker that changed most became {percent:.1} % smaller, but a press makes it larger: are {rest} and {pressed} swapped?"
            );
            Warning::new("swapped-frames", text, [("growth", growth)])
        });
        let alike = self.moved_alike().filter(|_| moved.is_none());
        let alike = alike.map(|(how, numbers)| {
            let text = format!(
                "all markers of {rest} {how} in {pressed}: did the camera move? a press moves markers differently"
            );
            Warning::new("moved-camera", text, numbers)
        });
        let lost = self.counts().warning();
        let moved = moved.into_iter().chain(alike);
        moved.chain(swapped).chain(lost).collect()
    }

    fn changes(&self) -> impl Iterator<Item = Change> {
        self.tracks.iter().filter_map(Track::change)
    }

    /// The median shift of the markers and the median distance between neighbouring markers, both in px. `None` if the
    /// shift is at most a quarter of the distance.
    fn moved_together(&self) -> Option<(f64, f64)> {
        let shifts = self.changes().map(|change| {
            let [x, y] = change.shift_px;
            libm::hypot(x, y)
        });
        let places: Vec<[f64; 2]> = self
            .tracks
            .iter()
            .filter_map(|track| Some(track.rest?.centroid_px))
            .collect();
        let away = |[x, y]: [f64; 2]| {
            let distances = places
                .iter()
                .map(move |at| libm::hypot(at[0] - x, at[1] - y));
            let others = distances.filter(|&distance| distance > 0.0);
            others.fold(f64::INFINITY, f64::min)
        };
        let spacing = median(places.iter().map(|&place| away(place)))?;
        let shift = median(shifts)?;
        (shift > 0.25 * spacing).then_some((shift, spacing))
    }

    /// Motion that all markers have in common, as if the camera had moved: a shift, or a rotation about the centre of
    /// the image circle. Returns the motion as text and as numbers, and `None` if there is no common motion.
    fn moved_alike(&self) -> Option<(String, Vec<(&'static str, f64)>)> {
        let shifts: Vec<([f64; 2], [f64; 2])> = self
            .tracks
            .iter()
            .filter_map(|track| {
                let [x, y] = track.rest?.centroid_px;
                let arm = [x - self.centre_px[0], y - self.centre_px[1]];
                Some((arm, track.change()?.shift_px))
            })
            .collect();
        if shifts.len() < MIN_MARKERS {
            return None;
        }
        let of_axis = |axis: usize| median(shifts.iter().map(|(_, shift)| shift[axis]));
        let [x, y] = [of_axis(0)?, of_axis(1)?];
        let apart = |(_, shift): &([f64; 2], [f64; 2])| libm::hypot(shift[0] - x, shift[1] - y);
        let size = libm::hypot(x, y);
        if size > MIN_COMMON_PX && size > MIN_COMMON_RATIO * median(shifts.iter().map(apart))? {
            let text = format!("moved by about ({x:.1}, {y:.1}) px");
            return Some((text, vec![("shift_x_px", x), ("shift_y_px", y)]));
        }
        let turn = |([x, y], [along_x, along_y]): &([f64; 2], [f64; 2])| {
            (x * along_y - y * along_x) / (x * x + y * y)
        };
        let all = median(shifts.iter().map(turn))?;
        let apart = median(shifts.iter().map(|shift| (turn(shift) - all).abs()))?;
        let arm = median(shifts.iter().map(|(arm, _)| libm::hypot(arm[0], arm[1])))?;
        let is_turned = all.abs() * arm > MIN_COMMON_PX && all.abs() > MIN_COMMON_RATIO * apart;
        is_turned.then(|| {
            let turn = all.to_degrees();
            let text = format!("turned about the middle by about {turn:.1} degrees");
            (text, vec![("turn_deg", turn)])
        })
    }

    /// Tests whether the two frames are probably swapped. This is the case if the marker whose diameter changed most
    /// became smaller, and its change is clearly larger than those of the other markers. Returns the change of the
    /// logarithm of this marker's diameter; `None` if the frames are probably not swapped.
    fn swapped(&self) -> Option<f64> {
        let (_, growth) = self.strongest(|track| Some(track.change()?.growth))?;
        let scatter = median(self.changes().map(|change| change.growth.abs()))?;
        (growth < -0.01 && -growth > 5.0 * scatter).then_some(growth)
    }
}

pub(super) fn median(numbers: impl Iterator<Item = f64>) -> Option<f64> {
    let mut numbers: Vec<f64> = numbers.filter(|number| number.is_finite()).collect();
    numbers.sort_by(f64::total_cmp);
    numbers.get(numbers.len() / 2).copied()
}
