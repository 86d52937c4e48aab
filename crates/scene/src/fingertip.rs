//! A fingertip by itself: how its skin folds, how large a camera sees its markers, and the flat pattern it is cut from.

use std::fmt::Write;

use palpate_chromatouch::{
    Camera, Discs, FoldStrain, Layout, Lens, MarkerArray, Pattern, PatternError,
};

use crate::Outcome;
use crate::plan::PlanError;
use crate::press::{disc_depths, discs, layout_of, of_layout, of_optics};
use palpate_study::config::{
    BareFingertipConfig, ConfigError, LengthUnit, LensConfig, LensName, PressConfig,
    PressProbeConfig, SceneConfig, Study,
};
use palpate_study::{Quantity, Unit};

const GREATEST: Quantity = Quantity {
    name: "greatest_fold_strain",
    unit: Unit::One,
};
const RMS: Quantity = Quantity {
    name: "rms_fold_strain",
    unit: Unit::One,
};
const AREA: Quantity = Quantity {
    name: "marker_area",
    unit: Unit::PixelSquared,
};

/// A fingertip by itself: nothing touches it, and nothing is random.
#[derive(Clone, Debug, PartialEq)]
pub struct FingertipScene {
    quantities: &'static [Quantity],
    /// Values of the quantities, in their order; `None` where the camera does not see the place.
    values: Vec<Option<f64>>,
    needs: Vec<String>,
}

impl FingertipScene {
    /// The scene that a config describes.
    ///
    /// # Errors
    /// [`PlanError`] with the path of the field that makes no scene.
    pub fn new(config: &BareFingertipConfig) -> Result<Self, PlanError> {
        let PressProbeConfig::MarkerSphere {
            radius,
            layout,
            discs,
            ..
        } = &config.probe;
        let layout = layout_of(layout);
        let path = "scene.probe.layout";
        let markers = layout
            .places(*radius)
            .map_err(|error| of_layout(path, &error))?;
        let mut needs = vec![format!("{} markers, touching nothing", markers.len())];
        let mut values = Vec::new();
        let folds = if let Layout::Gores { gores, .. } = layout {
            let strain = FoldStrain::of(gores)
                .map_err(|error| PlanError::at(format!("{path}.gores"), error))?;
            values.extend([strain.greatest(), strain.rms()].map(Some));
            needs.push(format!("strain of folding {gores} gores: closed form"));
            true
        } else {
            false
        };
        if discs.is_some() {
            values.push(area(config, &config.sensor)?);
            needs.push("image area of a marker: closed form, no pixels".to_owned());
        }
        let quantities: &'static [Quantity] = match (folds, discs.is_some()) {
            (true, true) => &[GREATEST, RMS, AREA],
            (true, false) => &[GREATEST, RMS],
            (false, true) => &[AREA],
            (false, false) => {
                let message =
                    "has neither `discs` nor a layout with gores: there is nothing to tell";
                return Err(PlanError::at("scene.probe", message));
            }
        };
        Ok(Self {
            quantities,
            values,
            needs,
        })
    }

    /// Quantities that the scene tells.
    pub fn quantities(&self) -> &'static [Quantity] {
        self.quantities
    }

    /// One trial, as any other; see [`crate::Scene::trial`].
    ///
    /// # Errors
    /// The stable name of what went wrong: `out-of-field` where a marker is not wholly seen.
    pub fn trial(&self, mut observe: impl FnMut(usize, Outcome)) -> Result<(), &'static str> {
        for (quantity, value) in self.values.iter().enumerate() {
            let value = value.ok_or("out-of-field")?;
            observe(
                quantity,
                Outcome {
                    estimate: value,
                    truth: value,
                    std: None,
                    interval_holds: None,
                },
            );
        }
        Ok(())
    }

    /// The value of a quantity, where it has one.
    pub fn truth(&self, quantity: usize) -> Option<f64> {
        self.values.get(quantity).copied().flatten()
    }

    /// Needs of the scene, one line each.
    pub fn needs(&self) -> Vec<String> {
        self.needs.clone()
    }
}

/// Image area of the larger disc of a marker, px²; `None` where it is not wholly seen.
fn area(config: &BareFingertipConfig, camera: &LensConfig) -> Result<Option<f64>, PlanError> {
    let PressProbeConfig::MarkerSphere { radius, .. } = config.probe;
    let (sizes, depths) = (discs(&config.probe)?, disc_depths(&config.probe)?);
    let lens = match camera.lens {
        LensName::Fisheye => Lens::Fisheye,
        LensName::Pinhole => Lens::Pinhole,
    };
    let camera =
        Camera::new(lens, camera.size_px, camera.field_deg).map_err(|error| of_optics(&error))?;
    // Fails unless such discs can be made in the skin.
    let diameters = Discs {
        magenta: sizes.magenta_diameter,
        yellow: sizes.yellow_diameter,
    };
    MarkerArray::new(radius, &[[0.0; 2]], diameters, depths).map_err(|error| of_optics(&error))?;
    let seen = |diameter: f64, depth: f64| libm::atan2(0.5 * diameter, radius - depth);
    let larger = f64::max(
        seen(sizes.magenta_diameter, depths.magenta),
        seen(sizes.yellow_diameter, depths.yellow),
    );
    Ok(camera.disc_area(larger, config.view.polar_deg.to_radians()))
}

/// The flat pattern of a study's sensor, ready to be cut.
///
/// ```
/// use palpate_study::config::parse;
/// use palpate_scene::fingertip::CutPattern;
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
    /// The drawing as SVG, in millimetres.
    pub svg: String,
    /// The drawing as DXF, with the layers `CUT`, `FOLD`, `MAGENTA` and `YELLOW`.
    pub dxf: String,
    /// How many gores make the turn.
    pub gores: u32,
    /// How many markers are printed on them.
    pub markers: usize,
    /// The greatest strain of folding, and the root of its mean square.
    pub fold_strain: FoldStrain,
    /// Strain of folding: `longitude_deg,latitude_deg,strain` over the half of a gore, from its middle meridian.
    pub strain: String,
    /// Strain of folding by the number of gores: `gores,greatest_fold_strain,rms_fold_strain`, from 3 to 12.
    pub strain_by_gores: String,
}

impl CutPattern {
    /// The pattern of the sensor of a study's first cell.
    ///
    /// # Errors
    /// [`ConfigError`] at the field that makes no pattern: a scene without a marker sensor, a layout without gores, no
    /// discs, no unit, discs that overlap or would be cut.
    pub fn of(study: &Study) -> Result<Self, ConfigError> {
        let refuse = |error: PlanError| study.error_at(0, &error.path, error.message);
        let config = &study.cells[0].config;
        let probe = match &config.scene {
            SceneConfig::Press(PressConfig { probe, .. })
            | SceneConfig::Fingertip(BareFingertipConfig { probe, .. }) => probe,
            SceneConfig::Roll(_) | SceneConfig::Glide(_) => {
                let message = "has no sensor with markers; a press and a fingertip have";
                return Err(study.error_at(0, "scene.kind", message));
            }
        };
        let unit_mm = millimetres(config.length_unit).ok_or_else(|| {
            let message = "a cutting file is in millimetres: must be m, cm, mm or um";
            study.error_at(0, "length_unit", message)
        })?;
        planned(probe, unit_mm).map_err(refuse)
    }
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

fn planned(probe: &PressProbeConfig, unit_mm: f64) -> Result<CutPattern, PlanError> {
    let PressProbeConfig::MarkerSphere {
        radius,
        layout,
        outline_samples,
        ..
    } = probe;
    let layout = layout_of(layout);
    let Layout::Gores { gores, .. } = layout else {
        let message = "has no gores: a skin is cut along them";
        return Err(PlanError::at("scene.probe.layout", message));
    };
    let sizes = discs(probe)?;
    disc_depths(probe)?;
    let discs = Discs {
        magenta: sizes.magenta_diameter,
        yellow: sizes.yellow_diameter,
    };
    let refused = |error: PatternError| of_pattern(&error);
    let sheet = Pattern::new(gores, *outline_samples, *radius)
        .and_then(|pattern| pattern.sheet(&layout, discs))
        .map_err(refused)?;
    let places = layout
        .places(*radius)
        .map_err(|error| of_layout("scene.probe.layout", &error))?;
    Ok(CutPattern {
        svg: sheet.svg(unit_mm).map_err(refused)?,
        dxf: sheet.dxf(unit_mm).map_err(refused)?,
        gores,
        markers: places.len(),
        fold_strain: FoldStrain::of(gores).map_err(refused)?,
        strain: strain_over_gore(gores).map_err(refused)?,
        strain_by_gores: strain_by_gores().map_err(refused)?,
    })
}

fn of_pattern(error: &PatternError) -> PlanError {
    let path = match error {
        PatternError::Layout(error) => match error.setting() {
            Some("samples") => "scene.probe.outline_samples".to_owned(),
            Some("radius") => "scene.probe.radius".to_owned(),
            Some(disc @ ("magenta" | "yellow")) => format!("scene.probe.discs.{disc}_diameter"),
            _ => "scene.probe.layout".to_owned(),
        },
        PatternError::TooFewGores { .. } | PatternError::TooManyGores { .. } => {
            "scene.probe.layout.gores".to_owned()
        }
        PatternError::DiscsOverlap { .. } | PatternError::DiscAcrossEdge { .. } => {
            "scene.probe.discs".to_owned()
        }
        PatternError::NotDrawable { .. } => "scene.probe.radius".to_owned(),
        PatternError::BeyondTheEquator { .. } => "scene.probe.layout".to_owned(),
    };
    PlanError::at(path, error)
}

/// Steps of the strain's table, from the middle meridian to the edge and from the equator to the apex.
const STEPS: u32 = 18;

fn strain_over_gore(gores: u32) -> Result<String, PatternError> {
    let strain = FoldStrain::of(gores)?;
    let mut csv = "longitude_deg,latitude_deg,strain\n".to_owned();
    for along in 0..=STEPS {
        for across in 0..=STEPS {
            let share = |step: u32| f64::from(step) / f64::from(STEPS);
            let longitude = std::f64::consts::PI / f64::from(gores) * share(across);
            let latitude = std::f64::consts::FRAC_PI_2 * share(along);
            let here = strain.at(longitude, latitude)?;
            let degrees = [longitude.to_degrees(), latitude.to_degrees()];
            let _ = writeln!(csv, "{},{},{here}", degrees[0], degrees[1]);
        }
    }
    Ok(csv)
}

fn strain_by_gores() -> Result<String, PatternError> {
    let mut csv = "gores,greatest_fold_strain,rms_fold_strain\n".to_owned();
    for gores in 3..=12 {
        let strain = FoldStrain::of(gores)?;
        let _ = writeln!(csv, "{gores},{},{}", strain.greatest(), strain.rms());
    }
    Ok(csv)
}
