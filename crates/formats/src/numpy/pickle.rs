//! Pickled arrays, as `numpy.save` writes dictionaries: a safe subset of pickle, protocols 0 to 5.
//!
//! A pickle is a program for a small stack machine (the module `pickletools` of Python documents
//! its operations). Here it can make numbers, texts, lists, dictionaries and `NumPy` arrays, and
//! nothing else: calls of any other function leave an unknown value, nothing is imported or run.

mod machine;
mod node;

use super::array::Array;
use super::bundle::Bundle;
use crate::error::Fault;
use machine::Machine;
use node::{Id, Node};
use segue_text::Message;
use std::collections::BTreeSet;

/// The greatest depth of lists and arrays around the dictionaries.
const MAX_DEPTH: usize = 8;

/// The greatest number of dictionaries that are read.
const MAX_BUNDLES: usize = 1000;

/// The greatest length of a text that is kept, bytes: words such as the gender of a body.
const MAX_TEXT: usize = 64;

/// Reads a pickle: one bundle for each dictionary or array in it.
pub(super) fn read(bytes: &[u8]) -> Result<Vec<Bundle<'_>>, Fault> {
    let mut machine = Machine::new(bytes);
    let top = machine.run()?;
    let mut bundles = Vec::new();
    machine.collect(top, &mut bundles, &mut BTreeSet::new(), 0)?;
    if bundles.is_empty() {
        return Err(Fault::new(
            0,
            Message::word("pickled objects without arrays"),
            "a dictionary of NumPy arrays",
        ));
    }
    Ok(bundles)
}

impl<'a> Machine<'a> {
    /// Adds the dictionaries and arrays of a value.
    fn collect(
        &mut self,
        id: Id,
        out: &mut Vec<Bundle<'a>>,
        seen: &mut BTreeSet<Id>,
        depth: usize,
    ) -> Result<(), Fault> {
        // A list may contain itself.
        if depth > MAX_DEPTH || out.len() >= MAX_BUNDLES || !seen.insert(id) {
            return Ok(());
        }
        let items: Vec<Id> = match self.node(id) {
            Node::Dictionary(pairs) => {
                let pairs = pairs.clone();
                let mut arrays = Vec::new();
                for (key, value) in pairs {
                    let Node::Text(key) = self.node(key) else { continue };
                    let key = key.clone();
                    if let Some(array) = self.array(value)? {
                        arrays.push((key, array));
                    }
                }
                out.push(Bundle::new(arrays));
                return Ok(());
            }
            Node::List(items) => items.clone(),
            Node::Array(parts) if parts.is_of_objects() => match parts.data.map(|d| self.node(d)) {
                Some(Node::List(items)) => items.clone(),
                _ => Vec::new(),
            },
            Node::Array(_) => {
                let array = self.array(id)?;
                out.extend(array.map(|array| Bundle::new(vec![(String::new(), array)])));
                return Ok(());
            }
            _ => Vec::new(),
        };
        for item in items {
            // Lists of numbers have no bundles in them.
            if !matches!(self.node(item), Node::Integer(_) | Node::Float(_) | Node::Text(_)) {
                self.collect(item, out, seen, depth + 1)?;
            }
        }
        Ok(())
    }

    /// Returns a value as an array; `None` if it is none.
    fn array(&mut self, id: Id) -> Result<Option<Array<'a>>, Fault> {
        Ok(match self.node(id) {
            Node::Integer(value) => Some(Array::of_number(*value as f64)),
            Node::Float(value) => Some(Array::of_number(*value)),
            Node::Text(text) if text.len() <= MAX_TEXT => {
                Some(Array::of_texts(std::slice::from_ref(text)))
            }
            Node::Array(parts) => {
                let parts = parts.clone();
                let (Some(dtype), Some(data)) = (parts.dtype, parts.data) else {
                    return Ok(None);
                };
                if !dtype.is_number() {
                    return Ok(None);
                }
                let Some(data) = self.bytes_of(data)? else { return Ok(None) };
                Some(Array::new(dtype, parts.shape, parts.fortran, data)?)
            }
            _ => None,
        })
    }
}

#[cfg(test)]
mod tests;
