//! What one evaluation costs.
