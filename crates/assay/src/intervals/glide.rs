//! Warnings of EP2 on random glides whose contacts contradict the model.

use anyhow::Result;
use palpate_ep2::{Method, Penalised};

use super::best_test::DisplacementTest;
use super::coverage::{Score, Sums, Tally, below_5_percent, detectable_where_short};
use super::glide_contacts::Path;
use super::glide_flaws::{Family, Flaw, displacement};
use super::patch::{errors, estimates};
use super::surface::Surface;
use super::{Options, case_scores, scenes};

/// Scores of all families. `report` gets each as soon as it is computed.
///
/// # Errors
/// If a surface has no contacts, or `report` fails.
pub fn scores(options: Options<'_>, report: impl Fn(&Score) -> Result<()>) -> Result<Vec<Score>> {
    case_scores(Family::all(), Family::name, options, report, |family| {
        let scenes = scenes(options, |number| tally(family, number, options))?;
        Ok([score(family, &scenes)])
    })
}

/// Trials of the scene with this number.
fn tally(family: &Family, number: u64, options: Options<'_>) -> Result<Tally> {
    let Family { case, flaw } = family;
    let surface = Surface::random(options.seed, number);
    let path = Path::random(options.seed, number);
    let places = path.map_places(&surface);
    let mut tally = Tally {
        sums: Sums::new(2.0 * options.trials as f64 * places.len() as f64),
        detectable: f64::NAN,
        ..Tally::default()
    };
    if *flaw == Flaw::Displaced {
        let test = DisplacementTest::new(case, &path, &surface, options.seed);
        let (finger, by) = displacement(case, options.seed, number);
        tally.detectable = test.map_or(f64::NAN, |test| test.power(finger, by));
    }
    let method = Penalised {
        noise: flaw.stated_noise(case.stated_noise()),
        ..Penalised::default()
    };
    for trial in 0..options.trials {
        let trial = number * options.trials + trial;
        let mut contacts = case.contacts(&surface, &path, options.seed, trial)?;
        flaw.add_to(case, &mut contacts, options.seed, number);
        let estimated = estimates(&method, &contacts, &places)
            .and_then(|(patch, curvatures)| Ok((curvatures, method.misfit(&patch)?)));
        let (curvatures, tested) = match estimated {
            Ok(estimated) => estimated,
            Err(error) => {
                tally.failures.add([error.name()]);
                continue;
            }
        };
        let warnings = tested.misfits.iter().map(|misfit| misfit.code());
        tally.add_estimate(tested.goodness.map(|fit| fit.p_value), warnings);
        for (error, std) in errors(&curvatures, &places).flatten() {
            tally.sums.add(error, std);
        }
    }
    Ok(tally)
}

/// Score of a family from its scenes.
fn score(family: &Family, scenes: &[Tally]) -> Score {
    let all: Vec<&Tally> = scenes.iter().collect();
    let (score, shares) = Score::new(family.name(), &all);
    Score {
        lowest: None,
        below_5_percent: Some(below_5_percent(scenes)),
        tellable_where_short: Some(detectable_where_short(&all)),
        is_within_limits: Some(match family.flaw {
            Flaw::None => shares.false_alarms_are_rare(),
            _ => shares.meet_limits(),
        }),
        ..score
    }
}
