//! Families of random rolls, the flaws of their readings, and the stated noise.

use std::f64::consts::{FRAC_PI_2, TAU};

use anyhow::Result;
use nalgebra::{Matrix2, Vector2};
use palpate_ep1::{PadStart, ProbeReading, ReadingNoise};
use palpate_geometry::surfaces::{Ellipsoid, Sphere};
use palpate_geometry::{CurvatureForm, Shape, Surface};
use palpate_rolling::{Chart, Model, Motion, Probe, Roller, Rolls};
use palpate_sensing::{Channel, PadLayout, PadOffset, Pads, Stream};
use palpate_statistics::{HALF_WIDTHS, student_half_width};

use super::Draws;

/// Radius of the probe, mm.
pub(super) const RADIUS: f64 = 10.0;
/// Smallest and largest ratio of the stated to the true radius of the probe.
const RADIUS_RATIOS: [f64; 2] = [1.1, 1.3];
/// Smallest and largest angle between the frames of rotations and shifts, degrees.
const FRAME_ANGLES: [f64; 2] = [5.0, 30.0];
/// Smallest and largest slip of a probe, as a share of its path.
const SLIPS: [f64; 2] = [0.2, 1.0];
/// Smallest and largest common error of all first contacts, mm.
const OFFSETS: [f64; 2] = [0.2, 1.0];

/// Smallest and largest radius of balls, mm.
const RADII: [f64; 2] = [8.0, 200.0];
/// Smallest and largest semi-axis of ellipsoids, mm.
const SEMI_AXES: [f64; 2] = [20.0, 80.0];
/// Smallest and largest distance of the first contact from the top of an ellipsoid, as a share of its semi-axes.
const PLACES: [f64; 2] = [-0.5, 0.5];
/// Smallest and largest rotation of short rolls and of long ones, rad.
const SHORT: [f64; 2] = [0.1, 0.3];
const LONG: [f64; 2] = [0.5, 1.2];
/// Smallest and largest standard deviation of shifts, mm, and of rotations, relative to the rotation.
const SHIFT_STDS: [f64; 2] = [0.01, 0.1];
const ROTATION_STDS: [f64; 2] = [0.005, 0.03];
/// Bound of a uniform error of unit variance, √3.
const BOUND: f64 = 1.732_050_807_568_877_2;
/// Smallest and largest pitch of pads, mm.
const PITCHES: [f64; 2] = [0.1, 0.5];
/// Error of the rolls' truth, as a share of the radius.
const TOLERANCE: f64 = 1e-7;

/// Flaw of the readings.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Flaw {
    None,
    /// The stated radius of the probe is wrong.
    Radius,
    /// The frame of the rotations is rotated about the normal.
    Rotated,
    /// One probe slipped.
    Slipped,
    /// All first contacts have the same error.
    Offset,
    /// The stated noise is half of the true one.
    HalfNoise,
}

impl Flaw {
    /// All flaws.
    const ALL: [Self; 5] = [
        Self::Radius,
        Self::Rotated,
        Self::Slipped,
        Self::Offset,
        Self::HalfNoise,
    ];

    const fn name(self) -> Option<&'static str> {
        match self {
            Self::None => None,
            Self::Radius => Some("wrong radius of the probe"),
            Self::Rotated => Some("frames turned against each other"),
            Self::Slipped => Some("a slipped probe"),
            Self::Offset => Some("first contacts off"),
            Self::HalfNoise => Some("half the noise told"),
        }
    }

    /// Stated radius of the probe, mm.
    fn stated_radius(self, draws: &mut Draws) -> f64 {
        match self {
            Self::Radius => RADIUS * draws.between(RADIUS_RATIOS),
            _ => RADIUS,
        }
    }

    /// Ratio of the stated to the true noise.
    const fn noise_ratio(self) -> f64 {
        match self {
            Self::HalfNoise => 0.5,
            _ => 1.0,
        }
    }

    /// Adds the flaw to readings without noise.
    fn add_to(self, readings: &mut [ProbeReading], draws: &mut Draws) {
        match self {
            Self::None | Self::Radius | Self::HalfNoise => (),
            Self::Rotated => {
                let (sine, cosine) = libm::sincos(draws.between(FRAME_ANGLES).to_radians());
                let turn = Matrix2::new(cosine, -sine, sine, cosine);
                readings
                    .iter_mut()
                    .for_each(|one| one.rotation = turn * one.rotation);
            }
            Self::Slipped => {
                let probe = draws.between([0.0, readings.len() as f64]) as usize;
                let remaining = 1.0 - draws.between(SLIPS);
                if let Some(reading) = readings.get_mut(probe) {
                    reading.shift *= remaining;
                }
            }
            Self::Offset => {
                let offset = Vector2::from(draws.direction()) * draws.log_between(OFFSETS);
                readings.iter_mut().for_each(|one| one.shift += offset);
            }
        }
    }
}

/// Sensor of a family.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Sensor {
    Shifts,
    Rotations,
    /// Rotations whose errors are uniform.
    Uniform,
    Both,
    Pads,
}

/// Rolls of one kind.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Family {
    on_ball: bool,
    is_long: bool,
    probes: usize,
    sensor: Sensor,
    states_noise: bool,
    pub(super) flaw: Flaw,
}

impl Family {
    /// All families.
    pub(super) fn all() -> Vec<Self> {
        let plain = Self {
            on_ball: true,
            is_long: false,
            probes: 8,
            sensor: Sensor::Shifts,
            states_noise: true,
            flaw: Flaw::None,
        };
        let sensors = [
            Sensor::Shifts,
            Sensor::Rotations,
            Sensor::Both,
            Sensor::Pads,
        ];
        let mut all: Vec<Self> = sensors.map(|sensor| Self { sensor, ..plain }).into();
        let unstated = Self {
            states_noise: false,
            ..plain
        };
        all.extend([
            unstated,
            Self { probes: 4, ..plain },
            Self {
                probes: 4,
                ..unstated
            },
            Self {
                sensor: Sensor::Uniform,
                ..plain
            },
        ]);
        let with_four = [Sensor::Rotations, Sensor::Uniform, Sensor::Pads];
        all.extend(with_four.map(|sensor| Self {
            probes: 4,
            sensor,
            ..plain
        }));
        for base in [plain, unstated] {
            for is_long in [false, true] {
                all.push(Self {
                    on_ball: false,
                    is_long,
                    ..base
                });
            }
        }
        all.push(Self {
            on_ball: false,
            sensor: Sensor::Both,
            ..plain
        });
        for base in [plain, unstated] {
            let is_possible = |flaw: &Flaw| base.states_noise || *flaw != Flaw::HalfNoise;
            let flaws = Flaw::ALL.into_iter().filter(is_possible);
            all.extend(flaws.map(|flaw| Self { flaw, ..base }));
            all.push(Self {
                probes: 4,
                flaw: Flaw::Slipped,
                ..base
            });
        }
        all
    }

    /// Name of the family in the table.
    pub(super) fn name(&self) -> String {
        let either = |is: bool, yes: &str, no: &str| if is { yes } else { no }.to_owned();
        let sensor = match self.sensor {
            Sensor::Shifts => "noise of shifts",
            Sensor::Rotations => "noise of rotations",
            Sensor::Uniform => "uniform noise of rotations",
            Sensor::Both => "noise of both",
            Sensor::Pads => "pads",
        };
        let mut words = vec![
            format!("{} probes", self.probes),
            either(self.on_ball, "balls", "ellipsoids"),
            either(self.is_long, "long rolls", "short rolls"),
            sensor.to_owned(),
            either(self.states_noise, "told", "found"),
        ];
        words.extend(self.flaw.name().map(str::to_owned));
        words.join(", ")
    }

    /// Half-widths of the intervals of 50, 80 and 95 %, in standard deviations.
    pub(super) fn half_widths(&self) -> [f64; 3] {
        // Each probe has two readings; the mobility has three unknown entries.
        let freedom = 2 * self.probes - 3;
        match self.states_noise {
            true => HALF_WIDTHS,
            false => [0.5, 0.8, 0.95].map(|share| student_half_width(share, freedom)),
        }
    }

    /// Whether the readings are those of the stated sensor, without a flaw.
    pub(super) fn is_sound(&self) -> bool {
        self.flaw == Flaw::None && self.states_noise
    }

    /// Whether the readings contradict the model of the least squares.
    pub(super) fn is_wrong(&self) -> bool {
        self.flaw != Flaw::None || self.is_long
    }
}

/// Names of the families whose readings agree with the assumed model.
pub(super) fn sound_families() -> Vec<String> {
    let sound = Family::all().into_iter().filter(Family::is_sound);
    sound.map(|family| family.name()).collect()
}

/// Rolls of a family.
pub(super) struct Case {
    /// Readings without noise, mm.
    exact: Vec<ProbeReading>,
    noise: ReadingNoise,
    /// Draws an error of rotations of unit variance.
    rotation_error: fn(&mut Stream) -> f64,
    pads: Option<Pads>,
    seed: u64,
    /// Stated radius of the probe, mm.
    pub(super) radius: f64,
    /// Stated noise, mm.
    pub(super) stated: ReadingNoise,
    pub(super) half_widths: [f64; 3],
    /// The object's curvature at the first contact, per mm.
    pub(super) truth: CurvatureForm,
}

impl Case {
    /// The case with this number.
    ///
    /// # Errors
    /// If its sensor or its roll is invalid.
    pub(super) fn random(family: Family, seed: u64, number: u64) -> Result<Self> {
        let mut draws = Draws::new(seed, number, Channel::PadOffset);
        let (object, place) = object(&family, &mut draws)?;
        let angles = if family.is_long { LONG } else { SHORT };
        let angle = draws.log_between(angles);
        let start = draws.between([0.0, TAU]);
        let step = TAU / family.probes as f64;
        let motions: Vec<Vec<Motion>> = (0..family.probes)
            .map(|probe| vec![Motion::rolling(start + probe as f64 * step, angle, 1.0)])
            .collect();
        let model = Model::Auto {
            tolerance: TOLERANCE,
            chart: Chart::default(),
        };
        let probe = Probe::new(RADIUS)?;
        let roller = Roller::new(probe, object, place, model, Rolls { rolls: &motions })?;
        let first = roller.first_contact();
        let (_, truth) = roller
            .object()
            .curvature_along(&first.on_object, &first.x_axis)?;
        let mut exact = Vec::new();
        for motions in &motions {
            let shift = roller.shift(motions)?.displacement;
            let rotation = motions[0].rotation();
            exact.push(ProbeReading { rotation, shift });
        }
        let (shift_std, rotation_std) = (
            draws.log_between(SHIFT_STDS),
            draws.log_between(ROTATION_STDS),
        );
        let pitch = draws.log_between(PITCHES);
        let pads = Pads::new(
            RADIUS,
            pitch,
            PadLayout::Square,
            PadOffset::Random,
            FRAC_PI_2,
        )?;
        let pads = (family.sensor == Sensor::Pads).then_some(pads);
        let has = |sensors: &[Sensor], std: f64| match sensors.contains(&family.sensor) {
            true => std,
            false => 0.0,
        };
        let noise = ReadingNoise {
            relative_rotation_std: has(
                &[Sensor::Rotations, Sensor::Uniform, Sensor::Both],
                rotation_std,
            ),
            shift_std: has(&[Sensor::Shifts, Sensor::Both], shift_std),
            ..ReadingNoise::default()
        };
        family.flaw.add_to(&mut exact, &mut draws);
        let ratio = family.flaw.noise_ratio();
        let stated = match (&pads, family.states_noise) {
            (_, false) => ReadingNoise::default(),
            (Some(pads), true) => ReadingNoise::of_pads(pads.pitch(), PadStart::PerRoll),
            (None, true) => ReadingNoise {
                relative_rotation_std: ratio * noise.relative_rotation_std,
                shift_std: ratio * noise.shift_std,
                ..noise
            },
        };
        Ok(Self {
            radius: family.flaw.stated_radius(&mut draws),
            exact,
            noise,
            rotation_error: match family.sensor {
                Sensor::Uniform => |stream| BOUND * stream.symmetric_uniform(),
                _ => Stream::standard_normal,
            },
            pads,
            seed: seed.wrapping_mul(1000).wrapping_add(number),
            stated,
            half_widths: family.half_widths(),
            truth,
        })
    }

    /// Readings of a trial.
    ///
    /// # Errors
    /// If a shift is out of the range of the pads.
    pub(super) fn readings(&self, trial: u64) -> Result<Vec<ProbeReading>> {
        let mut stream = Stream::new(self.seed, trial, Channel::WristContact);
        let mut starts = Stream::new(self.seed, trial, Channel::PadOffset);
        let mut readings = self.exact.clone();
        for reading in &mut readings {
            let rotation_std = self.noise.relative_rotation_std * reading.rotation.norm();
            for angle in reading.rotation.iter_mut() {
                *angle += rotation_std * (self.rotation_error)(&mut stream);
            }
            for shift in reading.shift.iter_mut() {
                *shift += self.noise.shift_std * stream.standard_normal();
            }
            if let Some(pads) = &self.pads {
                reading.shift = pads.read(&pads.place(&mut starts), &reading.shift)?;
            }
        }
        Ok(readings)
    }
}

/// A random object, and the place of the first contact.
fn object(family: &Family, draws: &mut Draws) -> Result<(Shape, (f64, f64))> {
    if family.on_ball {
        return Ok((
            Shape::Sphere(Sphere::new(draws.log_between(RADII))?),
            (0.0, 0.0),
        ));
    }
    let semi_axes = [(); 3].map(|()| draws.log_between(SEMI_AXES));
    let mut along = |axis: usize| semi_axes[axis] * draws.between(PLACES);
    let place = (along(0), along(1));
    Ok((Shape::Ellipsoid(Ellipsoid::new(semi_axes)?), place))
}

#[cfg(test)]
impl Family {
    /// Config of rolls with the smallest (0) or the largest (1) values of the family, divided or multiplied by `factor`.
    pub(super) fn config(&self, end: usize, factor: f64) -> String {
        let factor = if end == 0 { factor.recip() } else { factor };
        let object = match self.on_ball {
            true => format!(r#"kind = "sphere", radius = {}"#, RADII[end] * factor),
            false => {
                let [long, wide, high] = [SEMI_AXES[end] * factor; 3];
                format!(r#"kind = "ellipsoid", semi_axes = [{long}, {wide}, {high}]"#)
            }
        };
        let angle = factor * if self.is_long { LONG[end] } else { SHORT[end] };
        let directions: Vec<f64> = (0..self.probes)
            .map(|probe| 360.0 * probe as f64 / self.probes as f64)
            .collect();
        let wrist = format!(
            r#"{{ kind = "wrist", std = {} }}"#,
            SHIFT_STDS[end] * factor
        );
        let pads = format!(
            r#"{{ kind = "pads", pitch = {}, offset = "random" }}"#,
            PITCHES[end] * factor
        );
        let ideal = r#"{ kind = "ideal" }"#.to_owned();
        let rotation_noise = |kind: &str, fraction: f64| {
            format!(r#"angular_velocity = {{ kind = "{kind}", fraction = {fraction} }}"#)
        };
        let rotation_std = ROTATION_STDS[end] * factor;
        let rotations = rotation_noise("gaussian", rotation_std);
        let (sensor, noise) = match self.sensor {
            Sensor::Shifts => (wrist, String::new()),
            Sensor::Rotations => (ideal, rotations),
            Sensor::Uniform => (ideal, rotation_noise("uniform", BOUND * rotation_std)),
            Sensor::Both => (wrist, rotations),
            Sensor::Pads => (pads, String::new()),
        };
        format!(
            r#"
            name = "rolls"
            length_unit = "mm"
            [scene]
            kind = "roll"
            probe = {{ kind = "sphere", radius = {RADIUS} }}
            object = {{ {object} }}
            motion = {{ angle_deg = {}, directions_deg = {directions:?} }}
            sensor = {sensor}
            noise = {{ {noise} }}
            "#,
            angle.to_degrees()
        )
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;

    #[test]
    fn families_have_different_names() {
        let names: BTreeSet<String> = Family::all().iter().map(Family::name).collect();
        assert_eq!(names.len(), Family::all().len());
    }
}
