//! A marker in a frame, and its change from a frame at rest to a pressed frame.

use strum::IntoStaticStr;

/// A marker in a frame. Positions (x, y) are in px from the middle of the frame's first pixel. x increases to the
/// right, and y downward.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Marker {
    /// Centroid of the marker, px. Each pixel is weighted by its contrast to the background.
    pub centroid_px: [f64; 2],
    /// Hue of the marker, in turns, from 0 (red) to below 1. It is the HSV hue of the summed light of the marker's
    /// pixels.
    pub hue_turns: f64,
    /// Mean of the HSV hues of the marker's pixels, in turns. The mean is arithmetic, not cyclic, although the hues 0
    /// and 1 are both red. Only pixels with a saturation above 1/4 count. If there are no such pixels, the mean is
    /// `hue_turns`.
    pub mean_hue_turns: f64,
    /// Size of the marker, px²: its contrast to the background, summed over its pixels. On a bright background, the
    /// contrast of a pixel is the absorbed share of green light plus the absorbed share of blue light. So the size of a
    /// disc that absorbs all light of one of these colours is the disc's area. On a dark background, the contrast is
    /// the light that the pixel adds in the marker's strongest colour, as a share of full scale.
    pub size_px2: f64,
    /// Number of pixels of the connected shape that was recognised as the marker.
    pub pixels: u32,
}

impl Marker {
    /// Mean of this image of a marker and of other images of the same marker.
    #[must_use]
    pub fn averaged(self, others: &[Self]) -> Self {
        // Sum the differences from the first image: of both centroid coordinates, the hue, the mean hue and the size.
        // Hues are angles, so only their differences can be summed.
        let mut sums = [0.0; 5];
        for marker in others {
            let turn = marker.hue_turns - self.hue_turns;
            let differences = [
                marker.centroid_px[0] - self.centroid_px[0],
                marker.centroid_px[1] - self.centroid_px[1],
                turn - (turn + 0.5).floor(),
                marker.mean_hue_turns - self.mean_hue_turns,
                marker.size_px2 - self.size_px2,
            ];
            for (sum, difference) in sums.iter_mut().zip(differences) {
                *sum += difference;
            }
        }
        let [x, y, hue, mean_hue, size] = sums.map(|sum| sum / (1.0 + others.len() as f64));
        Self {
            centroid_px: [self.centroid_px[0] + x, self.centroid_px[1] + y],
            hue_turns: (self.hue_turns + hue).rem_euclid(1.0),
            mean_hue_turns: self.mean_hue_turns + mean_hue,
            size_px2: self.size_px2 + size,
            ..self
        }
    }
}

/// Result of tracking a marker from the frame at rest to the pressed frame.
#[derive(Clone, Copy, Debug, Eq, Hash, IntoStaticStr, PartialEq)]
#[strum(serialize_all = "kebab-case")]
pub enum Status {
    /// The marker was found again in the pressed frame.
    Tracked,
    /// The marker was not found again in the pressed frame.
    Lost,
    /// In the pressed frame, the marker and another marker form one shape.
    Merged,
    /// In the pressed frame, the marker is split into several shapes.
    Split,
    /// The marker was found only in the pressed frame.
    New,
}

/// A marker in the frame at rest and in the pressed frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Track {
    /// The marker in the frame at rest; `None` for a new marker.
    pub rest: Option<Marker>,
    /// The marker in the pressed frame; `None` for a lost marker.
    pub pressed: Option<Marker>,
    /// Status of the marker.
    pub status: Status,
}

/// Change of a marker from the frame at rest to the pressed frame.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Change {
    /// Shift of the centroid, px.
    pub shift_px: [f64; 2],
    /// Change of the hue (turns) of the marker's summed light, from -0.5 to below 0.5.
    pub hue_turns: f64,
    /// Change of the logarithm of the marker's diameter, that is, half the change of the logarithm of its size.
    pub growth: f64,
}

impl Track {
    /// The change of a marker between the frame at rest and the pressed frame. `None` unless the status is `Tracked`
    /// and all numbers are finite.
    ///
    /// ```
    /// use palpate_tracking::{Marker, Status, Track};
    ///
    /// let rest = Marker { centroid_px: [10.0, 10.0], hue_turns: 0.95, mean_hue_turns: 0.95, size_px2: 100.0, pixels: 100 };
    /// let pressed = Marker { centroid_px: [13.0, 6.0], hue_turns: 0.05, ..rest };
    /// let track = Track { rest: Some(rest), pressed: Some(pressed), status: Status::Tracked };
    /// let change = track.change().ok_or("not tracked")?;
    /// assert_eq!(change.shift_px, [3.0, -4.0]);
    /// // Hues are cyclic: the change from 0.95 to 0.05 is a tenth of a turn forward.
    /// assert!((change.hue_turns - 0.1).abs() < 1e-12);
    /// assert_eq!(change.growth, 0.0);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn change(&self) -> Option<Change> {
        let (rest, pressed) = self.rest.zip(self.pressed)?;
        if self.status != Status::Tracked {
            return None;
        }
        let turn = pressed.hue_turns - rest.hue_turns;
        let change = Change {
            shift_px: [0, 1].map(|axis| pressed.centroid_px[axis] - rest.centroid_px[axis]),
            hue_turns: turn - (turn + 0.5).floor(),
            growth: 0.5 * libm::log(pressed.size_px2 / rest.size_px2),
        };
        Some(change).filter(Change::is_finite)
    }

    /// Change of the mean hue of a marker, turns. The mean hue is arithmetic, not cyclic. The result is `None` unless
    /// the status of the marker is `Tracked`.
    pub fn mean_hue_change(&self) -> Option<f64> {
        let (rest, pressed) = self.rest.zip(self.pressed)?;
        let change = pressed.mean_hue_turns - rest.mean_hue_turns;
        (self.status == Status::Tracked && change.is_finite()).then_some(change)
    }
}

impl Change {
    pub(crate) fn is_finite(&self) -> bool {
        let [x, y] = self.shift_px;
        [x, y, self.hue_turns, self.growth]
            .iter()
            .all(|number| number.is_finite())
    }
}
