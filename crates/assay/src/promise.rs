//! Whether `auto` keeps its word.
