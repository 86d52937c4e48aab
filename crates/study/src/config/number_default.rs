//! Functions that return numbers as defaults of config keys, for `#[serde(default = "…")]`.

pub(super) const fn whole<const N: u32>() -> u32 {
    N
}

pub(super) const fn count<const N: u64>() -> u64 {
    N
}

pub(super) fn number<const N: u32>() -> f64 {
    f64::from(N)
}
