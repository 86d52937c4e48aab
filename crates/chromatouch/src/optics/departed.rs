//! Sensors that depart from a known one.

use super::{Colours, Departure, Optics, OpticsError};

impl Optics {
    /// A sensor that departs so from this one. Shares of light stay between 0 and 1.
    ///
    /// # Errors
    /// [`OpticsError::BadDepth`] and [`OpticsError::BadSetting`] where there is no such sensor.
    pub fn departed(&self, departure: &Departure) -> Result<Self, OpticsError> {
        let Departure {
            depths,
            diameters,
            centre_px,
            px_per_rad,
            place,
            turn_rad,
            magenta,
            yellow,
        } = *departure;
        let middle = 0.5 * (f64::from(self.camera.size_px()) - 1.0);
        let centre = self.camera.centre_px();
        let offset = [0, 1].map(|axis| centre[axis] - middle + centre_px[axis]);
        let focal = self.camera.px_per_rad() * (1.0 + px_per_rad);
        let share = |colour: [f64; 3], more: [f64; 3]| {
            std::array::from_fn(|channel| (colour[channel] + more[channel]).clamp(0.0, 1.0))
        };
        let colours = Colours {
            magenta: share(self.colours.magenta, magenta),
            yellow: share(self.colours.yellow, yellow),
            ..self.colours
        };
        let optics = Self::new(
            self.array.clone().remade(depths, diameters)?,
            self.camera.adjusted(offset, focal)?,
            colours,
            self.blemishes,
        )?;
        optics.seen_from(self.pose().moved(place, turn_rad))
    }

    /// Optics of this sensor with other misalignments of its markers, as
    /// [`MarkerArray::with_misalignments`](super::MarkerArray::with_misalignments) takes them.
    ///
    /// # Errors
    /// [`OpticsError::BadSetting`] for `misalignment`.
    pub fn misaligned(&self, misalignments: &[[f64; 2]]) -> Result<Self, OpticsError> {
        Ok(Self {
            array: self.array.clone().with_misalignments(misalignments)?,
            ..self.clone()
        })
    }
}
