//! Readings of a press, and their flaws.

use palpate_press::{Contact, MarkerDisplacement, Markers, Measured, Reading};
use palpate_sensing::{Channel, Stream};

use super::Draws;

/// Smallest and largest factor of a wrong gain.
const GAINS: [f64; 2] = [1.1, 1.3];
/// Smallest and largest displacement of a marker that slipped, mm.
const SLIPS: [f64; 2] = [0.3, 1.0];
/// Half length of an edge, mm, and the number of contacts that represent it.
const EDGE: f64 = 6.0;
const EDGE_CONTACTS: usize = 13;

/// Flaw of the readings.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Flaw {
    None,
    /// All normal displacements are too large or too small.
    Gain,
    /// One marker slipped.
    Slipped,
    /// The object is an edge instead of a ball.
    Edge,
}

impl Flaw {
    pub(super) const fn name(self) -> Option<&'static str> {
        match self {
            Self::None => None,
            Self::Gain => Some("wrong gain"),
            Self::Slipped => Some("a slipped marker"),
            Self::Edge => Some("an edge"),
        }
    }
}

/// Readings of the markers, mm.
pub(super) struct Readings {
    normal: Vec<f64>,
    tangential: Option<Vec<[f64; 2]>>,
    /// The marker that slipped.
    pub(super) slipped: Option<usize>,
}

impl Readings {
    /// Readings without a contact.
    pub(super) fn without_contact(markers: &Markers) -> Self {
        let count = markers.places().len();
        Self {
            normal: vec![0.0; count],
            tangential: Some(vec![[0.0; 2]; count]),
            slipped: None,
        }
    }

    /// Readings of a contact at a place, without noise.
    pub(super) fn new(
        markers: &Markers,
        contact: &Contact<'_>,
        at: [f64; 2],
        flaw: Flaw,
        draws: &mut Draws,
    ) -> Self {
        let moved = match flaw {
            Flaw::Edge => edge(markers, contact, at, draws),
            _ => markers
                .displacements(contact, at)
                .iter()
                .map(|moved| (moved.normal, moved.tangential))
                .collect(),
        };
        let (mut normal, tangential): (Vec<f64>, Vec<[f64; 2]>) = moved.into_iter().unzip();
        let is_more = draws.between([-1.0, 1.0]) > 0.0;
        let mut slipped = None;
        match flaw {
            Flaw::None | Flaw::Edge => {}
            Flaw::Gain => {
                let gain = draws.between(GAINS);
                let gain = if is_more { gain } else { gain.recip() };
                normal.iter_mut().for_each(|normal| *normal *= gain);
            }
            Flaw::Slipped => {
                // One of the ten markers nearest to the contact, because a distant one hardly matters.
                let mut order: Vec<usize> = (0..normal.len()).collect();
                let distances = markers.distances(at);
                order.sort_by(|&one, &other| distances[one].total_cmp(&distances[other]));
                let marker = order[draws.between([0.0, 10.0]) as usize];
                let slip = draws.between(SLIPS);
                normal[marker] += if is_more { slip } else { -slip };
                slipped = Some(marker);
            }
        }
        Self {
            normal,
            tangential: Some(tangential),
            slipped,
        }
    }

    /// Keeps or drops the tangential displacements.
    pub(super) fn keep_tangential(self, keep: bool) -> Self {
        Self {
            tangential: self.tangential.filter(|_| keep),
            ..self
        }
    }

    /// Residuals from the displacements of a press, and `more` as an additional normal one.
    pub(super) fn residuals(&self, press: &[MarkerDisplacement], more: f64) -> Self {
        let normal = self.normal.iter().zip(press);
        let along = |all: &Vec<[f64; 2]>| {
            let pairs = all.iter().zip(press);
            pairs
                .map(|([x, y], press)| [x - press.tangential[0], y - press.tangential[1]])
                .collect()
        };
        Self {
            normal: normal
                .map(|(normal, press)| normal - press.normal)
                .chain([more])
                .collect(),
            tangential: self.tangential.as_ref().map(along),
            slipped: None,
        }
    }

    /// As many readings as these, all 0.
    pub(super) fn zeros(&self) -> Self {
        let none = |all: &Vec<[f64; 2]>| vec![[0.0; 2]; all.len()];
        Self {
            normal: vec![0.0; self.normal.len()],
            tangential: self.tangential.as_ref().map(none),
            slipped: None,
        }
    }

    /// All displacements, mm.
    pub(super) fn all(&self) -> impl Iterator<Item = f64> {
        let along = self.tangential.iter().flatten().flatten();
        self.normal.iter().chain(along).copied()
    }

    /// These readings with the noise of a trial.
    pub(super) fn noisy(&self, std: f64, seed: u64, trial: u64) -> Self {
        let mut across = Stream::new(seed, trial, Channel::Position);
        let mut along = Stream::new(seed, trial, Channel::Normal);
        let error = |stream: &mut Stream| std * stream.standard_normal();
        Self {
            normal: self
                .normal
                .iter()
                .map(|normal| normal + error(&mut across))
                .collect(),
            tangential: self.tangential.as_ref().map(|all| {
                all.iter()
                    .map(|both| both.map(|one| one + error(&mut along)))
                    .collect()
            }),
            slipped: self.slipped,
        }
    }

    /// The reading for a fit.
    pub(super) fn reading<'a>(
        &'a self,
        markers: &'a Markers,
        indentation: Option<Measured>,
    ) -> Reading<'a> {
        Reading {
            markers,
            normal: &self.normal,
            tangential: self.tangential.as_deref(),
            indentation,
        }
    }
}

/// Displacements by an edge: a row of contacts, scaled to the depth of one contact.
fn edge(
    markers: &Markers,
    contact: &Contact<'_>,
    [x, y]: [f64; 2],
    draws: &mut Draws,
) -> Vec<(f64, [f64; 2])> {
    let [cosine, sine] = draws.direction();
    let count = markers.places().len();
    let mut sum = vec![(0.0, [0.0; 2]); count];
    for number in 0..EDGE_CONTACTS {
        let share = 2.0 * number as f64 / (EDGE_CONTACTS - 1) as f64 - 1.0;
        let at = [x + EDGE * share * cosine, y + EDGE * share * sine];
        for (sum, moved) in sum.iter_mut().zip(markers.displacements(contact, at)) {
            sum.0 += moved.normal;
            sum.1[0] += moved.tangential[0];
            sum.1[1] += moved.tangential[1];
        }
    }
    // Scaled so that the middle of the edge is as deep as one contact.
    let mut deepest = 0.0;
    for number in 0..EDGE_CONTACTS {
        let share = 2.0 * number as f64 / (EDGE_CONTACTS - 1) as f64 - 1.0;
        deepest += contact.displacement((EDGE * share).abs()).normal;
    }
    let scale = contact.displacement(0.0).normal / deepest;
    sum.into_iter()
        .map(|(normal, tangential)| (scale * normal, tangential.map(|one| scale * one)))
        .collect()
}

#[cfg(test)]
mod tests {
    use palpate_press::{Body, Skin};

    use super::*;

    fn markers() -> Markers {
        let places: Vec<_> = (0..21 * 21)
            .map(|number| [number % 21, number / 21].map(|step| f64::from(step) - 10.0))
            .collect();
        Markers::new(Skin::new(20.0).unwrap(), &places).unwrap()
    }

    fn readings(markers: &Markers, flaw: Flaw, number: u64) -> Readings {
        let body = Body::half_space(0.5, 2.0).unwrap();
        let contact = markers.skin().contact(&body, 1.0 / 40.0, 1.0).unwrap();
        let mut draws = Draws::new(3, number, Channel::PadOffset);
        Readings::new(markers, &contact, [0.0; 2], flaw, &mut draws)
    }

    #[test]
    fn gains_scale_all_readings_and_slips_shift_one() {
        let markers = markers();
        for number in 0..20 {
            let [plain, gained, slipped] = [Flaw::None, Flaw::Gain, Flaw::Slipped]
                .map(|flaw| readings(&markers, flaw, number).normal);
            let gain = gained[0] / plain[0];
            assert!((1.0 / 1.3..=1.0 / 1.1).contains(&gain) || (1.1..=1.3).contains(&gain));
            for (gained, plain) in gained.iter().zip(&plain) {
                assert!((gained - gain * plain).abs() <= 1e-12 * plain.abs());
            }
            let moved = slipped.iter().zip(&plain);
            let moved: Vec<f64> = moved.map(|(one, other)| (one - other).abs()).collect();
            assert_eq!(moved.iter().filter(|slip| **slip > 1e-12).count(), 1);
            let slip = moved.iter().fold(0.0, |most: f64, one| most.max(*one));
            assert!((0.3..=1.0).contains(&slip), "{slip}");
        }
    }

    #[test]
    fn an_edge_is_longer_than_wide() {
        let markers = markers();
        let [ball, edge] = [Flaw::None, Flaw::Edge].map(|flaw| readings(&markers, flaw, 1).normal);
        let second_moments = |normal: &[f64]| {
            let mut sums = [0.0; 3];
            for (place, weight) in markers.places().iter().zip(normal) {
                let (x, y) = (place.direction.x, place.direction.y);
                for (sum, product) in sums.iter_mut().zip([x * x, x * y, y * y]) {
                    *sum += weight * product;
                }
            }
            let [xx, xy, yy] = sums;
            let spread = libm::hypot(0.5 * (xx - yy), xy);
            (0.5 * (xx + yy) + spread) / (0.5 * (xx + yy) - spread)
        };
        assert!((second_moments(&ball) - 1.0).abs() < 0.02);
        assert!(second_moments(&edge) > 1.1, "{}", second_moments(&edge));
    }
}
