//! Finding of a claim in its tables.

/// Finding of a claim.
pub(super) struct Finding {
    /// Whether the tables show what the paper says.
    pub(super) holds: bool,
    /// Finding in words, with units.
    pub(super) measured: String,
    /// Thresholds behind the verdict, and further remarks.
    pub(super) why: String,
}
