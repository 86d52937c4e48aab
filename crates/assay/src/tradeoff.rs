//! Error against a trusted truth and cost per evaluation, for every ladder of the system.
