//! Claims 1 to 4, 20 and 21 about single rolls (1996 paper, section 4.1). Lengths are in units of the probe's radius
//! R₁.

use super::bounds::Bound::{Above, AtLeast, AtMost, Between};
use super::bounds::{greatest, is, near, percent, range, short, within};
use super::claim::Claim;
use super::row::{Row, probe_radius, roll_angle, size, sorted};
use crate::study;

const RADIUS: &str = "scene.probe.radius";
const NOISE: &str = "scene.noise.angular_velocity.fraction";
const ARC: &str = "scene.motion.arc_length";

pub(super) fn claims() -> [Claim; 6] {
    [
        relative_curvature(),
        length_on_sphere(),
        length_on_paraboloid(),
        paraboloids(),
        edge(),
        wrist(),
    ]
}

/// Creates a claim about rolls on convex objects.
pub(super) fn of_convex(number: u32, texts: [&'static str; 3]) -> Claim {
    Claim::new(
        number,
        texts,
        "normal_curvature_u of a convex object",
        is_convex,
    )
    .numbers(&[RADIUS])
}

fn is_convex(row: &Row<'_>) -> bool {
    row.quantity() == "normal_curvature_u"
        && row.statistic("truth").is_some_and(|truth| truth > 0.0)
}

fn mean_error(row: &Row<'_>) -> Option<f64> {
    row.statistic("relative_mean_abs_error")
}

pub(super) fn rms_error(row: &Row<'_>) -> Option<f64> {
    row.statistic("relative_rms_error")
}

pub(super) fn size_in_words(row: &Row<'_>) -> String {
    format!("R₂ = {} R₁", short(size(row).unwrap_or_default()))
}

fn noise(row: &Row<'_>) -> Option<f64> {
    row.number(NOISE)
}

fn is_noisy(row: &Row<'_>) -> bool {
    is_convex(row) && noise(row) != Some(0.0)
}

fn relative_curvature() -> Claim {
    let gain = |row: &Row<'_>| Some(mean_error(row)? / noise(row)?);
    let says = [
        "Error grows as relative curvature falls",
        "dramatic from R₂ = 50 R₁",
        "The error for a given noise in angular velocity grows as the relative curvature falls, \
         dramatically from R₂ of about 50 R₁ up.",
    ];
    Claim::new(1, says, "normal_curvature_u of a convex object", is_noisy)
        .numbers(&[RADIUS, NOISE])
        .steps(&["scene.object", "scene.probe"], size, mean_error)
        .bound(Above(1.0))
        .says("the mean error rises in {count} steps to a lower relative curvature")
        .rows(gain)
        .only(size, AtLeast(50.0))
        .bound(AtLeast(10.0))
        .says("it is {range} × the noise for R₂ ≥ 50 R₁")
        .headline("{range} × the noise")
        .rows(gain)
        .only(size, AtMost(5.0))
        .bound(AtMost(2.0))
        .says("it is {range} × the noise for R₂ ≤ 5 R₁")
        // Let n be the amplitude of the uniform noise. The standard deviation of the noise is n/√3. Four probes roll
        // along each direction, so the noise of their mean has the standard deviation n/√12. Compute the ratio of the
        // rms error to its predicted value, n/√12 (1 + R₂/R₁).
        .rows(|row| Some(rms_error(row)? * 12f64.sqrt() / (noise(row)? * (1.0 + size(row)?))))
        .when(has_eight_uniform_probes)
        .only(noise, AtMost(0.01))
        .bound(Between(0.95, 1.05))
        .if_present()
        .says("up to 1 % noise the rms error is {range} × the predicted noise × (1 + 1/RCR)/√12")
}

/// Whether a table row has the paper's noise and directions: the noise is uniform and drawn once per probe, and two
/// probes roll in each of the directions ±u and ±v.
fn has_eight_uniform_probes(row: &Row<'_>) -> bool {
    const DIRECTIONS: [f64; 8] = [0.0, 0.0, 90.0, 90.0, 180.0, 180.0, 270.0, 270.0];
    let word = |path: &str| row.text(path);
    let is_paper = |directions: &toml::Value| {
        let directions = directions.as_array().into_iter().flatten();
        directions.map(study::number).eq(DIRECTIONS.map(Some))
    };
    let directions = row.study.setting("scene.motion.directions_deg");
    let rolls = row.number("scene.motion.rolls");
    word("scene.noise.angular_velocity.kind") == Some("uniform")
        && word("scene.noise.angular_velocity.when").is_none_or(|when| when == "per-probe")
        && rolls.is_none()
        && directions.is_none_or(is_paper)
}

fn length_on_sphere() -> Claim {
    let says = [
        "Roll length does not affect spheres",
        "no effect",
        "On a sphere the length of the roll does not change the error from noise in angular velocity.",
    ];
    Claim::new(2, says, "normal_curvature_u of a sphere", |row| {
        is_noisy(row) && row.text("scene.object.kind") == Some("sphere")
    })
    .numbers(&[RADIUS, NOISE])
    .groups(&["scene.motion"], |group| {
        let lengths = range(group.iter().filter_map(roll_angle))?;
        let (low, high) = range(group.iter().filter_map(mean_error))?;
        (!near(lengths.0, lengths.1) && high > 0.0).then(|| (high - low) / high)
    })
    .bound(AtMost(0.05))
    .says(
        "the mean error changes by {max%} between rolls of different length| ({n} combinations of \
        radius and noise)",
    )
    .headline("{max%} change")
    .rows(roll_angle)
    .reports("the rolls are {range} rad long")
}

// ---- Paraboloids z = −c r² at equal arc lengths

fn c(row: &Row<'_>) -> Option<f64> {
    Some(row.number("scene.object.c")? * probe_radius(row)?)
}

fn arc_length(row: &Row<'_>) -> Option<f64> {
    Some(row.number(ARC)? / probe_radius(row)?)
}

fn c_in_words(row: &Row<'_>) -> String {
    format!("c = {}", short(c(row).unwrap_or_default()))
}

fn is_noiseless(row: &Row<'_>) -> bool {
    noise(row).unwrap_or(0.0) == 0.0
}

fn of_paraboloids(number: u32, texts: [&'static str; 3]) -> Claim {
    of_convex(number, texts).numbers(&[RADIUS, "scene.object.c", ARC])
}

fn length_on_paraboloid() -> Claim {
    let says = [
        "Long rolls spoil paraboloids",
        "rapid growth; c = 5 fails",
        "On a paraboloid the error grows rapidly with the length of the roll; c = 5 cannot be estimated at a \
         reasonable length even without noise.",
    ];
    of_paraboloids(3, says)
        .rows(mean_error)
        .when(is_noiseless)
        .only(arc_length, is(0.1))
        .named(c_in_words)
        .reports("without noise the error at an arc length of 0.1 R₁ is {list%}")
        .rows(mean_error)
        .when(is_noiseless)
        .only(arc_length, is(0.3))
        .named(c_in_words)
        .reports("at 0.3 R₁ it is {list%}")
        .steps(&[ARC], arc_length, |row| {
            mean_error(row).filter(|error| *error > 0.0 && *error < 0.5)
        })
        .when(is_noiseless)
        .when(|row| {
            [0.1, 0.3]
                .iter()
                .any(|length| within(arc_length, is(*length))(row))
        })
        .bound(AtLeast(3.0))
        .says("tripling the length multiplies errors that stay below 50 % by {range}")
        .headline("× {range} per tripling")
        .rows(mean_error)
        .when(is_noiseless)
        .only(arc_length, is(0.1))
        .only(c, is(5.0))
        .bound(Above(0.15))
        .says("c = 5 is off by {range%} already at 0.1 R₁")
}

fn paraboloids() -> Claim {
    let says = [
        "Paraboloids are estimated within 15 %",
        "about 15 %",
        "The curvatures of paraboloids with c from 1 to 0.01 are estimated within about 15 %.",
    ];
    let end = |c_end: f64| move |row: &Row<'_>| is_noiseless(row) && within(c, is(c_end))(row);
    of_paraboloids(4, says)
        .needs("roll without noise on a paraboloid with c = 1", end(1.0))
        .needs("roll without noise on a paraboloid with c = 0.01", end(0.01))
        .rows(mean_error)
        .when(is_noiseless)
        .when(|row| [0.1, 0.3].iter().any(|length| within(arc_length, is(*length))(row)))
        .only(c, Between(0.01, 1.0))
        .bound(AtMost(0.15))
        .says("without noise, the largest error for c = 1 to 0.01, of rolls by 0.1 and 0.3 R₁, is {max%}")
        .headline("{max%} at worst")
        .rows(|row| Some((mean_error(row)? - exact_error(c(row)? * arc_length(row)?)).abs()))
        .when(is_noiseless)
        .reports("noiseless errors differ from the closed form by up to {max%}")
        .rows(|row| Some(crossing() / c(row)?))
        .named(c_in_words)
        .reports("by the closed form 15 % is crossed at an arc length, in R₁, of {list}")
        .rows(mean_error)
        .only(noise, Above(0.0))
        .only(arc_length, is(0.3))
        .only(c, Between(0.01, 1.0))
        .named(|row| format!("{} noise", percent(noise(row).unwrap_or_default())))
        .merged(greatest)
        .reports("with noise, at 0.3 R₁, the worst mean error is {list%}")
        .remark(
            "The paper states radii of 500 to 2.5 for C of 5 to 0.01, which contradict each other: the apex of \
             z = −C r² has the radius 1/(2C), 0.1 to 50 R₁, which is used here.",
        )
}

/// Arc length of the paraboloid z = −c r² from the apex to the point with the slope `x`, multiplied by 2c (no unit).
fn arc(x: f64) -> f64 {
    0.5 * (x * libm::hypot(1.0, x) + libm::asinh(x))
}

/// Largest slope for which `is_below` returns true, found by bisection. `is_below` must return true for all slopes
/// below a limit, and false above it.
fn slope(is_below: impl Fn(f64) -> bool) -> f64 {
    let (mut low, mut high) = (0.0, 1e9);
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        match is_below(middle) {
            true => low = middle,
            false => high = middle,
        }
    }
    low
}

/// Relative error of the estimated curvature at the apex of the paraboloid z = −c r², without noise. The roll begins at
/// the apex. The estimate is the mean curvature along the roll: the slope angle atan(2 c r) at the end of the roll,
/// divided by the arc length. `share` is the product of c and the arc length (no unit).
fn exact_error(share: f64) -> f64 {
    1.0 - libm::atan(slope(|x| arc(x) < 2.0 * share)) / (2.0 * share)
}

/// Arc length of a roll from the apex of the paraboloid z = −c r², multiplied by c (no unit). For this arc length, the
/// estimated curvature at the apex has a relative error of 15 % without noise.
fn crossing() -> f64 {
    0.5 * arc(slope(|x| libm::atan(x) > 0.85 * arc(x)))
}

// ---- Sharp objects, whose contact stays on one pad

/// Share of the trials of a table row in which the contact stays on one pad. Such a trial does not give a radius of the
/// object, but only an upper bound on it. `None` if the row has no trials.
fn unresolved(row: &Row<'_>) -> Option<f64> {
    row.failed(|kind| kind.starts_with("unresolved"))
}

/// All table rows of objects with the same radius. `all` is the number of their trials, and `unresolved` the number of
/// those trials in which the contact stayed on one pad.
struct Trials<'a> {
    rows: Vec<Row<'a>>,
    all: f64,
    unresolved: f64,
}

impl Trials<'_> {
    fn share(&self) -> f64 {
        self.unresolved / self.all.max(1.0)
    }
}

fn by_size<'a>(rows: &[Row<'a>]) -> Vec<Trials<'a>> {
    let mut rows = rows.to_vec();
    let size = |row: &Row<'_>| size(row).unwrap_or(f64::INFINITY);
    rows.sort_by(|a, b| size(a).total_cmp(&size(b)));
    let number = |row: &Row<'_>| row.statistic("trials").unwrap_or_default();
    let of_size = |rows: &[Row<'a>]| Trials {
        rows: rows.to_vec(),
        all: rows.iter().map(number).sum(),
        unresolved: rows
            .iter()
            .filter_map(|row| Some(unresolved(row)? * number(row)))
            .sum(),
    };
    rows.chunk_by(|a, b| near(size(a), size(b)))
        .map(of_size)
        .collect()
}

impl Claim {
    /// Adds a check with one value per radius of the object: `number(trials)` of all trials on objects with this
    /// radius.
    fn sizes(self, number: impl Fn(&Trials<'_>) -> f64 + 'static) -> Self {
        self.values(move |rows| {
            let sizes = by_size(rows).into_iter();
            sizes
                .map(|trials| (trials.rows[0], number(&trials)))
                .collect()
        })
    }
}

fn edge() -> Claim {
    let says = [
        "An edge gives only a bound",
        "sensed, no radius",
        "An edge can be sensed, but not its radius.",
    ];
    of_convex(20, says)
        .values(|rows| match &by_size(rows)[..] {
            [sharpest, _, ..] => {
                let rows = sharpest.rows.iter();
                rows.filter_map(|row| Some((*row, unresolved(row)?))).collect()
            }
            _ => Vec::new(),
        })
        .bound(AtLeast(1.0))
        .in_one()
        .says("on the sharpest object the contact of every trial stays on its pad in {count} cells|, so that only a bound on the radius is known")
        .headline("an edge gives only a bound in {count} cells")
        .values(|rows| match &by_size(rows)[..] {
            [sharpest, others @ ..] => {
                let excess = |trials: &Trials<'_>| trials.share() - sharpest.share();
                others.iter().map(|trials| (trials.rows[0], excess(trials))).collect()
            }
            [] => Vec::new(),
        })
        .bound(AtMost(0.0))
        .says("{count} other radii have no larger share of trials whose contact stays on one pad")
        .sizes(|trials| trials.share())
        .named(size_in_words)
        .reports("the share of trials whose contact stays on one pad is {list%}")
        .sizes(|trials| trials.unresolved.round())
        .named(size_in_words)
        .reports("the numbers of these trials are {list}")
        .sizes(|trials| trials.all)
        .reports("there are {range} trials for each radius")
}

// ---- Comparison of a wrist force sensor with pads

/// The rms errors of a wrist sensor and of pads count as similar if the larger one, divided by the smaller one, is at
/// most this number.
const ALIKE: f64 = 1.5;

/// Number after `word` in the label of a sensor, such as 0.5 in the label `pads 0.5 mm` for the word `pads `. `None` if
/// the label does not begin with this word and a positive number.
fn labelled_size(row: &Row<'_>, word: &str) -> Option<f64> {
    let label = row.text("scene.sensor")?.strip_prefix(word)?;
    let size: f64 = label.split_whitespace().next()?.parse().ok()?;
    (size > 0.0).then_some(size)
}

/// Whether the stated error of a wrist sensor is approximately equal to the size of the pads. Error and size are read
/// from the labels of the two sensors.
fn is_wrist_and_pads(wrist: &Row<'_>, pads: &Row<'_>) -> bool {
    let sizes = labelled_size(wrist, "wrist ").zip(labelled_size(pads, "pads "));
    sizes.is_some_and(|(wrist, pads)| libm::log(pads / wrist).abs() <= libm::log(ALIKE) / 2.0)
}

/// Size of the pads that would have the same rms error as the wrist sensor, interpolated between two pad sizes. `None`
/// if the wrist sensor's error is outside the range of the pads' errors.
fn equal_pads(group: &[Row<'_>]) -> Option<f64> {
    let is_compared = |wrist: &&Row<'_>| group.iter().any(|pads| is_wrist_and_pads(wrist, pads));
    let error = group.iter().find(is_compared).and_then(rms_error)?;
    let pads = sorted(group, |row| labelled_size(row, "pads "), rms_error);
    pads.windows(2).find_map(|pair| {
        let ((x0, y0), (x1, y1)) = (pair[0], pair[1]);
        (y0 < y1 && (y0..=y1).contains(&error))
            .then(|| x0 * libm::pow(x1 / x0, libm::log(error / y0) / libm::log(y1 / y0)))
    })
}

fn wrist() -> Claim {
    let says = [
        "Wrist sensor acts like coarse pads",
        "like pads of 0.54 mm",
        "A wrist sensor's contact error of 0.54 mm (2.7 % of a probe of R₁ = 10 mm across) \
            acts like pads of that size.",
    ];
    of_convex(21, says)
        .needs("scene.sensor labelled \"wrist SIZE\"", |row| labelled_size(row, "wrist ").is_some())
        .pairs(&["scene.sensor"], is_wrist_and_pads, |row| rms_error(row).filter(|error| *error > 0.0))
        .bound(Between(1.0 / ALIKE, ALIKE))
        .says("the rms error of the wrist sensor is {range} × that of pads of its size| (over \
            {n} objects)")
        .headline("{range} × their error")
        .groups(&["scene.sensor"], equal_pads)
        .reports("it acts like pads of {range} mm at {n} of the objects")
        .remark(
            "Pad sizes are interpolated between logarithms. A mean distance of 0.54 mm is a standard deviation of \
             0.43 mm along each axis, more than that of the rounding of 0.54 mm pads (0.54/√12 = 0.16 mm).",
        )
}
