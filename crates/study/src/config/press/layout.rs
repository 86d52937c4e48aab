//! Layouts of the markers along the skin.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Places of the markers along the skin: the name of a layout, or a table that makes one.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum LayoutConfig {
    /// A layout that has a name.
    Named(NamedLayout),
    /// A layout that is made from its settings.
    Table(LayoutTable),
}

impl Default for LayoutConfig {
    fn default() -> Self {
        Self::Named(NamedLayout::Published)
    }
}

/// A layout that has a name.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum NamedLayout {
    /// The 77 markers of the 2020 paper: one at the apex, rows of 1, 3, 3, 5, 7 in each of 4 gores, 11.9° apart.
    Published,
}

/// A layout that is made.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "kebab-case", deny_unknown_fields)]
pub enum LayoutTable {
    /// A marker at the apex, and rows of markers in each of several equal gores.
    Gores {
        /// How many gores share the circle.
        #[schemars(extend("minimum" = 1))]
        gores: u32,
        /// Markers of each row of a gore, from the apex outward.
        rows: Vec<u32>,
        /// Polar angle between neighbouring rows.
        #[schemars(extend("exclusiveMinimum" = 0, "maximum" = 180))]
        row_spacing_deg: f64,
    },
    /// An even density of markers over a cap around the apex.
    Lattice {
        /// Distance between neighbouring markers.
        #[schemars(extend("exclusiveMinimum" = 0, "x-unit" = "length"))]
        pitch: f64,
        /// Polar angle of the cap's rim.
        #[schemars(extend("exclusiveMinimum" = 0, "maximum" = 180))]
        cap_deg: f64,
    },
    /// Markers in equal steps on a great circle along x, the apex in their middle.
    Line {
        /// How many.
        #[schemars(extend("minimum" = 2, "maximum" = 100_000))]
        markers: u32,
        /// Distance from the first marker to the last along the skin.
        #[schemars(extend("exclusiveMinimum" = 0, "x-unit" = "length"))]
        length: f64,
    },
    /// Markers in equal steps along x, the first at the apex.
    Radius {
        /// How many.
        #[schemars(extend("minimum" = 2, "maximum" = 100_000))]
        markers: u32,
        /// Distance from the first marker to the last along the skin.
        #[schemars(extend("exclusiveMinimum" = 0, "x-unit" = "length"))]
        length: f64,
    },
}
