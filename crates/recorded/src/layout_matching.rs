//! Matches the markers found in a frame at rest with the markers of the layout, and fits the camera to the matched
//! markers.

use nalgebra::DMatrix;
use palpate_chromatouch::{Departure, Optics};
use palpate_press::{ImageFit, MarkerDisplacement, Rest, Seen, SensorState};
use palpate_statistics::Number;
use palpate_study::Warning;
use palpate_study::config::LengthUnit;
use palpate_tracking::{Found, Marker};

use super::camera_file::{CameraEstimate, Residual};
use super::frame_pair::median;
use super::nominal_sensor::{NominalSensor, TERMS};
use palpate_estimators::marker_image;

/// Largest accepted difference between a disc parameter and its nominal value, in prior standard deviations.
const MAX_DEPARTURE: f64 = 6.0;
/// Index of each disc parameter in a [`Departure`] (the list of all sensor parameters' differences from their nominal
/// values), and the name of the parameter in messages.
const DISCS: [(usize, &str); 10] = [
    (0, "depth of the magenta discs"),
    (1, "depth of the yellow discs"),
    (2, "diameter of the magenta discs"),
    (3, "diameter of the yellow discs"),
    (13, "transmission of red light by the magenta discs"),
    (14, "transmission of green light by the magenta discs"),
    (15, "transmission of blue light by the magenta discs"),
    (16, "transmission of red light by the yellow discs"),
    (17, "transmission of green light by the yellow discs"),
    (18, "transmission of blue light by the yellow discs"),
];
/// Indices of the camera parameters in a [`Departure`], the list of all sensor parameters' differences from their
/// nominal values.
pub(super) const CAMERA: [usize; 11] = [4, 5, 6, 7, 8, 9, 10, 11, 12, TERMS[0], TERMS[1]];
const ROUNDS: usize = 4;
/// Standard deviations of the four numbers of a marker's image in the rough fits, which come before the final fit: both
/// centroid coordinates (px), hue (turns), and logarithm of the size. These values are large, because the misalignments
/// of the discs are still unknown.
const ROUGH_STDS: [f64; 4] = [3.0, 3.0, 0.03, 0.05];
/// Two limits for the final round of matching, as shares of the number of markers in the layout: the smallest share
/// that must be found, and the largest accepted share of other shapes in the frame.
const SHARES: [f64; 2] = [0.66, 0.2];
/// Two limits for the rough rounds of matching (before the final round), as shares of the number of markers in the
/// layout: the smallest share that must be found, and the largest accepted share of other shapes in the frame.
const ROUGH_SHARES: [f64; 2] = [0.5, 0.5];
/// Largest accepted median difference (turns) between the measured and the nominal hues of the markers.
const MAX_HUE_DIFFERENCE: f64 = 0.06;
/// Largest accepted reduced χ² of the fit to the markers at rest. If it is larger, the frame contradicts the layout.
pub(super) const CONTRADICTION: f64 = 25.0;
/// Largest reduced χ² of the fit for which the uncertainties are not increased. If the reduced χ² is larger, the
/// uncertainties are multiplied by its square root.
const MAX_REDUCED_CHI_SQUARED: f64 = 1.5;
/// Start values of the camera's height that are tried in addition to the nominal height. They are differences from the
/// nominal height, in prior standard deviations.
const HEIGHTS: [f64; 4] = [-1.0, 1.0, -2.0, 2.0];
/// Index of the camera's height (its position toward the apex) in a [`Departure`], the list of all sensor parameters'
/// differences from their nominal values.
const HEIGHT: usize = 9;
const CAUSES: &str = "possible causes: the frame is from another layout or camera; its pixels are encoded by sRGB (then use setting `srgb`); the camera differs from `place`, `turn_deg` or `field_deg` of the study's `scene.sensor`; or the discs are misaligned by more than `scene.probe.discs.misalignment`";
/// Maximum number of fits of the camera to the markers at rest. Each fit starts at the result of the previous fit.
const MAX_FITS: usize = 12;
/// The fit is repeated until χ² decreases by less than this value.
const MIN_DECREASE: f64 = 1e-3;

/// For each marker of the layout: its index in the list of found markers, and its image. `None` if the marker was not
/// found.
type Matches = (Vec<Option<usize>>, Vec<Option<Seen>>);

pub(super) struct Matched {
    /// Index of each marker of the layout in the list of found markers; `None` if the marker was not found.
    pub(super) found: Vec<Option<usize>>,
    pub(super) images: Vec<Option<Seen>>,
    rest: Rest,
    law: Vec<Option<[f64; 4]>>,
    missing: usize,
}

impl Matched {
    /// Matches the markers, starting from the nominal optics and from higher and lower camera positions. Returns the
    /// best match with its optics. Several heights are tried, because a wrong scale and lens can compensate a wrong
    /// height, and a fit may then end in a local minimum.
    pub(super) fn of(
        nominal: &NominalSensor<'_>,
        optics: &Optics,
        found: &Found,
    ) -> Result<(Self, Optics), String> {
        let from = |height: f64| {
            let mut raised = [0.0; Departure::NUMBERS];
            raised[HEIGHT] = height * nominal.stds[HEIGHT];
            let raised = optics.departed(&Departure::from(raised));
            Self::about(nominal, raised.map_err(other_layout)?, found)
        };
        HEIGHTS
            .into_iter()
            .map(from)
            .fold(from(0.0), |best, tried| {
                let is_better = match (&best, &tried) {
                    (Ok((best, _)), Ok((tried, _))) => tried.reduced() < best.reduced(),
                    (Err(_), tried) => tried.is_ok(),
                    (Ok(_), Err(_)) => false,
                };
                if is_better { tried } else { best }
            })
    }

    /// Matches the found markers with the markers of the layout, starting from the camera in `optics`. Several rough
    /// rounds of matching and fitting improve the camera; the final round has tighter limits.
    fn about(
        nominal: &NominalSensor<'_>,
        optics: Optics,
        found: &Found,
    ) -> Result<(Self, Optics), String> {
        let mut optics = optics;
        for _ in 0..ROUNDS {
            let fit = nominal.fit(&optics)?;
            let (_, images) = Self::images(nominal, &fit, found, ROUGH_SHARES)?;
            let rough: Vec<Option<Seen>> =
                images.into_iter().map(|image| image.map(roughly)).collect();
            let rest = fit.at_rest(&rough).map_err(other_layout)?;
            optics = optics.departed(&of_camera(&rest)?).map_err(other_layout)?;
        }
        let fit = nominal.fit(&optics)?;
        let (markers, images) = Self::images(nominal, &fit, found, SHARES)?;
        let missing = missing_markers(&law(&fit, None)?, &images, found, SHARES)?;
        let rest = fit.at_rest(&images).map_err(other_layout)?;
        let (fit, rest, optics) = match nominal.has_exact_lens() {
            true => (fit, rest, optics),
            false => settled(nominal, (rest, optics), &images)?,
        };
        let law = law(&fit, Some(&rest))?;
        let matched = Self {
            missing,
            law,
            rest,
            found: markers,
            images,
        };
        Ok((matched, optics))
    }

    fn images(
        nominal: &NominalSensor<'_>,
        fit: &ImageFit,
        found: &Found,
        shares: [f64; 2],
    ) -> Result<Matches, String> {
        let expected = law(fit, None)?;
        let markers = nearest(&centroids(&expected), found);
        let picture = |(at, marker): (usize, &Option<usize>)| {
            let marker = (*marker)?;
            let picture = marker_image(&found.markers[marker], &found.errors[marker]);
            Some(nominal.clear(at, picture))
        };
        let images: Vec<Option<Seen>> = markers.iter().enumerate().map(picture).collect();
        missing_markers(&expected, &images, found, shares).map(|_| (markers, images))
    }

    /// Quantity (positions, hues or sizes) in which the markers differ most from the fitted model.
    fn most_off(&self) -> &'static str {
        let mut squares = [0.0; 3];
        for (image, law) in self.images.iter().zip(&self.law) {
            if let (Some(image), Some(law)) = (image, law) {
                for (number, law) in law.iter().enumerate() {
                    let off = image.picture[number] - law;
                    squares[number.saturating_sub(1)] +=
                        off * off / image.covariance[(number, number)];
                }
            }
        }
        let most =
            (0..squares.len()).max_by(|&one, &other| squares[one].total_cmp(&squares[other]));
        ["places", "hues", "sizes"][most.unwrap_or(0)]
    }

    pub(super) fn camera(
        &self,
        nominal: &NominalSensor<'_>,
        optics: &Optics,
        length_unit: LengthUnit,
    ) -> Result<CameraEstimate, String> {
        let mut residuals_px = Vec::new();
        for (marker, pair) in self.images.iter().zip(&self.law).enumerate() {
            if let (Some(image), Some(law)) = pair {
                let [x, y] = [0, 1].map(|axis| image.picture[axis] - law[axis]);
                let px = libm::hypot(x, y);
                residuals_px.push(Residual { marker, px });
            }
        }
        let squares = residuals_px.iter().map(|one| one.px * one.px);
        let residual_px = (squares.sum::<f64>() / residuals_px.len() as f64).sqrt();
        let reduced = self.reduced();
        if reduced > CONTRADICTION {
            let all = residuals_px.iter();
            let worst = all.max_by(|one, other| one.px.total_cmp(&other.px));
            let worst = worst.map_or(0, |one| one.marker);
            return Err(format!(
                "contradicts the layout, most of all in the {} of the markers: chi-squared is {} per degree of freedom (at most {CONTRADICTION}), and the markers are {} px from their expected positions, number {worst} the farthest; {CAUSES}",
                self.most_off(),
                Number::rounded(reduced),
                Number::rounded(residual_px)
            ));
        }
        for (number, what) in DISCS {
            let (departure, std) = (self.rest.common[number], nominal.stds[number]);
            if departure.abs() > MAX_DEPARTURE * std {
                return Err(format!(
                    "contradicts the layout: the {what} would have an error of {}, but its standard deviation is {}",
                    Number::rounded(departure),
                    Number::rounded(std)
                ));
            }
        }
        let widened = scatter(reduced);
        let covariance = self.covariance(nominal, widened)?;
        let std = |number: usize| covariance[(number, number)].sqrt();
        let mut warnings = Vec::new();
        if widened > 1.0 {
            let text = format!(
                "the markers scatter {0} times as much as the frame's noise explains; uncertainties are multiplied by {0}",
                Number::rounded(widened)
            );
            warnings.push(Warning::new("scatter-at-rest", text, [("ratio", widened)]));
        }
        warnings.extend(self.warning());
        let departure: [f64; Departure::NUMBERS] = self.rest.common[..]
            .try_into()
            .map_err(|_| "has no departures".to_owned())?;
        let Departure {
            centre_px,
            px_per_rad,
            place,
            turn_rad,
            odd_terms: [k3, k5],
            ..
        } = Departure::from(departure);
        let pose = optics.pose();
        let camera = optics.camera();
        let turn = pose.turn_rad();
        let terms = camera.odd_terms().unwrap_or_default();
        // The first nine rows of the covariance are for the image centre, scale, position and rotation of the camera,
        // followed by the rows for the lens coefficients k3 and k5.
        let std_of_term = |at: usize| (nominal.stds[TERMS[at]] > 0.0).then(|| std(9 + at));
        Ok(CameraEstimate {
            length_unit,
            place: [0, 1, 2].map(|axis| pose.place[axis] + place[axis]),
            place_std: [3, 4, 5].map(std),
            turn_deg: [0, 1, 2].map(|axis| (turn[axis] + turn_rad[axis]).to_degrees()),
            turn_std_deg: [6, 7, 8].map(|number| std(number).to_degrees()),
            px_per_rad: camera.px_per_rad() * (1.0 + px_per_rad),
            px_per_rad_std: camera.px_per_rad() * std(2),
            k3: terms.k3 + k3,
            k3_std: std_of_term(0),
            k5: terms.k5 + k5,
            k5_std: std_of_term(1),
            centre_px: [0, 1].map(|axis| camera.centre_px()[axis] + centre_px[axis]),
            covariance: covariance
                .row_iter()
                .map(|row| row.iter().copied().collect())
                .collect(),
            residual_px,
            residuals_px,
            reduced_chi_squared: reduced,
            warnings,
        })
    }

    fn reduced(&self) -> f64 {
        self.rest.chi_squared / self.rest.freedom.max(1) as f64
    }

    pub(super) fn warning(&self) -> Option<Warning> {
        let (all, missing) = (self.images.len(), self.missing);
        (missing > 0).then(|| {
            let text = format!("{missing} of the layout's {all} markers are missing at rest");
            let numbers = [("missing", missing as f64), ("markers", all as f64)];
            Warning::new("missing-markers", text, numbers)
        })
    }

    /// Covariance of the camera parameters, after all standard errors of the fit are multiplied by `widened`.
    fn covariance(
        &self,
        nominal: &NominalSensor<'_>,
        widened: f64,
    ) -> Result<DMatrix<f64>, String> {
        let singular = || "does not determine the camera".to_owned();
        let shares = self.rest.covariance().ok_or_else(singular)?;
        let free: Vec<usize> = (0..nominal.stds.len())
            .filter(|&number| nominal.stds[number] > 0.0)
            .collect();
        let of_camera = (0..free.len()).filter(|&at| CAMERA.contains(&free[at]));
        let places: Vec<usize> = of_camera.collect();
        let std = |at: usize| widened * nominal.stds[free[places[at]]];
        let size = places.len();
        Ok(DMatrix::from_fn(size, size, |row, column| {
            shares[(places[row], places[column])] * std(row) * std(column)
        }))
    }
}

/// Factor by which the stated errors of the markers are multiplied: the square root of `reduced` (the reduced χ² of the
/// fit) if `reduced` is above `MAX_REDUCED_CHI_SQUARED`, otherwise 1.
pub(super) fn scatter(reduced: f64) -> f64 {
    match reduced > MAX_REDUCED_CHI_SQUARED {
        true => reduced.sqrt(),
        false => 1.0,
    }
}

/// Repeats the fit of the camera; each fit starts at the optics of the previous fit. A single fit from distant start
/// values stops before it reaches the smallest χ². The reason is that changes of the lens coefficients k3 and k5, the
/// scale and the camera's height almost compensate each other.
fn settled(
    nominal: &NominalSensor<'_>,
    (mut rest, mut optics): (Rest, Optics),
    images: &[Option<Seen>],
) -> Result<(ImageFit, Rest, Optics), String> {
    for _ in 0..MAX_FITS {
        optics = optics.departed(&of_camera(&rest)?).map_err(other_layout)?;
        let again = nominal
            .fit(&optics)?
            .at_rest(images)
            .map_err(other_layout)?;
        let gain = rest.chi_squared - again.chi_squared;
        rest = again;
        if gain < MIN_DECREASE {
            break;
        }
    }
    Ok((nominal.fit(&optics)?, rest, optics))
}

fn other_layout(error: impl std::fmt::Display) -> String {
    format!("does not show the layout: {error}; {CAUSES}")
}

/// Images of the markers at rest that the model predicts, for the sensor that was estimated in `rest` or, without
/// `rest`, for the nominal sensor. `None` for a marker outside of the frame.
fn law(fit: &ImageFit, rest: Option<&Rest>) -> Result<Vec<Option<[f64; 4]>>, String> {
    let markers = fit.markers.count();
    let still = vec![[MarkerDisplacement::default(); 2]; markers];
    let aligned = vec![[0.0; 2]; markers];
    let sensor = match rest {
        Some(rest) => SensorState {
            common: &rest.common,
            misalignments: &rest.misalignments,
        },
        None => SensorState {
            common: &[0.0; Departure::NUMBERS],
            misalignments: &aligned,
        },
    };
    let pictures = fit.view.pictures(&sensor, &still);
    pictures.ok_or_else(|| {
        other_layout("with these parameters no camera has the markers in its field of view")
    })
}

/// Estimated differences between the camera parameters and their nominal values. In the result, all parameters that do
/// not belong to the camera are 0.
fn of_camera(rest: &Rest) -> Result<Departure, String> {
    let mut numbers = [0.0; Departure::NUMBERS];
    for number in CAMERA {
        numbers[number] = *rest.common.get(number).ok_or("has no departures")?;
    }
    Ok(Departure::from(numbers))
}

/// The same marker image with larger standard errors, which allow for the unknown misalignment of the marker's two
/// discs.
fn roughly(image: Seen) -> Seen {
    let mut covariance = image.covariance;
    for (number, std) in ROUGH_STDS.into_iter().enumerate() {
        covariance[(number, number)] += std * std;
    }
    Seen {
        covariance,
        ..image
    }
}

fn centroids(pictures: &[Option<[f64; 4]>]) -> Vec<Option<[f64; 2]>> {
    let centroid = |picture: &Option<[f64; 4]>| picture.map(|[column, row, ..]| [column, row]);
    pictures.iter().map(centroid).collect()
}

/// Number of markers of the layout that are missing in the frame. Returns an error if too many are missing, if too many
/// found markers do not belong to the layout, or if the hues differ too much from the expected hues.
fn missing_markers(
    expected: &[Option<[f64; 4]>],
    images: &[Option<Seen>],
    found: &Found,
    [least, most]: [f64; 2],
) -> Result<usize, String> {
    let wanted = expected.iter().flatten().count();
    let there = images.iter().flatten().count();
    let beside = found.markers.len().saturating_sub(there);
    let few = (there as f64) < least * wanted as f64;
    if few || beside as f64 > most * wanted as f64 {
        return Err(format!(
            "shows {there} of the {wanted} markers of the layout that the camera should see, and {beside} other shapes; {CAUSES}"
        ));
    }
    let turns = expected.iter().zip(images).filter_map(|(expected, image)| {
        let turn = image.as_ref()?.picture[2] - expected.as_ref()?[2];
        Some((turn - (turn + 0.5).floor()).abs())
    });
    let median = median(turns).unwrap_or(0.0);
    if median > MAX_HUE_DIFFERENCE {
        return Err(format!(
            "has markers whose hues differ by {} turns in the median from those of magenta and yellow discs (at most {MAX_HUE_DIFFERENCE}): are colours swapped?",
            Number::rounded(median)
        ));
    }
    // Markers that are only partly in the frame do not count as missing.
    let centroids = centroids(expected);
    let cut = found.cut.iter().filter_map(|cut| closest(&centroids, cut));
    let cut = cut.filter(|(at, _)| images[*at].is_none()).count();
    Ok((wanted - there).saturating_sub(cut))
}

/// Matches found markers with expected positions. Each found marker is assigned to the nearest expected position. For
/// each expected position, returns the index of the nearest of its assigned markers; `None` if no marker was assigned
/// to the position.
pub(super) fn nearest(expected: &[Option<[f64; 2]>], found: &Found) -> Vec<Option<usize>> {
    let mut nearest = vec![None; expected.len()];
    let mut distances = vec![f64::INFINITY; expected.len()];
    for (number, marker) in found.markers.iter().enumerate() {
        if let Some((at, distance)) = closest(expected, marker)
            && distance < distances[at]
        {
            distances[at] = distance;
            nearest[at] = Some(number);
        }
    }
    nearest
}

/// Index of the expected position that is nearest to a marker of a frame, and the distance between them (px). `None` if
/// there is no expected position.
pub(super) fn closest(expected: &[Option<[f64; 2]>], marker: &Marker) -> Option<(usize, f64)> {
    let [x, y] = marker.centroid_px;
    let all = expected.iter().enumerate().filter_map(|(at, centroid)| {
        let [column, row] = (*centroid)?;
        Some((at, libm::hypot(column - x, row - y)))
    });
    all.min_by(|one, other| one.1.total_cmp(&other.1))
}
