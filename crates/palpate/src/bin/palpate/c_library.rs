//! Elementary functions that dependencies take from the C library, which would round as the host does.
#![allow(unsafe_code, reason = "an exported name is all that is unsafe here")]

/// Power x^y, for the progress bar and the page's templates. No table needs it: `palpate-replica` has the simulation
/// without them, and imports no elementary function either.
#[unsafe(no_mangle)]
extern "C" fn pow(x: f64, y: f64) -> f64 {
    libm::pow(x, y)
}

/// Natural logarithm, for filters of Parquet that no table has.
#[cfg(feature = "parquet")]
#[unsafe(no_mangle)]
extern "C" fn log(x: f64) -> f64 {
    libm::log(x)
}

/// Logarithm to base 10, for decimal numbers of Parquet that no table has.
#[cfg(feature = "parquet")]
#[unsafe(no_mangle)]
extern "C" fn log10(x: f64) -> f64 {
    libm::log10(x)
}
