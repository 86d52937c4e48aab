//! Terms that palpate prints or accepts, with their meanings.

use crate::quantity::Quantity;
use crate::readings::spelt;
use crate::statistic::Statistic;

/// A term and its meaning.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Term {
    /// The term, as palpate prints it.
    pub name: &'static str,
    /// Its meaning, in sentences; for a failure, also a remedy.
    pub meaning: &'static str,
}

/// Terms of one subject.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Subject {
    /// Subject in words.
    pub title: &'static str,
    /// Its terms.
    pub terms: &'static [Term],
}

macro_rules! subjects {
    ($($title:literal { $($name:literal: $meaning:literal;)* })*) => {
        /// All terms by subject, except quantities and statistics, which have a `meaning` of their own.
        pub const SUBJECTS: &[Subject] = &[$(Subject {
            title: $title,
            terms: &[$(Term { name: $name, meaning: $meaning }),*],
        }),*];
    };
}

subjects! {
    "Studies" {
        "study": "A config: one scene, the axes along which its fields are swept, and the plots of its table. `palpate run` makes tables of it, `palpate plot` figures of these.";
        "scene": "What touches what, how that is modelled, sensed and estimated: of kind roll, glide, press or fingertip.";
        "cell": "One combination of the swept values of a study. Cells are counted from 0, the first axis varying slowest.";
        "trial": "One repetition of a cell with noise of its own, which cell, trial and seed determine: `palpate trace --trial` replays it.";
        "shard": "Every N-th task of a run, to be run by itself; `palpate merge` puts shards together.";
        "sweep": "An axis along which fields of the config take values. A swept value stands in place of the one that the config writes in that field.";
        "rung": "One of several models of a scene, ordered by cost: a cheap closed form, a general integrator. `palpate check` says which one is taken, and what the next ones would err by and cost.";
        "auto": "The model that takes the cheapest rung whose error is at most the tolerance.";
        "tolerance": "Largest relative error of a model that `auto` may take; it is about the forward law, not about noise.";
        "roll": "A scene in which a round probe rolls a little on an object; the object's curvature follows from how far the contact moves (EP1).";
        "glide": "A scene in which fingers slide over a patch of an object; the curvature all over the patch follows from the places of contact (EP2).";
        "press": "A scene in which a soft ball with markers under its skin is pressed once onto an object; the object's curvature follows from how the markers move.";
        "fingertip": "A scene without an object: a sensor with markers by itself. Its quantities are the image area of a marker (`marker_area`) and the strain of folding the skin (`greatest_fold_strain`, `rms_fold_strain`). Nothing is random.";
        "trace": "One pass of a scene: what was true at each step (trace.csv) and what the sensor read (readings.csv).";
        "claim": "A statement of one of the reproduced papers that is scored from a study's tables: it holds, differs or cannot be tested.";
    }
    "Surfaces and contact" {
        "probe": "The body that touches: a fingertip, a point, or a soft sphere with markers.";
        "u": "First tangent direction at the contact. For a roll it is the x axis of the first contact frame, so normal_curvature_u is the object's curvature in that direction.";
        "v": "Second tangent direction at the contact, at a right angle to u.";
        "curvature": "Inverse of a radius: how fast a surface turns, positive where it is convex. All curvatures are in 1/length.";
        "relative curvature": "Curvature of the sensor plus that of the object, 1/R_s + 1/R_o. It determines how two bodies roll or press on each other. For rolls it is a form with a value in each direction.";
        "principal curvatures": "The least and the greatest normal curvature at a place, k_min and k_max, in directions at right angles to each other.";
        "shape class": "One of eight shapes of a place, by the signs of Gaussian curvature K and mean curvature H; magnitudes below a threshold count as 0: peak, ridge, saddle-ridge, flat, minimal, pit, valley, saddle-valley.";
        "peak": "Shape class of a place that is convex in all directions: K > 0, H > 0.";
        "ridge": "Shape class of a place that is convex across and straight along: K = 0, H > 0.";
        "saddle-ridge": "Shape class of a saddle that is rather convex: K < 0, H > 0.";
        "flat": "Shape class of a place without curvature: K = 0, H = 0. Of a press, the regime of an object without curvature.";
        "minimal": "Shape class of a saddle that is as convex as it is concave: K < 0, H = 0.";
        "pit": "Shape class of a place that is concave in all directions: K > 0, H < 0.";
        "valley": "Shape class of a place that is concave across and straight along: K = 0, H < 0.";
        "saddle-valley": "Shape class of a saddle that is rather concave: K < 0, H < 0.";
        "shape index": "A number for the shape of a place that does not depend on its size: -1 is a cup, 0 a saddle, 1 a cap.";
        "convex": "Of an object: it bulges towards the sensor; its curvature is positive. As a class by signs: both principal curvatures are positive.";
        "concave": "Of an object: it is hollow; its curvature is negative. As a class by signs: both principal curvatures are negative.";
        "saddle": "Class by signs of a place that is convex one way and concave the other, or flat in some direction.";
        "thresholds": "Magnitudes of K and H below which they count as 0 when shapes are classified.";
        "edge": "Regime of a press on an object more hollow than the sensor is round: it touches the rim, and no curvature follows.";
        "RCR": "Relative curvature ratio: the object's normal curvature over the probe's. Relative errors of rolls are amplified by 1 + 1/RCR.";
        "Montana": "Author of the contact equations (1988): how a contact moves on two bodies that roll on each other, by their curvatures.";
        "coherence": "Of a region of one class: from 0, where its direction of largest curvature points every way, to 1, where it points one way.";
        "indentation": "Approach of two bodies after their first touch, length.";
        "half-space": "Soft body that is deep compared with the contact; its displacements under load have a closed form.";
        "bonded-layer": "Soft layer that sticks to a rigid core; its contact is solved as an integral equation.";
        "hertz": "The oldest model of elastic contact: displacements at the surface of a half-space.";
        "elliptic": "Estimator of presses on a half-space: it fits both principal curvatures of the object and their axis, for example of a cylinder.";
        "gaussian": "Estimator of the 2020 paper: a bell curve is fitted to the normal displacements, and its width gives the effective radius.";
    }
    "Sensors and noise" {
        "pad": "Element of a tactile array. It reports a contact anywhere on it as its centre. A roll whose contact stays on one pad gives only a bound on the radius.";
        "encoder": "Sensor of the rotation of a roll. It reports whole steps (`scene.noise.encoder`).";
        "pitch": "Distance between neighbouring pads or markers, length.";
        "IFD": "Inter-finger distance: the distance between neighbouring fingers, and the unit in which the 1996 paper counts the noise of positions (`fraction_of_ifd`, `axis_fractions`).";
        "marker": "Coloured disc under the skin of a camera sensor, or a pair of discs at two depths; presses move it.";
        "layout": "Arrangement of the markers of a sensor.";
        "hue": "Colour of a pair of discs: it changes with their overlap, and so with how differently the two move inward.";
        "growth": "Change of the logarithm of a marker's diameter: it grows as it comes towards the camera.";
        "tracked": "Status of a marker that was found again in the pressed frame.";
        "lost": "Status of a marker that was not found again.";
        "cut_at_rest": "Number of markers at the rim of the image circle that the frame at rest does not show whole, and that are left out.";
        "merged": "Status of a marker that was found grown together with another.";
        "split": "Status of a marker that was found in pieces.";
        "new": "Status of a marker without a counterpart in the frame at rest.";
        "not-seen": "Status of a marker of the scene that neither frame shows.";
        "direct": "Reading of a press without a camera: displacements with noise.";
        "projected": "Reading of a press by a camera without pixels: places of markers in the image, with noise.";
        "rendered": "Reading of a press by a camera with pixels: frames are drawn, and markers found in them.";
    }
    "Estimators" {
        "least-squares": "Estimator of rolls: the curvature form that explains the rotations and shifts of all probes best.";
        "quadric": "Estimator of glides: one paraboloid for the whole patch; few unknowns, and blind to what a quadric cannot show.";
        "image": "Estimator of presses before a camera: what the camera sees of each marker, its place, hue and size, is fitted without displacements in between.";
        "plane": "Estimator of glides: the plane through the contacts, without outliers.";
        "sphere": "Estimator of glides: the sphere through the contacts, on any side of it and without outliers.";
        "cylinder": "Estimator of glides: the circular cylinder through the contacts, on any side of it and without outliers.";
        "shape": "Estimator of glides: the most probable of plane, sphere and cylinder, or none of these.";
        "penalised": "Estimator of glides: a spline through contacts and normals whose roughness is penalised by as much as the noise asks for.";
        "two-pass": "Estimator of glides, the 1996 paper's: two smoothing splines, one over the fingers' paths and one across. It counts lengths in inter-finger distances (IFD).";
        "std": "Standard deviation that the estimator reports of its own value, from the noise that is stated or from the residuals.";
        "interval95": "Interval that holds the true value in 95 of 100 cases, if the model is right; an end that is null is no bound.";
        "verdict": "Shape of a pressed object, by the interval of its curvature: convex, concave, flat-within-noise or not-resolved.";
        "flat-within-noise": "Verdict of a press: the interval of the object's curvature holds 0 and is narrower than the sensor's own curvature.";
        "not-resolved": "Verdict of a press: the interval of the object's curvature holds 0 and is at least as wide as the sensor's own curvature, so the press determines almost nothing.";
        "amplification": "Factor by which a relative error of the readings grows to one of the curvature, 1 + R_object/R_probe: the flatter the object, the larger.";
        "baseline": "Displacement that all markers have in common beside that of the press, length; fitted where it is asked for.";
        "gain": "Factor on all inward displacements, 1 if they are read without a scale error; fitted on request. Readings cannot separate it from a change of curvature and indentation.";
        "contact_seen": "Whether the readings show a contact of themselves. Where they do not, but an indentation is stated, the interval has the curvatures of all contacts that would hide in the noise.";
        "radius below": "Status of rolls whose contact stayed on one pad in some direction: the object's radius there is below a bound, and no more is known of it.";
        "wrong markers": "Markers that contradict the others so much that the fit leaves them out.";
        "chi-squared": "Sum of squared residuals over their variances; the reduced one is about 1 where residuals are as large as the noise.";
        "polynomial": "Status of two-pass: a polynomial without knots meets the smoothing sum already.";
        "interpolating": "Status of two-pass: all residuals are rounding.";
        "smoothing": "Status of two-pass: the smoothing sum is met within its tolerance.";
        "knots-exhausted": "Status of two-pass: the smoothing sum is too small to be met with the knots that there can be; curvatures are of no use. A larger --smoothing helps.";
        "unsettled": "Status of two-pass: the parameter that balances residuals against roughness was not found; curvatures are of no use. Another --smoothing helps.";
        "never-enough": "Of two objects: no number of trials distinguishes them, because each trial is as likely to put them in the wrong order.";
    }
    "Fields of estimates" {
        "amplification_u": "Factor from a relative error of a roll's readings to that of the curvature along u: 1 + 1/RCR. `amplification_v` is that along v.";
        "principal_curvature_min": "Smallest normal curvature from rolls; `principal_curvature_max` is the largest, in the direction `principal_direction_max_deg` from u towards v. The direction's standard deviation is 52° if the two curvatures do not differ significantly.";
        "radius": "Inverse of the mean curvature from rolls and glides, with a 95 % interval for a convex and for a concave object.";
        "residual_rms": "Root mean square of the shifts that the fit of rolls does not explain.";
        "std_from": "Source of the standard deviations of rolls: stated noise, the pitch of the pads, or the residuals.";
        "unresolved_probes": "Rolls during which no pad changed, with the bound on the object's radius if there is one.";
        "k_min": "Smallest normal curvature at a place; `direction_of_min` is its direction.";
        "k_max": "Largest normal curvature at a place; `direction_of_max` is its direction.";
        "class_probabilities": "Probability of each of the eight shape classes, by the uncertainty of K and H.";
        "sign_class": "Class by the signs of the principal curvatures alone: convex, concave or saddle.";
        "regions": "Connected parts of a patch that have one shape class, with area, mean curvatures, direction and coherence.";
        "status": "Outcome of a smoothing spline of two-pass. The curvature is usable unless it is knots-exhausted or unsettled.";
        "contact": "Place of the contact on the skin: x and y along the skin from the apex.";
        "regime": "Kind of contact of a press: convex, flat, concave, conforming or edge.";
        "unit": "Unit in which a value is stated. The unit of a curvature is one over the unit of length.";
        "format_version": "Version of the JSON. It rises if a key goes or changes its meaning.";
    }
    "Warnings about estimates" {
        "warnings": "Messages that the estimate may be wrong, each with a code, a text and numbers. A p_value is the probability of a contradiction at least as large by chance.";
        "p-value": "Probability that noise of the stated size leaves residuals at least as large where the model holds; small where the readings contradict the model or the noise.";
        "poor-fit": "Warning: the residuals are larger than the noise explains (p-value below 0.005; of rolls, below 0.02). The stated noise is too small, or the model does not hold.";
        "outlier": "Warning: one reading contradicts the others. Its number among them, counted from 0, is in `numbers`. Markers of a press that contradict the others strongly are left out instead.";
        "stated-noise": "Warning: the stated noise differs from the noise that the readings show, so the intervals are too narrow or too wide.";
        "stated-pitch": "Warning about rolls: a contact moved by less than the stated pitch, but pads report only multiples of the pitch.";
        "stated-scale": "Warning: a stated length that scales the readings, for example the distance between fingers, differs from the one in the readings or the scene.";
        "not-round": "Warning about presses: displacements depend on the direction from the contact, as by an edge, a cylinder or a saddle.";
        "stated-indentation": "Warning about presses: the stated indentation contradicts the displacements.";
    }
    "Warnings about readings, calibrations and runs" {
        "not-through-rest": "A line with an intercept fits the calibration far better than a line through rest: the points may not be changes from rest.";
        "large-calibration-residual": "The residual of a calibration is more than 10 % of the largest displacement.";
        "insignificant-slope": "The slope of a calibration is not significantly different from 0.";
        "different-slopes": "The slopes of the series of a calibration differ by more than 20 %.";
        "other-sensor": "Most markers moved far between the frames: they may be of two sensors, or the camera moved.";
        "moved-camera": "All markers moved alike between the frames, as they do when the camera moves.";
        "swapped-frames": "The markers shrank: the frame at rest and the pressed frame may be swapped.";
        "lost-markers": "Many markers were not found again in the pressed frame.";
        "failed-pilot": "All pilot trials of a cell failed, so the number of trials is chosen without it.";
        "heavy-tails": "A few trials determine the root mean square error, so its stated error is rough.";
        "failed-map": "The map lacks estimates of a cell, because its trial 0 failed.";
        "unknown-noise": "The noise is estimated from few readings, so its estimate is rough.";
        "unknown-fit": "The goodness of fit of the surface could not be computed.";
        "unexplained-readings": "The fit explains little of the variance of the readings.";
        "repeated-rows": "Some rows equal others to the last digit. Copied rows are not new readings, and make the stated uncertainty too small.";
        "units": "The readings, or a stated noise, seem to be in another unit, or displacements of a press to have the opposite sign.";
        "signs": "Readings seem to have the opposite sign, or their columns to be swapped: displacements that point outward, or normals that contradict the positions.";
        "unnamed-probes": "No column names the probes; they are counted by rows, blank lines or times.";
        "assumed-columns": "The file does not name its columns as palpate does. They were found by their order, or as columns of several fingers, or some are not read.";
        "unnamed-fingers": "No column names the fingers; they are separated by blank lines or long steps.";
        "flat-object": "The object is so flat that the rounding of double precision changes its curvature noticeably.";
        "left-out": "Contacts are left out of the fit: lost readings and other outliers.";
        "not-resolved": "The contacts do not determine the radius of the shape; its interval is open.";
        "not-resolved-across": "The contacts are of one stroke. They determine the curvature along it, but not across it.";
        "two-groups": "The contacts form two groups that are farther apart than each is wide. They may be of two objects.";
        "uncertain-shape": "The contacts fit two shapes about as well. Record more contacts over a larger part of the object.";
        "too-many-outliers": "More than a fifth of the contacts are lost readings or outliers, or of another object.";
        "none-of-these": "The contacts are of none of the shapes that were compared; the radius is of the best one.";
        "correlated-noise": "The noise of consecutive contacts is correlated. Fewer independent contacts are counted, and the intervals are wider.";
        "distant-contact": "One contact is far from all others.";
        "assumed-indentation-std": "The indentation is stated without a standard deviation, and 2 % is assumed.";
        "unstated-depth": "The depth of the markers is not stated; they are assumed to lie at the surface.";
        "swapped-columns": "The displacements along the skin fit better with their columns swapped or their sign changed.";
        "lone-marker": "One marker alone shows the contact.";
        "unseen-contact": "Only the stated indentation indicates a contact; the displacements do not show one.";
        "large-contact": "The contact radius is a large share of the sensor's or the object's radius, so that strains are not small.";
        "gaussian-body": "The fitted Gaussian is not an elastic contact model, so its intervals cover the noise but not the error of the model.";
        "scatter-at-rest": "The markers in the frame at rest scatter more than the tracker states. The intervals are widened accordingly.";
        "missing-markers": "Markers of the layout were not found in the frames.";
        "other-camera": "The frame at rest contradicts the stated camera.";
        "camera-scale": "The stated radial scale contradicts the frames.";
        "uncertain-gain": "The gain of the calibration is uncertain, so the curvature is uncertain too.";
        "ignored-layer": "The study's model is a layer, but a half-space is fitted.";
        "uneven-pictures": "The effect of light and blur is computed for markers at rest, and changes as the markers move.";
    }
    "Failures of rolls" {
        "too-few-probes": "Fewer than two rolls: a curvature has three components and one roll determines two. Roll in at least two directions.";
        "unresolvable-set": "All rolls have nearly the same direction, so the curvature across it is undetermined. Add a roll in another direction.";
        "noisy-rotations": "At least half of the squared rotations is measurement error. Use longer rolls or a finer encoder.";
        "unresolved": "The contact did not move in some direction, though the probe rolled: the object is too sharp for the pads, and only a bound on its radius is known. Finer pads or longer rolls help.";
        "not-rolling": "The contact moved against the roll in some direction, as no rolling contact does: noise is larger than the movement, or a sign of the readings is wrong. Longer rolls or less noise help; of recorded readings, a contact that moves to +u belongs to rotation_y < 0.";
        "overlapping": "Beside the contact the object reaches into the probe, so that a real probe cannot roll there.";
        "conforming": "The object is as hollow as the probe or sensor is round, or nearly: they touch over an area at once, and there is no point of contact, nor a finite radius. In `press`, also the regime of such a pair.";
        "too-many-steps": "The integrator of the roll took the largest number of steps without coming to the end.";
        "singular": "The step of the integrator shrank to nothing, because the motion is singular at that place.";
        "beyond-pads": "The contact rolled off the part of the fingertip that has pads.";
    }
    "Failures of glides" {
        "contact-lost": "The tip passes beside the object.";
        "two-contacts": "The tip rests on two places at once: a dish or valley as tight as the tip, or tighter. A smaller tip helps.";
        "no-convergence": "The search for the contact came to no end: lengths too far apart for double precision, or an object too rough for the tip.";
        "too-few-contacts": "Fewer contacts than the estimator has unknowns. A quadric needs the fewest.";
        "bad-weight": "A contact has a weight that weighs nothing.";
        "bad-normal": "A normal has no length, and so no direction.";
        "missing-normal": "Some contacts have a normal and others none.";
        "coincident": "All contacts lie on one point.";
        "collinear": "All contacts lie on one line, so the shape across it is undetermined. A second finger, or a pass beside the first, helps.";
        "folded": "The patch is no graph over its mean plane: some normal points away by 90 degrees or more. A smaller patch helps, or normals that all point outward.";
        "no-plane": "The contacts spread as far in all directions as those of a closed shape, which has no mean plane.";
        "tip-too-large": "The centre of a round tip turns more sharply than a tip of that radius can on any object: --tip-radius is too large, or the readings are places of contact, not of the tip.";
        "no-side": "The outward direction lies in the patch's plane, and does not say which side is outside: --outward X,Y,Z.";
        "undetermined": "The readings do not determine all unknowns: some change of them changes no reading.";
    }
    "Failures of presses" {
        "off-skin": "A marker lies further along the skin than the skin goes; place and sensor radius may be in different units.";
        "no-indentation": "The indentation is not positive, so that the bodies do not touch.";
        "edge-contact": "The object is more hollow than the sensor is round, so that its rim is touched and not its bottom.";
        "too-deep": "The indentation is larger than the body that is indented.";
        "too-wide": "The contact radius would exceed the sensor's radius, or 0.9 of the object's radius.";
        "layer-too-thin": "The contact is so much wider than the layer is thick that its equations cannot be solved.";
        "too-few-markers": "Fewer readings of markers than unknowns.";
        "no-contact": "All markers moved alike, or not beyond their noise: the best fit of a press explains them hardly better than none. Where nothing touches, noise passes for a press in fewer than 5 of 100. A deeper press or less noise helps; of recorded readings, inward displacements are positive.";
        "other-body": "The kind of the fitted body, its thickness or the depth of the markers is wrong. This is an error if no press fits, and a warning if the fit is bad.";
        "off-markers": "The contact that would explain the readings lies away from all markers.";
        "hidden-marker": "A marker was seen in the frame at rest where no camera like the one that is meant sees it: the layout or the camera is another.";
    }
    "Failures of cameras and frames" {
        "folded-lens": "With its odd terms the lens would show angles within its field twice.";
        "bad-depth": "A disc of a marker would lie outside the skin, or at the sensor's centre.";
        "off-the-skin": "A marker would lie half a turn or more from the apex.";
        "too-many-markers": "More markers than can be worked with.";
        "discs-overlap": "Discs of two markers cover each other as seen from the centre.";
        "wrong-count": "The number of motions is not that of the markers.";
        "impossible-motion": "A disc would move to the camera, or by a number that is not finite.";
        "out-of-field": "What is measured lies outside of the camera's image.";
        "empty-image": "The frame has no pixels.";
        "too-small": "The frame, or what its mask leaves, is too small to hold a marker.";
        "too-large": "The frame is larger than is read.";
        "mask-outside": "The image circle is not a circle, or lies outside of the frame.";
        "no-markers": "Nothing stands out from the ground as a marker does.";
        "too-many": "More shapes than a sensor has markers: noise, or no frame of a sensor.";
    }
    "Other failures" {
        "off-domain": "The surface does not reach to the contact, or its formula is undefined there.";
        "chart-singular": "The coordinates of the surface, not the surface, are singular at the contact.";
        "no-closest-point": "No single point of the surface is closest, as from the centre of a ball.";
        "not-finite": "A number, or what follows from it, is not finite or too large to be squared.";
        "out-of-range": "The numbers leave the range of double precision: lengths too far apart, or in a strange unit.";
        "bad-setting": "A setting is out of its range; the message names it, its value and what it must be.";
        "negative-std": "An estimator reported a negative standard deviation; this is a defect of palpate.";
        "unknown-quantity": "A trial returned a quantity that its scene does not have; this is a defect of palpate.";
        "usage": "Kind of an error: bad arguments or a bad config; status 2.";
        "work": "Kind of an error: the work failed, or the readings are bad; status 1.";
        "stopped": "Kind of an error: a signal stopped the work; status 130 or 143. The same command goes on where it stopped.";
    }
}

/// The term, quantity or statistic with this name. Case does not matter; hyphens, underscores and spaces are equal.
///
/// ```
/// use palpate_study::glossary::meaning;
///
/// assert!(meaning("ifd").is_some_and(|term| term.meaning.starts_with("Inter-finger distance")));
/// assert!(meaning("Mean curvature").is_some());
/// assert!(meaning("blancmange").is_none());
/// ```
pub fn meaning(word: &str) -> Option<Term> {
    let word = spelt(word);
    all().find(|term| spelt(term.name) == word)
}

/// Up to five names that resemble a word, the most similar first.
pub fn similar(word: &str) -> Vec<&'static str> {
    let word = spelt(word);
    let likeness = |term: Term| {
        let name = spelt(term.name);
        let likeness = match !word.is_empty() && (name.contains(&word) || word.contains(&name)) {
            true => 1.0,
            false => strsim::jaro_winkler(&name, &word),
        };
        (likeness, term.name)
    };
    let mut found: Vec<(f64, &str)> = all().map(likeness).collect();
    found.retain(|(likeness, _)| *likeness >= 0.88);
    found.sort_by(|one, other| other.0.total_cmp(&one.0));
    found.dedup_by_key(|(_, name)| *name);
    found.into_iter().take(5).map(|(_, name)| name).collect()
}

/// Every term, then the quantities and the statistics.
fn all() -> impl Iterator<Item = Term> {
    let terms = SUBJECTS.iter().flat_map(|subject| subject.terms).copied();
    let quantities = Quantity::ALL.iter().map(|quantity| Term {
        name: quantity.name,
        meaning: quantity.meaning.trim(),
    });
    let statistics = Statistic::ALL.into_iter().chain([Statistic::StdBound]);
    let statistics = statistics.map(|statistic| Term {
        name: statistic.name(),
        meaning: statistic.meaning(),
    });
    terms.chain(quantities).chain(statistics)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn every_word_has_one_meaning_in_sentences() {
        let mut known = BTreeSet::new();
        for term in SUBJECTS.iter().flat_map(|subject| subject.terms) {
            assert!(known.insert(spelt(term.name)), "{} occurs twice", term.name);
        }
        for term in all() {
            assert!(meaning(term.name).is_some(), "{}", term.name);
            assert!(
                term.meaning.ends_with('.'),
                "{}: {}",
                term.name,
                term.meaning
            );
            assert!(
                !term.meaning.contains("  "),
                "{}: {}",
                term.name,
                term.meaning
            );
        }
    }

    #[test]
    fn words_in_any_writing() {
        for word in ["not-rolling", "Not Rolling", "not_rolling", " NOT-ROLLING "] {
            assert_eq!(meaning(word).map(|term| term.name), Some("not-rolling"));
        }
        assert_eq!(meaning(""), None);
        assert_eq!(similar("not-roling").first(), Some(&"not-rolling"));
        assert!(similar("rung?").contains(&"rung"));
        assert!(similar("knots").contains(&"knots-exhausted"));
        assert!(similar("").len() <= 5);
        assert!(similar("zzzzzz").is_empty());
    }
}
