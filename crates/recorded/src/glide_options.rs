//! Settings of an estimate from glides.

use nalgebra::Vector3;
use palpate_ep2::{RoundTip, TipPoint};
use palpate_estimators::GlideFit;
use palpate_geometry::ShapeThresholds;
use palpate_study::config::{
    GlideEstimatorConfig, LengthUnit, SettingError, SettingTable, split_settings, with_settings,
};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value as Json};

/// Point of a round fingertip whose position is in the readings, instead of the position of the contact.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum TipReports {
    /// The point of the tip that lies farthest in the direction opposite to the setting `outward`.
    #[default]
    LowestPoint,
    /// The centre of the spherical tip.
    Centre,
}

/// Settings of an estimate that the readings do not state. Lengths are in the unit of the readings.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct GlideOptions {
    /// The estimator of the glide, and its settings.
    #[serde(skip)]
    pub estimator: GlideEstimatorConfig,
    /// Unit of lengths, used if the header does not state it.
    #[serde(skip)]
    pub length_unit: Option<LengthUnit>,
    /// Number of points along each side of the grid on which the map and its regions are computed.
    #[schemars(extend("minimum" = 1, "maximum" = 1000))]
    pub grid: usize,
    /// Whether the map has one point per fitted contact, in the order of the contacts, instead of the grid points.
    #[serde(skip)]
    pub map_at_contacts: bool,
    /// Radius of round fingertips, in the readings' length unit. State it if the positions in the readings are not
    /// contacts but points of the fingertips (see setting `reports`). The contacts are then computed from these points
    /// and the normals or, if there are no normals, from a first fit.
    #[schemars(extend("minimum" = 0, "x-unit" = "length"))]
    pub tip_radius: Option<f64>,
    /// Point of round fingertips whose position is in the readings; lowest-point by default.
    pub reports: Option<TipReports>,
    /// Direction that points out of the object; 0,0,1 by default. It is used if the readings have no normals, or if
    /// they contain the lowest points of fingertips. For readings without normals, any direction that points to the
    /// correct side of the patch is sufficient.
    #[schemars(with = "[f64; 3]")]
    pub outward: Option<[f64; 3]>,
    /// Threshold of the Gaussian curvature, 1/length². A Gaussian curvature of smaller magnitude counts as zero. The
    /// threshold must be at least the square of the threshold of the mean curvature. By default, it is computed from
    /// the size of the patch.
    #[schemars(extend("minimum" = 0))]
    pub gaussian_threshold: Option<f64>,
    /// Threshold of the mean curvature, 1/length. A mean curvature of smaller magnitude counts as zero. By default, the
    /// threshold is computed from the size of the patch.
    #[schemars(extend("minimum" = 0))]
    pub mean_threshold: Option<f64>,
    /// Distance between fingers, in the readings' length unit. The settings of the method `two-pass`, and a position
    /// noise that is stated as a fraction, are relative to this distance. By default, it is the mean distance between
    /// neighbouring fingers.
    #[schemars(extend("exclusiveMinimum" = 0, "x-unit" = "length"))]
    pub inter_finger_distance: Option<f64>,
}

impl SettingTable for GlideOptions {}

impl Default for GlideOptions {
    fn default() -> Self {
        Self {
            estimator: GlideEstimatorConfig::default(),
            length_unit: None,
            grid: 30,
            map_at_contacts: false,
            tip_radius: None,
            reports: None,
            outward: None,
            gaussian_threshold: None,
            mean_threshold: None,
            inter_finger_distance: None,
        }
    }
}

impl GlideOptions {
    /// Returns options in which the settings `given` replace the values of `base`. The keys of `given` are the fields
    /// of this struct and the settings of the estimator.
    ///
    /// ```
    /// use palpate_recorded::GlideOptions;
    ///
    /// let given = serde_json::json!({ "inter_finger_distance": 1.0 });
    /// let given = given.as_object().ok_or("a table")?;
    /// let error = GlideOptions::with_settings(None, given, None, true).expect_err("no two-pass");
    /// assert_eq!(error.key, "inter_finger_distance");
    /// let reason = "has an effect only with setting `kind` two-pass or setting `position_fraction_of_ifd`";
    /// assert_eq!(error.reason, reason);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`SettingError`] for a setting that is out of its range or has no effect with the others.
    pub fn with_settings(
        base: Option<Self>,
        given: &Map<String, Json>,
        length_unit: Option<LengthUnit>,
        has_normals: bool,
    ) -> Result<Self, SettingError> {
        let base = base.unwrap_or_default();
        let [own, of_estimator] = split_settings::<Self>(given);
        let mut options = Self {
            estimator: with_settings(&base.estimator, &of_estimator)?,
            length_unit: length_unit.or(base.length_unit),
            map_at_contacts: base.map_at_contacts,
            ..with_settings(&base, &own)?
        };
        options.outward = options.outward.map(direction).transpose()?;
        let checked = options.estimator.check();
        checked.map_err(|reason| SettingError::new("gamma", format!("has no effect: {reason}")))?;
        let useless = |key: &str, to: &str| {
            let is_given = given.contains_key(key);
            let error = SettingError::new(key, format!("has an effect only with {to}"));
            is_given.then_some(error).map_or(Ok(()), Err)
        };
        if !GlideFit::uses_finger_distance(&options.estimator) {
            useless(
                "inter_finger_distance",
                "setting `kind` two-pass or setting `position_fraction_of_ifd`",
            )?;
        }
        let tip = options.tip();
        if has_normals && tip.is_none_or(|tip| tip.point != TipPoint::Lowest) {
            let to = "readings without normals, or readings of the lowest point of a round tip";
            useless("outward", to)?;
        }
        if tip.is_none() {
            let to = "readings of round tips; give setting `tip_radius` too";
            useless("reports", to)?;
        }
        if !has_normals {
            useless("normal_std_deg", "readings with normals")?;
        }
        let [gaussian, mean] = ["gaussian_threshold", "mean_threshold"];
        for (key, other) in [(gaussian, mean), (mean, gaussian)] {
            if given.contains_key(key) && !given.contains_key(other) {
                let reason = format!("has an effect only with setting `{other}`");
                return Err(SettingError::new(key, reason));
            }
        }
        options.thresholds()?;
        Ok(options)
    }

    pub(super) fn thresholds(&self) -> Result<Option<ShapeThresholds>, SettingError> {
        let both = self.gaussian_threshold.zip(self.mean_threshold);
        let thresholds = both.map(|(gaussian, mean)| ShapeThresholds::new(gaussian, mean));
        thresholds.transpose().map_err(|error| {
            SettingError::new("gaussian_threshold", format!("is invalid: {error}"))
        })
    }

    /// Direction that points out of the object.
    pub(super) fn outward(&self) -> Vector3<f64> {
        self.outward.map_or(Vector3::z(), Vector3::from)
    }

    /// The round fingertip; `None` if the readings state contacts instead of points of the tip.
    pub(super) fn tip(&self) -> Option<RoundTip> {
        Some(RoundTip {
            radius: self.tip_radius?,
            point: match self.reports.unwrap_or_default() {
                TipReports::LowestPoint => TipPoint::Lowest,
                TipReports::Centre => TipPoint::Centre,
            },
        })
    }
}

/// The direction `components`, scaled so that its largest component is 1 or −1.
fn direction(components: [f64; 3]) -> Result<[f64; 3], SettingError> {
    let largest = components
        .iter()
        .fold(0.0, |largest: f64, one| largest.max(one.abs()));
    if components.iter().all(|one| one.is_finite()) && largest > 0.0 {
        return Ok(components.map(|one| one / largest));
    }
    Err(SettingError::new("outward", "must be finite and not zero"))
}
