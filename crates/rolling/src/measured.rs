//! Errors and costs of the rungs, measured on the noiseless rolls.

use crate::ladder::Ends;
use crate::{Chart, InvalidRoll, Model, Roller, Rolls};

/// DOP853's on a ladder that is shown.
const LADDER_TOLERANCES: [f64; 4] = [1e-3, 1e-6, 1e-9, 1e-12];

/// A rung of the ladder, with what it errs by and costs on the noiseless rolls.
#[derive(Clone, Debug, PartialEq)]
pub struct MeasuredRung {
    /// The model that names the rung: never [`Model::Auto`].
    pub model: Model,
    /// The rung with its setting, in words.
    pub name: String,
    /// The largest error of a contact at the end of a roll, relative to its length scale, as held
    /// against DOP853 at the smallest tolerance; or why the rung cannot do these rolls.
    pub outcome: Result<f64, String>,
    /// Number of evaluations of the contact equations by all rolls together; 0 for a closed form.
    pub evaluations: usize,
}

impl Roller {
    /// The rungs on which these rolls, without noise, can be computed, cheapest first; the one that
    /// is taken is among them. `chart` is for the integrators.
    pub fn ladder(&self, chart: Chart, rolls: Rolls<'_>) -> Vec<MeasuredRung> {
        let rk4 = (0..=6).map(|power| Model::Rk4 {
            steps: 1 << power,
            chart,
        });
        let dop853 = LADDER_TOLERANCES.map(|tolerance| Model::Dop853 { tolerance, chart });
        let mut models = vec![Model::ClosedForm, Model::Meridian];
        models.extend(rk4.chain(dop853));
        let taken = self.choice().model;
        if !models.contains(&taken) {
            models.push(taken);
        }
        let mut rungs = self.measured(&models, chart, rolls);
        rungs.sort_by_key(|rung| rung.evaluations);
        rungs
    }

    /// Measured error and cost of each of these models on these rolls. `chart` is that of the
    /// integrator that they are held against.
    pub fn measured(&self, models: &[Model], chart: Chart, rolls: Rolls<'_>) -> Vec<MeasuredRung> {
        let reference = self.ends_on(
            Model::Dop853 {
                tolerance: Model::SMALLEST_TOLERANCE,
                chart,
            },
            rolls,
        );
        let setting = self.setting();
        models
            .iter()
            .map(|model| {
                let ends = self.ends_on(*model, rolls);
                let evaluations = ends.as_ref().map_or(0, |ends| ends.evaluations);
                MeasuredRung {
                    model: *model,
                    name: model.name(),
                    outcome: ends.and_then(|ends| {
                        let reference = reference.as_ref().map_err(Clone::clone)?;
                        Ok(setting.distance(&ends, reference))
                    }),
                    evaluations,
                }
            })
            .collect()
    }

    fn ends_on(&self, model: Model, rolls: Rolls<'_>) -> Result<Ends, String> {
        let roller = self.on(model, rolls).map_err(|error| match error {
            InvalidRoll::Unsupported { reason, .. } => reason,
            error => error.to_string(),
        })?;
        let mut ends = Ends::default();
        for roll in rolls.rolls {
            let (contact, evaluations) = roller.follow(roll).map_err(|error| error.to_string())?;
            ends.contacts.push(contact);
            ends.evaluations += evaluations;
        }
        Ok(ends)
    }
}
