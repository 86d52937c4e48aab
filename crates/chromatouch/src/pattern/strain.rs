//! Strain of a flat gore that is folded onto the sphere.
//!
//! The sphere has the radius R, and the skin has n gores. A gore covers |x| ≤ (πR/n) cos φ at the height y = Rφ above
//! the equator. Folding maps the point (x, y) to the latitude φ = y/R and to the longitude λ = x/(R cos φ) from the
//! gore's middle meridian, so heights and widths of the gore do not change. With R cos φ dλ = dx + λ sin φ dy and R dφ
//! = dy,
//!
//! ```text
//! ds² = (R cos φ dλ)² + (R dφ)² = (dx + s dy)² + dy²,    s = λ sin φ:
//! ```
//!
//! This is a simple shear by s. It does not change areas, so the principal stretches are σ and 1/σ, where σ − 1/σ = s:
//!
//! ```text
//! σ = s/2 + √(1 + s²/4).
//! ```
//!
//! The strain is σ − 1. It is largest where the seams meet the apex (|λ| = π/n and φ = π/2). It vanishes on the middle
//! meridian and on the equator. The element of a gore's area is R² cos φ dλ dφ. For points that are spread uniformly
//! over this area, sin φ and nλ/π are independent and uniformly distributed. Therefore the mean square of the strain is
//! an integral over a square.
//!
//! In this construction, the parallels and the middle meridian do not change their lengths. A skin that can slide on
//! the sphere would relax to a state with lower elastic energy.

use std::f64::consts::{FRAC_PI_2, PI};
use std::num::NonZeroUsize;

use gauss_quad::GaussLegendre;

use super::{FEWEST_GORES, PatternError};
use crate::LayoutError;

/// Number of quadrature nodes per direction for the mean square strain. For three or more gores, the quadrature error
/// is below 1e-20. This bound follows from the singularity of the integrand at the imaginary shear s = 2i.
const NODES: usize = 16;

/// Strain of a gore (one of the flat pieces that form a skin) after it is folded onto the sphere. The strain at a point
/// is the larger principal stretch minus 1. The gore is drawn in the polyconic map projection: its shear is the longitude
/// from its middle meridian times the sine of the latitude.
///
/// ```
/// use palpate_chromatouch::FoldStrain;
///
/// let strain = FoldStrain::of(4)?;
/// // If the stretch is σ, the shear is σ − 1/σ: π/4 where the seams of four gores meet the apex.
/// let stretch = 1.0 + strain.greatest;
/// assert!((stretch - 1.0 / stretch - std::f64::consts::FRAC_PI_4).abs() < 1e-12);
/// // The middle meridian keeps its length.
/// assert_eq!(strain.at(0.0, 1.0)?, 0.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FoldStrain {
    gores: u32,
    /// Largest strain of the gore. It occurs where the gore's edges meet the apex.
    pub greatest: f64,
    /// Root mean square of the strain over the gore's area.
    pub rms: f64,
}

impl FoldStrain {
    /// Strain of the gores of a pattern with `gores` gores per turn. The strain does not depend on the radius.
    ///
    /// # Errors
    /// [`PatternError::TooFewGores`] for fewer than three gores.
    pub fn of(gores: u32) -> Result<Self, PatternError> {
        enough(gores)?;
        Ok(Self {
            gores,
            greatest: strain_of_shear(PI / f64::from(gores)),
            rms: rms(gores),
        })
    }

    /// Strain (largest principal stretch minus 1) at a place of the gore. The angles (rad) `longitude` and `latitude`
    /// are measured from the middle meridian and from the equator. The other principal stretch is 1/(1 + strain).
    ///
    /// # Errors
    /// [`LayoutError::BadSetting`] for a place outside the gore.
    pub fn at(&self, longitude: f64, latitude: f64) -> Result<f64, PatternError> {
        let half_width = PI / f64::from(self.gores);
        let on_gore = longitude.abs() <= half_width;
        let expected = format!("from -{half_width} to {half_width}");
        LayoutError::unless(on_gore, "longitude", longitude, &expected)?;
        let on_gore = (0.0..=FRAC_PI_2).contains(&latitude);
        LayoutError::unless(on_gore, "latitude", latitude, "from 0 to a quarter turn")?;
        Ok(strain_of_shear((longitude * libm::sin(latitude)).abs()))
    }
}

/// Strain σ − 1 of a simple shear `shear` ≥ 0, where σ is the larger principal stretch. The formula has no cancellation
/// at small shears.
fn strain_of_shear(shear: f64) -> f64 {
    let half = 0.5 * shear;
    half + half * half / (1.0 + libm::hypot(half, 1.0))
}

fn rms(gores: u32) -> f64 {
    let nodes = NonZeroUsize::new(NODES).expect("a rule has nodes");
    let rule: Vec<[f64; 2]> = GaussLegendre::new(nodes)
        .iter()
        .map(|(node, weight)| [0.5 + 0.5 * node, 0.5 * weight])
        .collect();
    let widest = PI / f64::from(gores);
    let mut mean_square = 0.0;
    for [share_of_width, weight] in &rule {
        for [sine_of_latitude, other_weight] in &rule {
            let strain = strain_of_shear(widest * share_of_width * sine_of_latitude);
            mean_square += weight * other_weight * strain * strain;
        }
    }
    mean_square.sqrt()
}

pub(super) fn enough(gores: u32) -> Result<(), PatternError> {
    if gores >= FEWEST_GORES {
        return Ok(());
    }
    Err(PatternError::TooFewGores {
        gores,
        strain: (gores > 0).then(|| strain_of_shear(PI / f64::from(gores))),
    })
}
