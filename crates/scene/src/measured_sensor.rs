//! A sensor without contact. Two of its properties are computed: the strain of its folded skin, and the image area of
//! its markers.

use palpate_chromatouch::{FoldStrain, Layout};
use palpate_estimators::MarkerSphere;
use palpate_study::config::{BareFingertipConfig, PressProbeConfig};
use palpate_study::{FieldError, Quantity};
use palpate_sweep::Observation;

use crate::scene::{Need, Observer, Trials};

/// A sensor without contact, and its computed properties. Nothing is estimated or random.
#[derive(Clone, Debug, PartialEq)]
pub struct MeasuredSensor {
    quantities: &'static [Quantity],
    values: Vec<Option<f64>>,
    needs: Vec<Need>,
}

impl MeasuredSensor {
    /// Quantities that are computed for the sensor of a config. If the skin is made from gores (flat pieces), they
    /// include folding strains. If the markers consist of discs, they include the marker area.
    pub(crate) fn quantities_of(probe: &PressProbeConfig) -> &'static [Quantity] {
        let sphere = MarkerSphere::from(probe);
        let all: &'static [Quantity] = &[
            Quantity::GREATEST_FOLD_STRAIN,
            Quantity::RMS_FOLD_STRAIN,
            Quantity::MARKER_AREA,
        ];
        let has_folds = matches!(sphere.layout, Layout::Gores { .. });
        match (has_folds, sphere.discs.is_some()) {
            (true, true) => all,
            (true, false) => &all[..2],
            (false, true) => &all[2..],
            (false, false) => &[],
        }
    }

    /// Builds the sensor of a config.
    ///
    /// # Errors
    /// [`FieldError`] with the path of the invalid field.
    pub(crate) fn new(config: &BareFingertipConfig) -> Result<Self, FieldError> {
        let sphere = MarkerSphere::from(&config.probe);
        let markers = sphere.markers()?.1.len();
        let mut needs = vec![Need::Model(format!("{markers} markers, no contact"))];
        let mut values = Vec::new();
        if let Layout::Gores { gores, .. } = sphere.layout {
            let strain = FoldStrain::of(gores)
                .map_err(|error| FieldError::at("scene.probe.layout.gores", error))?;
            values.extend([strain.greatest, strain.rms].map(Some));
            needs.push(Need::Model(format!(
                "strain of folding {gores} gores: closed form"
            )));
        }
        if sphere.discs.is_some() {
            values.push(sphere.marker_area(config)?);
            let text = "image area of a marker: closed form, no pixels";
            needs.push(Need::Model(text.to_owned()));
        }
        if values.is_empty() {
            let message =
                "has neither `discs` nor a layout with gores: it has no quantity to compute";
            return Err(FieldError::at("scene.probe", message));
        }
        Ok(Self {
            quantities: Self::quantities_of(&config.probe),
            values,
            needs,
        })
    }
}

impl Trials for MeasuredSensor {
    fn quantities(&self) -> &'static [Quantity] {
        self.quantities
    }

    fn is_random(&self) -> bool {
        false
    }

    fn trial(&self, _trial: u64, observe: Observer<'_>) -> Result<(), &'static str> {
        for (quantity, value) in self.values.iter().enumerate() {
            let value = value.ok_or("out-of-field")?;
            observe(quantity, Observation::plain(value, value));
        }
        Ok(())
    }

    fn truth(&self, quantity: usize) -> Option<f64> {
        self.values.get(quantity).copied().flatten()
    }

    fn needs(&self) -> Vec<Need> {
        self.needs.clone()
    }
}
