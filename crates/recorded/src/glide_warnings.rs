//! Warnings about the contacts of a patch: values that contradict the settings, and likely mistakes.

use nalgebra::{Matrix3, Vector3};
use palpate_ep2::{
    Contact, Curvature, Method, NoiseEstimate, Patch, Quadric, Shape, ShapeFit, ShapeSettings,
};
use palpate_estimators::{GlideFit, GlideMethod};
use palpate_statistics::{
    Misfit, Number, SIGNIFICANCE_LEVEL, StatedQuantity, chi_squared_tail, evenly_spaced,
};
use palpate_study::Warning;
use palpate_study::config::{GlideEstimatorConfig, LengthUnit};

use super::frame_pair::median;
use super::glide_options::GlideOptions;
use super::misfit_warning::ReadingWords;
use super::source::ReadingSource;

/// Largest accepted ratio of the stated to the measured distance between fingers, or of the measured to the stated
/// distance. A larger ratio causes a warning.
const MAX_SPACING_RATIO: f64 = 3.0;

/// Each contact has a distance to its nearest neighbour. If the largest of these distances, divided by the second
/// largest, exceeds this ratio, a warning states that the contact with the largest distance may be an outlier.
const MAX_DISTANCE_RATIO: f64 = 3.0;
/// Largest number of contacts for which the search for a contact far from all others is made. The number is limited,
/// because the search compares all pairs of contacts.
const MAX_COMPARED: usize = 3000;

pub(super) fn spacing(patch: &Patch, options: &GlideOptions, unit: LengthUnit) -> Option<String> {
    let stated = options.inter_finger_distance?;
    let found = patch.finger_distance? * patch.frame.scale();
    let near = found / MAX_SPACING_RATIO..=found * MAX_SPACING_RATIO;
    (GlideFit::uses_finger_distance(&options.estimator) && !near.contains(&stated)).then(|| {
        let [stated, found] = [stated, found].map(Number::rounded);
        let unit = unit.as_str();
        format!(
            "the distance between fingers is stated as {stated} {unit}, but the fingers of the readings are {found} {unit} apart: is the unit right?"
        )
    })
}

/// Warning about a contact that is far from all other contacts. The fitted surface passes through such a contact even
/// if it is wrong.
pub(super) fn distant(
    contacts: &[Contact],
    unit: LengthUnit,
    row: &dyn Fn(usize) -> String,
) -> Option<String> {
    if contacts.len() > MAX_COMPARED {
        return None;
    }
    let nearest = |place: usize| {
        let others = (0..contacts.len()).filter(|other| *other != place);
        let distance = |other: usize| (contacts[other].position - contacts[place].position).norm();
        (others.map(distance).fold(f64::INFINITY, f64::min), place)
    };
    let mut distances: Vec<(f64, usize)> = (0..contacts.len()).map(nearest).collect();
    distances.sort_by(|(one, _), (other, _)| other.total_cmp(one));
    let [(far, contact), (next, _), ..] = distances[..] else {
        return None;
    };
    (far > MAX_DISTANCE_RATIO * next && next > 0.0).then(|| {
        let ([far, next], unit) = ([far, next].map(Number::rounded), unit.as_str());
        format!(
            "the contact of {} is {far} {unit} from the nearest other contact, but all other contacts are within {next} {unit} of their neighbours: is it a contact?",
            row(contact)
        )
    })
}

/// Largest accepted ratio of the estimated to the stated standard deviation of the noise, or of the stated to the
/// estimated standard deviation. A larger ratio makes the intervals wrong, so it causes a warning.
const MAX_NOISE_RATIO: f64 = 1.5;

/// Noise of contacts, estimated by a fit that does not use the stated noise.
pub(super) struct FoundNoise {
    noise: NoiseEstimate,
    /// Root mean square (1/length) of the principal curvatures of the fitted surface.
    bending: f64,
    /// A fitted contact may be the mean of several recorded contacts and then has less noise. These are the standard
    /// deviations of its position and of its normal, divided by those of a recorded contact.
    ratios: [f64; 2],
    /// Degrees of freedom of the estimated noise: of the positions, and of one component of the normals.
    freedoms: [f64; 2],
}

impl FoundNoise {
    /// Noise from a fit of a graph by the method `estimator`. `None` if this fit does not determine the noise.
    pub(super) fn of_graph(
        patch: &Patch,
        estimator: &GlideEstimatorConfig,
        ratios: [f64; 2],
    ) -> Option<Self> {
        let GlideMethod::Graph(method) = GlideMethod::of(estimator, None) else {
            return None;
        };
        let fit = method.fit(patch).ok()?;
        let centre = fit.centre().ok()?;
        let left = 1.0 - fit.effective_unknowns / patch.equations() as f64;
        Some(Self {
            noise: fit.noise?,
            bending: centre.k_min.hypot(centre.k_max) / 2.0_f64.sqrt(),
            ratios,
            freedoms: [left * patch.samples.len() as f64; 2],
        })
    }

    /// `None` if the contacts do not determine the noise, or if they are not on a plane, sphere or cylinder.
    pub(super) fn of_shape(fit: &ShapeFit, contacts: &[Contact]) -> Option<Self> {
        let settings = ShapeSettings {
            shape: Some(fit.shape),
            ..ShapeSettings::default()
        };
        let found = settings.fit(contacts).ok()?;
        let curvature = found.curvature.value?;
        let count = found.readings.distinct as f64;
        let has_normals = contacts.iter().any(|one| one.normal.is_some());
        let equations = if has_normals { 3.0 } else { 1.0 } * count;
        let left = (1.0 - fit.shape.unknowns() as f64 / equations) * count;
        let bending = match fit.shape {
            Shape::Cylinder => curvature / 2.0_f64.sqrt(),
            Shape::Plane | Shape::Sphere => curvature,
        };
        let mut noise = found.noise.filter(|_| !fit.is_none_of_these())?;
        // Errors of positions tilt the normals. The estimated noise of the normals does not contain these tilts.
        let tilt = bending * noise.position_std;
        noise.normal_std_rad = noise.normal_std_rad.map(|std| std.hypot(tilt));
        Some(Self {
            noise,
            bending,
            ratios: [1.0; 2],
            freedoms: [
                left / found.readings.position_correlation,
                left / found.readings.normal_correlation,
            ],
        })
    }
}

/// Warnings if the user stated the noise `stated`, but the contacts have the noise `found`, which is clearly different.
pub(super) fn stated_noise(
    stated: [Option<f64>; 2],
    found: &FoundNoise,
    unit: LengthUnit,
) -> Vec<Warning> {
    let (noise, ratios) = (&found.noise, found.ratios);
    // Errors of positions tilt the normals of a curved surface. These tilts are not part of the stated noise.
    let tilt = found.bending * noise.position_std / ratios[1];
    let tilts = [0.0, tilt.to_degrees()];
    let sizes = [
        Some(noise.position_std / ratios[0]),
        noise.normal_std_rad.map(|std| std.to_degrees() / ratios[1]),
    ];
    let [of_positions, of_normals] = found.freedoms;
    let kinds = [
        ("positions", unit.as_str(), of_positions),
        ("normals", "degrees", 2.0 * of_normals),
    ];
    let all = stated.into_iter().zip(sizes).zip(tilts).zip(kinds);
    all.filter_map(|(((stated, found), tilt), (noise_of, unit, freedom))| {
        let (stated, found) = stated.zip(found)?;
        let ratio = found / f64::hypot(stated, tilt);
        let without_tilt = (found * found - tilt * tilt).max(0.0).sqrt();
        let estimated = without_tilt.max(stated * ratio);
        let freedom = freedom.max(1.0);
        let larger = chi_squared_tail(freedom * ratio * ratio, freedom.round() as usize);
        let p_value = 2.0 * larger.min(1.0 - larger);
        let is_far = ratio.max(ratio.recip()) > MAX_NOISE_RATIO && p_value < SIGNIFICANCE_LEVEL;
        let words = ReadingWords {
            reading: &|_| String::new(),
            noise_of,
            unit,
        };
        is_far.then(|| {
            words.warning(&Misfit::Stated {
                quantity: StatedQuantity::Noise,
                stated,
                estimated,
                p_value,
            })
        })
    })
    .collect()
}

/// Warnings about misfits. If the normals are wrong, outliers are not reported, because the wrong normals cause them.
pub(super) fn misfit_warnings(
    misfits: &[Misfit],
    are_normals_wrong: bool,
    source: &ReadingSource,
) -> impl Iterator<Item = Warning> {
    misfits.iter().filter_map(move |misfit| {
        let words = ReadingWords {
            reading: &|contact| format!("the contact of {}", source.row(contact)),
            noise_of: "contacts",
            unit: "",
        };
        let is_caused = are_normals_wrong && matches!(misfit, Misfit::Outlier { .. });
        (!is_caused).then(|| words.warning(misfit))
    })
}

/// Largest accepted deviation of a normal's length from 1. Rounding or noise of the components can explain smaller
/// deviations.
const MAX_LENGTH_ERROR: f64 = 0.1;

/// Smallest and largest usual extent (m) of the contacts of a glide.
const USUAL_EXTENTS: [f64; 2] = [1e-4, 10.0];

/// Smallest and largest usual curvature of an object that is clearly not flat, times the extent of the contacts. Other
/// curvatures occur if one coordinate is in another unit than the others.
const USUAL_CURVATURES: [f64; 2] = [2e-3, 100.0];
/// Smallest usual range of a coordinate along the surface, divided by the largest range of a coordinate.
const MIN_RANGE: f64 = 0.01;
/// A coordinate is along the surface if the component of the mean normal along its axis is smaller than this value.
const MAX_FACING: f64 = 0.7;
/// Smallest usual radius of fingertips, relative to the extent of the contacts.
const MIN_TIP_RADIUS: f64 = 2.5e-3;

/// Question about a coordinate along the surface whose range is far smaller than that of another coordinate, although
/// there are several fingers. `normal` is the surface's normal; it is used if the contacts have no normals.
pub(super) fn narrow(contacts: &[Contact], normal: &Vector3<f64>) -> Option<String> {
    let first = contacts.first()?;
    let (mut low, mut high) = (first.position, first.position);
    for contact in contacts {
        low = low.inf(&contact.position);
        high = high.sup(&contact.position);
    }
    let ranges = high - low;
    let measured: Vector3<f64> = contacts.iter().filter_map(|one| one.normal).sum();
    let normal = measured.try_normalize(0.0).unwrap_or(*normal);
    let is_narrow =
        |axis: &usize| normal[*axis].abs() < MAX_FACING && ranges[*axis] < MIN_RANGE * ranges.max();
    let axis = (0..3).find(is_narrow)?;
    let has_fingers = contacts.iter().any(|one| one.finger != first.finger);
    has_fingers.then(|| {
        let [narrow, wide] = [ranges[axis], ranges.max()].map(Number::rounded);
        let [axis, other] = [axis, ranges.imax()].map(|axis| ["x", "y", "z"][axis]);
        format!(
            "{axis} has a range of only {narrow}, but {other} one of {wide}: do x, y and z have the same unit?"
        )
    })
}

/// Text about contacts whose extent is unusual for a stated unit of m, cm or mm, for the radius of the fingertips or for
/// the estimated curvature. `None` if the extent is usual.
pub(super) fn extent(
    contacts: &[Contact],
    unit: LengthUnit,
    tip_radius: Option<f64>,
    curvature: &Curvature,
) -> Option<String> {
    let first = contacts.first()?.position;
    let distances = contacts.iter().map(|one| (one.position - first).norm());
    let extent = distances.fold(0.0, f64::max);
    let is_outside = |number: f64, [least, most]: [f64; 2]| number < least || number > most;
    let metres = unit.to(LengthUnit::M).filter(|_| unit != LengthUnit::Um);
    let is_unusual = metres.is_some_and(|metres| is_outside(extent * metres, USUAL_EXTENTS));
    let is_unusual = is_unusual && extent > 0.0;
    let mean = curvature.mean.abs();
    let is_clear = curvature
        .uncertainty
        .is_some_and(|one| mean > 10.0 * one.mean_std);
    let is_mixed = is_clear && is_outside(mean * extent, USUAL_CURVATURES);
    let tip_radius = tip_radius.filter(|&one| 0.0 < one && one < MIN_TIP_RADIUS * extent);
    let (extent, unit) = (Number::rounded(extent), unit.as_str());
    let cause = match tip_radius {
        _ if is_unusual => format!("are their positions in {unit}?"),
        Some(radius) => format!("is setting `tip_radius`, {radius}, in {unit} too?"),
        None if is_mixed => "do x, y and z have the same unit?".to_owned(),
        None => return None,
    };
    Some(format!(
        "all contacts are within {extent} {unit} of the first contact: {cause}"
    ))
}

/// Warnings about likely mistakes in the normals of contacts.
pub(super) fn normals(contacts: &[Contact]) -> impl Iterator<Item = Warning> {
    let all = || contacts.iter().filter_map(|contact| contact.normal);
    let middle = median(all().map(|normal| normal.norm()));
    let length = middle.filter(|length| (length - 1.0).abs() > MAX_LENGTH_ERROR);
    let length = length.map(|length| {
        format!(
            "the normals have lengths of about {}, not 1: are they angles instead of unit vectors?",
            Number::rounded(length)
        )
    });
    let mean: Vector3<f64> = all().filter_map(|normal| normal.try_normalize(0.0)).sum();
    let is_down = mean.z < -0.5 * contacts.len() as f64;
    let inward = is_down.then(|| {
        "the normals point to -z: unless the object is touched from below, they point inward, convex and concave are swapped, and a stated tip radius is on the wrong side".to_owned()
    });
    let length = Warning::of("units", length);
    length.into_iter().chain(Warning::of("signs", inward))
}

/// Smallest number of contacts for which signs and columns of the normals are checked.
const MIN_CONTACTS: usize = 8;
/// Largest number of contacts with which the directions of the normals are checked. If there are more contacts, only an
/// evenly spaced selection is used.
const MAX_CONTACTS: usize = 2000;

/// A warning about the normals is shown if swapped or reversed components decrease the error of the fit to contacts and
/// normals by more than this factor.
const MIN_RATIO: f64 = 2.0;

/// Contacts and normals count as consistent if the relative error of a quadric surface that is fitted to them (see
/// [`fit_error`]) is below this value.
const MAX_ERROR: f64 = 0.1;

/// Text about a likely mistake in the normals: swapped columns or a wrong sign. The normals are compared with a quadric
/// surface that is fitted to the contacts. A mistake is likely if a swap or a reversed sign of components improves the
/// fit clearly. `None` if no mistake is likely.
pub(super) fn directions(contacts: &[Contact]) -> Option<String> {
    let has_normals = contacts.iter().all(|contact| contact.normal.is_some());
    if !has_normals || contacts.len() < MIN_CONTACTS {
        return None;
    }
    let selection = evenly_spaced(contacts.len(), MAX_CONTACTS);
    let contacts: Vec<Contact> = selection.map(|contact| contacts[contact]).collect();
    let own = fit_error(&contacts, &Matrix3::identity());
    let changed = changes().map(|(change, name)| (fit_error(&contacts, &change), name));
    let (least, name) = changed
        .into_iter()
        .min_by(|(one, _), (other, _)| one.total_cmp(other))?;
    (own > MIN_RATIO * least && least < MAX_ERROR).then(|| {
        let times = match (own / least).is_finite() {
            true => format!("{} times ", Number::rounded(own / least)),
            false => String::new(),
        };
        format!(
            "the normals contradict the positions of the contacts and would fit them {times}better with {name}: are columns swapped, or is a sign wrong?"
        )
    })
}

/// Error of a quadric surface that is fitted to the contacts, after the normals are multiplied by `change`. It is the
/// geometric mean of the relative errors of the height and both slopes; infinite if the fit is impossible.
fn fit_error(contacts: &[Contact], change: &Matrix3<f64>) -> f64 {
    let changed = contacts.iter().map(|contact| Contact {
        normal: contact.normal.map(|normal| change * normal),
        ..*contact
    });
    let patch = Patch::new(&changed.collect::<Vec<_>>(), &Vector3::z());
    let fit = patch.and_then(|patch| Quadric::default().fit(&patch));
    let noise = fit
        .ok()
        .and_then(|fit| Some((fit.frame.scale(), fit.noise?)));
    let error = noise.and_then(|(scale, noise)| {
        let slope = noise.normal_std_rad?;
        Some(libm::cbrt(noise.position_std / scale * slope * slope))
    });
    error.unwrap_or(f64::INFINITY)
}

/// Changes of the normals that correct a possible mistake: two components are swapped, or the sign of one component is
/// reversed. Normals with all signs reversed are not in this list: they point inward, and have a warning of their own.
fn changes() -> [(Matrix3<f64>, &'static str); 6] {
    let signs = |x, y, z| Matrix3::from_diagonal(&Vector3::new(x, y, z));
    let swap = |one: usize, other: usize| {
        let mut change = Matrix3::identity();
        change.swap_columns(one, other);
        change
    };
    [
        (signs(-1.0, 1.0, 1.0), "the sign of normal_x reversed"),
        (signs(1.0, -1.0, 1.0), "the sign of normal_y reversed"),
        (signs(1.0, 1.0, -1.0), "the sign of normal_z reversed"),
        (swap(0, 1), "normal_x and normal_y swapped"),
        (swap(0, 2), "normal_x and normal_z swapped"),
        (swap(1, 2), "normal_y and normal_z swapped"),
    ]
}
