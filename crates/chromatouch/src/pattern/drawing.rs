//! Drawings of a cutting sheet for those who cut it.

mod dxf;
mod layers;
mod svg;

use super::PatternError;
use super::sheet::CuttingSheet;

/// Radii of spheres that a drawing in millimetres takes, mm: files tell places to 1e-6 mm.
const DRAWABLE_MM: [f64; 2] = [0.01, 1e6];

impl CuttingSheet {
    /// The drawing as SVG in millimetres, y up the page, with the groups `CUT`, `FOLD`, `MAGENTA` and `YELLOW`;
    /// `unit_mm` is the pattern's unit of length in millimetres.
    ///
    /// # Errors
    /// [`PatternError::NotDrawable`].
    pub fn svg(&self, unit_mm: f64) -> Result<String, PatternError> {
        Ok(svg::written(&self.in_millimetres(unit_mm)?))
    }

    /// The drawing as DXF R12 in millimetres, with the layers `CUT`, `FOLD`, `MAGENTA` and `YELLOW`; `unit_mm` is the
    /// pattern's unit of length in millimetres.
    ///
    /// # Errors
    /// [`PatternError::NotDrawable`].
    pub fn dxf(&self, unit_mm: f64) -> Result<String, PatternError> {
        Ok(dxf::written(&self.in_millimetres(unit_mm)?))
    }

    /// The sheet in millimetres, if a drawing takes it.
    fn in_millimetres(&self, unit_mm: f64) -> Result<Self, PatternError> {
        let radius_mm = self.radius() * unit_mm;
        let [least, most] = DRAWABLE_MM;
        if (least..=most).contains(&radius_mm) {
            return Ok(self.scaled(unit_mm));
        }
        Err(PatternError::NotDrawable {
            radius_mm,
            least,
            most,
        })
    }
}
