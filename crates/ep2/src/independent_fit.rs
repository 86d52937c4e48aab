//! Fits to logs whose contacts are not independent, because of copies, resting fingers, and noise that is correlated
//! along a stroke.

use nalgebra::{Vector2, Vector3};
use palpate_statistics::evenly_spaced;

use crate::effective_readings::{
    DistinctContacts, EffectiveReadings, correlation_time, distinct_contacts,
};
use crate::patch::{by_finger, check};
use crate::{
    Contact, Ep2Error, Fit, MapPoint, Method, Patch, Penalised, StrokeCurvature, stroke_curvature,
};

/// Smallest number of contacts of a finger from which the correlation of its noise is estimated.
const MIN_CONTACTS: usize = 60;
/// In the first fit, each stroke is divided into this number of groups of consecutive contacts. The fit uses the means
/// of the groups, so that correlated noise has little effect on it.
const FIRST_MEANS: usize = 30;
/// Consecutive contacts may be replaced by their means. The longest stroke must then have at least this number of
/// means.
const MIN_MEANS: usize = 8;
/// Two surfaces are compared: one is fitted to means of contacts, the other to all contacts. Let r be the contacts'
/// root-mean-square distance from the first surface, divided by their distance from the second. This constant is the
/// largest accepted r. At a larger r, the surface through the means is too smooth.
const MAX_RESIDUAL_RATIO: f64 = 2.0;
/// Limit that replaces [`MAX_RESIDUAL_RATIO`] if consecutive contacts have correlated distances from the surface that
/// is fitted to all contacts. At a smaller ratio, the correlation comes from the noise, and the surface through all
/// contacts follows a part of this noise. At a larger ratio, the correlation comes from the object, whose shape no
/// spline follows.
const MAX_CORRELATED_RATIO: f64 = 3.0;
/// The distances of the contacts from a surface count as correlated if at least this number of consecutive distances
/// counts as one independent distance.
const MIN_CORRELATION: f64 = 1.5;
/// The assumed correlation length of the noise determines how many consecutive contacts are averaged before a fit. If
/// the correlation length of the residuals exceeds the assumed length by more than this factor, the fit is repeated
/// with the correlation length of the residuals.
const MAX_GROWTH: f64 = 1.3;

/// Largest number of contacts in a fit. In larger logs, consecutive contacts are replaced by their means. A surface
/// that is fitted to more contacts without averaging would follow their errors across a stroke.
const MAX_FITTED: usize = 10_000;
/// The noise of positions moves the contacts of a stroke across it, but their heights do not follow the surface's slope
/// there. A surface that is fitted to many contacts without normals is therefore too level on the strokes. Groups of
/// consecutive contacts are replaced by their means as long as the root-mean-square distance of the contacts from these
/// means, relative to that from the mean of all contacts, is below this value.
const MAX_MEAN_RATIO: f64 = 0.02;
/// Limit of a test whether the contacts of a finger are in the order of its path. The test divides the root-mean-square
/// distance of the contacts from the means of consecutive contacts by that from the mean of all contacts. Above this
/// limit, the contacts have no order, and means of consecutive contacts are not used.
const MAX_BLOCK_RATIO: f64 = 0.05;
/// Correlated noise is looked for only if the mean distance of consecutive contacts, relative to the spread of all
/// contacts, is below this limit. Otherwise the contacts have no order.
const MAX_PAIR_RATIO: f64 = 0.3;
/// The path of a stroke is smooth if the second differences between successive means of its contacts are small. This
/// constant is the largest second difference on a smooth path. It is relative to the distance between the mean before
/// and the mean after.
const MAX_BEND: f64 = 0.25;
/// With at most this number of strokes, the heights do not determine the fourth derivative of the surface across the
/// strokes.
const MAX_FEW_STROKES: usize = 4;
/// Largest number of effective degrees of freedom of a surface that counts as a quadric.
const MAX_QUADRIC_UNKNOWNS: f64 = 7.5;
/// The standard errors are multiplied by this factor if the surface is no quadric and there are few strokes. The fit
/// then assumes that the surface is as rough across the strokes as along them, but waves may be rougher across.
const FEW_STROKES_FACTOR: f64 = 1.25;
/// Smallest gap between the contacts of two neighbouring strokes, relative to the width of the patch across the
/// strokes.
const MIN_GAP: f64 = 0.1;

/// A fit to the independent contacts of a log, and the contacts to which it was fitted.
#[derive(Clone, Debug)]
pub struct IndependentFit {
    /// The fitted contacts, in which copies and the contacts of resting fingers are merged. If the noise is correlated,
    /// the fitted contacts are means of consecutive contacts.
    pub contacts: Vec<Contact>,
    /// The patch that these contacts form.
    pub patch: Patch,
    /// The fitted surface. Its noise is the noise of a single contact.
    pub fit: Fit,
    /// For each fitted contact, the index of a row of the log: the first of the rows that were merged into the contact.
    pub rows: Vec<usize>,
    /// Number of independent readings in the log.
    pub readings: EffectiveReadings,
    /// Standard deviations of the errors of positions and of normals in `patch`, divided by those of a single contact
    /// of the log.
    pub noise_ratios: [f64; 2],
}

/// Means of consecutive contacts. For each mean, `rows` contains the index of its first row in the log.
struct Means {
    contacts: Vec<Contact>,
    rows: Vec<usize>,
}

/// A log in which copies and the contacts of resting fingers are merged, and the method by which it is fitted.
struct Log<'a, M> {
    method: &'a dyn Fn([f64; 2]) -> M,
    outward: &'a Vector3<f64>,
    count: usize,
    distinct: DistinctContacts,
    /// For each finger, the indices of its contacts in `distinct`.
    strokes: Vec<Vec<usize>>,
    /// In a fit that assumes independent noise, each group of this number of consecutive contacts is replaced by its
    /// mean.
    block: usize,
}

impl IndependentFit {
    /// Fits the contacts of a log. `distinct` are the merged contacts of [`SoundContacts`](crate::SoundContacts), if
    /// they were already computed. `method` receives one factor for positions and one for normals. It returns the
    /// method, with its stated standard deviations multiplied by these factors.
    ///
    /// # Errors
    /// Errors of [`Patch::new`] and of the method. The number of a contact in an error is its index in `contacts`.
    pub fn new<M: Method>(
        method: impl Fn([f64; 2]) -> M,
        contacts: &[Contact],
        distinct: Option<DistinctContacts>,
        outward: &Vector3<f64>,
    ) -> Result<Self, Ep2Error> {
        let distinct = match distinct {
            Some(distinct) => distinct,
            None => {
                check(contacts.iter().enumerate())?;
                distinct_contacts(contacts)
            }
        };
        if distinct.contacts.len() == 1 && contacts.len() > 1 {
            let (contacts, extent) = (contacts.len(), 0.0);
            return Err(Ep2Error::Coincident { contacts, extent });
        }
        let mut log = Log {
            method: &method,
            outward,
            count: contacts.len(),
            strokes: by_finger(&distinct.contacts),
            block: distinct.contacts.len().div_ceil(MAX_FITTED),
            distinct,
        };
        let has_normals = contacts.iter().all(|one| one.normal.is_some());
        let longest = log.strokes.iter().map(Vec::len).max().unwrap_or_default();
        let has_enough = |block: usize| !has_normals && block * MIN_MEANS <= longest;
        while has_enough(2 * log.block)
            && log.spread_of_blocks(2 * log.block) < MAX_MEAN_RATIO.powi(2)
        {
            log.block *= 2;
        }
        if log.block > 1 && log.spread_of_blocks(log.block) > MAX_BLOCK_RATIO * MAX_BLOCK_RATIO {
            let count = log.distinct.contacts.len();
            let mut is_selected = vec![false; count];
            evenly_spaced(count, MAX_FITTED).for_each(|one| is_selected[one] = true);
            let strokes = log.strokes.iter_mut();
            strokes.for_each(|stroke| stroke.retain(|&one| is_selected[one]));
            log.strokes.retain(|stroke| !stroke.is_empty());
            log.block = 1;
        }
        log.fit()
    }

    /// Increases the standard errors where the model of the fit is too simple.
    ///
    /// A quadric (`is_quadric`) is biased on most other shapes. Therefore its estimate is compared with a penalised
    /// spline. The mean square error of the quadric is at least the squared difference between both estimates, plus the
    /// variance of the spline.
    ///
    /// Heights on up to four strokes, or heights and normals on two strokes, do not show whether the surface bends like
    /// a circle or like a parabola across the strokes. The standard error of the mean curvature is at least the
    /// difference between circle and parabola, also for exact contacts.
    ///
    /// # Errors
    /// [`Ep2Error::Undetermined`] for two strokes without normals, and the errors of [`Fit::centre`].
    pub fn widen_by_bias(
        &mut self,
        outward: &Vector3<f64>,
        is_quadric: bool,
    ) -> Result<(), Ep2Error> {
        if self.are_two_strokes(outward) {
            return Err(Ep2Error::Undetermined {
                contacts: self.contacts.len(),
                rank: 5,
                unknowns: 6,
            });
        }
        let centre = self.fit.centre()?;
        let Some(stds) = centre.curvature.uncertainty else {
            return Ok(());
        };
        let of_strokes = self.bias_across_strokes(&centre) / stds.mean_std;
        let is_rough = self.fit.effective_unknowns > MAX_QUADRIC_UNKNOWNS;
        let factor = match is_rough && of_strokes > 0.0 && !self.patch.has_normals() {
            true => of_strokes.max(FEW_STROKES_FACTOR),
            false => of_strokes,
        };
        let spline = is_quadric.then(|| Penalised::default().fit(&self.patch).ok());
        let curvature = |spline: Fit| spline.curvature_at(&centre.position).ok();
        let of_spline = spline.flatten().and_then(curvature);
        let of_bias = of_spline.map(|other| {
            let [mean_std, gaussian_std] = match other.uncertainty {
                Some(other) => [other.mean_std, other.gaussian_std],
                None => [0.0; 2],
            };
            let of_mean = (other.mean - centre.curvature.mean).hypot(mean_std);
            let of_gaussian = (other.gaussian - centre.curvature.gaussian).hypot(gaussian_std);
            (of_mean / stds.mean_std).max(of_gaussian / stds.gaussian_std)
        });
        let factor = of_bias.map_or(factor, |of_bias| of_bias.max(factor));
        let posterior = self.fit.posterior.as_mut();
        if let Some(posterior) = posterior.filter(|_| factor > 1.0 && factor.is_finite()) {
            posterior.widen(factor * factor);
        }
        Ok(())
    }

    /// Removes the normals from the noise of this fit: uses the correlation of the positions from `stroke`, sets the
    /// correlation of the normals to 1, and deletes their standard deviation. Call this if the fit used the normals of
    /// [`StrokeCurvature::with_normals`], which are computed, not measured.
    pub fn without_normals(&mut self, stroke: &StrokeCurvature) {
        self.readings.position_correlation = stroke.correlation;
        self.readings.normal_correlation = 1.0;
        if let Some(noise) = &mut self.fit.noise {
            noise.normal_std_rad = None;
        }
    }

    /// Whether the contacts are two strokes without normals. The fit of a quadric is then not unique, because any
    /// multiple of a quadric that is 0 on both strokes can be added. This must be tested here: if the contacts have
    /// noise across the strokes, the equations of the fit seem to have a unique solution.
    fn are_two_strokes(&self, outward: &Vector3<f64>) -> bool {
        if self.patch.has_normals() {
            return false;
        }
        let contacts = |rows: Vec<usize>| rows.iter().map(|&row| self.contacts[row]).collect();
        let fingers = by_finger(&self.contacts)
            .into_iter()
            .map(contacts)
            .collect();
        let by_gap = self.strokes().1;
        let is_stroke = |contacts: &Vec<Contact>| stroke_curvature(contacts, outward).is_some();
        let are_two = |strokes: &Vec<_>| strokes.len() == 2 && strokes.iter().all(is_stroke);
        // Noise may leave a gap in a single stroke, so that it seems to be two strokes side by side. Therefore all
        // contacts together must not form one stroke.
        [fingers, by_gap].iter().any(are_two) && !is_stroke(&self.contacts)
    }

    /// The axis of the patch across the strokes, and the contacts of each stroke. Gaps across the strokes separate
    /// them, because a finger may move to and fro along several strokes.
    fn strokes(&self) -> (usize, Vec<Vec<Contact>>) {
        let frame = &self.fit.frame;
        // The strokes run along the axis along which successive contacts of a finger are farther apart. Among many
        // contacts, compare contacts that are so far apart that their noise does not matter.
        let lag = (self.contacts.len() / 100).max(1);
        let pairs = self.contacts.iter().zip(&self.contacts[lag..]);
        let pairs = pairs.filter(|(one, other)| one.finger == other.finger);
        let steps = pairs.map(|(one, other)| frame.direction(&(other.position - one.position)));
        let steps: Vector2<f64> = steps.map(|step| step.xy().abs()).sum();
        let axis = usize::from(steps.x > steps.y);
        let [low, high] = self.fit.domain[axis];
        let across = |&contact: &usize| frame.point(&self.contacts[contact].position)[axis];
        let mut order: Vec<usize> = (0..self.contacts.len()).collect();
        order.sort_by(|one, other| across(one).total_cmp(&across(other)));
        let is_near =
            |one: &usize, other: &usize| across(other) - across(one) <= MIN_GAP * (high - low);
        let strokes = order.chunk_by_mut(is_near).map(|stroke| {
            stroke.sort_unstable();
            stroke.iter().map(|&one| self.contacts[one]).collect()
        });
        (axis, strokes.collect())
    }

    /// Assumed bias of the mean curvature at `centre`, 1/length: the difference between the mean curvatures of two
    /// surfaces, which bend like a circle and like a parabola across the strokes. Few strokes do not show which of the
    /// two curves is right. The bias is 0 if there are more than four strokes, or more than two strokes with normals.
    fn bias_across_strokes(&self, centre: &MapPoint) -> f64 {
        let place = self.fit.frame.point(&centre.position);
        let jet = self.fit.jet(place.x, place.y);
        let (axis, strokes) = self.strokes();
        let curvature = if axis == 1 {
            jet.vv.abs()
        } else {
            jet.uu.abs()
        };
        let [low, high] = self.fit.domain[axis];
        let few = if self.patch.has_normals() {
            2
        } else {
            MAX_FEW_STROKES
        };
        if !(2..=few).contains(&strokes.len()) {
            return 0.0;
        }
        let angle = 0.5 * curvature * (high - low);
        0.5 * 0.25 * curvature * angle * angle / self.fit.frame.scale()
    }

    /// Returns two results. The first is the root-mean-square distance of the contacts from the surface, in the unit of
    /// the patch. The second contains two numbers, one for distances and one for normals: the number of consecutive
    /// values that count as one, because their errors are correlated.
    fn correlations<M>(&self, log: &Log<'_, M>) -> (f64, [f64; 2]) {
        let (mut distances, mut tilts) = (Vec::new(), Vec::new());
        let (mut square, mut count) = (0.0, 0.0);
        for stroke in &log.strokes {
            let mut residuals = [const { Vec::new() }; 3];
            for &index in stroke {
                let contact = &log.distinct.contacts[index];
                let place = self.fit.frame.point(&contact.position);
                let jet = self.fit.jet(place.x, place.y);
                let steepness = (1.0 + jet.u * jet.u + jet.v * jet.v).sqrt();
                let distance = (place.z - jet.w) / steepness;
                residuals[0].push(distance);
                square += distance * distance;
                count += 1.0;
                if let Some(normal) = contact.normal {
                    let normal = self.fit.frame.direction(&normal.normalize());
                    let expected = Vector3::new(-jet.u, -jet.v, 1.0) / steepness;
                    residuals[1].push(normal.x - expected.x);
                    residuals[2].push(normal.y - expected.y);
                }
            }
            let [of_stroke, along, across] = residuals;
            distances.push(of_stroke);
            tilts.extend([along, across]);
        }
        // Positions and normals together determine the fitted parameters. Therefore attribute half of the effective
        // degrees of freedom to the positions and half to the normals.
        let kinds = if self.patch.has_normals() { 2.0 } else { 1.0 };
        let absorbed = (self.fit.effective_unknowns / kinds) as usize;
        let of_tilts = match self.patch.has_normals() {
            true => correlation_time(&tilts, absorbed),
            false => 1.0,
        };
        let times = [correlation_time(&distances, absorbed), of_tilts];
        ((square / f64::max(count, 1.0)).sqrt(), times)
    }

    fn with(mut self, [position, normal]: [f64; 2], variance: f64) -> Self {
        self.readings.position_correlation = position;
        self.readings.normal_correlation = normal;
        if let Some(posterior) = self.fit.posterior.as_mut().filter(|_| variance > 1.0) {
            posterior.widen(variance);
        }
        self
    }
}

impl<M: Method> Log<'_, M> {
    fn fit(&self) -> Result<IndependentFit, Ep2Error> {
        let longest = self.strokes.iter().map(Vec::len).max().unwrap_or(0);
        let is_ordered = || self.spread_of_blocks(2) < MAX_PAIR_RATIO * MAX_PAIR_RATIO;
        let first = match longest >= MIN_CONTACTS && is_ordered() {
            true => self.of_means(longest.div_ceil(FIRST_MEANS), [1.0; 2]).ok(),
            false => None,
        };
        // A fit without a posterior has no standard errors that could be corrected for correlated noise, so ignore it.
        let first = first.filter(|first| first.fit.posterior.is_some());
        let mut found = first.map_or([1.0; 2], |first| first.correlations(self).1);
        let plain = self.of_means(self.block, [1.0; 2])?;
        if found == [1.0; 2] {
            return Ok(plain);
        }
        let largest = |times: [f64; 2]| times[0].max(times[1]);
        let mut best = None;
        for _ in 0..2 {
            let block = (2.0 * largest(found)).ceil() as usize;
            let block = block.min(longest / MIN_MEANS).max(self.block);
            let Ok(fit) = self.of_means(block, found) else {
                break;
            };
            let (residual, times) = fit.correlations(self);
            let is_longer = largest(times) > MAX_GROWTH * largest(found);
            best = Some((
                fit.with(found, 2.0 * largest(found) / block as f64),
                residual,
            ));
            if !is_longer {
                break;
            }
            found = times;
        }
        let (residual, times) = plain.correlations(self);
        let largest_ratio = match times[0] >= MIN_CORRELATION {
            true => MAX_CORRELATED_RATIO,
            false => MAX_RESIDUAL_RATIO,
        };
        Ok(match best {
            Some((fit, of_means)) if of_means <= largest_ratio * residual => fit,
            _ => plain.with(times, largest(times)),
        })
    }

    /// Sum of the squared distances of all contacts from the mean of their block of `size` consecutive contacts,
    /// divided by the same sum for a single block of all contacts. It is small if the contacts of each finger are in
    /// the order of its path, so that consecutive contacts are neighbours.
    fn spread_of_blocks(&self, size: usize) -> f64 {
        let contacts = &self.distinct.contacts;
        let square = |part: &[usize]| {
            let places = || {
                part.iter()
                    .map(|&one| contacts[one].position - contacts[part[0]].position)
            };
            let mean = places().sum::<Vector3<f64>>() / part.len() as f64;
            places()
                .map(|place| (place - mean).norm_squared())
                .sum::<f64>()
        };
        let all: Vec<usize> = (0..contacts.len()).collect();
        let blocks = self.strokes.iter().flat_map(|stroke| stroke.chunks(size));
        blocks.map(square).sum::<f64>() / square(&all)
    }

    /// Fits the means of every `block` consecutive contacts of each finger. `times` contains two numbers, one for
    /// positions and one for normals: the number of consecutive values that count as one, because their noise is
    /// correlated.
    fn of_means(&self, block: usize, times: [f64; 2]) -> Result<IndependentFit, Ep2Error> {
        let means = self.means(block);
        // If noise is correlated over more contacts than are averaged, averaging does not reduce the noise. Then the
        // noise of a mean is as large as that of a single contact.
        let ratios = times.map(|time| (time / block as f64).min(1.0).sqrt());
        let at_row = |error: Ep2Error| match error {
            Ep2Error::Folded { contact, angle_deg } => Ep2Error::Folded {
                contact: means.rows[contact],
                angle_deg,
            },
            error => error,
        };
        let patch = Patch::new(&means.contacts, self.outward).map_err(at_row)?;
        let mut fit = (self.method)(ratios).fit(&patch)?;
        if let Some(noise) = &mut fit.noise {
            noise.position_std /= ratios[0];
            noise.normal_std_rad = noise.normal_std_rad.map(|std| std / ratios[1]);
        }
        let readings = EffectiveReadings {
            contacts: self.count,
            distinct: self.distinct.contacts.len(),
            position_correlation: 1.0,
            normal_correlation: 1.0,
        };
        Ok(IndependentFit {
            contacts: means.contacts,
            patch,
            fit,
            rows: means.rows,
            readings,
            noise_ratios: ratios,
        })
    }

    fn means(&self, block: usize) -> Means {
        let DistinctContacts {
            contacts,
            run_of_row,
        } = &self.distinct;
        let mut rows = vec![usize::MAX; contacts.len()];
        for (row, &run) in run_of_row.iter().enumerate() {
            rows[run] = rows[run].min(row);
        }
        let count = self.strokes.iter().map(Vec::len).sum::<usize>();
        if block <= 1 && count == contacts.len() {
            let contacts = contacts.clone();
            return Means { contacts, rows };
        }
        let mut means = Means {
            contacts: Vec::new(),
            rows: Vec::new(),
        };
        for stroke in &self.strokes {
            let blocks = (stroke.len() / block).max(1);
            let before = means.contacts.len();
            for index in 0..blocks {
                let part = index * stroke.len() / blocks..(index + 1) * stroke.len() / blocks;
                let part = &stroke[part];
                let first = contacts[part[0]];
                let share = 1.0 / part.len() as f64;
                let others = || part.iter().map(|&one| contacts[one]);
                let position = others().map(|one| (one.position - first.position) * share);
                let normals = others().filter_map(|one| one.normal?.try_normalize(0.0));
                let normal = normals.sum::<Vector3<f64>>().try_normalize(1e-6);
                means.contacts.push(Contact {
                    position: first.position + position.sum::<Vector3<f64>>(),
                    normal: first.normal.map(|first| normal.unwrap_or(first)),
                    ..first
                });
                means.rows.push(rows[part[0]]);
            }
            let size = stroke.len() as f64 / blocks as f64;
            move_onto_path(&mut means.contacts[before..], size);
        }
        means
    }
}

/// Moves the means of groups of `size` consecutive contacts onto the path of the stroke. On a bent path, a mean lies on
/// the inner side of the path. If the path is smooth, the mean's distance from the path is (1 − 1/size²)/24 times the
/// second difference of successive means.
fn move_onto_path(means: &mut [Contact], size: f64) {
    let places: Vec<_> = means.iter().map(|mean| mean.position).collect();
    if places.len() < 3 {
        return;
    }
    let share = (1.0 - 1.0 / (size * size)) / 24.0;
    for (index, mean) in means.iter_mut().enumerate() {
        let middle = index.clamp(1, places.len() - 2);
        let [before, after] = [middle - 1, middle + 1].map(|one| places[one] - places[middle]);
        let bend = before + after;
        if bend.norm() < MAX_BEND * (after - before).norm() {
            mean.position -= bend * share;
        }
    }
}
