//! Settings of an estimate from glides.

use palpate_ep2::{RoundTip, TipPoint};
use palpate_geometry::ShapeThresholds;
use palpate_study::config::{GlideEstimatorConfig, LengthUnit, Range, with_settings};
use serde_json::{Map, Value as Json};

use super::super::patch::GlideOptions;
use super::super::wording::{GivenError, Wording};

/// Largest number of grid points along each side of a map.
const MOST_PLACES: f64 = 1000.0;

/// Settings given for an estimate from glides; `None` if not given. Lengths are in the readings' unit.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct GlideGiven {
    /// Settings of the estimator by their config keys, including `kind`.
    pub estimator: Map<String, Json>,
    /// Grid points along each side of the map, from 1 to 1000.
    pub grid: Option<u32>,
    /// Whether the map has one point per contact instead of a grid.
    pub at_contacts: bool,
    /// Direction out of the object, of any length; only for readings without normals or of the tips' lowest points.
    pub outward: Option<[f64; 3]>,
    /// Radius of round tips, if the readings state another point of the tip than the contact.
    pub tip_radius: Option<f64>,
    /// The point of the tip that readings state, by default the lowest; only with `tip_radius`.
    pub reports: Option<TipPoint>,
    /// Unit of lengths, where the readings do not state it.
    pub length_unit: Option<LengthUnit>,
    /// Magnitude of the Gaussian curvature below which it counts as zero, 1/length²; needs `mean_threshold`.
    pub gaussian_threshold: Option<f64>,
    /// Magnitude of the mean curvature below which it counts as zero, 1/length.
    pub mean_threshold: Option<f64>,
    /// Distance between fingers; only for two-pass, and for noise that is stated as a fraction of it.
    pub inter_finger_distance: Option<f64>,
}

impl GlideOptions {
    /// Options from the given settings, and from `base` for all others. Readings may have normals or not.
    ///
    /// ```
    /// use palpate_recorded::{GlideGiven, GlideOptions, Wording};
    ///
    /// let given = GlideGiven { inter_finger_distance: Some(1.0), ..GlideGiven::default() };
    /// let error = GlideOptions::given(&given, None, true, Wording::Arguments).expect_err("no two-pass");
    /// let said = "inter_finger_distance is of use only to method=\"two-pass\" or position_fraction_of_ifd";
    /// assert_eq!(error.to_string(), said);
    /// ```
    ///
    /// # Errors
    /// [`GivenError`] for a setting that is out of its range or has no effect with the others.
    pub fn given(
        given: &GlideGiven,
        base: Option<Self>,
        has_normals: bool,
        wording: Wording,
    ) -> Result<Self, GivenError> {
        let grid = Range {
            least: Some(1.0),
            most: Some(MOST_PLACES),
            is_whole: true,
            ..Range::default()
        };
        let distance = given.inter_finger_distance;
        wording.check([
            ("grid", given.grid.map(f64::from), grid),
            (
                "gaussian_threshold",
                given.gaussian_threshold,
                Range::NOT_NEGATIVE,
            ),
            ("mean_threshold", given.mean_threshold, Range::NOT_NEGATIVE),
            ("inter_finger_distance", distance, Range::POSITIVE),
            ("tip_radius", given.tip_radius, Range::NOT_NEGATIVE),
        ])?;
        let base = base.unwrap_or_default();
        let estimator = match given.estimator.is_empty() {
            true => base.estimator,
            false => with_settings(&base.estimator, &given.estimator)
                .map_err(|error| wording.of_estimator(error))?,
        };
        estimator.check().map_err(|message| {
            wording.refused("gamma", format!("{}: {message}", wording.name("gamma")))
        })?;
        let useless = |key: &str, to: String| {
            let message = format!("{} is of use only to {to}", wording.name(key));
            Err(wording.refused(key, message))
        };
        let is_two_pass = matches!(estimator, GlideEstimatorConfig::TwoPass { .. });
        let is_used = is_two_pass || estimator.position_fraction_of_ifd().is_some();
        if distance.is_some() && !is_used {
            let fraction = wording.name("position_fraction_of_ifd");
            let to = format!("{} or {fraction}", wording.with("kind", "two-pass"));
            return useless("inter_finger_distance", to);
        }
        let tip = tip(given, base.tip);
        let tells_lowest = tip.is_some_and(|tip| tip.point == TipPoint::Lowest);
        if given.outward.is_some() && has_normals && !tells_lowest {
            let to = "readings without normals and to lowest points of round tips";
            return useless("outward", to.to_owned());
        }
        if given.reports.is_some() && tip.is_none() {
            return useless(
                "reports",
                format!(
                    "readings of round tips; give {} too",
                    wording.name("tip_radius")
                ),
            );
        }
        if given.estimator.contains_key("normal_std_deg") && !has_normals {
            return useless("normal_std_deg", "readings with normals".to_owned());
        }
        Ok(Self {
            estimator,
            length_unit: given.length_unit.or(base.length_unit),
            outward: match given.outward {
                Some(outward) => direction(outward, wording)?,
                None => base.outward,
            },
            tip,
            grid: given.grid.map_or(base.grid, |grid| grid as usize),
            map_at_contacts: given.at_contacts,
            thresholds: thresholds(given, wording)?.or(base.thresholds),
            inter_finger_distance: distance.or(base.inter_finger_distance),
        })
    }
}

/// The round tip as given, else that of `base`.
fn tip(given: &GlideGiven, base: Option<RoundTip>) -> Option<RoundTip> {
    let radius = given.tip_radius.or(base.map(|tip| tip.radius))?;
    let point = given.reports.or(base.map(|tip| tip.point));
    Some(RoundTip {
        radius,
        point: point.unwrap_or_default(),
    })
}

/// Scales a direction so that its largest component is ±1.
fn direction(components: [f64; 3], wording: Wording) -> Result<[f64; 3], GivenError> {
    let largest = components
        .iter()
        .fold(0.0, |largest: f64, one| largest.max(one.abs()));
    if components.iter().all(|one| one.is_finite()) && largest > 0.0 {
        return Ok(components.map(|one| one / largest));
    }
    let message = format!("{} must be finite and not zero", wording.name("outward"));
    Err(wording.refused("outward", message))
}

fn thresholds(given: &GlideGiven, wording: Wording) -> Result<Option<ShapeThresholds>, GivenError> {
    let [gaussian, mean] = ["gaussian_threshold", "mean_threshold"];
    match (given.gaussian_threshold, given.mean_threshold) {
        (None, None) => Ok(None),
        (Some(of_gaussian), Some(of_mean)) => ShapeThresholds::new(of_gaussian, of_mean)
            .map(Some)
            .map_err(|error| wording.refused(gaussian, error.to_string())),
        (of_gaussian, _) => {
            let (key, other) = match of_gaussian {
                Some(_) => (gaussian, mean),
                None => (mean, gaussian),
            };
            let [named, other] = [key, other].map(|key| wording.name(key));
            Err(wording.refused(key, format!("{named} is of use only with {other}")))
        }
    }
}
