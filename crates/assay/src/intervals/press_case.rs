//! Families of random presses, and the model that the fit assumes.

use anyhow::Result;
use palpate_chromatouch::Layout;
use palpate_press::{Body, ForwardFit, Markers, Measured, Skin};
use palpate_sensing::Channel;

use super::Draws;
use super::best_test::ContactTest;
use super::press_readings::{Flaw, Readings};

/// Radius of the sensor, and depth of its markers, mm.
pub(super) const RADIUS: f64 = 20.0;
const DEPTH: f64 = 2.0;
/// Smallest and largest relative curvature, per mm: those of a dish of 60 mm and of a ball of 5 mm.
const CURVATURES: [f64; 2] = [1.0 / RADIUS - 1.0 / 60.0, 1.0 / RADIUS + 1.0 / 5.0];
/// Smallest and largest indentation, mm, and angle of the contact from the apex, degrees.
const INDENTATIONS: [f64; 2] = [0.6, 1.4];
const POLAR_ANGLES: [f64; 2] = [0.0, 20.0];
/// Smallest and largest noise of normal and tangential displacements, mm.
const NOISES: [f64; 2] = [0.01, 0.1];
/// Largest standard deviation of a stated indentation, mm; half of the indentations are exact.
const INDENTATION_STD: f64 = 0.04;
/// Smallest and largest Cramér–Rao bound of faint presses, in curvatures of the sensor.
const FAINT_BOUNDS: [f64; 2] = [0.3, 1.0];
/// Number of presses that the best test assumes, and their largest angle from the apex, degrees. It is that of the outermost
/// markers, because a fit does not get the place of the contact.
const TEST_PRESSES: u64 = 8000;
const MARKED_ANGLE: f64 = 59.5;
/// Number of flaws that the best test assumes, and of trials that measure its power.
const TEST_FLAWS: u64 = 200;
const POWER_TRIALS: u64 = 1000;
/// Smallest and largest thickness of layers, mm.
const THICKNESSES: [f64; 2] = [4.0, 20.0];

/// Signal of a press relative to its noise.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Signal {
    /// Noise between limits.
    Clear,
    /// Noise that hardly determines the curvature.
    Faint,
    /// No contact.
    None,
}

/// Soft body of a family.
#[derive(Clone, Copy, Debug, PartialEq)]
enum BodyKind {
    HalfSpace,
    /// Layers of one thickness, or of random ones.
    Layer(Option<f64>),
}

/// Presses of one kind.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Family {
    pressed: BodyKind,
    /// Body that the fit assumes, if it is another.
    assumed: Option<BodyKind>,
    signal: Signal,
    knows_indentation: bool,
    reads_tangential: bool,
    states_noise: bool,
    flaw: Flaw,
}

impl Family {
    /// All families.
    pub(super) fn all() -> Vec<Self> {
        let plain = Self {
            pressed: BodyKind::HalfSpace,
            assumed: None,
            signal: Signal::Clear,
            knows_indentation: true,
            reads_tangential: false,
            states_noise: true,
            flaw: Flaw::None,
        };
        let any = BodyKind::Layer(None);
        let layers =
            [4.0, 5.0, 7.0, 10.0, 14.0, 20.0].map(|thickness| BodyKind::Layer(Some(thickness)));
        let bodies = [BodyKind::HalfSpace, any];
        let mut all = Vec::new();
        for pressed in [BodyKind::HalfSpace].into_iter().chain(layers) {
            for knows_indentation in [true, false] {
                all.push(Self {
                    pressed,
                    knows_indentation,
                    ..plain
                });
            }
        }
        for (reads_tangential, states_noise) in [(true, true), (false, false), (true, false)] {
            all.extend(bodies.map(|pressed| Self {
                pressed,
                reads_tangential,
                states_noise,
                ..plain
            }));
        }
        for signal in [Signal::Faint, Signal::None] {
            for pressed in bodies {
                for knows_indentation in [true, false] {
                    all.push(Self {
                        pressed,
                        signal,
                        knows_indentation,
                        ..plain
                    });
                }
            }
        }
        let thin = BodyKind::Layer(Some(5.0));
        for reads_tangential in [false, true] {
            for (pressed, assumed) in [(thin, BodyKind::HalfSpace), (BodyKind::HalfSpace, thin)] {
                all.push(Self {
                    pressed,
                    assumed: Some(assumed),
                    reads_tangential,
                    ..plain
                });
            }
            for flaw in [Flaw::Gain, Flaw::Slipped, Flaw::Edge] {
                all.push(Self {
                    flaw,
                    reads_tangential,
                    ..plain
                });
            }
        }
        all
    }

    /// Name of the family in the table.
    pub(super) fn name(&self) -> String {
        let body = |kind: BodyKind| match kind {
            BodyKind::HalfSpace => "half-space".to_owned(),
            BodyKind::Layer(Some(thickness)) => format!("layer of {thickness} mm"),
            BodyKind::Layer(None) => "layers".to_owned(),
        };
        let mut words = vec![body(self.pressed)];
        words.extend(self.assumed.map(|kind| format!("taken for {}", body(kind))));
        words.extend(match self.signal {
            Signal::Clear => None,
            Signal::Faint => Some("faint".to_owned()),
            Signal::None => Some("nothing touches".to_owned()),
        });
        words.extend(self.flaw.name().map(str::to_owned));
        let either = |is: bool, yes: &str, no: &str| if is { yes } else { no }.to_owned();
        words.push(either(
            self.knows_indentation,
            "indentation known",
            "indentation fitted",
        ));
        words.push(either(
            self.reads_tangential,
            "all displacements",
            "normal displacements",
        ));
        words.push(either(self.states_noise, "noise told", "noise found"));
        words.join(", ")
    }

    /// Whether an object touches the sensor.
    pub(super) fn touches(&self) -> bool {
        self.signal != Signal::None
    }

    /// Whether the curvature is hardly determined.
    pub(super) fn is_faint(&self) -> bool {
        self.signal == Signal::Faint
    }

    /// Whether the presses are clear and the fit assumes the right model.
    pub(super) fn is_sound(&self) -> bool {
        self.signal == Signal::Clear && !self.is_wrong()
    }

    /// Whether readings with the flaw look like those of another press.
    pub(super) fn is_undetectable(&self) -> bool {
        self.flaw == Flaw::Gain
    }

    /// Whether the readings contradict the model of the fit.
    pub(super) fn is_wrong(&self) -> bool {
        self.assumed.is_some() || self.flaw != Flaw::None
    }
}

/// Names of the families whose readings agree with the assumed model.
pub(super) fn sound_families() -> Vec<String> {
    let sound = Family::all().into_iter().filter(Family::is_sound);
    sound.map(|family| family.name()).collect()
}

/// A random press, drawn alike in all families.
struct Press {
    /// Relative curvature, per mm.
    curvature: f64,
    indentation: f64,
    at: [f64; 2],
}

impl Press {
    fn random(draws: &mut Draws) -> Self {
        let curvature = draws.log_between(CURVATURES);
        let indentation = draws.between(INDENTATIONS);
        let polar = draws.between(POLAR_ANGLES).to_radians();
        Self {
            curvature,
            indentation,
            at: place_at(polar, draws),
        }
    }
}

/// Place at this angle from the apex, radians, in a random direction.
fn place_at(polar: f64, draws: &mut Draws) -> [f64; 2] {
    draws.direction().map(|along| RADIUS * polar * along)
}

/// A press of a family.
pub(super) struct Case {
    pub(super) markers: Markers,
    pub(super) readings: Readings,
    /// Readings of this press with other flaws of the same kind; empty without a flaw.
    flawed: Vec<Readings>,
    pub(super) best_test: ContactTest,
    pub(super) fit: ForwardFit,
    /// Relative curvature, per mm.
    pub(super) relative_curvature: f64,
    /// Stated indentation, mm.
    pub(super) indentation: Option<Measured>,
    pub(super) std: f64,
    pub(super) seed: u64,
}

impl Case {
    /// The case with this number.
    ///
    /// # Errors
    /// If its sensor or its contact is invalid.
    pub(super) fn random(family: Family, seed: u64, number: u64) -> Result<Self> {
        let mut draws = Draws::new(seed, number, Channel::PadOffset);
        let Press {
            curvature,
            indentation,
            at,
        } = Press::random(&mut draws);
        let noise = draws.log_between(NOISES);
        let faint = draws.log_between(FAINT_BOUNDS);
        let thickness = draws.log_between(THICKNESSES);
        let body = |kind: BodyKind| match kind {
            BodyKind::HalfSpace => Body::half_space(0.5, DEPTH),
            BodyKind::Layer(fixed) => Body::bonded_layer(fixed.unwrap_or(thickness), DEPTH),
        };
        let skin = Skin::new(RADIUS)?;
        let places = Layout::published().places(RADIUS)?;
        let markers = Markers::new(skin, &places)?;
        let pressed = body(family.pressed)?;
        let contact = skin.contact(&pressed, curvature - 1.0 / RADIUS, indentation)?;
        let mut fit = ForwardFit::new(body(family.assumed.unwrap_or(family.pressed))?);
        let mut known = Draws::new(seed, number, Channel::Indentation);
        let known = known.between([-INDENTATION_STD, INDENTATION_STD]).max(0.0);
        let known = family.knows_indentation.then_some(known);
        let std = match family.signal {
            Signal::Clear => noise,
            Signal::Faint | Signal::None => {
                let bound = |std: f64| {
                    let fit = ForwardFit {
                        normal_std: Some(std),
                        tangential_std: Some(std),
                        ..fit.clone()
                    };
                    fit.bounds(&markers, &contact, at, family.reads_tangential, known)
                        .map_or(f64::INFINITY, |bounds| bounds.relative_curvature)
                };
                noise_at(bound, faint / RADIUS)
            }
        };
        if family.states_noise {
            (fit.normal_std, fit.tangential_std) = (Some(std), Some(std));
        }
        let readings = match family.signal {
            Signal::None => Readings::without_contact(&markers),
            _ => Readings::new(&markers, &contact, at, family.flaw, &mut draws),
        };
        let flawed = (0..if family.is_wrong() { TEST_FLAWS } else { 0 }).map(|other| {
            let mut draws = Draws::new(seed.wrapping_add(number), other, Channel::Normal);
            Readings::new(&markers, &contact, at, family.flaw, &mut draws)
                .keep_tangential(family.reads_tangential)
        });
        let flawed = flawed.collect();
        let others = (0..TEST_PRESSES).map(|other| {
            let mut draws = Draws::new(seed.wrapping_add(number), other, Channel::Position);
            let press = Press::random(&mut draws);
            let indentation = known.map_or(press.indentation, |_| indentation);
            let contact = skin.contact(&pressed, press.curvature - 1.0 / RADIUS, indentation)?;
            let height = draws.between([libm::cos(MARKED_ANGLE.to_radians()), 1.0]);
            let anywhere = place_at(libm::acos(height), &mut draws);
            let read = Readings::new(&markers, &contact, anywhere, Flaw::None, &mut draws);
            Ok(read.keep_tangential(family.reads_tangential))
        });
        let no_contact =
            Readings::without_contact(&markers).keep_tangential(family.reads_tangential);
        let best_test =
            ContactTest::new(&others.collect::<Result<Vec<_>>>()?, &no_contact, std, seed);
        Ok(Self {
            best_test,
            flawed,
            readings: readings.keep_tangential(family.reads_tangential),
            markers,
            fit,
            relative_curvature: curvature,
            indentation: known.map(|std| Measured {
                value: indentation,
                std,
            }),
            std,
            seed: seed.wrapping_mul(1000).wrapping_add(number),
        })
    }
}

impl Case {
    /// Share of trials in which the best test with 5 % false alarms distinguishes the readings from those of every press of
    /// the assumed model. The test has the press and the kind of flaw, but not its size. The share is 1 if no press of the
    /// model fits, and NaN without a flaw.
    pub(super) fn detectable(&self) -> f64 {
        if self.flawed.is_empty() {
            return f64::NAN;
        }
        let Some(residuals) = self.residuals(&self.readings) else {
            return 1.0;
        };
        let flawed: Vec<Readings> = self
            .flawed
            .iter()
            .filter_map(|flawed| self.residuals(flawed))
            .collect();
        let test = ContactTest::new(&flawed, &residuals.zeros(), self.std, self.seed);
        let detected = (0..POWER_TRIALS).filter(|&trial| {
            let seed = self.seed.wrapping_add(1);
            test.detects(&residuals.noisy(self.std, seed, trial))
        });
        detected.count() as f64 / POWER_TRIALS as f64
    }

    /// Residuals of the readings from the best fit, and the one of a stated indentation; `None` if the fit fails or rejects
    /// markers.
    fn residuals(&self, readings: &Readings) -> Option<Readings> {
        let fit = ForwardFit {
            normal_std: Some(self.std),
            tangential_std: Some(self.std),
            ..self.fit.clone()
        };
        let reading = readings.reading(&self.markers, self.indentation);
        let nearest = fit.estimate(&reading).ok()?;
        if !nearest.wrong_markers.is_empty() {
            return None;
        }
        let skin = self.markers.skin();
        let curvature = nearest.most_likely_curvature - 1.0 / RADIUS;
        let indentation = nearest.indentation.value;
        let contact = skin.contact(&fit.body, curvature, indentation).ok()?;
        let press = self.markers.displacements(&contact, nearest.contact);
        let error = self.indentation.map_or(0.0, |known| match known.std > 0.0 {
            true => (indentation - known.value) / known.std * self.std,
            false => 0.0,
        });
        Some(readings.residuals(&press, error))
    }
}

/// The noise at which an increasing bound has this value.
fn noise_at(bound: impl Fn(f64) -> f64, value: f64) -> f64 {
    let [mut low, mut high] = [1e-4, 1e2];
    for _ in 0..60 {
        let middle = f64::sqrt(low * high);
        if bound(middle) < value {
            low = middle;
        } else {
            high = middle;
        }
    }
    low
}

#[cfg(test)]
impl Family {
    /// Config of a press with the smallest (0) or the largest (1) values of the family, divided or multiplied by `factor`.
    pub(super) fn config(&self, end: usize, factor: f64) -> String {
        let factor = if end == 0 { factor.recip() } else { factor };
        let relative = CURVATURES[end] * RADIUS * factor;
        let curvature = (relative - 1.0) / RADIUS;
        let kind = if curvature < 0.0 { "dish" } else { "sphere" };
        let radius = curvature.abs().recip();
        let indentation = INDENTATIONS[end] * factor;
        let polar = POLAR_ANGLES[end] * factor;
        let noise = NOISES[end] * factor;
        let std = [0.0, INDENTATION_STD][end] * factor;
        let (model, thickness) = match self.pressed {
            BodyKind::HalfSpace => ("half-space", String::new()),
            BodyKind::Layer(fixed) => {
                let thickness = fixed.unwrap_or(THICKNESSES[end]);
                ("bonded-layer", format!(", thickness = {thickness}"))
            }
        };
        let known = if self.knows_indentation {
            "known"
        } else {
            "fitted"
        };
        let noise_source = if self.states_noise { "stated" } else { "found" };
        let tangential = self.reads_tangential;
        format!(
            r#"
            name = "a-press"
            length_unit = "mm"
            [scene]
            kind = "press"
            probe = {{ kind = "marker-sphere", radius = {RADIUS}, marker_depth = {DEPTH} }}
            object = {{ kind = "{kind}", radius = {radius} }}
            motion = {{ indentation = {indentation}, contact_deg = [{polar}, 30.0] }}
            model = {{ kind = "{model}"{thickness} }}
            sensor = {{ kind = "direct", tangential = {tangential} }}
            estimator = {{ kind = "{model}", indentation = "{known}", indentation_std = {std}, noise = "{noise_source}" }}
            [scene.noise]
            normal_displacement = {{ kind = "gaussian", std = {noise} }}
            tangential_displacement = {{ kind = "gaussian", std = {noise} }}
            indentation = {{ kind = "gaussian", std = {std} }}
            "#
        )
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;

    #[test]
    fn noise_is_found_from_the_bound() {
        assert!((noise_at(|std| 3.0 * std, 0.6) - 0.2).abs() < 1e-9);
    }

    #[test]
    fn an_edge_is_detectable() {
        let detectable = |word: &str| {
            let named = |family: &Family| family.name().contains(word);
            let family = Family::all().into_iter().find(named).unwrap();
            Case::random(family, 1, 0).unwrap().detectable()
        };
        let edge = detectable("an edge");
        assert!((0.9..=1.0).contains(&edge), "{edge}");
    }

    #[test]
    fn families_have_different_names() {
        let names: BTreeSet<String> = Family::all().iter().map(Family::name).collect();
        assert_eq!(names.len(), Family::all().len());
    }
}
