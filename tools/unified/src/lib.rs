//! A crate of dependencies alone. Cargo builds a package once for each set of features that a build
//! asks of it, and once more everything above it: the libraries take minutes. Tests with the
//! window, tests without it and the Python package of the tests depend on this, and share one build
//! of the libraries.
