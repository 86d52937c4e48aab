//! Best tests for whether an object touches the sensor and for whether readings have a flaw. They are upper bounds for what
//! any detector can find.
//!
//! A test compares the mean likelihood of the readings over all alternatives with their likelihood without contact or flaw.
//! At the same share of false alarms, no other test detects more of the alternatives (Neyman and Pearson, for the mixture).
//! Alternatives and threshold are drawn, so this holds up to their sampling errors.

use nalgebra::{DMatrix, DVector, Matrix3, Vector3};
use palpate_sensing::{Channel, Stream};

use super::glide_contacts::{GlideSetup, Path};
use super::glide_flaws::DISPLACEMENTS;
use super::press_readings::Readings;
use super::surface::{Place, Surface};

/// Share of false alarms of the tests.
pub(super) const FALSE_ALARMS: f64 = 0.05;
/// Number of draws of noise for the threshold, and of draws for the power of a displacement test.
const DRAWS: u64 = 1000;
/// Number of random surfaces for the covariance that a displacement test assumes.
const SURFACES: u64 = 2000;
/// Number of displacements of a finger that a test tries.
const SIZES: u32 = 25;

/// Threshold that a share [`FALSE_ALARMS`] of draws without a flaw exceeds.
fn threshold(evidence_of_draw: impl Fn(u64) -> f64) -> f64 {
    let mut evidence: Vec<f64> = (0..DRAWS).map(evidence_of_draw).collect();
    evidence.sort_by(|one, other| other.total_cmp(one));
    evidence[(FALSE_ALARMS * DRAWS as f64) as usize]
}

/// Logarithm of the sum of numbers with these logarithms.
fn log_sum(logarithms: &[f64]) -> f64 {
    let max = logarithms.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let shares = logarithms.iter().map(|one| libm::exp(one - max));
    max + libm::log(shares.sum())
}

/// Test of readings against those without contact. The alternatives are readings of presses, or what a flaw adds to them.
pub(super) struct ContactTest {
    /// Readings of each press without noise, a row each, divided by the noise.
    presses: DMatrix<f64>,
    /// Halves of the rows' squares.
    halves: DVector<f64>,
    std: f64,
    threshold: f64,
}

impl ContactTest {
    /// The test for equally likely presses; `std` is the standard deviation of the readings.
    pub(super) fn new(presses: &[Readings], no_contact: &Readings, std: f64, seed: u64) -> Self {
        let rows: Vec<Vec<f64>> = presses
            .iter()
            .map(|press| press.all().map(|moved| moved / std).collect())
            .collect();
        let columns = no_contact.all().count();
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
        test.threshold = threshold(|draw| test.evidence(&no_contact.noisy(std, seed, draw)));
        test
    }

    /// Whether the test detects a press in the readings.
    pub(super) fn detects(&self, readings: &Readings) -> bool {
        self.evidence(readings) > self.threshold
    }

    /// Logarithm of the sum of the presses' likelihoods over that of no contact.
    fn evidence(&self, readings: &Readings) -> f64 {
        let read = DVector::from_iterator(
            self.presses.ncols(),
            readings.all().map(|moved| moved / self.std),
        );
        log_sum((&self.presses * read - &self.halves).as_slice())
    }
}

/// Test for whether a finger is displaced. The alternatives are displacements of each finger by several lengths.
///
/// The test has the true noise, and the covariance of the random surfaces. It is the best one for normally distributed
/// surfaces with this covariance.
pub(super) struct DisplacementTest {
    /// Information on displacements, a row and a column for each finger.
    information: DMatrix<f64>,
    root: DMatrix<f64>,
    sizes: Vec<f64>,
    threshold: f64,
    seed: u64,
}

impl DisplacementTest {
    /// The test for the contacts of a path over a surface; `None` if it is singular.
    pub(super) fn new(
        case: &GlideSetup,
        path: &Path,
        surface: &Surface,
        seed: u64,
    ) -> Option<Self> {
        let contacts: Vec<(usize, Place)> = path.contact_places(surface, case.fingers).collect();
        let roots = contacts
            .iter()
            .map(|(_, place)| Some(noise(case, place)?.cholesky()?.l()));
        let roots: Vec<Matrix3<f64>> = roots.collect::<Option<_>>()?;
        let rows = if case.normal_std_deg.is_some() { 3 } else { 1 };
        // Heights and slopes over their noise, a column for each surface or finger.
        let whitened = |columns: usize, of: &dyn Fn(usize, usize) -> [f64; 3]| {
            let mut all = DMatrix::zeros(rows * contacts.len(), columns);
            for (contact, root) in roots.iter().enumerate() {
                for column in 0..columns {
                    let one = root.solve_lower_triangular(&Vector3::from(of(contact, column)));
                    let one = one.unwrap_or_default();
                    let own = all.view_mut((rows * contact, column), (rows, 1));
                    { own }.copy_from(&one.rows(0, rows));
                }
            }
            all
        };
        let others: Vec<Surface> = (0..SURFACES)
            .map(|index| Surface::random(seed.wrapping_add(1), index))
            .collect();
        let surfaces = whitened(others.len(), &|contact, other| {
            let at = contacts[contact].1.point;
            let place = others[other].at(at.x, at.y);
            let [p, q] = slopes(&place);
            [place.point.z, p, q]
        });
        let displaced = whitened(case.fingers, &|contact, finger| {
            let is_own = contacts[contact].0 == finger;
            [f64::from(u8::from(is_own)), 0.0, 0.0]
        });
        let mut covariance = &surfaces * surfaces.transpose() / others.len() as f64;
        for row in 0..covariance.nrows() {
            covariance[(row, row)] += 1.0;
        }
        let information = displaced.tr_mul(&covariance.cholesky()?.solve(&displaced));
        let step = |index: u32| (f64::from(index) + 0.5) / f64::from(SIZES);
        let [low, high] = DISPLACEMENTS;
        let size = |index| case.position_std * (low + (high - low) * step(index));
        let mut test = Self {
            root: information.clone().cholesky()?.l(),
            information,
            sizes: (0..SIZES).map(size).collect(),
            threshold: f64::INFINITY,
            seed,
        };
        test.threshold = threshold(|draw| test.evidence(&test.noise(Channel::Position, draw)));
        Some(test)
    }

    /// Share of glides in which the test detects a displacement of this finger.
    pub(super) fn power(&self, finger: usize, by: f64) -> f64 {
        let detected = (0..DRAWS).filter(|draw| {
            let noise = self.noise(Channel::Normal, *draw);
            self.evidence(&(noise + by * self.information.column(finger))) > self.threshold
        });
        detected.count() as f64 / DRAWS as f64
    }

    /// Products of the displacements with contacts without a displacement.
    fn noise(&self, channel: Channel, draw: u64) -> DVector<f64> {
        let mut stream = Stream::new(self.seed, draw, channel);
        &self.root * DVector::from_fn(self.root.nrows(), |_, _| stream.standard_normal())
    }

    /// Logarithm of the sum of the displacements' likelihoods over that of none.
    fn evidence(&self, products: &DVector<f64>) -> f64 {
        let each = (0..products.len()).flat_map(|finger| {
            let [own, information] = [products[finger], self.information[(finger, finger)]];
            let sizes = self.sizes.iter();
            sizes.map(move |size| size * own - 0.5 * size * size * information)
        });
        log_sum(&each.collect::<Vec<f64>>())
    }
}

/// Covariance of a contact's height and slopes; without normals the variance of the slopes is 1.
fn noise(case: &GlideSetup, place: &Place) -> Option<Matrix3<f64>> {
    let [p, q] = slopes(place);
    let steepness = 1.0 + p * p + q * q;
    let height = case.position_std * case.position_std * steepness;
    let normal = case.normal_std_deg.map_or(1.0, f64::to_radians);
    let slope = normal * normal * steepness;
    let cross = slope * p * q;
    let [pp, qq] = [slope * (1.0 + p * p), slope * (1.0 + q * q)];
    let noise = Matrix3::new(height, 0.0, 0.0, 0.0, pp, cross, 0.0, cross, qq);
    noise.iter().all(|one| one.is_finite()).then_some(noise)
}

fn slopes(place: &Place) -> [f64; 2] {
    [place.normal.x, place.normal.y].map(|along| -along / place.normal.z)
}

#[cfg(test)]
mod tests {
    use palpate_press::{Body, Markers, Skin};
    use palpate_sensing::Distribution;
    use palpate_statistics::{normal_tail, score_of_tail};

    use super::super::Draws;
    use super::super::press_readings::Flaw;
    use super::*;

    fn power(test: &ContactTest, readings: &Readings) -> f64 {
        let is_detected = |trial: &u64| test.detects(&readings.noisy(test.std, 2, *trial));
        (0..DRAWS).filter(is_detected).count() as f64 / DRAWS as f64
    }

    #[test]
    fn a_known_press_is_detected_as_often_as_a_normal_distribution_implies() {
        let places: Vec<_> = (0..11 * 11)
            .map(|number| [number % 11, number / 11].map(|step| 2.0 * f64::from(step) - 10.0))
            .collect();
        let markers = Markers::new(Skin::new(20.0).unwrap(), &places).unwrap();
        let body = Body::half_space(0.5, 2.0).unwrap();
        let contact = markers.skin().contact(&body, 1.0 / 40.0, 1.0).unwrap();
        let mut draws = Draws::new(3, 0, Channel::PadOffset);
        let mut at = |place| Readings::new(&markers, &contact, place, Flaw::None, &mut draws);
        let none = Readings::without_contact(&markers);
        let size = at([0.0; 2]).all().map(|one| one * one).sum::<f64>().sqrt();
        for scores in [2.0, 3.0] {
            let (std, press) = (size / scores, at([0.0; 2]));
            let expected = normal_tail(score_of_tail(FALSE_ALARMS) - scores);
            let known = ContactTest::new(&[at([0.0; 2])], &none, std, 1);
            let own = 0.5 * scores * scores;
            assert!((known.evidence(&press) - own).abs() < 1e-9);
            let twice = ContactTest::new(&[at([0.0; 2]), at([0.0; 2])], &none, std, 1);
            assert!((twice.evidence(&press) - own - std::f64::consts::LN_2).abs() < 1e-9);
            let share = power(&known, &press);
            assert!((share - expected).abs() < 0.04, "{share} for {expected}");
            // False alarms are as frequent as allowed; presses at an unknown place are detected less often.
            let places = [[0.0; 2], [4.0, 0.0], [-4.0, 4.0], [0.0, -6.0]];
            let unknown = ContactTest::new(&places.map(&mut at), &none, std, 1);
            for test in [&known, &unknown] {
                let alarms = power(test, &none);
                assert!((alarms - FALSE_ALARMS).abs() < 0.02, "{alarms}");
            }
            assert!(power(&unknown, &press) < share);
        }
    }

    fn test(position_std: f64, normal_std_deg: Option<f64>) -> DisplacementTest {
        let case = GlideSetup {
            fingers: 3,
            position_std,
            distribution: Distribution::Gaussian,
            normal_std_deg,
            states_noise: true,
        };
        let (path, surface) = (Path::random(1, 0), Surface::random(1, 0));
        DisplacementTest::new(&case, &path, &surface, 1).unwrap()
    }

    #[test]
    fn false_alarms_are_as_frequent_as_allowed_and_normals_reveal_displacements() {
        let heights = test(0.02, None);
        assert!((heights.power(1, 0.0) - FALSE_ALARMS).abs() < 0.03);
        let by = 10.0 * 0.02;
        let [heights, normals] = [heights.power(1, by), test(0.02, Some(1.0)).power(1, by)];
        assert!(heights < 0.5 && normals > 0.95, "{heights} {normals}");
    }

    #[test]
    fn all_contacts_of_a_finger_count_if_noise_exceeds_the_surfaces() {
        let wide = test(100.0, None);
        let (path, surface) = (Path::random(1, 0), Surface::random(1, 0));
        let contacts = path.contact_places(&surface, 3);
        let information: f64 = contacts
            .filter(|(finger, _)| *finger == 0)
            .map(|(_, place)| {
                let [p, q] = slopes(&place);
                ((1.0 + p * p + q * q) * 1e4).recip()
            })
            .sum();
        let own = wide.information[(0, 0)];
        assert!(
            (own / information - 1.0).abs() < 0.01,
            "{own} {information}"
        );
    }
}
