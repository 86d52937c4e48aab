//! Warnings of an estimate.

use serde::Serialize;

use crate::failure::Failure;
use crate::failure::with_flags;

/// Repeats on standard error what an estimate warns of.
pub(crate) fn warn(estimate: &impl Serialize) -> Result<(), Failure> {
    let json = serde_json::to_value(estimate).map_err(Failure::work)?;
    let warnings = json["warnings"].as_array().into_iter().flatten();
    for warning in warnings.filter_map(|warning| warning["text"].as_str()) {
        eprintln!("warning: {}", with_flags(warning));
    }
    Ok(())
}
