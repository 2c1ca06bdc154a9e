//! The keys of parameters.

use super::table::parameters;

macro_rules! keys {
    ($($key:ident $name:literal $label:literal $group:ident$(($lab:ident))?, $kind:expr, $default:expr, $unit:literal, $help:literal $([$($mark:ident),*])? $(in $labs:tt)?;)*) => {
        /// The name of a parameter inside the program; its row is [`Key::param`].
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
        #[expect(missing_docs, reason = "the help sentence of the row says it")]
        pub enum Key { $($key),* }
    };
}

parameters!(keys);
