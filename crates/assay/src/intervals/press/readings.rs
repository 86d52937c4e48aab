//! What is read of a press, with what may be wrong with it.

use palpate_press::{Contact, Markers, Measured, Reading};
use palpate_sensing::{Channel, Stream};

use super::super::draws::Draws;

/// Smallest and largest factor of a wrong gain.
const GAINS: [f64; 2] = [1.1, 1.3];
/// Smallest and largest displacement of a marker that slipped, mm.
const SLIPS: [f64; 2] = [0.3, 1.0];
/// Half the length of an edge, mm, and number of contacts that it is made of.
const EDGE: f64 = 6.0;
const ALONG_EDGE: usize = 13;

/// What is wrong with the readings.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Flaw {
    None,
    /// All normal displacements are read too large or too small.
    Gain,
    /// One marker slipped.
    Slipped,
    /// Not a ball presses but an edge.
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

/// Readings of the markers, without noise, mm.
pub(super) struct Readings {
    normal: Vec<f64>,
    tangential: Option<Vec<[f64; 2]>>,
}

impl Readings {
    /// Readings where nothing touches.
    pub(super) fn of_nothing(markers: &Markers) -> Self {
        let count = markers.places().len();
        Self {
            normal: vec![0.0; count],
            tangential: Some(vec![[0.0; 2]; count]),
        }
    }

    pub(super) fn of(
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
        match flaw {
            Flaw::None | Flaw::Edge => {}
            Flaw::Gain => {
                let gain = draws.between(GAINS);
                let gain = if is_more { gain } else { gain.recip() };
                normal.iter_mut().for_each(|normal| *normal *= gain);
            }
            Flaw::Slipped => {
                // One that counts: among the ten nearest to the contact.
                let mut order: Vec<usize> = (0..normal.len()).collect();
                let distances = markers.distances(at);
                order.sort_by(|&one, &other| distances[one].total_cmp(&distances[other]));
                let marker = order[draws.between([0.0, 10.0]) as usize];
                let slip = draws.between(SLIPS);
                normal[marker] += if is_more { slip } else { -slip };
            }
        }
        Self {
            normal,
            tangential: Some(tangential),
        }
    }

    /// Readings with or without the displacements along the skin.
    pub(super) fn reading_along(self, does: bool) -> Self {
        Self {
            tangential: self.tangential.filter(|_| does),
            ..self
        }
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

/// Displacements by contacts in a row, as deep together as one of them.
fn edge(
    markers: &Markers,
    contact: &Contact<'_>,
    [x, y]: [f64; 2],
    draws: &mut Draws,
) -> Vec<(f64, [f64; 2])> {
    let (sine, cosine) = libm::sincos(draws.between([0.0, std::f64::consts::TAU]));
    let count = markers.places().len();
    let mut sum = vec![(0.0, [0.0; 2]); count];
    for number in 0..ALONG_EDGE {
        let share = 2.0 * number as f64 / (ALONG_EDGE - 1) as f64 - 1.0;
        let at = [x + EDGE * share * cosine, y + EDGE * share * sine];
        for (sum, moved) in sum.iter_mut().zip(markers.displacements(contact, at)) {
            sum.0 += moved.normal;
            sum.1[0] += moved.tangential[0];
            sum.1[1] += moved.tangential[1];
        }
    }
    // As deep in the middle as one contact alone.
    let mut deepest = 0.0;
    for number in 0..ALONG_EDGE {
        let share = 2.0 * number as f64 / (ALONG_EDGE - 1) as f64 - 1.0;
        deepest += contact.displacement((EDGE * share).abs()).normal;
    }
    let scale = contact.displacement(0.0).normal / deepest;
    sum.into_iter()
        .map(|(normal, tangential)| (scale * normal, tangential.map(|one| scale * one)))
        .collect()
}
