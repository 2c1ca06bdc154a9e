//! Values of parameters in words.

use crate::error::BatchError;
use segue_session::{CommandError, Key, Value};

/// Reads the value of a parameter by its name in links, with `-` or `_` between words.
///
/// # Errors
/// [`BatchError`] if there is no such parameter, or the value does not fit it.
pub fn value_of(name: &str, text: &str) -> Result<(Key, Value), BatchError> {
    let name = name.replace('-', "_");
    let key = Key::from_name(&name).ok_or(BatchError::NoParameter(name))?;
    Ok((key, key.param().parse(text).map_err(CommandError::from)?))
}
