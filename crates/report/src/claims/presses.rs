//! Claims 15 to 17 about presses (2020 paper, sections III.A and IV.B).

use super::bounds::Bound::{Above, AtLeast, AtMost, Below, Between};
use super::bounds::{is, near, short, within};
use super::claim::Claim;
use super::row::{Row, probe_radius};

const ESTIMATOR: &str = "scene.estimator";

pub(super) fn claims() -> [Claim; 3] {
    [gaussian_profile(), effective_radius(), regimes()]
}

fn gaussian_profile() -> Claim {
    let is_kind = |row: &Row<'_>, part: &str, kind| row.text(&format!("{part}.kind")) == Some(kind);
    let says = [
        "Gaussian fits the filtered profile",
        "R² 0.96",
        "A Gaussian fits the displacement that Hertz's theory gives under a layer of skin with \
            R² of 0.96.",
    ];
    Claim::new(15, says, "r_squared of a gaussian on a half-space press without noise", move |row| {
        // A press without noise runs only one trial. Therefore, a table row with one trial is a press without noise.
        row.quantity() == "r_squared"
            && row.statistic("trials") == Some(1.0)
            && is_kind(row, ESTIMATOR, "gaussian")
            && is_kind(row, "scene.model", "half-space")
    })
    .rows(|row| row.statistic("mean"))
    // Name the swept fields on which R² depends. The layout determines how many markers are in each part of the
    // displacement profile, and so the weight of this part in R². The estimator determines which markers are fitted.
    .named(|row| row.swept(&["scene.probe.layout", ESTIMATOR]))
    .bound(Between(0.95, 0.97))
    .in_one()
    .says("R² of the Gaussian on the profile of the half-space is {list}")
    .headline("R² {range}")
    .remark(
        "The cases are ways to spread the samples: the paper does not say how it weighs them. Its R² of 0.96 has two \
         digits.",
    )
}

// ---- The effective radius at increasing indentations

/// Effective radii that the paper states, mm: for a sensor of radius 20 mm that is pressed onto a dish of radius 80 mm,
/// onto a plane, and onto a ball of radius 80 mm.
const RADII: [f64; 3] = [26.7, 20.0, 16.0];
/// Largest indentation in the paper, mm.
const DEEPEST: f64 = 1.4;
/// Indentation below which noise dominates, mm. The paper states this value.
const SHALLOW: f64 = 1.0;

fn in_millimetres(row: &Row<'_>, statistic: &str) -> Option<f64> {
    Some(row.millimetres()? * row.statistic(statistic)?)
}

fn has_radius(row: &Row<'_>, radius: f64) -> bool {
    // The true value may differ from the paper's radius by 1 %, because the paper states rounded radii.
    in_millimetres(row, "truth").is_some_and(|truth| (truth - radius).abs() <= 0.01 * radius)
}

fn depth(row: &Row<'_>) -> Option<f64> {
    Some(row.millimetres()? * row.number("scene.motion.indentation")?)
}

fn error(row: &Row<'_>) -> Option<f64> {
    let truth = row.statistic("truth")?;
    Some((row.statistic("q50")? - truth).abs() / truth)
}

/// Half the distance between the 5 % and the 95 % quantile of the estimates, relative to the true value.
fn scatter(row: &Row<'_>) -> Option<f64> {
    Some((row.statistic("q95")? - row.statistic("q05")?) / (2.0 * row.statistic("truth")?))
}

/// Whether a table row belongs to the paper's estimator and to a sensor that reads displacements directly. Rows of
/// camera sensors are excluded, because they use another elastic model.
fn is_paper(row: &Row<'_>) -> bool {
    is_direct(row)
        && row.text("scene.estimator.kind") == Some("gaussian")
        && within(|row| row.number("scene.estimator.c"), is(1.0))(row)
}

fn is_direct(row: &Row<'_>) -> bool {
    matches!(row.text("scene.sensor.kind"), None | Some("direct"))
}

fn is_direct_fit(row: &Row<'_>) -> bool {
    is_direct(row) && row.text("scene.estimator.kind") == Some("half-space")
}

impl Claim {
    /// Adds sentences about the table rows that `is_it` accepts: the scatter of the estimates, and the share of failed
    /// trials.
    fn scatter(self, is_it: fn(&Row<'_>) -> bool) -> Self {
        self.rows(scatter)
            .when(is_it)
            .only(depth, Below(SHALLOW))
            .reports("below 1 mm it is {range%} of the radius")
            .rows(|row| row.failed(|_| true))
            .when(is_it)
            .only(depth, Below(SHALLOW))
            .without(0.0)
            .reports("up to {max%} of the trials fail there")
            .rows(scatter)
            .when(is_it)
            .only(depth, is(DEEPEST))
            .reports("at 1.4 mm it is {range%}")
    }
}

fn effective_radius() -> Claim {
    let beyond = |row: &Row<'_>| Some(scatter(row)? / error(row)?);
    let says = [
        "Effective radius converges with indentation",
        "31.4, 22.0, 15.4 mm",
        "The estimated effective radius converges to the true radius of 26.7, 20 or 16 mm as the indentation grows to \
         1.4 mm; below 1 mm noise dominates.",
    ];
    let what = "row of effective_radius whose true value is 26.7, 20 or 16 mm (the study must state its `length_unit`)";
    let mut claim = Claim::new(16, says, what, |row| {
        row.quantity() == "effective_radius" && RADII.iter().any(|radius| has_radius(row, *radius))
    })
    .needs("gaussian with c = 1 at an indentation below 1 mm", |row| {
        is_paper(row) && within(depth, Below(SHALLOW))(row)
    });
    for radius in RADII {
        let what = format!("median of {radius} mm at 1.4 mm by the gaussian with c = 1");
        claim = claim.needs(what, move |row| {
            let is_end = is_paper(row) && within(depth, is(DEEPEST))(row);
            is_end && has_radius(row, radius) && error(row).is_some()
        });
    }
    claim
        .rows(|row| in_millimetres(row, "q50"))
        .when(is_paper)
        .only(depth, is(DEEPEST))
        .named(|row| format!("for {}", short(in_millimetres(row, "truth").unwrap_or_default())))
        .reports("the gaussian with c = 1 has medians at 1.4 mm of {list} mm")
        .headline("{list} mm")
        .rows(error)
        .when(is_paper)
        .only(depth, is(DEEPEST))
        .bound(AtMost(0.2))
        .says("the median of the gaussian with c = 1 is off by {range%} at 1.4 mm")
        .rows(beyond)
        .when(is_paper)
        .only(depth, Below(SHALLOW))
        .bound(Above(1.0))
        .if_present()
        .says("below 1 mm its scatter exceeds the median's error in {count} cells")
        .pairs(
            &["scene.motion.indentation"],
            |one, other| within(depth, Below(SHALLOW))(one) && within(depth, is(DEEPEST))(other),
            scatter,
        )
        .when(is_paper)
        .bound(AtLeast(1.5))
        .if_present()
        .says("its scatter there is {range} times that at 1.4 mm")
        .scatter(is_paper)
        .rows(beyond)
        .when(is_direct_fit)
        .only(depth, Below(SHALLOW))
        .bound(Above(1.0))
        .reports("the scatter of the half-space fit exceeds the median's error in {count} cells \
            below 1 mm")
        .scatter(is_direct_fit)
        .rows(|row| in_millimetres(row, "q50"))
        .when(|row| !is_paper(row))
        .only(depth, is(DEEPEST))
        .named(|row| row.label(ESTIMATOR).to_owned())
        .reports("other estimators have medians at 1.4 mm of {list} mm")
        .rows(error)
        .when(|row| !is_paper(row))
        .only(depth, is(DEEPEST))
        .named(|row| row.label(ESTIMATOR).to_owned())
        .reports("they are off by {list%}")
        .remark(
            "The paper's own estimates are 18, 10 and 4 % off. Scatter is half the width from the 5 % to the 95 % \
             quantile. A cell without any estimate is left out.",
        )
}

// ---- Regimes of contact, as a function of the relative curvature

/// A relative curvature counts as zero if its absolute value, divided by the curvature of the sensor's surface, is at
/// most this number.
const ZERO: f64 = 1e-9;

fn relative_curvature(row: &Row<'_>) -> Option<f64> {
    let sensor = probe_radius(row)?;
    let object = || match row.text("scene.object.kind")? {
        "plane" => Some(0.0),
        "sphere" => Some(1.0 / row.number("scene.object.radius")?),
        "dish" => Some(-1.0 / row.number("scene.object.radius")?),
        _ => None,
    };
    let relative = row.statistic("truth");
    Some(sensor * relative.or_else(|| Some(1.0 / sensor + object()?))?)
}

/// 1 if the sensor of the table row can sense the object of this row, otherwise 0. `None` if some trials succeeded but
/// the row does not state the coverage of the intervals. A sensor can sense an object if at most 10 % of the trials
/// fail and at least 90 % of the 95 % intervals contain the true value.
fn sensed(row: &Row<'_>) -> Option<f64> {
    let failed = row.failed(|_| true)?;
    match row.statistic("coverage95") {
        Some(coverage) => Some(f64::from(u8::from(failed <= 0.1 && coverage >= 0.9))),
        None => (failed >= 1.0).then_some(0.0),
    }
}

/// For each sensor, one of its table rows and the number of objects that the sensor can sense. The sensors are sorted
/// by radius.
fn by_radius<'a>(rows: &[Row<'a>]) -> Vec<(Row<'a>, f64)> {
    let mut rows: Vec<(f64, Row<'a>)> = rows
        .iter()
        .filter_map(|row| Some((probe_radius(row)?, *row)))
        .collect();
    rows.sort_by(|a, b| a.0.total_cmp(&b.0));
    let number = |group: &[(f64, Row<'a>)]| {
        let sensed = group.iter().filter_map(|(_, row)| sensed(row));
        (group[0].1, sensed.sum())
    };
    rows.chunk_by(|a, b| near(a.0, b.0)).map(number).collect()
}

fn regimes() -> Claim {
    let says = [
        "Contact regime follows relative curvature",
        "by its sign",
        "Contact is at a point where the relative curvature is positive, ill-defined where it is zero, at the edge \
         where it is negative; so a small sensor is the most versatile.",
    ];
    Claim::new(17, says, "relative_curvature", |row| row.quantity() == "relative_curvature")
        .numbers(&["scene.probe.radius"])
        .rows(sensed)
        .only(relative_curvature, Above(ZERO))
        .bound(AtLeast(1.0))
        .says("{count} cells of positive relative curvature are sensed")
        .headline("{count} sensed")
        .rows(|row| row.statistic("coverage95"))
        .only(relative_curvature, Above(ZERO))
        .reports("their 95 % intervals hold the truth in {range%}")
        .rows(|row| row.failed(|kind| kind == "conforming"))
        .only(relative_curvature, Between(-ZERO, ZERO))
        .bound(AtLeast(1.0))
        .says("{count} cells of zero relative curvature fail as conforming")
        .headline("{count} conform")
        .rows(|row| row.failed(|kind| kind == "edge-contact"))
        .only(relative_curvature, Below(-ZERO))
        .bound(AtLeast(1.0))
        .says("{count} cells of negative relative curvature fail as edge-contact")
        .headline("{count} at edge")
        .values(|rows| {
            let numbers = by_radius(rows);
            let steps = numbers.windows(2).map(|pair| (pair[0].0, pair[1].1 - pair[0].1));
            steps.collect()
        })
        .bound(AtMost(0.0))
        .says("in {count} steps to a larger sensor no more objects are sensed")
        .values(|rows| match by_radius(rows)[..] {
            [first, .., last] => vec![(first.0, first.1 - last.1)],
            _ => Vec::new(),
        })
        .bound(Above(0.0))
        .says("the number of objects that are sensed falls by {range} from the smallest to the \
            largest sensor")
        .values(by_radius)
        .named(|row| format!("radius {}", short(probe_radius(row).unwrap_or_default())))
        .reports("sensors sense {list} objects")
        .groups(&["scene.object"], |group| Some(group.len() as f64))
        .reports("each presses {range}")
        .remark(
            "Sensed: at least 90 % of the 95 % intervals on the relative curvature hold the truth, and at most 10 % \
             of the trials fail.",
        )
}
