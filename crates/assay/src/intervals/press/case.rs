//! Presses, and what the fit believes of them.

use anyhow::Result;
use palpate_chromatouch::Layout;
use palpate_press::{Body, ForwardFit, Markers, Measured, Skin};
use palpate_sensing::Channel;

use super::super::draws::Draws;
use super::best_test::BestTest;
use super::readings::{Flaw, Readings};

/// Radius of the sensor, and depth of its markers, mm.
pub(super) const RADIUS: f64 = 20.0;
const DEPTH: f64 = 2.0;
/// Smallest and largest relative curvature: of a dish of 60 mm and of a ball of 5 mm, per mm.
const CURVATURES: [f64; 2] = [1.0 / RADIUS - 1.0 / 60.0, 1.0 / RADIUS + 1.0 / 5.0];
/// Smallest and largest indentation, mm, and angle of the contact from the apex, degrees.
const INDENTATIONS: [f64; 2] = [0.6, 1.4];
const POLAR_ANGLES: [f64; 2] = [0.0, 20.0];
/// Smallest and largest noise of normal displacements, mm; along the skin it is as large.
const NOISES: [f64; 2] = [0.01, 0.1];
/// Largest standard deviation of an indentation that is known, mm; half of them are known exactly.
const INDENTATION_STD: f64 = 0.04;
/// Cramér–Rao standard deviations of faint presses, in curvatures of the sensor.
const FAINT: [f64; 2] = [0.3, 1.0];
/// Largest share of false alarms.
pub(super) const ALARMS: f64 = 0.05;
/// Number of presses in whose mean a test is the best, and the largest angle of theirs from the apex, degrees: that of the
/// outermost markers, as a fit is not told where the contact is.
const OTHERS: u64 = 8000;
const MARKED: f64 = 59.5;
/// Number of flaws in whose mean a test is the best, and of trials that tell how often it tells them.
const FLAWS: u64 = 200;
const TOLD: u64 = 1000;
/// Smallest and largest thickness of layers, mm.
pub(super) const THICKNESSES: [f64; 2] = [4.0, 20.0];

/// How well a press is seen.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Seen {
    /// With noise between limits.
    Well,
    /// With the noise at which the curvature is hardly determined.
    Barely,
    /// Nothing touches.
    Nothing,
}

/// A body as a family draws it.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Kind {
    HalfSpace,
    /// Layers of one thickness, or of any.
    Layer(Option<f64>),
}

/// Presses of one kind.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Family {
    pressed: Kind,
    /// Kind that the fit believes in, where it is another.
    believed: Option<Kind>,
    seen: Seen,
    knows_indentation: bool,
    reads_along: bool,
    is_noise_told: bool,
    flaw: Flaw,
}

impl Family {
    /// All families.
    pub(super) fn all() -> Vec<Self> {
        let plain = Self {
            pressed: Kind::HalfSpace,
            believed: None,
            seen: Seen::Well,
            knows_indentation: true,
            reads_along: false,
            is_noise_told: true,
            flaw: Flaw::None,
        };
        let any = Kind::Layer(None);
        let layers =
            [4.0, 5.0, 7.0, 10.0, 14.0, 20.0].map(|thickness| Kind::Layer(Some(thickness)));
        let bodies = [Kind::HalfSpace, any];
        let mut all = Vec::new();
        for pressed in [Kind::HalfSpace].into_iter().chain(layers) {
            for knows_indentation in [true, false] {
                all.push(Self {
                    pressed,
                    knows_indentation,
                    ..plain
                });
            }
        }
        for (reads_along, is_noise_told) in [(true, true), (false, false), (true, false)] {
            all.extend(bodies.map(|pressed| Self {
                pressed,
                reads_along,
                is_noise_told,
                ..plain
            }));
        }
        for seen in [Seen::Barely, Seen::Nothing] {
            for pressed in bodies {
                for knows_indentation in [true, false] {
                    all.push(Self {
                        pressed,
                        seen,
                        knows_indentation,
                        ..plain
                    });
                }
            }
        }
        let thin = Kind::Layer(Some(5.0));
        for reads_along in [false, true] {
            for (pressed, believed) in [(thin, Kind::HalfSpace), (Kind::HalfSpace, thin)] {
                all.push(Self {
                    pressed,
                    believed: Some(believed),
                    reads_along,
                    ..plain
                });
            }
            for flaw in [Flaw::Gain, Flaw::Slipped, Flaw::Edge] {
                all.push(Self {
                    flaw,
                    reads_along,
                    ..plain
                });
            }
        }
        all
    }

    /// The family in words.
    pub(super) fn name(&self) -> String {
        let body = |kind: Kind| match kind {
            Kind::HalfSpace => "half-space".to_owned(),
            Kind::Layer(Some(thickness)) => format!("layer of {thickness} mm"),
            Kind::Layer(None) => "layers".to_owned(),
        };
        let mut words = vec![body(self.pressed)];
        words.extend(
            self.believed
                .map(|kind| format!("taken for {}", body(kind))),
        );
        words.extend(match self.seen {
            Seen::Well => None,
            Seen::Barely => Some("faint".to_owned()),
            Seen::Nothing => Some("nothing touches".to_owned()),
        });
        words.extend(self.flaw.name().map(str::to_owned));
        let either = |is: bool, yes: &str, no: &str| if is { yes } else { no }.to_owned();
        words.push(either(
            self.knows_indentation,
            "indentation known",
            "indentation fitted",
        ));
        words.push(either(
            self.reads_along,
            "all displacements",
            "normal displacements",
        ));
        words.push(either(self.is_noise_told, "noise told", "noise found"));
        words.join(", ")
    }

    /// Whether a contact is to be seen.
    pub(super) fn touches(&self) -> bool {
        self.seen != Seen::Nothing
    }

    /// Whether a contact is to be seen well.
    pub(super) fn is_well_seen(&self) -> bool {
        self.seen == Seen::Well
    }

    /// Whether noise all but hides the press.
    pub(super) fn is_faint(&self) -> bool {
        self.seen == Seen::Barely
    }

    /// Whether no reading tells what is wrong from another press.
    pub(super) fn cannot_be_told(&self) -> bool {
        self.flaw == Flaw::Gain
    }

    /// Whether the readings are not what the fit believes.
    pub(super) fn is_wrong(&self) -> bool {
        self.believed.is_some() || self.flaw != Flaw::None
    }
}

/// A press as all families draw it.
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
            at: towards(polar, draws),
        }
    }
}

/// Place at this angle from the apex, radians, in any direction.
fn towards(polar: f64, draws: &mut Draws) -> [f64; 2] {
    let (sine, cosine) = libm::sincos(draws.between([0.0, std::f64::consts::TAU]));
    [cosine, sine].map(|along| RADIUS * polar * along)
}

/// A press of a family.
pub(super) struct Case {
    pub(super) markers: Markers,
    pub(super) readings: Readings,
    /// Readings of this press with other flaws of the same kind; none where nothing is wrong.
    flawed: Vec<Readings>,
    pub(super) best_test: BestTest,
    pub(super) fit: ForwardFit,
    /// Relative curvature, per mm.
    pub(super) relative_curvature: f64,
    /// Indentation with its error, where it is known, mm.
    pub(super) indentation: Option<Measured>,
    pub(super) std: f64,
    pub(super) seed: u64,
}

impl Case {
    /// The case of this number.
    ///
    /// # Errors
    /// None that a family makes.
    pub(super) fn random(family: Family, seed: u64, number: u64) -> Result<Self> {
        let mut draws = Draws::new(seed, number, Channel::PadOffset);
        let Press {
            curvature,
            indentation,
            at,
        } = Press::random(&mut draws);
        let noise = draws.log_between(NOISES);
        let faint = draws.log_between(FAINT);
        let thickness = draws.log_between(THICKNESSES);
        let body = |kind: Kind| match kind {
            Kind::HalfSpace => Body::half_space(0.5, DEPTH),
            Kind::Layer(fixed) => Body::bonded_layer(fixed.unwrap_or(thickness), DEPTH),
        };
        let skin = Skin::new(RADIUS)?;
        let places = Layout::published().places(RADIUS)?;
        let markers = Markers::new(skin, &places)?;
        let pressed = body(family.pressed)?;
        let contact = skin.contact(&pressed, curvature - 1.0 / RADIUS, indentation)?;
        let mut fit = ForwardFit::new(body(family.believed.unwrap_or(family.pressed))?);
        let mut known = Draws::new(seed, number, Channel::Indentation);
        let known = known.between([-INDENTATION_STD, INDENTATION_STD]).max(0.0);
        let known = family.knows_indentation.then_some(known);
        let std = match family.seen {
            Seen::Well => noise,
            Seen::Barely | Seen::Nothing => {
                let bound = |std: f64| {
                    let fit = ForwardFit {
                        normal_std: Some(std),
                        tangential_std: Some(std),
                        ..fit.clone()
                    };
                    fit.bounds(&markers, &contact, at, family.reads_along, known)
                        .map_or(f64::INFINITY, |bounds| bounds.relative_curvature)
                };
                noise_of(bound, faint / RADIUS)
            }
        };
        if family.is_noise_told {
            (fit.normal_std, fit.tangential_std) = (Some(std), Some(std));
        }
        let readings = match family.seen {
            Seen::Nothing => Readings::of_nothing(&markers),
            _ => Readings::of(&markers, &contact, at, family.flaw, &mut draws),
        };
        let flawed = (0..if family.is_wrong() { FLAWS } else { 0 }).map(|other| {
            let mut draws = Draws::new(seed.wrapping_add(number), other, Channel::Normal);
            Readings::of(&markers, &contact, at, family.flaw, &mut draws)
                .reading_along(family.reads_along)
        });
        let flawed = flawed.collect();
        let others = (0..OTHERS).map(|other| {
            let mut draws = Draws::new(seed.wrapping_add(number), other, Channel::Position);
            let press = Press::random(&mut draws);
            let indentation = known.map_or(press.indentation, |_| indentation);
            let contact = skin.contact(&pressed, press.curvature - 1.0 / RADIUS, indentation)?;
            let height = draws.between([libm::cos(MARKED.to_radians()), 1.0]);
            let anywhere = towards(libm::acos(height), &mut draws);
            let read = Readings::of(&markers, &contact, anywhere, Flaw::None, &mut draws);
            Ok(read.reading_along(family.reads_along))
        });
        let nothing = Readings::of_nothing(&markers).reading_along(family.reads_along);
        let best_test = BestTest::new(
            &others.collect::<Result<Vec<_>>>()?,
            &nothing,
            std,
            ALARMS,
            seed,
        );
        Ok(Self {
            best_test,
            flawed,
            readings: readings.reading_along(family.reads_along),
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
    /// Share of trials in which the best test with 5 % of false alarms tells the readings from those of any press that the fit
    /// believes in; it knows the press and what kind of flaw they have, but not which one. 1 where no such press is near, and
    /// NaN where nothing is wrong.
    pub(super) fn tellable(&self) -> f64 {
        if self.flawed.is_empty() {
            return f64::NAN;
        }
        let Some(beyond) = self.beyond_nearest(&self.readings) else {
            return 1.0;
        };
        let flawed: Vec<Readings> = self
            .flawed
            .iter()
            .filter_map(|flawed| self.beyond_nearest(flawed))
            .collect();
        let none = beyond.of_nothing_alike();
        let test = BestTest::new(&flawed, &none, self.std, ALARMS, self.seed);
        let told = (0..TOLD).filter(|&trial| {
            let seed = self.seed.wrapping_add(1);
            test.sees(&beyond.noisy(self.std, seed, trial))
        });
        told.count() as f64 / TOLD as f64
    }

    /// Readings beyond those of the press that is nearest to them, with the error of a known indentation as one more; `None`
    /// where no press is near.
    fn beyond_nearest(&self, readings: &Readings) -> Option<Readings> {
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
        Some(readings.beyond(&press, error))
    }
}

/// The noise at which a bound that grows with it has a value.
fn noise_of(bound: impl Fn(f64) -> f64, value: f64) -> f64 {
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
    /// Press with the smallest values (0) or the largest (1) that the family draws, as a config; they are so many times as large.
    pub(super) fn text(&self, end: usize, times: f64) -> String {
        let times = if end == 0 { times.recip() } else { times };
        let relative = CURVATURES[end] * RADIUS * times;
        let curvature = (relative - 1.0) / RADIUS;
        let kind = if curvature < 0.0 { "dish" } else { "sphere" };
        let radius = curvature.abs().recip();
        let indentation = INDENTATIONS[end] * times;
        let polar = POLAR_ANGLES[end] * times;
        let noise = NOISES[end] * times;
        let std = [0.0, INDENTATION_STD][end] * times;
        let (model, thickness) = match self.pressed {
            Kind::HalfSpace => ("half-space", String::new()),
            Kind::Layer(fixed) => {
                let thickness = fixed.unwrap_or(THICKNESSES[end]);
                ("bonded-layer", format!(", thickness = {thickness}"))
            }
        };
        let known = if self.knows_indentation {
            "known"
        } else {
            "fitted"
        };
        let told = if self.is_noise_told {
            "stated"
        } else {
            "found"
        };
        let tangential = self.reads_along;
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
            estimator = {{ kind = "{model}", indentation = "{known}", indentation_std = {std}, noise = "{told}" }}
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
    use super::*;

    #[test]
    fn noise_is_where_the_bound_is() {
        assert!((noise_of(|std| 3.0 * std, 0.6) - 0.2).abs() < 1e-9);
    }

    #[test]
    fn readings_are_told_from_those_of_presses_where_they_are_wrong() {
        let tellable = |word: &str| {
            let named = |family: &Family| family.name().contains(word);
            let family = Family::all().into_iter().find(named).unwrap();
            Case::random(family, 1, 0).unwrap().tellable()
        };
        let edge = tellable("an edge");
        assert!((0.9..=1.0).contains(&edge), "{edge}");
    }

    #[test]
    fn names_tell_families_apart() {
        let mut names: Vec<String> = Family::all().iter().map(Family::name).collect();
        let count = names.len();
        names.sort();
        names.dedup();
        assert_eq!(names.len(), count);
    }
}
