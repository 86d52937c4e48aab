//! Kinds of results.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A kind of result.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Output {
    /// The table of cells and quantities.
    Cells,
    /// One noiseless pass of the first cell.
    Trace,
    /// The estimated curvatures over a patch; of a press, the true and the estimated displacement along a radius.
    Map,
}
