//! The flat pattern from which the skin of a sensor is cut.

use palpate_chromatouch::{FoldStrain, Layout, Pattern, PatternError};
use palpate_study::config::{
    BareFingertipConfig, ConfigError, LengthUnit, PressConfig, PressProbeConfig, SceneConfig, Study,
};

use palpate_study::{Column, FieldError, Table};

use crate::marker_sphere::{LAYOUT, MarkerSphere};

/// The flat pattern of a study's sensor, ready to be cut.
///
/// ```
/// use palpate_study::config::parse;
/// use palpate_estimators::CutPattern;
///
/// let text = r#"
///     name = "fingertip"
///     length_unit = "mm"
///     scene.kind = "fingertip"
///     scene.probe.kind = "marker-sphere"
///     scene.probe.radius = 20.0
///     scene.probe.marker_depth = 2.0
///     scene.probe.discs = { magenta_diameter = 2.0, yellow_diameter = 2.0 }
/// "#;
/// let pattern = CutPattern::of(&parse("study.toml", text)?)?;
/// assert_eq!((pattern.gores, pattern.markers), (4, 77));
/// assert!(pattern.svg.contains("YELLOW") && pattern.dxf.contains("YELLOW"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct CutPattern {
    /// The drawing of the pattern as SVG, in millimetres.
    pub svg: String,
    /// The drawing of the pattern as DXF, with the layers `CUT`, `FOLD`, `MAGENTA` and `YELLOW`.
    pub dxf: String,
    /// Number of gores (flat pieces of the skin) around the sphere.
    pub gores: u32,
    /// Number of markers printed on the gores.
    pub markers: usize,
    /// Largest strain and root mean square strain of the skin when the flat gores are folded over the sphere.
    pub fold_strain: FoldStrain,
    /// Folding strain at the points of a grid over half a gore. One grid direction leads from the middle meridian of
    /// the gore to its edge, the other from the equator to the apex.
    pub strain: Table,
    /// Largest and root mean square folding strain of skins with 3 to 12 gores.
    pub strain_by_gores: Table,
}

impl CutPattern {
    /// The pattern of the sensor in the first grid point of a study.
    ///
    /// # Errors
    /// [`ConfigError`] if there is no pattern. The error is at the field that causes it: a scene without a marker
    /// sensor, a layout without gores, missing discs, a missing length unit, or discs that overlap or would be cut.
    pub fn of(study: &Study) -> Result<Self, ConfigError> {
        let (config, probe) = (&study.config, probe(study)?);
        let unit_mm = millimetres(config.length_unit).ok_or_else(|| {
            let message = "must be m, cm, mm or um, because a cutting file is in millimetres";
            study.error_at(0, FieldError::at("length_unit", message))
        })?;
        planned(&MarkerSphere::from(probe), unit_mm).map_err(|error| study.error_at(0, error))
    }
}

fn probe(study: &Study) -> Result<&PressProbeConfig, ConfigError> {
    match &study.config.scene {
        SceneConfig::Press(PressConfig { probe, .. })
        | SceneConfig::Fingertip(BareFingertipConfig { probe, .. }) => Ok(probe),
        SceneConfig::Roll(_) | SceneConfig::Glide(_) => {
            let message = "has no sensor with markers; only `press` and `fingertip` have one";
            Err(study.error_at(0, FieldError::at("scene.kind", message)))
        }
    }
}

/// Chart coordinates of the markers in the first grid point of a study. The marker (x, y) lies in the direction (x, y)
/// from the apex, at the distance √(x² + y²) along the skin.
///
/// ```
/// use palpate_estimators::marker_places;
/// use palpate_study::config::parse;
///
/// let text = r#"
///     name = "fingertip"
///     scene.kind = "fingertip"
///     scene.probe = { kind = "marker-sphere", radius = 20.0, marker_depth = 2.0 }
/// "#;
/// let places = marker_places(&parse("study.toml", text)?)?;
/// assert_eq!((places.len(), places[0]), (77, [0.0, 0.0]));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`ConfigError`] if the scene has no marker sensor, or if the layout is invalid.
pub fn marker_places(study: &Study) -> Result<Vec<[f64; 2]>, ConfigError> {
    let places = MarkerSphere::from(probe(study)?).places();
    places.map_err(|error| study.error_at(0, error))
}

fn millimetres(unit: LengthUnit) -> Option<f64> {
    match unit {
        LengthUnit::M => Some(1e3),
        LengthUnit::Cm => Some(10.0),
        LengthUnit::Mm => Some(1.0),
        LengthUnit::Um => Some(1e-3),
        LengthUnit::Unit => None,
    }
}

fn planned(sphere: &MarkerSphere<'_>, unit_mm: f64) -> Result<CutPattern, FieldError> {
    let Layout::Gores { gores, .. } = sphere.layout else {
        let message = "has no gores, along which the skin is cut";
        return Err(FieldError::at(LAYOUT, message));
    };
    let diameters = sphere.diameters()?;
    sphere.disc_depths()?;
    let refused = |error: PatternError| pattern_error(&error);
    let sheet = Pattern::new(gores, sphere.outline_samples, sphere.radius)
        .and_then(|pattern| pattern.sheet(&sphere.layout, diameters))
        .map_err(refused)?;
    Ok(CutPattern {
        svg: sheet.svg(unit_mm).map_err(refused)?,
        dxf: sheet.dxf(unit_mm).map_err(refused)?,
        gores,
        markers: sphere.places()?.len(),
        fold_strain: FoldStrain::of(gores).map_err(refused)?,
        strain: strain_over_gore(gores).map_err(refused)?,
        strain_by_gores: strain_by_gores().map_err(refused)?,
    })
}

fn pattern_error(error: &PatternError) -> FieldError {
    let path = match error {
        PatternError::Layout(error) => match error.setting() {
            Some("samples") => "scene.probe.outline_samples".to_owned(),
            Some("radius") => "scene.probe.radius".to_owned(),
            Some(disc @ ("magenta" | "yellow")) => format!("scene.probe.discs.{disc}_diameter"),
            _ => LAYOUT.to_owned(),
        },
        PatternError::TooFewGores { .. } | PatternError::TooManyGores { .. } => {
            format!("{LAYOUT}.gores")
        }
        PatternError::DiscsOverlap { .. } | PatternError::DiscAcrossEdge { .. } => {
            "scene.probe.discs".to_owned()
        }
        PatternError::NotDrawable { .. } => "scene.probe.radius".to_owned(),
        PatternError::BeyondTheEquator { .. } => LAYOUT.to_owned(),
    };
    FieldError::at(path, error)
}

/// Number of grid steps in each direction of the table of folding strains. The two directions are from the middle
/// meridian of a gore to its edge, and from the equator to the apex.
const STEPS: u32 = 18;

fn strain_over_gore(gores: u32) -> Result<Table, PatternError> {
    let strain = FoldStrain::of(gores)?;
    let degrees = ["longitude_deg", "latitude_deg"].map(|name| Column::number(name, "deg"));
    let mut table = Table::new(degrees.into_iter().chain(Column::pure(["strain"])));
    for along in 0..=STEPS {
        for across in 0..=STEPS {
            let share = |step: u32| f64::from(step) / f64::from(STEPS);
            let longitude = std::f64::consts::PI / f64::from(gores) * share(across);
            let latitude = std::f64::consts::FRAC_PI_2 * share(along);
            let here = strain.at(longitude, latitude)?;
            table.push_numbers([longitude.to_degrees(), latitude.to_degrees(), here]);
        }
    }
    Ok(table)
}

fn strain_by_gores() -> Result<Table, PatternError> {
    let strains = Column::pure(["greatest_fold_strain", "rms_fold_strain"]);
    let mut table = Table::new(std::iter::once(Column::count("gores")).chain(strains));
    for gores in 3..=12 {
        let strain = FoldStrain::of(gores)?;
        table.push(gores as usize, [strain.greatest, strain.rms]);
    }
    Ok(table)
}
