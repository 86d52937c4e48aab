//! Rolls over random objects, and what is told of them.

use std::f64::consts::{FRAC_PI_2, TAU};

use anyhow::Result;
use palpate_ep1::{PadStart, ProbeReading, ReadingNoise};
use palpate_geometry::surfaces::{Ellipsoid, Sphere};
use palpate_geometry::{CurvatureForm, Shape, Surface};
use palpate_rolling::{Chart, Model, Motion, Probe, Roller, Rolls};
use palpate_sensing::{Channel, PadLayout, PadOffset, Pads, Stream};
use palpate_statistics::{HALF_WIDTHS, student_half_width};

use super::super::draws::Draws;
use super::flaw::{Flaw, RADIUS};

/// Smallest and largest radius of balls, mm.
const RADII: [f64; 2] = [8.0, 200.0];
/// Smallest and largest semi-axis of ellipsoids, mm; and how far from their tops they are touched, as a share of these.
const SEMI_AXES: [f64; 2] = [20.0, 80.0];
const PLACES: [f64; 2] = [-0.5, 0.5];
/// Smallest and largest rotation of short rolls and of long ones, rad.
const SHORT: [f64; 2] = [0.1, 0.3];
const LONG: [f64; 2] = [0.5, 1.2];
/// Smallest and largest standard deviation of shifts, mm, and of rotations, as a share of them.
const SHIFT_STDS: [f64; 2] = [0.01, 0.1];
const ROTATION_STDS: [f64; 2] = [0.005, 0.03];
/// Bound of a uniform error of unit variance, √3.
const BOUND: f64 = 1.732_050_807_568_877_2;
/// Smallest and largest pitch of pads, mm.
const PITCHES: [f64; 2] = [0.1, 0.5];
/// Error of the rolls' truth, as a share of the radius.
const TOLERANCE: f64 = 1e-7;

/// Sensor as a family draws it.
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
    is_noise_told: bool,
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
            is_noise_told: true,
            flaw: Flaw::None,
        };
        let sensors = [
            Sensor::Shifts,
            Sensor::Rotations,
            Sensor::Both,
            Sensor::Pads,
        ];
        let mut all: Vec<Self> = sensors.map(|sensor| Self { sensor, ..plain }).into();
        let found = Self {
            is_noise_told: false,
            ..plain
        };
        all.extend([
            found,
            Self { probes: 4, ..plain },
            Self { probes: 4, ..found },
            Self {
                sensor: Sensor::Uniform,
                ..plain
            },
        ]);
        let of_four = [Sensor::Rotations, Sensor::Uniform, Sensor::Pads];
        all.extend(of_four.map(|sensor| Self {
            probes: 4,
            sensor,
            ..plain
        }));
        for base in [plain, found] {
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
        for base in [plain, found] {
            let asked = |flaw: &Flaw| base.is_noise_told || *flaw != Flaw::HalfNoise;
            let flaws = Flaw::ALL.into_iter().filter(asked);
            all.extend(flaws.map(|flaw| Self { flaw, ..base }));
            all.push(Self {
                probes: 4,
                flaw: Flaw::Slipped,
                ..base
            });
        }
        all
    }

    /// The family in words.
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
            either(self.is_noise_told, "told", "found"),
        ];
        words.extend(self.flaw.name().map(str::to_owned));
        words.join(", ")
    }

    /// Half-widths of the intervals of 50, 80 and 95 %, in standard deviations.
    pub(super) fn half_widths(&self) -> [f64; 3] {
        // Two readings of each probe tell three entries of the mobility.
        let freedom = 2 * self.probes - 3;
        match self.is_noise_told {
            true => HALF_WIDTHS,
            false => [0.5, 0.8, 0.95].map(|share| student_half_width(share, freedom)),
        }
    }

    /// Whether the readings are those of a sensor as it is told, of whatever rolls.
    pub(super) fn is_sound(&self) -> bool {
        self.flaw == Flaw::None && self.is_noise_told
    }

    /// Whether the readings are not what the least squares believe.
    pub(super) fn is_wrong(&self) -> bool {
        self.flaw != Flaw::None || self.is_long
    }
}

/// Rolls of a family.
pub(super) struct Case {
    /// Readings without noise, mm.
    exact: Vec<ProbeReading>,
    noise: ReadingNoise,
    /// Draw of an error of rotations of unit variance.
    of_rotation: fn(&mut Stream) -> f64,
    pads: Option<Pads>,
    seed: u64,
    /// Radius of the probe and noise as they are told, mm.
    pub(super) radius: f64,
    pub(super) told: ReadingNoise,
    pub(super) half_widths: [f64; 3],
    /// The object's curvature where it is touched first, per mm.
    pub(super) truth: CurvatureForm,
}

impl Case {
    /// The case of this number.
    ///
    /// # Errors
    /// None that a family makes.
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
        family.flaw.spoil(&mut exact, &mut draws);
        let part = family.flaw.told();
        let told = match (&pads, family.is_noise_told) {
            (_, false) => ReadingNoise::default(),
            (Some(pads), true) => ReadingNoise::of_pads(pads.pitch(), PadStart::PerRoll),
            (None, true) => ReadingNoise {
                relative_rotation_std: part * noise.relative_rotation_std,
                shift_std: part * noise.shift_std,
                ..noise
            },
        };
        Ok(Self {
            radius: family.flaw.radius(&mut draws),
            exact,
            noise,
            of_rotation: match family.sensor {
                Sensor::Uniform => |stream| BOUND * stream.symmetric_uniform(),
                _ => Stream::standard_normal,
            },
            pads,
            seed: seed.wrapping_mul(1000).wrapping_add(number),
            told,
            half_widths: family.half_widths(),
            truth,
        })
    }

    /// Readings of a trial.
    ///
    /// # Errors
    /// None that a family makes.
    pub(super) fn readings(&self, trial: u64) -> Result<Vec<ProbeReading>> {
        let mut stream = Stream::new(self.seed, trial, Channel::WristContact);
        let mut starts = Stream::new(self.seed, trial, Channel::PadOffset);
        let mut readings = self.exact.clone();
        for reading in &mut readings {
            let rotation_std = self.noise.relative_rotation_std * reading.rotation.norm();
            for angle in reading.rotation.iter_mut() {
                *angle += rotation_std * (self.of_rotation)(&mut stream);
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

/// A random object, and the place at which it is touched.
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
    /// Rolls with the smallest values (0) or the largest (1) that the family draws, as a config; they are so many times as
    /// large, or as small.
    pub(super) fn text(&self, end: usize, times: f64) -> String {
        let times = if end == 0 { times.recip() } else { times };
        let object = match self.on_ball {
            true => format!(r#"kind = "sphere", radius = {}"#, RADII[end] * times),
            false => {
                let [long, wide, high] = [SEMI_AXES[end] * times; 3];
                format!(r#"kind = "ellipsoid", semi_axes = [{long}, {wide}, {high}]"#)
            }
        };
        let angle = times * if self.is_long { LONG[end] } else { SHORT[end] };
        let directions: Vec<f64> = (0..self.probes)
            .map(|probe| 360.0 * probe as f64 / self.probes as f64)
            .collect();
        let wrist = format!(r#"{{ kind = "wrist", std = {} }}"#, SHIFT_STDS[end] * times);
        let pads = format!(
            r#"{{ kind = "pads", pitch = {}, offset = "random" }}"#,
            PITCHES[end] * times
        );
        let ideal = r#"{ kind = "ideal" }"#.to_owned();
        let of_rotations = |kind: &str, fraction: f64| {
            format!(r#"angular_velocity = {{ kind = "{kind}", fraction = {fraction} }}"#)
        };
        let rotation_std = ROTATION_STDS[end] * times;
        let rotations = of_rotations("gaussian", rotation_std);
        let (sensor, noise) = match self.sensor {
            Sensor::Shifts => (wrist, String::new()),
            Sensor::Rotations => (ideal, rotations),
            Sensor::Uniform => (ideal, of_rotations("uniform", BOUND * rotation_std)),
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
    use super::*;

    #[test]
    fn names_tell_families_apart() {
        let mut names: Vec<String> = Family::all().iter().map(Family::name).collect();
        let count = names.len();
        names.sort();
        names.dedup();
        assert_eq!(names.len(), count);
    }
}
