//! Blemishes of a camera's picture: uneven light, blur, seams and pixel noise.

use super::OpticsError;
use crate::MOST_GORES;

/// Blemishes of the picture: none by default. One that is off takes no time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Blemishes {
    /// Light at the image circle's rim, as a share of that at the apex; it falls with the square of the polar angle.
    /// 1 is even.
    pub light_at_rim: f64,
    /// Standard deviation of a Gaussian blur, px, of all of the frame; 0 is none.
    pub blur_px: f64,
    /// Seams between gores.
    pub seams: Option<Seams>,
    /// Standard deviation of the Gaussian error of each channel of each pixel in the image circle, levels of 255.
    pub pixel_std: f64,
}

/// Seams between gores, along meridians from the apex; the first along +x.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Seams {
    /// How many gores share the circle.
    pub gores: u32,
    /// Width of a seam, length.
    pub width: f64,
}

impl Default for Blemishes {
    fn default() -> Self {
        Self {
            light_at_rim: 1.0,
            blur_px: 0.0,
            seams: None,
            pixel_std: 0.0,
        }
    }
}

impl Blemishes {
    pub(super) fn checked(self) -> Result<Self, OpticsError> {
        let Self {
            light_at_rim,
            blur_px,
            seams,
            pixel_std,
        } = self;
        for (setting, value, most, expected) in [
            ("light_at_rim", light_at_rim, 1.0, "from 0 to 1"),
            ("blur_px", blur_px, 16.0, "from 0 to 16"),
            ("pixel_std", pixel_std, 255.0, "from 0 to 255"),
        ] {
            OpticsError::unless((0.0..=most).contains(&value), setting, value, expected)?;
        }
        if let Some(Seams { gores, width }) = seams {
            let good = (1..=MOST_GORES).contains(&gores);
            OpticsError::unless(good, "gores", f64::from(gores), "from 1 to 360")?;
            let good = width >= 0.0 && width.is_finite();
            OpticsError::unless(good, "seam_width", width, "finite and at least 0")?;
        }
        Ok(self)
    }
}
