//! A marker in a frame, and what became of it in another.

use strum::IntoStaticStr;

/// A marker as a frame shows it. The middle of the first pixel has the coordinates (0, 0); x counts columns to the
/// right, y rows downward.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Marker {
    /// Centroid of what sets the marker off from the ground, px.
    pub centroid_px: [f64; 2],
    /// Mean hue in turns, from 0 (red) to below 1: the hue, as HSV has it, of its pixels' light summed, so that each
    /// pixel counts with its chroma.
    pub hue_turns: f64,
    /// How much sets it off from the ground, px²: on a bright ground the shares of green and of blue light that it
    /// takes, summed over its pixels, so that a disc that takes all of one of them counts with its area; on a dark
    /// ground the share of full scale that it adds to its strongest colour.
    pub size_px2: f64,
    /// Pixels that are its own.
    pub pixels: u32,
}

/// Fate of a marker between the rest frame and the pressed one.
#[derive(Clone, Copy, Debug, Eq, Hash, IntoStaticStr, PartialEq)]
#[strum(serialize_all = "kebab-case")]
pub enum Status {
    /// Found again.
    Tracked,
    /// Not found again.
    Lost,
    /// Found grown together with another.
    Merged,
    /// Found in more than one piece.
    Split,
    /// Found without a counterpart at rest.
    New,
}

impl Status {
    /// The stable name.
    pub fn name(self) -> &'static str {
        self.into()
    }
}

/// A marker in a rest frame and in a pressed one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Track {
    /// Marker at rest; `None` for one that is new.
    pub rest: Option<Marker>,
    /// Marker pressed; `None` for one that is lost.
    pub pressed: Option<Marker>,
    /// Fate of the marker.
    pub status: Status,
}

/// Change of a marker's picture between rest and press.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Change {
    /// Shift of the centroid, px.
    pub shift_px: [f64; 2],
    /// Change of the mean hue, turns, from -0.5 to below 0.5.
    pub hue_turns: f64,
    /// Change of the logarithm of the marker's diameter: half the change of that of its size.
    pub growth: f64,
}

impl Track {
    /// The change of a marker that was found again as it was: not of one that merged or split, nor of one whose numbers
    /// are none, as without a size.
    ///
    /// ```
    /// use palpate_tracking::{Marker, Status, Track};
    ///
    /// let rest = Marker { centroid_px: [10.0, 10.0], hue_turns: 0.95, size_px2: 100.0, pixels: 100 };
    /// let pressed = Marker { centroid_px: [13.0, 6.0], hue_turns: 0.05, ..rest };
    /// let track = Track { rest: Some(rest), pressed: Some(pressed), status: Status::Tracked };
    /// let change = track.change().ok_or("not tracked")?;
    /// assert_eq!(change.shift_px, [3.0, -4.0]);
    /// // Hues go round: from 0.95 to 0.05 it is a tenth of a turn forward.
    /// assert!((change.hue_turns - 0.1).abs() < 1e-12);
    /// assert_eq!(change.growth, 0.0);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn change(&self) -> Option<Change> {
        let (rest, pressed) = match self {
            Self {
                rest: Some(rest),
                pressed: Some(pressed),
                status: Status::Tracked,
            } => (rest, pressed),
            _ => return None,
        };
        let turn = pressed.hue_turns - rest.hue_turns;
        let change = Change {
            shift_px: [0, 1].map(|axis| pressed.centroid_px[axis] - rest.centroid_px[axis]),
            hue_turns: turn - (turn + 0.5).floor(),
            growth: 0.5 * libm::log(pressed.size_px2 / rest.size_px2),
        };
        Some(change).filter(Change::is_finite)
    }
}

impl Change {
    /// Whether all of its numbers are.
    pub(crate) fn is_finite(&self) -> bool {
        let [x, y] = self.shift_px;
        [x, y, self.hue_turns, self.growth]
            .iter()
            .all(|number| number.is_finite())
    }
}
