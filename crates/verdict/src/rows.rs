//! Tables as source: one row per line.

/// Makes a test of a table. At most one in a module, after which the table is named.
///
/// A row is `ENTRY, INPUT => CALL;`, where the call must end in an [`Answer`](crate::Answer) that keeps what it
/// promises, or `ENTRY, INPUT, ERROR => CALL;`, where it must end in an error by that name: its variant in kebab case,
/// or itself if it is a text; `none` for `None`. The input is a format string. A row may stand for several:
/// `, for PATTERN in VALUES` runs it for each of the values.
///
/// ```
/// use palpate_verdict::{Answer, NOT_FINITE, rows};
///
/// rows! {
///     "f64::sqrt", "square of {x:e}" => Answer::near((x * x).sqrt(), x), for x in [1e-9, 1.0, 1e9];
///     "str::parse", "{bad:e}", "parse-int-error" => format!("{bad}").parse::<u8>(), for bad in NOT_FINITE;
///     "u8::checked_add", "1 beyond the most", "none" => u8::MAX.checked_add(1);
/// }
/// ```
#[macro_export]
macro_rules! rows {
    ($(
        $entry:expr, $input:literal $(, $error:expr)? => $call:expr $(, for $each:pat in $values:expr)*;
    )+) => {
        #[test]
        fn rows() {
            let mut table = $crate::Table::default();
            $($crate::row!(table [$entry, $input $(, $error)?] [$call] $(for $each in $values;)*);)+
            if let Err(broken) = table.finish(env!("CARGO_PKG_NAME"), module_path!()) {
                panic!("{broken}");
            }
        }
    };
}

/// Adds the rows of one line of [`rows!`].
#[doc(hidden)]
#[macro_export]
macro_rules! row {
    ($table:ident $row:tt $call:tt for $each:pat in $values:expr; $($rest:tt)*) => {
        for $each in $values {
            $crate::row!($table $row $call $($rest)*);
        }
    };
    ($table:ident [$entry:expr, $input:literal] [$call:expr]) => {
        $table.value($entry, format!($input), || $call)
    };
    ($table:ident [$entry:expr, $input:literal, $error:expr] [$call:expr]) => {
        $table.refused($entry, format!($input), $error, || $call)
    };
}
