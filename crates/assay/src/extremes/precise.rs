//! Closed forms in more digits than a double has.
