//! Quantities in the tables of studies, and their units.

use crate::config::LengthUnit;

/// Unit of a quantity. Lengths are in the length unit of the study.
///
/// ```
/// use palpate_study::Unit;
/// use palpate_study::config::LengthUnit;
///
/// assert_eq!(Unit::Length.of(LengthUnit::Mm), "mm");
/// assert_eq!(Unit::PerLengthSquared.of(LengthUnit::Cm), "1/cm^2");
/// assert_eq!(Unit::Turn.of(LengthUnit::Cm), "turn");
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unit {
    /// Length.
    Length,
    /// 1/length.
    PerLength,
    /// 1/length².
    PerLengthSquared,
    /// Length².
    LengthSquared,
    /// Pure number, without a unit.
    One,
    /// Degree, for angles.
    Degree,
    /// Newton.
    Newton,
    /// Turn: a full circle of hues. A hue difference of 0.5 turns is half of this circle.
    Turn,
    /// Pixel.
    Pixel,
    /// Pixel².
    PixelSquared,
}

impl Unit {
    /// Name of the unit, as in the column `unit` of a table: `cm`, `1/cm`, `1/cm^2`.
    pub fn of(self, length: LengthUnit) -> &'static str {
        let of_length = |m, cm, mm, um, unit| match length {
            LengthUnit::M => m,
            LengthUnit::Cm => cm,
            LengthUnit::Mm => mm,
            LengthUnit::Um => um,
            LengthUnit::Unit => unit,
        };
        match self {
            Self::Length => length.as_str(),
            Self::PerLength => of_length("1/m", "1/cm", "1/mm", "1/um", "1/unit"),
            Self::PerLengthSquared => of_length("1/m^2", "1/cm^2", "1/mm^2", "1/um^2", "1/unit^2"),
            Self::LengthSquared => of_length("m^2", "cm^2", "mm^2", "um^2", "unit^2"),
            Self::One => "1",
            Self::Degree => "deg",
            Self::Newton => "N",
            Self::Turn => "turn",
            Self::Pixel => "px",
            Self::PixelSquared => "px^2",
        }
    }
}

/// How a trial determines a quantity: as an estimate, as a measured number, or as a share of correct results.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum QuantityKind {
    /// Estimated from readings, so the value has an error.
    Estimated,
    /// Measured or counted, but not estimated. The label of its mean is the name of the quantity, without the word
    /// "mean".
    Measured,
    /// Share of the points of a patch at which an estimate is correct, from 0 to 1.
    Share,
}

/// A quantity that the trials of a study determine. `cells.csv` has one row for each quantity in each cell, that is,
/// for each combination of the swept values.
///
/// ```
/// use palpate_study::{Quantity, QuantityKind};
///
/// let area = Quantity::named("marker_area").ok_or("a quantity")?;
/// assert_eq!((area, area.kind), (Quantity::MARKER_AREA, QuantityKind::Measured));
/// # Ok::<(), &str>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Quantity {
    /// Name of the quantity, as in `cells.csv` and in the JSON of `estimate`.
    pub name: &'static str,
    /// Unit of the quantity.
    pub unit: Unit,
    /// How a trial determines the quantity.
    pub kind: QuantityKind,
    /// Name of the quantity in words, as figures show it.
    pub words: &'static str,
    /// Meaning of the quantity, in one or two sentences.
    pub meaning: &'static str,
    /// Kinds of scenes that have this quantity.
    pub scenes: &'static [&'static str],
}

macro_rules! quantities {
    ($(#[doc = $doc:literal] $constant:ident = $name:literal, $words:literal, $unit:ident, $kind:ident, $scenes:expr;)*) => {
        impl Quantity {
            $(#[doc = $doc]
            pub const $constant: Self = Self {
                name: $name,
                unit: Unit::$unit,
                kind: QuantityKind::$kind,
                words: $words,
                meaning: $doc.trim_ascii(),
                scenes: $scenes,
            };)*

            /// Every quantity that the tables of a study may have.
            pub const ALL: &'static [Self] = &[$(Self::$constant),*];
        }
    };
}

quantities! {
    /// Normal curvature of the object at the first contact, along u, the x axis of the contact frame.
    NORMAL_CURVATURE_U = "normal_curvature_u", "normal curvature along u", PerLength, Estimated, &["roll"];
    /// Normal curvature of the object at the first contact, along v, the tangent direction perpendicular to u.
    NORMAL_CURVATURE_V = "normal_curvature_v", "normal curvature along v", PerLength, Estimated, &["roll"];
    /// Gaussian curvature of the object.
    GAUSSIAN_CURVATURE = "gaussian_curvature", "Gaussian curvature", PerLengthSquared, Estimated, &["roll", "glide"];
    /// Mean curvature of the object.
    MEAN_CURVATURE = "mean_curvature", "mean curvature", PerLength, Estimated, &["roll", "glide"];
    /// Mean length of the contact's path on the probe, over all rolls.
    ARC_LENGTH = "arc_length", "arc length", Length, Estimated, &["roll"];
    /// Shape class at a point of the patch: 1 if the class is right, otherwise 0.
    CLASS = "class", "share classified correctly", One, Share, &["glide"];
    /// Relative curvature: curvature of the sensor plus curvature of the object.
    RELATIVE_CURVATURE = "relative_curvature", "relative curvature", PerLength, Estimated, &["press"];
    /// Effective radius: the inverse of the relative curvature.
    EFFECTIVE_RADIUS = "effective_radius", "effective radius", Length, Estimated, &["press"];
    /// Curvature of the pressed object, positive if it is convex.
    OBJECT_CURVATURE = "object_curvature", "object curvature", PerLength, Estimated, &["press"];
    /// Distance by which the sensor and the object approach each other after their first touch.
    INDENTATION = "indentation", "indentation", Length, Estimated, &["press"];
    /// Radius of the circle of contact.
    CONTACT_RADIUS = "contact_radius", "contact radius", Length, Estimated, &["press"];
    /// Share of the readings' variance that the fit explains; 1 for a perfect fit.
    R_SQUARED = "r_squared", "R² of the fit", One, Estimated, &["press"];
    /// Displacement of a marker along the normal, as the camera sensor reads it.
    NORMAL_DISPLACEMENT = "normal_displacement", "normal displacement", Length, Estimated, &["press"];
    /// Component of a marker's displacement along the skin, as the camera sensor reads it.
    TANGENTIAL_DISPLACEMENT = "tangential_displacement", "tangential displacement", Length, Estimated, &["press"];
    /// Change in the hue of the marker under the contact. The hue is that of the summed light of the marker's pixels.
    HUE_CHANGE = "hue_change", "hue change", Turn, Measured, &["press"];
    /// Change in the mean hue of the pixels of the marker under the contact.
    MEAN_HUE_CHANGE = "mean_hue_change", "change of the mean hue", Turn, Measured, &["press"];
    /// Distance in the image by which the centroid of the marker under the contact moves.
    CENTROID_SHIFT = "centroid_shift", "centroid shift", Pixel, Measured, &["press"];
    /// Number of markers that were tracked.
    MARKERS_TRACKED = "markers_tracked", "markers tracked", One, Measured, &["press"];
    /// Number of markers that the tracker matched with a wrong marker.
    WRONG_MATCHES = "wrong_matches", "wrong matches", One, Measured, &["press"];
    /// Number of pixels that are computed to render the frames of one press.
    PIXELS = "pixels", "pixels evaluated per press", One, Measured, &["press"];
    /// Radius of the object, negative if it is concave. Studies of rolls and glides have it if their scene sets `principal_curvatures = true`, and only where all normal curvatures of the object are equal; there, it is the inverse of the mean curvature.
    OBJECT_RADIUS = "object_radius", "object radius", Length, Estimated, &["roll", "glide", "press"];
    /// Larger principal curvature of the object at the contact, positive if the object is convex. Studies of rolls and glides have it if their scene sets `principal_curvatures = true`.
    PRINCIPAL_CURVATURE_MAX = "principal_curvature_max", "larger principal curvature", PerLength, Estimated, &["roll", "glide", "press"];
    /// Smaller principal curvature of the object at the contact, positive if the object is convex. Studies of rolls and glides have it if their scene sets `principal_curvatures = true`.
    PRINCIPAL_CURVATURE_MIN = "principal_curvature_min", "smaller principal curvature", PerLength, Estimated, &["roll", "glide", "press"];
    /// Angle from the x axis at the contact to the direction of the smaller principal curvature (a cylinder's axis). Studies of rolls and glides have it if their scene sets `principal_curvatures = true`.
    AXIS_DEG = "axis_deg", "axis of the object", Degree, Estimated, &["roll", "glide", "press"];
    /// 1 if the axis is undetermined, because the principal curvatures do not differ significantly, otherwise 0. Studies of rolls and glides have it if their scene sets `principal_curvatures = true`.
    AXIS_UNDETERMINED = "axis_undetermined", "share of undetermined axes", One, Measured, &["roll", "glide"];
    /// Force between the sensor and the object.
    FORCE = "force", "force", Newton, Estimated, &["press"];
    /// Largest strain of the skin when it is folded from flat pieces to a sphere.
    GREATEST_FOLD_STRAIN = "greatest_fold_strain", "greatest strain of folding", One, Measured, &["fingertip"];
    /// Root mean square of the strain of the skin when it is folded from flat pieces to a sphere.
    RMS_FOLD_STRAIN = "rms_fold_strain", "rms strain of folding", One, Measured, &["fingertip"];
    /// Area of the larger disc of a marker in the image.
    MARKER_AREA = "marker_area", "image area of a marker", PixelSquared, Measured, &["fingertip"];
}

impl Quantity {
    /// Quantities of rolls and glides that are computed only with `scene.principal_curvatures`.
    pub const PRINCIPAL: [Self; 5] = [
        Self::PRINCIPAL_CURVATURE_MAX,
        Self::PRINCIPAL_CURVATURE_MIN,
        Self::AXIS_DEG,
        Self::AXIS_UNDETERMINED,
        Self::OBJECT_RADIUS,
    ];

    /// If this quantity is a radius, the index in `quantities` of the curvature whose inverse it is; otherwise `None`.
    /// If the trials do not determine the sign of this curvature, the radius has quantiles, but no mean and no standard
    /// deviation.
    pub fn inverse_of(self, quantities: &[Self]) -> Option<usize> {
        let is_inverse = |one: &Self| [Self::OBJECT_CURVATURE, Self::MEAN_CURVATURE].contains(one);
        let mut places = quantities.iter();
        (self == Self::OBJECT_RADIUS).then(|| places.position(is_inverse))?
    }

    /// The quantity with this name; `None` if there is none.
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.iter().copied().find(|one| one.name == name)
    }
}
