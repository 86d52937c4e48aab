//! The glossary: explanations of the terms that palpate prints or accepts.

use crate::quantity::Quantity;
use crate::readings::spelt;
use crate::statistic::Statistic;

/// A term of the glossary, and its meaning.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Term {
    /// The term, as palpate prints it.
    pub name: &'static str,
    /// Meaning of the term, in sentences. For a failure, it also states what the user can do.
    pub meaning: &'static str,
}

/// A subject of the glossary, with its terms.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Subject {
    /// Name of the subject.
    pub title: &'static str,
    /// The terms of this subject.
    pub terms: &'static [Term],
}

macro_rules! subjects {
    ($($title:literal { $($name:literal: $meaning:literal;)* })*) => {
        /// The terms of the glossary, grouped by subject. The meanings of quantities and statistics are in [`Quantity`]
        /// and [`Statistic`].
        pub const SUBJECTS: &[Subject] = &[$(Subject {
            title: $title,
            terms: &[$(Term { name: $name, meaning: $meaning }),*],
        }),*];
    };
}

subjects! {
    "Studies" {
        "study": "A config with one scene, the sweep axes that vary fields of the scene, and the plots. `palpate run` writes the tables of a study, and `palpate plot` draws its figures.";
        "scene": "The bodies, the motion, the contact model, the sensor, the noise and the estimator of a study. Its kind is roll, glide, press or fingertip.";
        "cell": "A grid point of a study: one combination of the swept values. Cells are numbered from 0, and the values of the first axis vary slowest.";
        "trial": "One repetition of a cell with new random noise. Seed, cell and trial number determine this noise, so `palpate trace --trial` can repeat a trial exactly.";
        "shard": "One of N parts of a run: every N-th grid point. Several processes or machines can share a run in this way. `palpate merge` combines the shards.";
        "sweep": "An axis along which fields of the config are varied. A swept value replaces the value that the config states for the field.";
        "rung": "One of several models for the same contact, ordered by cost, from a cheap closed form to a general integrator. `palpate check` prints the chosen model. It also prints the error and the cost of the next cheaper model and of the next more exact model.";
        "auto": "Setting of the contact model: palpate chooses the cheapest model whose error is at most the tolerance.";
        "tolerance": "Largest relative error of a contact model that `auto` may choose. It limits the error of the contact model, not the noise of a sensor.";
        "roll": "A scene in which a round probe rolls on an object by a small angle. The object's curvature is estimated from the distance that the contact moves (EP1).";
        "glide": "A scene in which fingers slide over a patch of an object. The curvature at every point of the patch is estimated from the contact points (EP2).";
        "press": "A scene in which a soft ball with markers under its skin is pressed once onto an object. The object's curvature is estimated from the displacements of the markers.";
        "fingertip": "A scene of a sensor with markers, without an object. Its quantities are the image area of a marker (`marker_area`) and the strain of folding the skin (`greatest_fold_strain`, `rms_fold_strain`). The scene has no random numbers.";
        "trace": "Data of one trial of a scene: the true values at each step (trace.csv) and the readings of the sensor (readings.csv).";
        "interval": "Range that contains the true value with a stated probability; see `interval95`. In cells.csv, `coverage95` is the share of trials whose 95 % interval contains the true value.";
        "claim": "A statement of one of the reproduced papers. The tables of a study decide whether the claim holds, whether the measured values differ from it, or whether it cannot be tested.";
    }
    "Surfaces and contact" {
        "probe": "The body that touches the object: a fingertip, a point, or a soft sphere with markers.";
        "x": "First coordinate of a position: along the fingers' paths in a glide, along the skin in a press. `y` is the second coordinate, and `z` the third, the height. Columns such as `normal_x` and `tip_y` are components of vectors: `normal` is the unit normal out of the object; `object` and `probe` are the contact points on both bodies; `tip` is the centre of a fingertip; `rotation` is the rotation of a probe; `shift` (u, v) is the movement of the contact on the probe; `tangential` is a displacement along the skin.";
        "u": "Tangent direction at the contact: the first of the two perpendicular directions u and v. For a roll, u is the x axis of the contact frame at the start of the roll. `normal_curvature_u` is the object's normal curvature along u.";
        "v": "Second tangent direction at the contact, perpendicular to the first direction u.";
        "curvature": "Inverse of a radius of curvature, 1/length. It is positive where the surface is convex.";
        "relative curvature": "Curvature of the sensor plus curvature of the object, 1/R_s + 1/R_o, where R_s and R_o are their radii. It determines how two bodies roll or press on each other. For rolls, each direction has its own value.";
        "principal curvatures": "The smallest and the largest normal curvature at a point, k_min and k_max. Their directions are at right angles to each other.";
        "shape class": "One of eight shapes of a surface at a point, from the signs of Gaussian curvature K and mean curvature H: peak, ridge, saddle-ridge, flat, minimal, pit, valley, saddle-valley. A curvature whose magnitude is below a threshold counts as 0.";
        "peak": "Shape class of a point where the surface is convex in all directions: K > 0, H > 0.";
        "ridge": "Shape class of a point where the surface is convex in one direction and straight across it, like a cylinder from outside: K = 0, H > 0.";
        "saddle-ridge": "Shape class of a saddle that is more convex than concave: K < 0, H > 0.";
        "flat": "Shape class of a point without curvature: K = 0, H = 0. For a press, the kind of contact with an object without curvature.";
        "minimal": "Shape class of a saddle that is as convex as it is concave: K < 0, H = 0.";
        "pit": "Shape class of a point where the surface is concave in all directions: K > 0, H < 0.";
        "valley": "Shape class of a point where the surface is concave in one direction and straight across it, like a cylinder from inside: K = 0, H < 0.";
        "saddle-valley": "Shape class of a saddle that is more concave than convex: K < 0, H < 0.";
        "shape index": "Number from -1 to 1 that describes the shape of a surface at a point, independent of the size: -1 is a cup, 0 a symmetric saddle, 1 a cap.";
        "convex": "An object is convex if it bulges towards the sensor; its curvature is positive. As the class of a point by signs: both principal curvatures are positive.";
        "concave": "An object is concave if it is hollow; its curvature is negative. As the class of a point by signs: both principal curvatures are negative.";
        "saddle": "Class of a point by the signs of the principal curvatures, without thresholds: one is positive and the other is negative, or at least one is 0.";
        "thresholds": "Limits for the Gaussian curvature K and the mean curvature H. If the magnitude of K or H is below its limit, the curvature counts as 0 for the shape class.";
        "edge": "Kind of contact of a press on a hollow object with a smaller radius than the sensor. The sensor touches only the rim of the object, so the object's curvature cannot be estimated.";
        "RCR": "Relative curvature ratio: the object's normal curvature divided by the probe's. A relative error of the readings of a roll causes a relative error of the curvature that is 1 + 1/RCR times as large.";
        "Montana": "Author of the contact equations (1988). From the curvatures of two bodies that roll on each other, these equations give the motion of the contact point on both bodies.";
        "coherence": "Number from 0 to 1 that states how parallel the directions of largest curvature are in a region of one shape class: 0 if they are random, 1 if they are parallel.";
        "indentation": "A length: the distance by which two bodies approach each other after their first touch.";
        "half-space": "Model of a soft body that is deep compared with the contact radius. Its displacements under load have a closed form.";
        "bonded-layer": "Model of a soft layer that is bonded to a rigid core. Its contact is computed from an integral equation.";
        "hertz": "Hertz's model of elastic contact with a half-space. In this model, all markers move like the surface, even if they are below the surface.";
        "elliptic": "Estimator of presses on an object that is not round, for example a cylinder. It fits an elastic half-space, and estimates both principal curvatures of the object and their directions (`principal`, with `curvature_max` and `curvature_min`).";
        "gaussian": "Estimator of presses from the paper of Lin and others (2020). It fits a Gaussian to the normal displacements, and computes the effective radius from the width of the Gaussian.";
    }
    "Sensors and noise" {
        "pads": "Sensor of a roll or a glide: the pad nearest to the contact is active and reports its own centre. The layout is square, hexagonal or uniform; a uniform layout has the same density of pads everywhere on the sphere. If `offset` is random, each roll starts at another place on a pad.";
        "pad": "Element of a tactile array. Wherever the contact is on a pad, the pad reports its own centre. If the contact of a roll stays on one pad, the readings give only a bound on the object's radius.";
        "encoder": "Sensor of the rotation in a roll. It rounds the rotation to whole steps (`scene.noise.encoder`).";
        "pitch": "A length: the distance between neighbouring pads or markers.";
        "IFD": "Inter-finger distance: the distance between neighbouring fingers. The paper of Charlebois, Gupta and Payandeh (1996) states the noise of positions as a fraction of this distance (`fraction_of_ifd`).";
        "marker": "Coloured disc, or a pair of discs at two depths, under the skin of a camera sensor. A press displaces the marker. In tables of markers, `dx`, `dy`, `dhue` and `dmean_hue` are changes since the frame at rest, and `radial_position` is the distance from the apex.";
        "layout": "Arrangement of the markers of a sensor.";
        "hue": "Colour of a marker that is a pair of discs; `mean_hue` is the mean over its pixels. The hue changes with the overlap of the discs, and so with the difference between their inward displacements.";
        "growth": "Change of the logarithm of a marker's diameter in the image. It is positive if the marker comes closer to the camera.";
        "tracked": "Status of a marker that was found in both frames.";
        "lost": "Status of a marker that was found in the frame at rest, but not in the pressed frame.";
        "cut_at_rest": "Number of markers in the frame at rest that are cut by the rim of the image circle. These markers are not used.";
        "merged": "Status of a marker whose image touches the image of another marker in the pressed frame.";
        "split": "Status of a marker whose image consists of several pieces in the pressed frame.";
        "new": "Status of a marker that was found in the pressed frame, but not in the frame at rest.";
        "not-seen": "Status of a simulated marker that was found in neither frame.";
        "direct": "Sensor of a press without a camera. It reads the displacements of the markers directly, with noise.";
        "projected": "Sensor of a press with a camera. The image of each marker is computed without rendering pixels, and is read with noise.";
        "rendered": "Sensor of a press with a camera. Frames are rendered pixel by pixel, and the markers are detected in these frames.";
    }
    "Estimators" {
        "least-squares": "Estimator of rolls. A least-squares fit gives the curvature that best explains the rotations and the movements of the contact (shifts) of all rolls.";
        "pad-edge": "Estimator of rolls whose readings are time series from pads. When the active pad changes, the contact is on the line between two pads; at all other times, it is on the active pad. The curvatures that agree with all samples give the estimate and its bounds.";
        "trajectory": "Estimator of rolls whose readings are time series. It fits the curvature at the first contact and the change of curvature along the rolls. It describes the curvature along a roll by a polynomial, and its estimate is a weighted mean over the rate at which the curvature may change.";
        "quadric": "Estimator of glides: it fits one quadric (second-degree surface) to the whole patch. A quadric has few unknowns, but cannot represent other shapes.";
        "image": "Estimator of presses for a sensor with a camera: it fits the contact model directly to the position, hue and size of each marker in the image, without computing displacements first.";
        "plane": "Estimator of glides: it fits a plane to the contacts and rejects outliers.";
        "sphere": "Estimator of glides: it fits a sphere to the contacts and rejects outliers. The contacts may lie anywhere on the sphere.";
        "cylinder": "Estimator of glides: it fits a circular cylinder to the contacts and rejects outliers. The contacts may lie anywhere on the cylinder.";
        "shape": "Estimator of glides. It chooses the most probable of plane, sphere and cylinder (`shape_probabilities`), or finds that `none` of them fits. It states the `centre`, the `axis`, the rms distance of the contacts from the shape (`rms_misfit`) and the p-value of the fit (`shape_p_value`).";
        "penalised": "Estimator of glides: it fits a spline to contacts and normals, with a penalty on roughness. The penalty reduces the effective number of its parameters (`effective_unknowns`). The weight of the penalty depends on the noise of the readings.";
        "two-pass": "Estimator of glides from the paper of Charlebois, Gupta and Payandeh (1996): a smoothing spline, and a second one that also uses \
            tangents. Its lengths are in units of the inter-finger distance (IFD).";
        "std": "Standard deviation of an estimate, as the estimator computes it from the stated noise or from the residuals. `normal_std` and `tangential_std` are the standard deviations of the noise of the markers' displacements in a press, along the normal and along the skin.";
        "interval95": "Interval that contains the true value in 95 of 100 cases, if the model is correct. If an end is null, the interval has no bound on that side.";
        "verdict": "Shape of a pressed object, from the 95 % interval of its curvature: convex, concave, flat-within-noise or not-resolved.";
        "flat-within-noise": "Verdict of a press: the interval of the object's curvature contains 0, and its width is less than the sensor's own curvature (the inverse of the sensor's radius).";
        "not-resolved": "Verdict of a press: the interval of the object's curvature contains 0, and its width is at least the sensor's own curvature (the inverse of the sensor's radius). The press determines almost nothing about the object's shape. A warning of glides has the same code: the contacts do not determine the radius of the fitted shape, so the interval of the radius has no upper end.";
        "amplification": "Relative error of the estimated curvature, divided by the relative error of a roll's readings that causes it: 1 + R_object/R_probe. It increases with the radius of the object.";
        "baseline": "A length: a constant offset of the displacements of all markers, for example because the sensor was not at rest at the start. It is fitted only on request.";
        "gain": "Factor on all inward displacements; 1 if the sensor has no scale error. It is fitted only on request. Readings cannot separate a gain from a change of curvature and indentation.";
        "contact_seen": "Whether the readings alone show a contact. If they show no contact, but an indentation is stated, the interval contains every curvature for which the displacements would be within the noise.";
        "radius below": "Status of rolls during which the contact stayed on one pad in some direction. The readings then give only an upper bound on the object's radius in this direction.";
        "wrong markers": "Markers whose readings contradict the other markers so much that the fit does not use them.";
        "chi-squared": "Sum of the squared residuals, each divided by the variance of its noise. The reduced chi-squared (`reduced_chi_squared`) is chi-squared divided by the degrees of freedom. It is about 1 if the residuals are as large as the noise.";
        "polynomial": "Status of the estimator `two-pass`: the spline needs no knots, so it is a single polynomial. Its sum of squared residuals (the smoothing sum) is at most the target.";
        "interpolating": "Status of the estimator `two-pass`: the spline passes through all contacts, up to rounding errors.";
        "smoothing": "Status of the estimator `two-pass`: the sum of squared residuals (the smoothing sum) equals its target, within a tolerance.";
        "knots-exhausted": "Status of the estimator `two-pass`: even with the largest possible number of knots, the sum of squared residuals (the smoothing sum) stays above its target. The curvatures are unusable. Use a larger --smoothing.";
        "unsettled": "Status of the estimator `two-pass`: the search found no weight of the roughness for which the sum of squared residuals (the smoothing sum) equals its target. The curvatures are unusable. Use another --smoothing.";
        "never-enough": "Status of a pair of objects in `distinguish`: no number of trials distinguishes them. The estimates from a single trial of each object are in the wrong order as often as in the order of the true values.";
    }
    "Fields of estimates" {
        "amplification_u": "Relative error of the estimated curvature along u, divided by the relative error of a roll's readings that causes it: 1 + 1/RCR. RCR is the relative curvature ratio: the object's normal curvature along u, divided by the probe's curvature. `amplification_v` is the same along v.";
        "principal_curvature_min": "Smallest normal curvature, estimated from rolls. `principal_curvature_max` is the largest, in the direction `principal_direction_max_deg` from u towards v. If the two curvatures do not differ significantly, the direction is undetermined. Its standard deviation is then 52°, as for directions that are distributed uniformly over 180°.";
        "radius": "Inverse of the mean curvature from rolls and glides. It has two 95 % intervals: for a convex and for a concave object.";
        "residual_rms": "Root mean square of the residuals in the fit of rolls. The residuals are those of the shifts, that is, of the movements of the contact on the probe.";
        "contacts": "Number of readings of a glide, by `fingers` fingers (`finger` is the number of a finger); `with_normals` states whether they have normals. In `distinct_contacts`, copies of a contact and contacts of a resting finger count once. `correlated_contacts` is the number of consecutive contacts that together count as one, because their noise is correlated. `effective_contacts` is the resulting number of independent contacts.";
        "convex95": "95 % interval of the radius if the object is convex; null if it cannot be convex. `concave95` is the interval if it is concave.";
        "stroke": "Result for a glide whose contacts lie along a single path (stroke). `curvature_along` is the curvature along the stroke. The readings do not determine the curvature across the stroke (`curvature_across`). For rolls in only one direction, the curvature in this direction is in `single_direction`.";
        "stiffness": "The product E*√R of a load curve, with the modulus E* = E/(1 − ν²) and the effective radius R. `exponent` is the power of the indentation that fits the forces best; in Hertz contact, it is 3/2.";
        "told_apart": "Probability that the estimates from one trial of each of two objects are in the same order as the true values, with its 95 % interval from `low95` to `high95`. With `repeats` trials per object, the mean estimates are in this order with the required probability `confidence`. `repeats_are` states whether this number was found, extrapolated or not found. `first` and `second` are the objects, and `failing` is the share of failed trials.";
        "effect": "Sensitivity of an estimate to a field: the change of the logarithm of the rms error, divided by the change of the logarithm of the field's value. It is 1 if the rms error is proportional to the value. `rms_errors` are the rms errors for the two compared values of the field. Usually, one value is below and one is above the value in the config. `skipped` lists fields without a result.";
        "meets": "Ranges of values that meet the `target` of `design`; `misses` are the ranges of values that miss it. `best_that_meets` is the best value of the field `sought`, `std_error` the standard error of the statistic, and `max_failures` the largest share of trials that may fail.";
        "main_failure": "Most frequent kind of failure of the trials. `first_trial` in failures.csv is the number of the first trial that failed in this way.";
        "std_from": "Source of the standard deviations of estimates from rolls: stated noise, the pitch or the edges of the pads, the steps of rounded shifts or rotations, or the residuals.";
        "terms": "Number of terms that describe the curvature along a roll in a fit of time series. With 1 term, the curvature is constant.";
        "bounds": "Smallest and largest curvature that agree with all samples in the time series of the rolls, if the rotations are exact. A bound that does not exist is null.";
        "unresolved_probes": "Rolls during which the contact stayed on one pad, with a bound on the \
            object's radius if possible.";
        "k_min": "Smallest normal curvature at a point; `direction_of_min` is its direction.";
        "k_max": "Largest normal curvature at a point; `direction_of_max` is its direction.";
        "class_probabilities": "Probability of each of the eight shape classes, from the uncertainty of K and H. In maps, each class has a column, such as `probability_peak`; `true_class` is the simulated class.";
        "sign_class": "Class by the signs of the principal curvatures, without thresholds: convex, concave or saddle; `null` for a plane or a cylinder, which have a principal curvature of 0.";
        "regions": "Connected parts of a patch that have the same shape class; `region` is the number of a part in a map. Each part has its `area`, the averages of K and H over \
            the part, the average direction of largest curvature, and the coherence of the directions.";
        "status": "In the columns of markers, whether a marker was found. Otherwise the result of fitting a smoothing spline with the estimator `two-pass`. The curvature is usable unless the status is knots-exhausted or unsettled.";
        "contact": "Position of the contact on the skin: x and y along the skin from the apex. `peak_pressure` is the pressure there, if the modulus is stated.";
        "regime": "Kind of contact of a press: convex, flat, concave, conforming or edge.";
        "unit": "Unit in which a value is stated. The unit of a curvature is one over the unit of length.";
        "format_version": "Version of the JSON. It increases when a key is removed or changes its meaning.";
    }
    "Warnings about estimates" {
        "warnings": "Messages that the estimate may be wrong, each with a `code`, a `text` and `numbers`. If a statistical test of the readings caused the warning, `numbers` contains the `p_value` of the test. This is the probability that chance alone causes a contradiction between readings and model (or stated values) at least as large as the observed one.";
        "p-value": "Probability that noise of the stated size causes residuals at least as large as the observed ones, if the model holds. A small p-value means that the readings contradict the model or the stated noise.";
        "poor-fit": "Warning: the residuals are larger than the noise explains (p-value below 0.005; for rolls by `least-squares`, below 0.02). The stated noise is too small, or the model does not hold. For time series of rolls without stated noise, the paths of the contacts contradict the rotations.";
        "outlier": "Warning: one reading contradicts the others. `numbers` contains the index of this reading, counted from 0. Markers of a press that contradict the others strongly are not used in the fit at all.";
        "stated-noise": "Warning: the stated noise differs from the noise that the readings show, so the intervals are not reliable. Correct the stated noise, or do not state it.";
        "stated-pitch": "Warning about rolls. Either a contact moved by less than the stated pitch, but pads report only multiples of the pitch; or no pitch is stated, but all shifts are multiples of one length, as those of pads are.";
        "stated-scale": "Warning about glides: the stated distance between fingers, or the stated tip radius, differs from the value in the readings. In a simulated glide, `inter_finger_distance` differs from the gaps between `finger_positions`.";
        "not-round": "Warning about presses: the displacements depend on the direction from the contact. The object may have an edge, or be a cylinder or a saddle.";
        "stated-indentation": "Warning about presses: the stated indentation contradicts the displacements.";
    }
    "Warnings about readings, calibrations and runs" {
        "not-through-rest": "Warning about a calibration: a line with an intercept fits the calibration points much better than a line through the origin. Perhaps the readings are not changes from the state at rest.";
        "large-calibration-residual": "Warning about a calibration: the rms residual of the calibrated displacements is more than 10 % of the largest displacement.";
        "insignificant-slope": "Warning about a calibration: its slope is not significantly different from 0.";
        "different-slopes": "Warning about a calibration: the slopes of its series differ by more than 20 %.";
        "other-sensor": "Most markers moved far between the frames. The frames may be of two different sensors, or the camera moved.";
        "moved-camera": "All markers moved by the same shift between the frames. The camera may have moved.";
        "swapped-frames": "The markers became smaller. The frame at rest and the pressed frame may be swapped.";
        "lost-markers": "Many markers were not found again in the pressed frame.";
        "failed-pilot": "To choose the number of trials, palpate first ran a few trials of each cell. In one cell all these trials failed, so this cell does not influence the number.";
        "heavy-tails": "A few trials with large errors determine the root mean square error, so its stated uncertainty is inaccurate.";
        "failed-map": "The map has no estimates for a cell, because trial 0 of this cell failed.";
        "unknown-noise": "The noise is estimated from few readings, so the estimated noise is uncertain.";
        "unknown-fit": "The goodness of fit of the surface could not be computed.";
        "unexplained-readings": "The fit explains little of the variance of the readings.";
        "repeated-rows": "Some rows repeat earlier rows, either exactly or with differences that are much smaller than the noise. Copied rows contain no new information. If they are counted as new readings, the standard errors and intervals are too small.";
        "units": "The readings or a stated noise seem to be in another unit, or the displacements of a press seem to have the opposite sign.";
        "signs": "The readings seem to have the opposite sign, or their columns seem to be swapped. For example, displacements point outward, or normals contradict the positions.";
        "unnamed-probes": "No column states to which roll each row belongs. Palpate separates the rolls by rows, blank lines or times.";
        "assumed-columns": "The names of the columns in the file are not palpate's names. Palpate used the order of the columns, or interpreted them as columns of several fingers, or ignored some columns.";
        "unnamed-fingers": "No column states to which finger each row belongs. Palpate separates the fingers by blank lines or by long steps between contacts.";
        "half-turn": "The contact of a simulated roll moves by more than half of the probe's circumference, so the movement of the contact on the probe (the shift) no longer determines the length of the roll.";
        "hidden-markers": "The simulated camera does not image all markers.";
        "large-shift": "The sideways movement of a simulated press is larger than the contact radius, so the strains are not small.";
        "markers-at-surface": "The contact model moves the markers as if they were at the surface of the skin. The estimator, however, computes their displacements at their true depth.";
        "no-estimate": "The estimate of a simulated press fails even without noise (`no-estimate`), the estimator cannot be built (`no-estimator`), or the press is impossible (`no-press`).";
        "biased-estimate": "Even without noise, the estimated curvature of a simulated press differs from the true one, because the estimator's model differs from the simulated one.";
        "unchecked-indentation": "The readings alone do not determine an indentation, so the stated indentation cannot be checked.";
        "grid-beyond-contacts": "The grid of a glide extends beyond the contacts, so the fit is extrapolated there.";
        "flat-object": "The object is so flat that rounding errors of double precision change its curvature noticeably.";
        "few-crossings": "The contact of a roll crosses few edges of pads. Only the bounds of the curvature are meaningful: the estimate is the middle of the wide range between them.";
        "left-out": "The fit does not use some readings: lost readings, other outliers, rolls that cannot be used, or surplus rows of very long tables. The key `left_out` lists these readings, except for surplus rows: `row` in the readings, `line` in the file, and `reason` (`sentinel`, `zeros`, `far` or `misfit`).";
        "not-resolved-across": "The contacts lie along one stroke, or all rolls have the same direction. The readings determine the curvature along this direction, but not across it.";
        "two-groups": "The contacts seem to lie on two surfaces. Two planes, two spheres or two quadrics fit the contacts much better than one smooth surface does. The contacts may belong to two objects, or the object may have an edge.";
        "uncertain-shape": "Two shapes fit the contacts about equally well. Record more contacts over a larger part of the object.";
        "too-many-outliers": "More than a fifth of the contacts are lost readings, outliers, or contacts with another object.";
        "none-of-these": "None of the compared shapes fits the contacts. The radius is that of the shape that fits best, and has no interval. The methods `penalised` and `quadric` estimate the curvatures.";
        "correlated-noise": "The noise of consecutive contacts is correlated. Palpate therefore counts fewer independent contacts, and the intervals become wider.";
        "distant-contact": "One contact is much farther from its neighbours than all other contacts are from theirs.";
        "assumed-side": "The contacts have no normals, so the outer side of the object is assumed. The sign of the curvature depends on this assumption. For a single stroke, the magnitude of the curvature also depends on it. State the outer side with `--outward`, or record normals.";
        "assumed-indentation-std": "The indentation is stated without a standard deviation, so a standard deviation of 2 % is assumed.";
        "unstated-depth": "The depth of the markers is not stated; they are assumed to lie at the surface.";
        "offset": "Warning about presses: a fit with an offset that is common to all normal displacements explains the readings much better than the fit without it. Use `--baseline fitted`.";
        "clipped": "Warning about presses: several markers have exactly the largest displacement. Perhaps the sensor measures no larger ones.";
        "swapped-columns": "The displacements along the skin fit better with their columns swapped or their sign changed.";
        "lone-marker": "Only one marker shows the contact.";
        "unseen-contact": "Only the stated indentation indicates a contact; the displacements do not show one.";
        "large-contact": "The contact radius is a large share of the sensor's or the object's radius, so the strains are not small. The errors of the model may be about as large as the percentage in the message. A press with a smaller indentation reduces these errors.";
        "gaussian-body": "The fitted Gaussian is not an elastic contact model, so its intervals cover the noise but not the error of the model.";
        "srgb-frames": "The frame at rest fits the sensor only if its pixels are encoded by sRGB. Both frames were linearised. State `--srgb` to omit this warning.";
        "subsampled-colours": "The frame at rest is compressed with a lower resolution of its colours, as in JPEG 4:2:0. The calibration attributes the errors of the compression to the lens, so curvatures may have a bias of several percent.";
        "jpeg-frames": "The frames are compressed as JPEG. The compression changes all markers in a similar way, so all uncertainties are tripled.";
        "scatter-at-rest": "In the frame at rest, the markers differ from the model of the sensor by more than their noise explains. The number `ratio` states how many times as large the differences are. All uncertainties are multiplied by `ratio`.";
        "missing-markers": "Some markers of the layout were not found in the frames.";
        "other-camera": "The frame at rest contradicts the stated camera.";
        "camera-scale": "The stated scale of the camera, in pixels per radian, contradicts the calibration.";
        "uncertain-gain": "The gain of the calibration is uncertain, so the curvature is uncertain too.";
        "ignored-layer": "The study's contact model is a layer, but the estimator fits a half-space.";
        "uneven-pictures": "Palpate computes how light and blur change the images of markers at rest. This effect is different for displaced markers.";
    }
    "Failures of rolls" {
        "too-few-probes": "There are fewer than two rolls. The curvature of a surface has three components, and one roll determines two of them. Roll in at least two directions. In a time series without a column `probe`, a new roll starts after a blank line, or where the time does not increase.";
        "unresolvable-set": "All rolls have nearly the same direction, so the curvature across this direction is undetermined. Add a roll in another direction.";
        "noisy-rotations": "In some direction, more than half of the sum of squared rotations comes from measurement errors. Use longer rolls or a finer encoder.";
        "unresolved": "The contact did not move in some direction although the probe rolled. The object's curvature is too large for the pitch of the pads, so the readings give only a bound on its radius. Use finer pads or longer rolls.";
        "not-rolling": "The contact moved against the direction of the roll, which is impossible in a rolling contact. The noise is larger than the movement, or a sign of the readings is wrong. Use longer rolls or less noise. In recorded readings, a contact that moves to +u has rotation_y < 0.";
        "too-few-rolls": "There are fewer than two usable time series of rolls. A roll is not usable if it has fewer than two samples, does not rotate or stays on one pad.";
        "time-order": "As an error: a time in the time series of a roll is not later than the time before it. As a warning: several rows of a recorded table have the same time but different readings, so palpate uses the order of the rows.";
        "off-probe": "A contact position in a time series is more than half the circumference of the probe away. The lengths may be in another unit.";
        "contradiction": "The rotations in the time series of a roll contradict the pads of this roll, or the other rolls, by more than the stated noise. The pitch, the radius of the probe or the axes may be wrong, or the probe slipped.";
        "changing-curvature": "The method `pad-edge` assumes that the curvature is constant. As an error: the readings show that the curvature changes along the rolls. As a warning: the readings do not show whether it changes, and if it does, the estimate may be wrong. Use the method `trajectory`, or roll less far.";
        "overlapping": "The object would penetrate the probe beside the contact, so a real probe cannot roll there.";
        "conforming": "The object is hollow and has almost the same radius as the probe or sensor. They would touch over a whole area, so there is no contact point and no finite effective radius. In `press`, this is also the name of a kind of contact.";
        "too-many-steps": "The integrator of the roll reached its largest number of steps before the end of the roll.";
        "singular": "The step of the integrator became too small, because the motion of the contact is singular at one point of the roll.";
        "beyond-pads": "The contact rolled beyond the part of the fingertip that has pads.";
    }
    "Failures of glides" {
        "contact-lost": "The tip passes beside the object without a contact.";
        "two-contacts": "The tip touches the object at two points at once, because a dish or valley of the object is narrower than the tip or equally narrow. Use a smaller tip.";
        "no-convergence": "The search for the contact did not converge. Either the lengths of the tip and the object differ too much for double precision, or the object is too rough for the tip.";
        "too-few-contacts": "There are fewer contacts than unknowns of the estimator. Record more contacts, or use the estimator quadric, which needs fewer contacts than the splines.";
        "bad-weight": "The weight of a contact is not greater than 0.";
        "bad-normal": "A normal has the length 0, so it has no direction.";
        "missing-normal": "Some contacts have a normal, and others have none.";
        "coincident": "All contacts are at the same point.";
        "collinear": "All contacts lie on one line, so the shape across this line is undetermined. Add a second finger, or a second path beside the first.";
        "folded": "The patch is folded, so it has no unique height over its mean plane: a normal is inclined by more than 85 degrees to the mean normal. Use a smaller patch, or check that all normals point outward.";
        "no-plane": "The contacts are spread equally in all directions, like those on a closed shape, so they have no mean plane.";
        "tip-too-large": "The path of the tip's centre is curved more strongly than a tip of this radius permits. Either --tip-radius is too large, or the readings are contact points and not positions of the tip.";
        "no-side": "The stated outward direction lies in the plane of the patch, so it does not determine which side is outside. Use another --outward X,Y,Z.";
        "undetermined": "The readings do not determine all unknowns: the unknowns can change in some way without any change of the predicted readings.";
    }
    "Failures of presses" {
        "off-skin": "The stated position of a marker is beyond the end of the skin. Position and sensor radius may be in different units.";
        "no-indentation": "The indentation is not positive, so the bodies do not touch.";
        "edge-contact": "The object is hollow and has a smaller radius than the sensor. The sensor touches the object's rim and not its bottom.";
        "too-deep": "The indentation is larger than its limit, for example the thickness of the soft layer.";
        "too-wide": "The contact radius would exceed the sensor's radius, or 0.9 times the object's radius.";
        "layer-too-thin": "The contact is too wide compared with the thickness of the layer: palpate cannot solve the equations of the contact.";
        "too-few-markers": "There are fewer readings of markers than unknowns.";
        "no-contact": "The markers did not move, moved only within their noise, or all moved in the same way. The best fit of a press therefore explains the readings hardly better than no press does. If nothing touches the sensor, palpate mistakes noise for a contact in fewer than 5 of 100 presses. Use a deeper press or less noise. In recorded readings, inward displacements are positive.";
        "other-body": "The model of the soft body, its thickness or the depth of the markers is wrong. The code `other-body` is an error if no press fits the readings, and a warning if the fit is bad.";
        "off-markers": "The contact that fits the readings best is outside the area of the markers.";
        "hidden-marker": "In the frame at rest, a marker was found where the stated camera could not see it. The layout or the camera differs from the stated one.";
    }
    "Failures of cameras and frames" {
        "folded-lens": "With these terms k3 and k5, the lens would map two different polar angles within its field to the same image point.";
        "bad-depth": "A disc of a marker would lie outside the skin, or at the sensor's centre.";
        "off-the-skin": "A marker would be half a turn or more away from the apex.";
        "too-many-markers": "The sensor has more markers than palpate accepts. The message states the limit.";
        "discs-overlap": "The discs of two markers overlap, seen from the centre of the sphere.";
        "wrong-count": "The number of displacements differs from the number of markers.";
        "impossible-motion": "The displacement of a disc is not finite, or is at least as long as the disc's distance from the sensor's centre.";
        "out-of-field": "The image circle does not contain the contact or the marker that is measured.";
        "empty-image": "The frame has no pixels.";
        "too-small": "The frame, or its part inside the image circle, is too small for a marker.";
        "too-large": "The frame has more pixels along a side than palpate accepts. The message states the limit.";
        "mask-outside": "The radius of the image circle is not positive, or its centre is outside the frame.";
        "no-markers": "Regions of the frame may differ from the background, but none of them has the size, shape and colour of a marker.";
        "too-many": "The frame has more separate regions than a sensor has markers: the frame is noisy, or it does not show a sensor.";
    }
    "Other failures" {
        "off-domain": "The surface does not extend to the contact, or its formula is undefined there.";
        "chart-singular": "The coordinates of the surface are singular at the contact, although the surface itself is regular.";
        "no-closest-point": "Several points of the surface are equally close to the given point, for example if the point is the centre of a ball.";
        "not-finite": "A number, or a result that is computed from it, is not finite or too large to be squared.";
        "out-of-range": "The numbers exceed the range of double precision: lengths differ too much, or are in a wrong unit.";
        "bad-setting": "A setting is out of its range. The message states the setting, its value and the allowed range.";
        "negative-std": "An estimator reported a negative standard deviation; this is a defect of palpate.";
        "unknown-quantity": "A trial returned a quantity that its scene does not have; this is a defect of palpate.";
        "usage": "Kind of an error: the arguments or the config are wrong; exit status 2.";
        "work": "Kind of an error: the work failed, or the readings are bad; exit status 1.";
        "stopped": "Kind of an error: a signal stopped the work; exit status 130 or 143. The same command resumes the work.";
    }
}

/// Returns the term, quantity or statistic with this name; `None` if there is none. Case does not matter, and hyphens,
/// underscores and spaces count as equal.
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

/// Term that explains the column or key `word`: the term with this name, or a term whose meaning contains this name
/// between backticks. If there is no such term, the search is repeated without the last part of the name (a unit, a
/// component or `std`).
///
/// ```
/// use palpate_study::glossary::related;
///
/// assert_eq!(related("k_max_per_mm").map(|term| term.name), Some("k_max"));
/// assert_eq!(related("concave95").map(|term| term.name), Some("convex95"));
/// ```
pub fn related(word: &str) -> Option<Term> {
    const ENDS: &str = " mm cm m um mm2 px deg rad turns s n per std x y z u v high low ";
    let word = spelt(word);
    let mut name = word.as_str();
    loop {
        let quoted = format!("`{name}`");
        let mentioning = || all().find(|term| term.meaning.replace('-', "_").contains(&quoted));
        match (meaning(name).or_else(mentioning), name.rsplit_once('_')) {
            (None, Some((before, end))) if ENDS.contains(&format!(" {end} ")) => name = before,
            (found, _) => return found,
        }
    }
}

/// Smallest number of letters of a word that counts as similar to every longer word that contains it.
const MIN_PART: usize = 3;

/// Up to five names of terms, quantities or statistics that are similar to `word`, the most similar first.
pub fn similar(word: &str) -> Vec<&'static str> {
    let word = spelt(word);
    let likeness = |term: Term| {
        let name = spelt(term.name);
        let is_part = |part: &str, whole: &str| part.len() >= MIN_PART && whole.contains(part);
        let likeness = match is_part(&word, &name) || is_part(&name, &word) {
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
