//! The one table of parameters. Sliders, the link, the page's API, compare, undo and
//! `docs/parameters.md` are made from it.

mod current;
mod grammar;
mod param;
mod table;
#[cfg(test)]
mod tests;
mod text;
mod value;

pub use current::Params;
pub use grammar::{HandTag, List, ListKind, MAX_WEIGHTED_CLIPS, Misread, write_ids};
pub(crate) use grammar::{escaped, is_recipe, parts};
pub use param::{Choice, Group, Kind, Mark, Param};
pub use table::{Key, PARAMS};
pub use text::{decimals_of, format_number};
pub use value::{Compare, MAX_PANES, Value, ValueError};
