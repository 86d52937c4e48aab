//! Divides contacts into cells, which are groups of neighbouring contacts. If most residuals in a cell have the same
//! sign, the shape does not fit the contacts, and the residuals are not only noise.

use nalgebra::Vector3;
use palpate_statistics::ratio_tail;

use super::pose::{Cloud, Equations, Gram, Pose, Row};
use super::robust_fit::{MIN_STD, Solution};

const MAX_CELLS: usize = 32;
const MIN_CONTACTS: usize = 5;
const MIN_CELLS: usize = 12;
/// Rounded coordinates of a scan have only a few values, called levels. They are searched in at most this number of
/// contacts.
const LEVEL_CONTACTS: usize = 2000;
/// Rounded coordinates of a scan have only a few values, called levels. Two coordinates belong to the same level if
/// they differ by less than this share of the contacts' spread.
const LEVEL_TOLERANCE: f64 = 1e-6;
/// Rounded coordinates of a scan have only a few values, called levels. A coordinate counts as rounded only if all its
/// values are close to levels. This constant is the largest accepted difference between a value and the nearest level,
/// divided by the step between levels.
const MAX_LEVEL_ERROR: f64 = 0.05;
/// A coordinate counts as rounded only if the contacts' distances from the shape are about as large as the rounding
/// errors. This constant is the largest accepted ratio of the larger to the smaller of these two standard deviations.
const MAX_ROUNDING_RATIO: f64 = 2.0;

/// A division of contacts into cells. `cell_of` contains the cell index of each contact.
pub(super) struct Cells {
    cell_of: Vec<usize>,
    count: usize,
}

impl Cells {
    /// Divides contacts into cells with similar numbers of contacts, according to the points of the shape that are
    /// nearest to the contacts. The measured positions are not used for this, because their errors are correlated with
    /// the distances from the shape. `None` if there are too few contacts.
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

    /// `values` contains one value per contact, such as the distance from the shape. Returns the p-value of the cells'
    /// mean values: the probability that noise alone causes mean values of at least this size. `correlation` is the
    /// number of consecutive values that count as one because their errors are correlated.
    pub(super) fn p_value(&self, values: &[f64], unknowns: usize, correlation: f64) -> f64 {
        let mut sums = vec![(0.0, 0.0); self.count];
        for (value, &cell) in values.iter().zip(&self.cell_of) {
            sums[cell].0 += value;
            sums[cell].1 += 1.0;
        }
        let between: f64 = sums.iter().map(|(sum, count)| sum * sum / count).sum();
        let total: f64 = values.iter().map(|value| value * value).sum();
        let within = (total - between).max(MIN_STD * MIN_STD * values.len() as f64);
        let freedom = (values.len() - self.count) as f64 / correlation;
        let of_cells = self.count.saturating_sub(unknowns);
        ratio_tail(
            between / correlation,
            of_cells,
            within / correlation,
            freedom.max(1.0) as usize,
        )
    }

    /// Divides contacts by the levels of a rounded coordinate, such as the heights of a scan whose voxels are larger
    /// than its noise. The coordinate is the one along which the shape's normals mainly point. `None` if this
    /// coordinate was not rounded, or if the distances from the shape are not about as large as the rounding errors.
    pub(super) fn of_levels(solution: &Solution, cloud: &Cloud) -> Option<Self> {
        let thinned = cloud.thinned(LEVEL_CONTACTS);
        let normals = thinned
            .places
            .iter()
            .map(|place| solution.pose.normal_at(place).abs());
        let facing = normals.sum::<Vector3<f64>>() / thinned.places.len() as f64;
        let axis = facing.imax();
        let mut levels: Vec<f64> = thinned.places.iter().map(|place| place[axis]).collect();
        levels.sort_unstable_by(f64::total_cmp);
        levels.dedup_by(|one, other| (*one - *other).abs() < LEVEL_TOLERANCE);
        let steps = levels.windows(2).map(|pair| pair[1] - pair[0]);
        let step = steps.reduce(f64::min)?;
        let number = |place: &Vector3<f64>| (place[axis] - levels[0]) / step;
        let is_level = |place: &Vector3<f64>| {
            let number = number(place);
            (number - libm::round(number)).abs() < MAX_LEVEL_ERROR
        };
        let of_rounding = step * facing[axis] / 12.0_f64.sqrt();
        let share = solution.variances[0].sqrt() / of_rounding;
        let are_levels = levels.len() * MIN_CONTACTS <= thinned.places.len()
            && (1.0 / MAX_ROUNDING_RATIO..=MAX_ROUNDING_RATIO).contains(&share)
            && cloud.places.iter().all(is_level);
        let lowest = cloud.places.iter().map(&number).fold(0.0, f64::min);
        let cell = |place| libm::round(number(place) - lowest) as usize;
        let cells = cloud.places.iter().map(&number).fold(0.0, f64::max) - lowest;
        (are_levels && cells < cloud.places.len() as f64).then(|| {
            let cell_of: Vec<usize> = cloud.places.iter().map(cell).collect();
            let count = cell_of.iter().max().map_or(0, |last| last + 1);
            Self { cell_of, count }
        })
    }

    /// Number of cells minus the number of fitted parameters, but at least 1.
    pub(super) fn freedom(&self, pose: &Pose) -> usize {
        self.count.saturating_sub(pose.unknowns()).max(1)
    }

    pub(super) const fn count(&self) -> usize {
        self.count
    }

    /// Covariance of the fitted parameters. All residuals of a cell count as one residual.
    pub(super) fn covariance(&self, solution: &Solution, cloud: &Cloud) -> Gram {
        let weights = solution.weights();
        let mut sums = vec![Row::zeros(); self.count];
        for (index, &cell) in self.cell_of.iter().enumerate() {
            sums[cell] += Equations::gradient(&solution.pose, cloud, index, weights);
        }
        let spread = sums
            .iter()
            .fold(Gram::zeros(), |all, sum| all + sum * sum.transpose());
        solution.inverse * spread * solution.inverse
    }
}

/// Divides a group of contacts along its longest side until there are enough cells. Each cut is at the widest gap near
/// a quantile, so that a cell does not end within a stroke. The residuals of a part of a stroke would mostly have the
/// same sign.
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
