//! Tables of one simulated roll of every probe.

use palpate_rolling::{Contact, Motion};

use super::motion_noise::{NoiseTrial, lasting};
use super::roll_trial::RollScene;
use crate::trace::{Trace, TraceError, counted};
use palpate_study::config::LengthUnit;
use palpate_study::readings::{COLUMNS, table_columns};
use palpate_study::{Column, Table, Unit};

/// Number of samples of each roll in the table, in addition to the first contact.
const SAMPLES: usize = 100;

impl RollScene {
    /// Records the true contacts and the readings of one roll of every probe. Contacts and readings have the noise of
    /// trial number `trial`; they have no noise if `trial` is `None`.
    pub(super) fn record(&self, trial: Option<u64>, unit: LengthUnit) -> Result<Trace, TraceError> {
        let mut sensor = self.sensor.begin(self.seed, trial);
        let mut noise = NoiseTrial::new(self.noise, self.seed, trial);
        let mut contacts = Table::new(columns(unit));
        let mut readings = Table::new(table_columns(&COLUMNS.rolls, unit));
        let mut rotations = trial.map(|trial| self.rotation_sensor.begin(self.seed, trial));
        for (probe, roll) in self.rolls.iter().enumerate() {
            let command = &roll.command;
            let (motions, rotation) = (noise.motions(command), noise.rotation(roll));
            let mut last = *self.roller.first_contact();
            for sample in 0..=SAMPLES {
                let t_s = command.duration_s * sample as f64 / SAMPLES as f64;
                let end = if sample == SAMPLES {
                    f64::INFINITY
                } else {
                    t_s
                };
                last = self
                    .roller
                    .roll(&cut_at(&motions, end))
                    .map_err(|error| TraceError::Roll { probe, error })?;
                contacts.push(probe, row(&last, t_s, self.roller.probe().radius()));
            }
            let shift = last.shift_from(self.roller.first_contact(), self.roller.probe().radius());
            let shift = sensor
                .read(&shift.displacement)
                .map_err(|error| TraceError::Sensor { probe, error })?;
            let rotation = match &mut rotations {
                Some(rotations) => rotations.read(rotation, command.duration_s),
                None => rotation,
            };
            readings.push(probe, [rotation.x, rotation.y, shift.x, shift.y]);
        }
        let probes = counted(readings.rows.len(), "probe");
        Ok(Trace {
            what: format!("{} of {probes}", counted(contacts.rows.len(), "contact")),
            contacts,
            readings: match &self.sampled {
                Some(sampled) => self.series_table(sampled, trial, unit)?,
                None => readings,
            },
            camera: None,
        })
    }
}

fn columns(unit: LengthUnit) -> impl Iterator<Item = Column> {
    let places = [
        "object_x", "object_y", "object_z", "probe_x", "probe_y", "probe_z",
    ];
    [Column::count("probe"), Column::number("t_s", "s")]
        .into_iter()
        .chain(Column::in_length(places, Unit::Length, unit))
        .chain(Column::pure(["normal_x", "normal_y", "normal_z"]))
        .chain(Column::in_length(["arc_length"], Unit::Length, unit))
}

fn row(contact: &Contact, t_s: f64, radius: f64) -> Vec<f64> {
    let mut row = vec![t_s];
    row.extend(contact.on_object.iter());
    row.extend(contact.on_probe(radius).iter());
    row.extend(contact.normal.iter());
    row.push(contact.arc_length);
    row
}

/// Motions from the start of a roll to the time `t_s`. The motion that is in progress at this time is shortened.
fn cut_at(motions: &[Motion], t_s: f64) -> Vec<Motion> {
    let mut left = t_s;
    let mut until = Vec::new();
    for motion in motions {
        let duration_s = motion.duration_s.min(left);
        if duration_s <= 0.0 {
            break;
        }
        until.push(lasting(motion, duration_s));
        left -= motion.duration_s;
    }
    until
}
