//! Colours of the sensor's parts, and the contribution of each region of a marker to the marker's size and hue. A
//! region is covered by the magenta disc, by the yellow disc, or by both discs.

use palpate_statistics::saturated_hue;

use super::OpticsError;

/// Colours of the sensor's parts as linear light; the components are red, green and blue.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Colours {
    /// Light of the illuminated white layer, relative to full scale.
    pub white: [f64; 3],
    /// Transmittances of a magenta disc for red, green and blue light.
    pub magenta: [f64; 3],
    /// Transmittances of a yellow disc for red, green and blue light.
    pub yellow: [f64; 3],
    /// Transmittances of a seam for red, green and blue light.
    pub seam: [f64; 3],
    /// Light of the frame outside the image circle, relative to full scale.
    pub outside: [f64; 3],
}

impl Default for Colours {
    /// Colours of the frame in the 2020 paper: pink and yellow discs, orange-red where the discs overlap, and white
    /// surroundings.
    fn default() -> Self {
        Self {
            white: [0.96, 0.96, 0.96],
            magenta: [0.98, 0.38, 0.68],
            yellow: [0.99, 0.90, 0.10],
            seam: [0.90, 0.82, 0.86],
            outside: [1.0, 1.0, 1.0],
        }
    }
}

/// Contribution of one pixel to the size and the hue of a marker. All pixels in a region of the marker (one disc, or
/// the overlap of both discs) have the same contribution.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Contrast {
    /// Share of green light plus share of blue light that the pixel absorbs. Both shares are relative to the light of
    /// the white layer.
    pub(super) absorbed: f64,
    /// Two chroma components of the pixel, computed from the red, green and blue light: red − (green + blue)/2, and
    /// √3/2 (green − blue).
    pub(super) chroma: [f64; 2],
    /// Hue of the pixel's colour, turns; `None` for a pale colour, which does not count in the mean hue.
    pub(super) hue_turns: Option<f64>,
}

/// Contributions of a pixel in each of the three regions of a marker. A region is covered only by the magenta disc,
/// only by the yellow disc, or by both discs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Contrasts {
    pub(super) magenta: Contrast,
    pub(super) yellow: Contrast,
    pub(super) overlap: Contrast,
}

impl Colours {
    pub(super) fn checked(self) -> Result<Self, OpticsError> {
        let named = [
            ("white", self.white),
            ("magenta", self.magenta),
            ("yellow", self.yellow),
            ("seam", self.seam),
            ("outside", self.outside),
        ];
        for (setting, colour) in named {
            for share in colour {
                let good = (0.0..=1.0).contains(&share);
                OpticsError::unless(good, setting, share, "shares from 0 to 1")?;
            }
        }
        Ok(self)
    }

    pub(super) fn contrasts(&self) -> Contrasts {
        let contrast = |through: [f64; 3]| {
            let [red, green, blue]: [f64; 3] =
                std::array::from_fn(|channel| self.white[channel] * through[channel]);
            Contrast {
                absorbed: 2.0 - through[1] - through[2],
                chroma: [
                    red - 0.5 * (green + blue),
                    0.5 * 3.0_f64.sqrt() * (green - blue),
                ],
                hue_turns: saturated_hue([red, green, blue]),
            }
        };
        let both = std::array::from_fn(|channel| self.magenta[channel] * self.yellow[channel]);
        Contrasts {
            magenta: contrast(self.magenta),
            yellow: contrast(self.yellow),
            overlap: contrast(both),
        }
    }
}
