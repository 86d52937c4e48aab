//! Centroid, hue and size of a marker, from the sums over its window.

use crate::measure::Sums;
use crate::{Ground, Marker};
use palpate_statistics::hue_turns;

/// Which hues markers have.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum HueWindow {
    /// [`Self::MagentaToYellow`] on a bright ground, [`Self::Any`] on a dark one.
    #[default]
    ByGround,
    /// All hues, and grey too.
    Any,
    /// Hues from magenta over red to yellow (0.75 to 0.22 turns), and of a colour: not grey dust.
    MagentaToYellow,
}

/// The first and the last hue of [`HueWindow::MagentaToYellow`], turns.
const MAGENTA_TO_YELLOW: [f64; 2] = [0.75, 0.22];
/// The least chroma per light taken from green and blue: pure magenta and yellow have 1, both over one another 1/2.
const LEAST_CHROMA: f64 = 0.2;

/// The marker, if its sums are such as a marker of these hues has.
pub(crate) fn marker(
    sums: &Sums,
    ground: Ground,
    hues: HueWindow,
    pixels: usize,
) -> Option<Marker> {
    let weights = weights(sums, ground);
    let light = dot(weights, sums.light);
    let size_px2 = match ground {
        Ground::Bright => light,
        Ground::Dark => sums.light.iter().copied().fold(0.0, f64::max),
    };
    let centroid_px = [0, 1].map(|axis| {
        sums.middle[axis] + dot(weights, sums.moment.map(|moment| moment[axis])) / light
    });
    let (hue_turns, chroma) = hue(sums.hue_light, ground);
    let coloured = chroma >= LEAST_CHROMA * light;
    let [first, last] = MAGENTA_TO_YELLOW;
    let wanted = match (hues, ground) {
        (HueWindow::Any, _) | (HueWindow::ByGround, Ground::Dark) => true,
        (HueWindow::MagentaToYellow, Ground::Dark) => hue_turns >= first || hue_turns <= last,
        (HueWindow::MagentaToYellow | HueWindow::ByGround, Ground::Bright) => {
            coloured && (hue_turns >= first || hue_turns <= last)
        }
    };
    let finite =
        centroid_px.iter().all(|at| at.is_finite()) && hue_turns.is_finite() && size_px2 > 0.0;
    (wanted && finite && size_px2.is_finite()).then_some(Marker {
        centroid_px,
        hue_turns,
        size_px2,
        pixels: u32::try_from(pixels).unwrap_or(u32::MAX),
    })
}

/// Weights of the colours in a marker's centroid.
pub(crate) fn weights(sums: &Sums, ground: Ground) -> [f64; 3] {
    match ground {
        Ground::Bright => [0.0, 1.0, 1.0],
        // Weights in proportion to the light make the most of pixels that are all equally noisy.
        Ground::Dark => sums.light.map(|light| light.max(0.0)),
    }
}

/// The hue of the summed light, in turns as HSV has it, and the length of its chroma.
pub(crate) fn hue(light: [f64; 3], ground: Ground) -> (f64, f64) {
    let sign = match ground {
        Ground::Bright => -1.0,
        Ground::Dark => 1.0,
    };
    let [red, green, blue] = light.map(|light| sign * light);
    let (along, across) = (red - 0.5 * (green + blue), green - blue);
    let length = libm::hypot(along, 0.75_f64.sqrt() * across);
    (hue_turns([red, green, blue]), length)
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
