//! Numbers that are left out of configs where they are 0.

/// Whether a number is 0.
// `skip_serializing_if` takes a reference.
#[allow(clippy::trivially_copy_pass_by_ref)]
pub(super) fn is_zero(number: &f64) -> bool {
    *number == 0.0
}
