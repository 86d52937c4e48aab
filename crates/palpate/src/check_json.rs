//! Converts the forecast of a study to JSON.

use serde_json::{Value as Json, json};

use crate::check::{Check, Rungs};
use crate::coverage::{Coverage, Family};
use palpate_scene::Accuracy;
use palpate_study::config::ModelConfig;

impl Check {
    /// The forecast as a JSON object.
    pub fn to_json(&self) -> Json {
        let groups = self.groups.iter().map(|group| {
            json!({
                "cells": group.cells,
                "needs": group.needs,
                "needless": group.needless,
                "rungs": of_rungs(&group.rungs),
            })
        });
        let intervals = self.intervals.iter().map(of_coverage);
        json!({
            "cells": self.cells,
            "checked": self.checked,
            "set_up": self.set_up,
            "single": self.single,
            "trials": self.trials,
            "seconds": self.seconds,
            "threads": self.threads,
            "groups": groups.collect::<Vec<Json>>(),
            "intervals": intervals.collect::<Vec<Json>>(),
        })
    }
}

fn of_coverage((cells, tested): &(usize, Coverage)) -> Json {
    let measured = |family: &Family, beyond: Option<&str>| {
        json!({
            "cells": cells,
            "family": family.name,
            "beyond": beyond,
            "scenes": family.scenes,
            "coverage95": family.coverage95,
            "lowest": family.lowest,
            "holds": family.holds(),
        })
    };
    match tested {
        Coverage::Measured(family) => measured(family, None),
        Coverage::Outside(family, beyond) => measured(family, Some(beyond)),
        Coverage::NotMeasured(why) => json!({ "cells": cells, "not_tested": why }),
    }
}

fn of_rungs(rungs: &Rungs) -> Json {
    match rungs {
        Rungs::None | Rungs::NotMeasured => Json::Null,
        Rungs::AsIn(cell) => json!({ "as_in_cell": cell }),
        Rungs::Measured {
            cell,
            ladder,
            times,
        } => {
            let all = times.iter().map(|(place, time)| {
                let rung = &ladder.rungs[*place];
                json!({
                    "name": rung.name,
                    "taken": *place == ladder.taken,
                    "error": rung.accuracy.error(),
                    "cannot": match &rung.accuracy {
                        Accuracy::Error(_) => None,
                        Accuracy::Impossible(reason) => Some(reason),
                    },
                    "seconds": time,
                    "each_trial": time.map(|_| matches!(rung.model, ModelConfig::Roll(_))),
                })
            });
            json!({
                "cell": cell,
                "reason": ladder.reason,
                "tolerance": ladder.tolerance,
                "rungs": all.collect::<Vec<Json>>(),
            })
        }
    }
}
