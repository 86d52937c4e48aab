//! Divides contacts into cells, which are groups of neighbouring contacts. If most residuals in a cell have the same
//! sign, the shape does not fit the contacts, and the residuals are not only noise.

use nalgebra::Vector3;
use palpate_statistics::ratio_tail;

use super::pose::{Cloud, Equations, Gram, Pose, Row};
use super::robust_fit::Solution;

const MAX_CELLS: usize = 32;
const MIN_CONTACTS: usize = 5;
const MIN_CELLS: usize = 12;

/// A division of contacts into cells. `cell_of` contains the cell index of each contact.
pub(super) struct Cells {
    cell_of: Vec<usize>,
    count: usize,
}

impl Cells {
    /// Divides contacts into cells with similar numbers of contacts, by their footpoints on the shape. The measured
    /// positions are not used for this, because their errors are correlated with the distances from the shape. `None`
    /// if there are too few contacts.
    pub(super) fn new(pose: &Pose, cloud: &Cloud) -> Option<Self> {
        let contacts = cloud.places.len();
        let wanted = (contacts / MIN_CONTACTS).min(MAX_CELLS);
        if wanted < MIN_CELLS {
            return None;
        }
        let mut cell_of = vec![0; contacts];
        let mut order: Vec<usize> = (0..contacts).collect();
        let mut count = 0;
        let foot = |place: &Vector3<f64>| place - pose.normal_at(place) * pose.distance(place);
        let feet: Vec<Vector3<f64>> = cloud.places.iter().map(foot).collect();
        divide(&feet, &mut order, wanted, &mut |members| {
            for &member in members {
                cell_of[member] = count;
            }
            count += 1;
        });
        Some(Self { cell_of, count })
    }

    /// P-value of the mean values of the cells: the probability that noise alone causes mean values of at least this
    /// size. `values` contains one value per contact. `correlation` is the number of consecutive values that count as
    /// one because their errors are correlated.
    pub(super) fn p_value(&self, values: &[f64], unknowns: usize, correlation: f64) -> f64 {
        let mut sums = vec![(0.0, 0.0); self.count];
        for (value, &cell) in values.iter().zip(&self.cell_of) {
            sums[cell].0 += value;
            sums[cell].1 += 1.0;
        }
        let between: f64 = sums.iter().map(|(sum, count)| sum * sum / count).sum();
        let total: f64 = values.iter().map(|value| value * value).sum();
        let within = (total - between).max(0.0);
        let freedom = (values.len() - self.count) as f64 / correlation;
        let of_cells = self.count.saturating_sub(unknowns);
        ratio_tail(
            between / correlation,
            of_cells,
            within / correlation,
            freedom.max(1.0) as usize,
        )
    }

    /// Covariance of the fitted parameters, and its degrees of freedom. All residuals of a cell count as one residual.
    pub(super) fn covariance(&self, solution: &Solution, cloud: &Cloud) -> (Gram, usize) {
        let weights = solution.weights();
        let mut sums = vec![Row::zeros(); self.count];
        for (index, &cell) in self.cell_of.iter().enumerate() {
            sums[cell] += Equations::gradient(&solution.pose, cloud, index, weights);
        }
        let freedom = self.count.saturating_sub(solution.pose.unknowns()).max(1);
        let scale = self.count as f64 / freedom as f64;
        let spread = sums
            .iter()
            .fold(Gram::zeros(), |all, sum| all + sum * sum.transpose());
        (
            solution.inverse * spread * solution.inverse * scale,
            freedom,
        )
    }
}

/// Divides a group of contacts along its longest side until there are enough cells. Each cut is at the widest gap near
/// a quantile, because a cell that ends within a stroke would collect errors of one sign.
fn divide(
    places: &[Vector3<f64>],
    members: &mut [usize],
    wanted: usize,
    take: &mut dyn FnMut(&[usize]),
) {
    if wanted <= 1 || members.len() < 2 {
        take(members);
        return;
    }
    let (mut low, mut high) = (places[members[0]], places[members[0]]);
    for &member in members.iter() {
        low = low.inf(&places[member]);
        high = high.sup(&places[member]);
    }
    let axis = (high - low).imax();
    members.sort_unstable_by(|&one, &other| places[one][axis].total_cmp(&places[other][axis]));
    let (count, first) = (members.len(), wanted / 2);
    let target = count * first / wanted;
    let near = count / 5;
    let window = target.saturating_sub(near).max(1)..(target + near + 1).min(count);
    let gap = |place: &usize| places[members[*place]][axis] - places[members[*place - 1]][axis];
    let widest = window.max_by(|one, other| gap(one).total_cmp(&gap(other)));
    let split = widest.unwrap_or(target).clamp(1, count - 1);
    let (before, after) = members.split_at_mut(split);
    divide(places, before, first, take);
    divide(places, after, wanted - first, take);
}
