//! Best test for whether a finger is displaced, to which it is unknown which one and how far.

use nalgebra::{DMatrix, DVector, Matrix3, Vector3};
use palpate_sensing::{Channel, Stream};

use super::super::case::{Case, Sweep};
use super::super::surface::{Place, Surface};
use super::flaw::DISPLACED;

/// Number of random surfaces whose mean square is that of what the test believes in.
const SURFACES: u64 = 2000;
/// Number of draws of noise by which the threshold is set, and of those that the test is asked of.
const DRAWS: u64 = 1000;
/// Share of false alarms.
const ALARMS: f64 = 0.05;
/// Number of displacements that stand for all.
const SIZES: u32 = 25;

/// Test of the likelihood of contacts in the mean over displacements of any finger, against that of no displacement.
///
/// It knows the noise, and that surfaces scatter as the random ones do: those of a normal distribution with their covariance no
/// other test with as many false alarms tells better (Neyman and Pearson, of the mixture).
pub(super) struct BestTest {
    /// Information of displacements, a row and a column for each finger; its products with them are what contacts tell.
    information: DMatrix<f64>,
    root: DMatrix<f64>,
    sizes: Vec<f64>,
    threshold: f64,
    seed: u64,
}

impl BestTest {
    /// The test for the fingers of a case at their places on a surface; `None` where it is singular.
    pub(super) fn new(case: &Case, sweep: &Sweep, surface: &Surface, seed: u64) -> Option<Self> {
        let touched: Vec<(usize, Place)> = sweep.touched(surface, case.fingers).collect();
        let roots = touched
            .iter()
            .map(|(_, place)| Some(noise(case, place)?.cholesky()?.l()));
        let roots: Vec<Matrix3<f64>> = roots.collect::<Option<_>>()?;
        let rows = if case.normal_std_deg.is_some() { 3 } else { 1 };
        let observed = |columns: usize, of: &dyn Fn(usize, usize) -> [f64; 3]| {
            let mut all = DMatrix::zeros(rows * touched.len(), columns);
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
        let surfaces = observed(others.len(), &|contact, other| {
            let at = touched[contact].1.point;
            let place = others[other].at(at.x, at.y);
            let [p, q] = slopes(&place);
            [place.point.z, p, q]
        });
        let displaced = observed(case.fingers, &|contact, finger| {
            let is_own = touched[contact].0 == finger;
            [f64::from(u8::from(is_own)), 0.0, 0.0]
        });
        let mut covariance = &surfaces * surfaces.transpose() / others.len() as f64;
        for row in 0..covariance.nrows() {
            covariance[(row, row)] += 1.0;
        }
        let information = displaced.tr_mul(&covariance.cholesky()?.solve(&displaced));
        let step = |index: u32| (f64::from(index) + 0.5) / f64::from(SIZES);
        let sizes = (0..SIZES).map(|index| {
            case.position_std * (DISPLACED[0] + (DISPLACED[1] - DISPLACED[0]) * step(index))
        });
        let mut test = Self {
            root: information.clone().cholesky()?.l(),
            information,
            sizes: sizes.collect(),
            threshold: f64::INFINITY,
            seed,
        };
        let mut quiet: Vec<f64> = (0..DRAWS)
            .map(|draw| test.evidence(&test.told(Channel::Position, draw)))
            .collect();
        quiet.sort_by(|one, other| other.total_cmp(one));
        test.threshold = quiet[(ALARMS * DRAWS as f64) as usize];
        Some(test)
    }

    /// Share of glides whose displacement of a finger the test tells.
    pub(super) fn tells(&self, finger: usize, by: f64) -> f64 {
        let told = (0..DRAWS).filter(|draw| {
            let of_noise = self.told(Channel::Normal, *draw);
            self.evidence(&(of_noise + by * self.information.column(finger))) > self.threshold
        });
        told.count() as f64 / DRAWS as f64
    }

    /// Products of displacements with contacts of which none is displaced.
    fn told(&self, channel: Channel, draw: u64) -> DVector<f64> {
        let mut stream = Stream::new(self.seed, draw, channel);
        &self.root * DVector::from_fn(self.root.nrows(), |_, _| stream.standard_normal())
    }

    /// Logarithm of the sum of the displacements' likelihoods over that of none.
    fn evidence(&self, told: &DVector<f64>) -> f64 {
        let each = (0..told.len()).flat_map(|finger| {
            let [own, information] = [told[finger], self.information[(finger, finger)]];
            let sizes = self.sizes.iter();
            sizes.map(move |size| size * own - 0.5 * size * size * information)
        });
        let each: Vec<f64> = each.collect();
        let most = each.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let shares = each.iter().map(|one| libm::exp(one - most));
        most + libm::log(shares.sum())
    }
}

/// Covariance of a contact's height and slopes; that of slopes is 1 where there are none.
fn noise(case: &Case, place: &Place) -> Option<Matrix3<f64>> {
    let [p, q] = slopes(place);
    let steepness = 1.0 + p * p + q * q;
    let height = case.position_std * case.position_std * steepness;
    let normal = case.normal_std_deg.map_or(1.0, f64::to_radians);
    let slope = normal * normal * steepness;
    let noise = Matrix3::new(
        height,
        0.0,
        0.0,
        0.0,
        slope * (1.0 + p * p),
        slope * p * q,
        0.0,
        slope * p * q,
        slope * (1.0 + q * q),
    );
    noise.iter().all(|one| one.is_finite()).then_some(noise)
}

fn slopes(place: &Place) -> [f64; 2] {
    [place.normal.x, place.normal.y].map(|along| -along / place.normal.z)
}

#[cfg(test)]
mod tests {
    use palpate_sensing::Distribution;

    use super::*;

    fn test(fingers: usize, position_std: f64, normal_std_deg: Option<f64>) -> BestTest {
        let case = Case {
            fingers,
            position_std,
            distribution: Distribution::Gaussian,
            normal_std_deg,
            is_told: true,
        };
        BestTest::new(&case, &Sweep::random(1, 0), &Surface::random(1, 0), 1).unwrap()
    }

    #[test]
    fn nothing_is_told_as_often_as_allowed_and_normals_tell_what_heights_do_not() {
        let none = test(3, 0.02, None);
        assert!((none.tells(1, 0.0) - ALARMS).abs() < 0.03);
        let by = 10.0 * 0.02;
        let [blind, seen] = [none.tells(1, by), test(3, 0.02, Some(1.0)).tells(1, by)];
        assert!(blind < 0.5 && seen > 0.95, "{blind} {seen}");
    }

    #[test]
    fn a_displacement_of_a_known_surface_is_told_by_all_contacts_of_its_finger() {
        // Of noise that outweighs every surface, heights alone tell: their number over its square.
        let wide = test(3, 100.0, None);
        let (sweep, surface) = (Sweep::random(1, 0), Surface::random(1, 0));
        let contacts = sweep.touched(&surface, 3);
        let own = contacts.filter(|(finger, _)| *finger == 0);
        let information: f64 = own
            .map(|(_, place)| (noise_of_height(&place) * 1e4).recip())
            .sum();
        let own = wide.information[(0, 0)];
        assert!(
            (own / information - 1.0).abs() < 0.01,
            "{own} {information}"
        );
    }

    fn noise_of_height(place: &Place) -> f64 {
        let [p, q] = slopes(place);
        1.0 + p * p + q * q
    }
}
