//! Segue's motion core.
