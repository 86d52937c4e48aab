//! Claim 17: regimes of contact by relative curvature (2020 paper, section III.A, Fig. 2).

use super::evidence::{groups, near, percent, range, short, span};
use super::finding::Finding;
use super::presses::{kind, number, rows_of};
use crate::Study;
use palpate_study::label::spoken_unit;

/// Contact at a point is sensed if at least this share of the 95 % intervals holds the true relative curvature …
const HONEST: f64 = 0.9;
/// … and at most this share of the trials fails.
const FAILING: f64 = 0.1;
/// A relative curvature below this share of the sensor's own is zero.
const ZERO: f64 = 1e-9;
/// The kinds of failure where bodies conform, and where they touch at an edge.
const CONFORMING: &str = "conforming";
const EDGE: &str = "edge-contact";

/// Claim 17.
pub(super) fn go_by_relative_curvature(study: &Study) -> Result<Finding, String> {
    let rows = rows_of(study, "relative_curvature");
    if groups(study, &rows, &["scene.probe.radius", "scene.object"]).len() > 1 {
        return Err("the table sweeps more than scene.probe.radius and scene.object".to_owned());
    }
    let presses = rows.into_iter().map(|row| press(study, row));
    let presses: Vec<Press> = presses.collect::<Result<_, String>>()?;
    let of = |sign: Sign| presses.iter().filter(move |press| press.sign == sign);
    for (sign, name) in [
        (Sign::Positive, "positive"),
        (Sign::Zero, "zero"),
        (Sign::Negative, "negative"),
    ] {
        if of(sign).next().is_none() {
            return Err(format!(
                "the table has no press of {name} relative curvature"
            ));
        }
    }
    let as_said = |sign: Sign| {
        let right = of(sign).filter(|press| press.is_as_said()).count();
        (right, of(sign).count())
    };
    let told = |(right, all): (usize, usize)| format!("{right} of {all}");
    let [positive, zero, negative] = [Sign::Positive, Sign::Zero, Sign::Negative].map(as_said);
    let coverage = range(of(Sign::Positive).filter_map(|press| press.coverage));
    let coverage = coverage.map_or(String::new(), |range| {
        format!(
            " (their 95 % intervals hold the truth in {})",
            span(range, percent)
        )
    });
    let (versatility, falls) = versatility(&presses)?;
    let unit = study.setting("length_unit").and_then(toml::Value::as_str);
    let unit = spoken_unit(unit.unwrap_or_default());
    let counts: Vec<String> = versatility.sensed.iter().map(usize::to_string).collect();
    let radii: Vec<String> = versatility
        .radii
        .iter()
        .map(|radius| short(*radius))
        .collect();
    Ok(Finding {
        holds: falls
            && [positive, zero, negative]
                .iter()
                .all(|(right, all)| right == all),
        measured: format!(
            "Of the cells of positive relative curvature {} are sensed{coverage}; of those at zero {} fail as {CONFORMING}, of those below {} as {EDGE}. Of {} objects a sensor of radius {} {unit} senses {}.",
            told(positive),
            told(zero),
            told(negative),
            versatility.objects,
            radii.join(", "),
            counts.join(", "),
        ),
        why: format!(
            "Holds if all are so, and the number of objects never rises with the sensor's radius and falls from the smallest to the largest. Sensed: at least {} of the intervals on the relative curvature hold the truth, and at most {} of the trials fail.",
            percent(HONEST),
            percent(FAILING)
        ),
    })
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Sign {
    Positive,
    Zero,
    Negative,
}

/// Cell of the table.
struct Press {
    sensor_radius: f64,
    sign: Sign,
    /// Shares of the trials that failed at all, as conforming and at an edge.
    failed: f64,
    conforming: f64,
    edge: f64,
    /// Share of the intervals that hold the truth; none where nothing was estimated.
    coverage: Option<f64>,
}

impl Press {
    fn is_sensed(&self) -> bool {
        self.failed <= FAILING && self.coverage.is_some_and(|share| share >= HONEST)
    }

    fn is_as_said(&self) -> bool {
        match self.sign {
            Sign::Positive => self.is_sensed(),
            Sign::Zero => self.conforming >= 1.0,
            Sign::Negative => self.edge >= 1.0,
        }
    }
}

fn press(study: &Study, row: usize) -> Result<Press, String> {
    let table = study.cells();
    let sensor_radius = study
        .number(row, "scene.probe.radius")
        .filter(|radius| *radius > 0.0)
        .ok_or("no number for scene.probe.radius in the table or the config")?;
    let object_curvature = || match kind(study, row, "scene.object")? {
        "plane" => Some(0.0),
        "sphere" => Some(1.0 / number(study, row, "scene.object", "radius")?),
        "dish" => Some(-1.0 / number(study, row, "scene.object", "radius")?),
        _ => None,
    };
    let relative = table
        .statistic(row, "truth")
        .or_else(|| Some(1.0 / sensor_radius + object_curvature()?))
        .ok_or("neither table nor config tell the relative curvature of every cell")?;
    let sign = match relative * sensor_radius {
        ratio if ratio > ZERO => Sign::Positive,
        ratio if ratio < -ZERO => Sign::Negative,
        _ => Sign::Zero,
    };
    let trials = table
        .statistic(row, "trials")
        .filter(|trials| *trials > 0.0);
    let trials = trials.ok_or("a cell without trials")?;
    let failures = || {
        let cell = table.cell(row);
        study
            .failures()
            .iter()
            .filter(move |failure| failure.cell == cell)
    };
    let share = |kind: &str| {
        let counts = failures().filter(|failure| failure.kind == kind);
        counts.map(|failure| failure.count as f64).sum::<f64>() / trials
    };
    let failed = failures().map(|failure| failure.count as f64).sum::<f64>() / trials;
    let coverage = table.statistic(row, "coverage95");
    if sign == Sign::Positive && coverage.is_none() && failed < 1.0 {
        return Err("a press of positive relative curvature has no coverage95".to_owned());
    }
    Ok(Press {
        sensor_radius,
        sign,
        failed,
        conforming: share(CONFORMING),
        edge: share(EDGE),
        coverage,
    })
}

/// Numbers of objects, out of equally many, that sensors of rising radius sense.
struct Versatility {
    objects: usize,
    radii: Vec<f64>,
    sensed: Vec<usize>,
}

/// The versatility, and whether it falls with the radius.
fn versatility(presses: &[Press]) -> Result<(Versatility, bool), String> {
    let mut radii: Vec<f64> = presses.iter().map(|press| press.sensor_radius).collect();
    radii.sort_by(f64::total_cmp);
    radii.dedup_by(|a, b| near(*a, *b));
    let of = |radius: f64| {
        presses
            .iter()
            .filter(move |press| near(press.sensor_radius, radius))
    };
    let objects = presses.len() / radii.len().max(1);
    if radii.len() < 2 || radii.iter().any(|radius| of(*radius).count() != objects) {
        return Err("the table lacks two sensor radii, each on the same objects".to_owned());
    }
    let sensed: Vec<usize> = radii
        .iter()
        .map(|radius| of(*radius).filter(|press| press.is_sensed()).count())
        .collect();
    let falls = sensed.windows(2).all(|pair| pair[1] <= pair[0]) && sensed.last() < sensed.first();
    Ok((
        Versatility {
            objects,
            radii,
            sensed,
        },
        falls,
    ))
}
