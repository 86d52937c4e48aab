//! Divides contacts into cells, which are groups of neighbouring contacts. If most residuals in a cell have the same
//! sign, the shape does not fit the contacts, and the residuals are not only noise.

use nalgebra::Vector3;
use palpate_statistics::{chi_squared_tail, ratio_tail};

use super::pose::{Cloud, Equations, Gram, Pose, Row};
use super::robust_fit::Solution;
use crate::patch::FingerMap;

const MAX_CELLS: usize = 32;
const MIN_CONTACTS: usize = 5;
const MIN_CELLS: usize = 12;
/// A coordinate counts as rounded only if the contacts' distances from the shape are about as large as the rounding
/// errors. This constant is the largest accepted ratio of the larger to the smaller of these two standard deviations.
const MAX_ROUNDING_RATIO: f64 = 2.0;

/// The assumed steps of a coordinate are wrong if two conditions are true: the contacts' mean square distance from the
/// shape is below this share of the variance of the rounding errors, and the probability of such a small distance is
/// below [`MIN_ROUNDING_P_VALUE`].
const MIN_ROUNDING_SHARE: f64 = 0.25;
const MIN_ROUNDING_P_VALUE: f64 = 0.01;
/// Largest difference between the distances of two contacts from the shape at which both have the same rounding error. It is
/// relative to the root mean square distance of all contacts.
const MAX_DIFFERENCE: f64 = 1e-6;
/// Largest number of different rounding errors, divided by the number of contacts. If there are more, equal errors may be
/// equal by chance, and all errors count as different.
const MAX_ERRORS: f64 = 0.7;
/// Smallest root mean square distance of rounded contacts from the shape, in the unit of the contacts' spread. Contacts at
/// smaller distances are exact.
const MIN_DISTANCE: f64 = 1e-9;
/// Rounding is neglected if its share of the variance of means of contacts is below this value.
const MIN_ROUNDING_EFFECT: f64 = 1e-4;

/// Errors of rounded coordinates. Contacts of a finger with the same value of a coordinate may have the same error. Such
/// errors do not contribute to the residuals if the fit can follow them, such as the heights of a few straight strokes.
/// On a grid of places without noise, all contacts on a line along a cylinder have the same error, and so have the mirror
/// images of a contact.
#[derive(Debug, Default)]
pub(super) struct Rounding {
    /// Variance that the distances from the shape would have if rounding caused all errors.
    pub(super) variance: f64,
    /// Number of consecutive positions that would count as one position if rounding caused all errors.
    run_length: f64,
    axes: Vec<RoundedAxis>,
}

/// Rounding errors of the coordinate `axis`, or of the distances from the shape if it is `None`. Contacts with the same
/// error have the same number in `run_of`.
#[derive(Debug)]
struct RoundedAxis {
    axis: Option<usize>,
    variance: f64,
    /// Mean variance of the distances from the shape, if all errors were caused by the rounding of this coordinate.
    of_distances: f64,
    step: f64,
    run_of: Vec<Option<usize>>,
    lengths: Vec<f64>,
}

impl Rounding {
    pub(super) fn new(solution: &Solution, cloud: &Cloud, fingers: &[usize]) -> Self {
        let (variances, steps) = cloud.rounding(&solution.pose);
        let count = cloud.places.len() as f64;
        let found = solution.equations.squares[0] / count;
        if let Some(equal) = RoundedAxis::of_equal_distances(&solution.pose, cloud, found) {
            let squares = equal.lengths.iter().map(|one| one * one);
            return Self {
                variance: found,
                run_length: squares.sum::<f64>() / count,
                axes: vec![equal],
            };
        }
        let mut all = Self::default();
        for axis in (0..3).filter(|&axis| steps[axis] > 0.0) {
            let (run_of, lengths) = runs(cloud, fingers, axis, steps[axis]);
            let independent = count - lengths.iter().map(|one| one - 1.0).sum::<f64>();
            let expected = variances[axis];
            let share = found / expected;
            let freedom = independent as usize;
            let freedom = freedom.saturating_sub(solution.pose.unknowns());
            let is_wrong = share < MIN_ROUNDING_SHARE
                && freedom > 0
                && 1.0 - chi_squared_tail(share * independent, freedom) < MIN_ROUNDING_P_VALUE;
            let excess: f64 = lengths.iter().map(|one| one * (one - 1.0)).sum();
            let of_means = expected * (1.0 + excess / count);
            if is_wrong || of_means < MIN_ROUNDING_EFFECT * found {
                continue;
            }
            all.variance += expected;
            all.run_length += of_means;
            all.axes.push(RoundedAxis {
                axis: Some(axis),
                variance: steps[axis] * steps[axis] / 12.0,
                of_distances: expected,
                step: steps[axis],
                run_of,
                lengths,
            });
        }
        all.run_length = match all.variance > 0.0 {
            true => all.run_length / all.variance,
            false => 1.0,
        };
        all
    }

    /// Number of consecutive positions of the fit `solution` that count as one, because they have the same rounding
    /// error.
    pub(super) fn correlation(&self, solution: &Solution) -> f64 {
        1.0 + (self.run_length - 1.0) * (self.variance / solution.variances[0]).min(1.0)
    }

    /// Divides contacts by the values of the rounded coordinate along which the shape's normals mainly point, such as the
    /// heights of a scan whose voxels are larger than its noise. `None` if the distances from the shape are not about as
    /// large as the rounding errors.
    pub(super) fn levels(&self, solution: &Solution, cloud: &Cloud) -> Option<Cells> {
        let largest = |one: &&RoundedAxis, other: &&RoundedAxis| {
            one.of_distances.total_cmp(&other.of_distances)
        };
        let RoundedAxis {
            axis,
            of_distances,
            step,
            ..
        } = self.axes.iter().max_by(largest)?;
        let share = (solution.variances[0] / of_distances).sqrt();
        let axis = (*axis)?;
        let values = cloud.places.iter().map(|place| place[axis]);
        let lowest = values.clone().fold(f64::INFINITY, f64::min);
        let cell_of: Vec<usize> = values
            .map(|value| libm::round((value - lowest) / step) as usize)
            .collect();
        let count = cell_of.iter().max()? + 1;
        let are_levels = (1.0 / MAX_ROUNDING_RATIO..=MAX_ROUNDING_RATIO).contains(&share)
            && count * MIN_CONTACTS <= cell_of.len();
        are_levels.then_some(Cells { cell_of, count })
    }

    /// Covariance of the fitted parameters that is caused by equal errors of different contacts.
    pub(super) fn covariance(&self, solution: &Solution, cloud: &Cloud) -> Gram {
        let weights = solution.weights();
        let mut spread = Gram::zeros();
        for one in &self.axes {
            let mut sums = vec![Row::zeros(); one.lengths.len()];
            for (place, run) in cloud.places.iter().zip(&one.run_of) {
                if let Some(run) = *run {
                    let normal = solution.pose.normal_at(place);
                    let part = one.axis.map_or(1.0, |axis| normal[axis]) * weights[0];
                    sums[run] += solution.pose.deviation(place, false).distance_row * part;
                }
            }
            // The variance of the distances already contains the squared error of each contact. Therefore add only the
            // products of errors of different contacts of a run: the factor 1 − 1/length removes the squares.
            for (sum, length) in sums.iter().zip(&one.lengths) {
                spread += sum * sum.transpose() * (one.variance * (1.0 - 1.0 / length));
            }
        }
        solution.inverse * spread * solution.inverse
    }
}

impl RoundedAxis {
    /// Groups contacts with equal distances from the shape; `None` if only a few distances are equal, or if the distances
    /// are larger than the rounding errors of the last decimals. `variance` is the mean square of the distances.
    fn of_equal_distances(pose: &Pose, cloud: &Cloud, variance: f64) -> Option<Self> {
        let normals = cloud.places.iter().map(|place| pose.normal_at(place).abs());
        let step = cloud.resolution.decimals[normals.sum::<Vector3<f64>>().imax()];
        if variance.sqrt() > MAX_ROUNDING_RATIO * step / 12.0_f64.sqrt() {
            return None;
        }
        let distances: Vec<f64> = cloud
            .places
            .iter()
            .map(|place| pose.distance(place))
            .collect();
        let mut order: Vec<usize> = (0..distances.len()).collect();
        order.sort_unstable_by(|&one, &other| distances[one].total_cmp(&distances[other]));
        let std = variance.sqrt();
        let is_equal = |one: &usize, other: &usize| {
            distances[*other] - distances[*one] <= MAX_DIFFERENCE * std
        };
        let groups: Vec<&[usize]> = order.chunk_by(is_equal).collect();
        if std < MIN_DISTANCE || groups.len() as f64 > MAX_ERRORS * distances.len() as f64 {
            return None;
        }
        let mut run_of = vec![None; distances.len()];
        for (run, group) in groups.iter().enumerate() {
            group
                .iter()
                .for_each(|&contact| run_of[contact] = Some(run));
        }
        let errors = groups.len() as f64;
        let freedom = (errors - pose.unknowns() as f64).max(1.0);
        Some(Self {
            axis: None,
            variance: variance * errors / freedom,
            of_distances: variance,
            step: std,
            run_of,
            lengths: groups.iter().map(|group| group.len() as f64).collect(),
        })
    }
}

/// Runs of consecutive contacts of a finger whose rounded coordinate has the same value. Returns the index of the run
/// of each contact, and the number of contacts in each run. If the value before a run is one step lower and the value
/// after it one step higher (or the reverse), the coordinate crossed the whole rounding interval during this run. The
/// errors of the run then nearly cancel, so its contacts get no index (`None`), and its length is set to 1.
fn runs(
    cloud: &Cloud,
    fingers: &[usize],
    axis: usize,
    step: f64,
) -> (Vec<Option<usize>>, Vec<f64>) {
    let first = cloud.places.first().map_or(0.0, |place| place[axis]);
    let mut open: FingerMap<Option<(usize, i64)>> = FingerMap::default();
    let mut run_of = Vec::with_capacity(cloud.places.len());
    let mut lengths: Vec<f64> = Vec::new();
    let mut changes: Vec<[i64; 2]> = Vec::new();
    for (place, &finger) in cloud.places.iter().zip(fingers) {
        let level = libm::round((place[axis] - first) / step) as i64;
        let last = open.entry(finger);
        let run = match *last {
            Some((run, before)) if before == level => run,
            before => {
                let change = before.map_or(0, |(run, before)| {
                    changes[run][1] = level - before;
                    level - before
                });
                changes.push([change, 0]);
                lengths.push(0.0);
                lengths.len() - 1
            }
        };
        *last = Some((run, level));
        lengths[run] += 1.0;
        run_of.push(Some(run));
    }
    let passes = |run: usize| changes[run][0].abs() == 1 && changes[run][0] == changes[run][1];
    for run in &mut run_of {
        *run = run.filter(|&run| !passes(run));
    }
    (0..lengths.len())
        .filter(|&run| passes(run))
        .for_each(|run| lengths[run] = 1.0);
    (run_of, lengths)
}

/// A division of contacts into cells. `cell_of` contains the cell index of each contact.
pub(super) struct Cells {
    cell_of: Vec<usize>,
    pub(super) count: usize,
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
    pub(super) fn p_value(&self, values: &[f64], solution: &Solution, correlation: f64) -> f64 {
        let mut sums = vec![(0.0, 0.0); self.count];
        for (value, &cell) in values.iter().zip(&self.cell_of) {
            sums[cell].0 += value;
            sums[cell].1 += 1.0;
        }
        let between: f64 = sums.iter().map(|(sum, count)| sum * sum / count).sum();
        let total: f64 = values.iter().map(|value| value * value).sum();
        let within = (total - between).max(solution.least_variance * values.len() as f64);
        let freedom = (values.len() - self.count) as f64 / correlation;
        let of_cells = self.count.saturating_sub(solution.pose.unknowns());
        ratio_tail(
            between / correlation,
            of_cells,
            within / correlation,
            freedom.max(1.0) as usize,
        )
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
