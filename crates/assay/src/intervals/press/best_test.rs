//! Best test for whether anything touches, to which place, curvature and indentation of a press are unknown, and for whether
//! anything is wrong with a press.

use nalgebra::{DMatrix, DVector};

use super::readings::Readings;

/// Number of draws of noise by which the threshold is set.
const QUIET: u64 = 1000;

/// Test of the likelihood of readings, in the mean over presses of a family, against that where nothing touches.
///
/// With its share of false alarms no other sees more of the presses that the family draws (Neyman and Pearson, of the mixture),
/// but for what chance makes of a mean over so many of them and of a threshold by so many draws.
pub(super) struct BestTest {
    /// Readings without noise over the noise, a row for each press.
    presses: DMatrix<f64>,
    /// Halves of the rows' squares.
    halves: DVector<f64>,
    std: f64,
    threshold: f64,
}

impl BestTest {
    /// The test by readings of presses, each as likely as the others, whose noise has this standard deviation.
    pub(super) fn new(
        presses: &[Readings],
        nothing: &Readings,
        std: f64,
        false_alarms: f64,
        seed: u64,
    ) -> Self {
        let rows: Vec<Vec<f64>> = presses
            .iter()
            .map(|press| press.all().map(|moved| moved / std).collect())
            .collect();
        let columns = nothing.all().count();
        let presses = DMatrix::from_fn(rows.len(), columns, |row, column| rows[row][column]);
        let halves = DVector::from_iterator(
            rows.len(),
            presses.row_iter().map(|row| 0.5 * row.norm_squared()),
        );
        let mut test = Self {
            presses,
            halves,
            std,
            threshold: f64::INFINITY,
        };
        let mut quiet: Vec<f64> = (0..QUIET)
            .map(|draw| test.evidence(&nothing.noisy(std, seed, draw)))
            .collect();
        quiet.sort_by(|one, other| other.total_cmp(one));
        test.threshold = quiet[(false_alarms * QUIET as f64) as usize];
        test
    }

    /// Whether the test takes the readings for those of a press.
    pub(super) fn sees(&self, readings: &Readings) -> bool {
        self.evidence(readings) > self.threshold
    }

    /// Logarithm of the sum of the presses' likelihoods over that of no contact.
    fn evidence(&self, readings: &Readings) -> f64 {
        let read = DVector::from_iterator(
            self.presses.ncols(),
            readings.all().map(|moved| moved / self.std),
        );
        let logarithms = &self.presses * read - &self.halves;
        let most = logarithms.max();
        let shares = logarithms.iter().map(|one| libm::exp(one - most));
        most + libm::log(shares.sum())
    }
}

#[cfg(test)]
mod tests {
    use palpate_press::{Body, Markers, Skin};
    use palpate_sensing::Channel;
    use palpate_statistics::{normal_tail, score_of_tail};

    use super::super::super::draws::Draws;
    use super::super::readings::Flaw;
    use super::*;

    const ALARMS: f64 = 0.05;
    const TRIALS: u64 = 1000;

    fn seen(test: &BestTest, readings: &Readings) -> f64 {
        let is_seen = |trial: &u64| test.sees(&readings.noisy(test.std, 2, *trial));
        (0..TRIALS).filter(is_seen).count() as f64 / TRIALS as f64
    }

    #[test]
    fn a_press_that_is_known_is_seen_as_often_as_its_normal_distribution_says() {
        let places: Vec<_> = (0..11 * 11)
            .map(|number| [number % 11, number / 11].map(|step| 2.0 * f64::from(step) - 10.0))
            .collect();
        let markers = Markers::new(Skin::new(20.0).unwrap(), &places).unwrap();
        let body = Body::half_space(0.5, 2.0).unwrap();
        let contact = markers.skin().contact(&body, 1.0 / 40.0, 1.0).unwrap();
        let mut draws = Draws::new(3, 0, Channel::PadOffset);
        let mut at = |place| Readings::of(&markers, &contact, place, Flaw::None, &mut draws);
        let nothing = Readings::of_nothing(&markers);
        let size = at([0.0; 2]).all().map(|one| one * one).sum::<f64>().sqrt();
        for scores in [2.0, 3.0] {
            let (std, press) = (size / scores, at([0.0; 2]));
            let expected = normal_tail(score_of_tail(ALARMS) - scores);
            let known = BestTest::new(&[at([0.0; 2])], &nothing, std, ALARMS, 1);
            let own = 0.5 * scores * scores;
            assert!((known.evidence(&press) - own).abs() < 1e-9);
            let twice = BestTest::new(&[at([0.0; 2]), at([0.0; 2])], &nothing, std, ALARMS, 1);
            assert!((twice.evidence(&press) - own - std::f64::consts::LN_2).abs() < 1e-9);
            let share = seen(&known, &press);
            assert!((share - expected).abs() < 0.04, "{share} for {expected}");
            // False alarms as many as are allowed, and fewer presses where their place is unknown.
            let places = [[0.0; 2], [4.0, 0.0], [-4.0, 4.0], [0.0, -6.0]];
            let unknown = BestTest::new(&places.map(&mut at), &nothing, std, ALARMS, 1);
            for test in [&known, &unknown] {
                let alarms = seen(test, &nothing);
                assert!((alarms - ALARMS).abs() < 0.02, "{alarms}");
            }
            assert!(seen(&unknown, &press) < share);
        }
    }
}
