//! The stack machine of a pickle.

use super::node::{ArrayParts, Function, Id, Node};
use crate::error::Fault;
use crate::numpy::header::Dtype;
use segue_text::{Message, msg};
use std::borrow::Cow;
use std::collections::BTreeMap;

/// The greatest number of values. A dictionary of arrays has a few hundred, with long lists of
/// texts some thousands.
const MAX_NODES: usize = 1 << 20;

/// The state of the machine.
#[derive(Debug)]
pub(super) struct Machine<'a> {
    bytes: &'a [u8],
    at: usize,
    nodes: Vec<Node<'a>>,
    stack: Vec<Id>,
    /// The heights of the stack at the marks.
    marks: Vec<usize>,
    memo: BTreeMap<u64, Id>,
    /// The number of bytes that may still be copied.
    copies_left: usize,
}

impl<'a> Machine<'a> {
    pub(super) fn new(bytes: &'a [u8]) -> Self {
        Self {
            bytes,
            at: 0,
            nodes: Vec::new(),
            stack: Vec::new(),
            marks: Vec::new(),
            memo: BTreeMap::new(),
            copies_left: bytes.len().saturating_mul(4),
        }
    }

    pub(super) fn node(&self, id: Id) -> &Node<'a> {
        self.nodes.get(id).unwrap_or(&Node::Unknown)
    }

    /// Runs the pickle to its end and returns the value that is left.
    pub(super) fn run(&mut self) -> Result<Id, Fault> {
        loop {
            let code = self.byte()?;
            if code == b'.' {
                return self.pop();
            }
            self.step(code)?;
        }
    }

    /// Returns the bytes of a value.
    pub(super) fn bytes_of(&mut self, id: Id) -> Result<Option<Cow<'a, [u8]>>, Fault> {
        match self.node(id) {
            Node::Bytes(Cow::Borrowed(bytes)) => Ok(Some(Cow::Borrowed(bytes))),
            Node::Bytes(Cow::Owned(bytes)) => {
                let bytes = bytes.clone();
                self.copied(bytes.len())?;
                Ok(Some(Cow::Owned(bytes)))
            }
            _ => Ok(None),
        }
    }

    fn step(&mut self, code: u8) -> Result<(), Fault> {
        match code {
            0x80 => self.take(1).map(drop),
            // A frame groups operations; they are read one after the other.
            0x95 => self.take(8).map(drop),
            b'(' => {
                self.marks.push(self.stack.len());
                Ok(())
            }
            b'0' => self.pop().map(drop),
            b'1' => self.pop_mark().map(drop),
            b'2' => {
                let top = self.top()?;
                self.push_id(top)
            }
            b'N' | 0x88 | 0x89 | b'I' | b'L' | b'J' | b'K' | b'M' | 0x8a | 0x8b | b'F' | b'G' => {
                let node = self.number(code)?;
                self.push(node)
            }
            b'S' | b'V' | b'T' | b'U' | b'X' | 0x8c | 0x8d | b'B' | b'C' | 0x8e | 0x96 => {
                let node = self.characters(code)?;
                self.push(node)
            }
            b'}' | b']' | b')' | b't' | 0x85 | 0x86 | 0x87 | b'l' | b'd' | b'a' | b'e' | b's'
            | b'u' => self.collection(code),
            b'p' | b'q' | b'r' | 0x94 | b'g' | b'h' | b'j' => self.memory(code),
            b'c' => {
                let (module, name) = (self.line()?, self.line()?);
                self.push(Node::Function(Function::named(&module, &name)))
            }
            0x93 => {
                let (name, module) = (self.pop()?, self.pop()?);
                let function = match (self.node(module), self.node(name)) {
                    (Node::Text(module), Node::Text(name)) => Function::named(module, name),
                    _ => Function::Other,
                };
                self.push(Node::Function(function))
            }
            b'R' | 0x81 => {
                let (arguments, function) = (self.pop()?, self.pop()?);
                let node = self.call(function, arguments)?;
                self.push(node)
            }
            b'b' => {
                let (state, object) = (self.pop()?, self.top()?);
                self.build(object, state);
                Ok(())
            }
            _ => {
                let found = msg!(
                    "the pickle operation 0x{code} at byte {at}",
                    code = format!("{code:02x}"),
                    at = self.at - 1
                );
                Err(Fault::new(0, found, "pickled NumPy arrays")
                    .with_hint("save the arrays alone with numpy.save or numpy.savez"))
            }
        }
    }

    fn number(&mut self, code: u8) -> Result<Node<'a>, Fault> {
        Ok(match code {
            0x88 => Node::Integer(1),
            0x89 => Node::Integer(0),
            b'I' | b'L' => {
                let line = self.line()?;
                // `I01` and `I00` are True and False.
                line.trim_end_matches('L').parse().map_or(Node::Unknown, Node::Integer)
            }
            b'F' => self.line()?.parse().map_or(Node::Unknown, Node::Float),
            b'J' => Node::Integer(i64::from(self.unsigned(4)? as u32 as i32)),
            b'K' => Node::Integer(self.unsigned(1)? as i64),
            b'M' => Node::Integer(self.unsigned(2)? as i64),
            0x8a | 0x8b => {
                let length = self.unsigned(if code == 0x8a { 1 } else { 4 })?;
                let digits = self.take(length)?;
                let last = digits.last().copied().unwrap_or(0);
                if digits.len() > 8 {
                    Node::Unknown
                } else {
                    let mut all = [if last & 0x80 == 0 { 0 } else { 0xff }; 8];
                    all[..digits.len()].copy_from_slice(digits);
                    Node::Integer(i64::from_le_bytes(all))
                }
            }
            b'G' => Node::Float(f64::from_bits(self.unsigned(8)?.swap_bytes())),
            _ => Node::Unknown,
        })
    }

    fn characters(&mut self, code: u8) -> Result<Node<'a>, Fault> {
        let length_bytes = match code {
            b'S' | b'V' => 0,
            b'U' | 0x8c | b'C' => 1,
            b'T' | b'X' | b'B' => 4,
            _ => 8,
        };
        if length_bytes == 0 {
            let line = self.raw_line()?;
            self.copied(line.len())?;
            return Ok(if code == b'V' {
                Node::Text(unescaped(line).into_iter().filter_map(char::from_u32).collect())
            } else {
                let inside = line.get(1..line.len().saturating_sub(1)).unwrap_or_default();
                Node::Bytes(Cow::Owned(
                    unescaped(inside).into_iter().map(|c| c.min(255) as u8).collect(),
                ))
            });
        }
        let length = self.unsigned(length_bytes)?;
        let bytes = self.take(length)?;
        if !matches!(code, b'X' | 0x8c | 0x8d) {
            return Ok(Node::Bytes(Cow::Borrowed(bytes)));
        }
        self.copied(bytes.len())?;
        Ok(Node::Text(String::from_utf8_lossy(bytes).into_owned()))
    }

    fn collection(&mut self, code: u8) -> Result<(), Fault> {
        match code {
            b'}' => self.push(Node::Dictionary(Vec::new())),
            b']' | b')' => self.push(Node::List(Vec::new())),
            b't' | b'l' => {
                let items = self.pop_mark()?;
                self.push(Node::List(items))
            }
            0x85..=0x87 => {
                let count = usize::from(code - 0x84);
                let from = self.stack.len().checked_sub(count).ok_or_else(damaged)?;
                let items = self.stack.split_off(from);
                self.push(Node::List(items))
            }
            b'd' => {
                let items = self.pop_mark()?;
                self.push(Node::Dictionary(pairs(&items)))
            }
            b'a' | b'e' => {
                let items = if code == b'a' { vec![self.pop()?] } else { self.pop_mark()? };
                let list = self.top()?;
                if let Some(Node::List(list)) = self.nodes.get_mut(list) {
                    list.extend(items);
                }
                Ok(())
            }
            _ => {
                let items = if code == b's' {
                    let value = self.pop()?;
                    vec![self.pop()?, value]
                } else {
                    self.pop_mark()?
                };
                let dictionary = self.top()?;
                if let Some(Node::Dictionary(own)) = self.nodes.get_mut(dictionary) {
                    own.extend(pairs(&items));
                }
                Ok(())
            }
        }
    }

    fn memory(&mut self, code: u8) -> Result<(), Fault> {
        let key = match code {
            b'p' | b'g' => self.line()?.parse().map_err(|_| damaged())?,
            b'q' | b'h' => self.unsigned(1)?,
            b'r' | b'j' => self.unsigned(4)?,
            _ => self.memo.len() as u64,
        };
        if matches!(code, b'g' | b'h' | b'j') {
            let id = *self.memo.get(&key).ok_or_else(damaged)?;
            return self.push_id(id);
        }
        let top = self.top()?;
        self.memo.insert(key, top);
        Ok(())
    }

    /// Returns the result of a call of one of the known functions.
    fn call(&mut self, function: Id, arguments: Id) -> Result<Node<'a>, Fault> {
        let Node::Function(function) = *self.node(function) else { return Ok(Node::Unknown) };
        let Node::List(arguments) = self.node(arguments) else { return Ok(Node::Unknown) };
        let argument: [Option<Id>; 4] = std::array::from_fn(|i| arguments.get(i).copied());
        let node = |machine: &Self, i: usize| {
            argument[i].map_or(Node::Unknown, |id| match machine.node(id) {
                // Only small values are needed as they are.
                Node::Bytes(_) | Node::Dictionary(_) => Node::Unknown,
                Node::Text(text) if text.len() > 64 => Node::Unknown,
                other => other.clone(),
            })
        };
        Ok(match function {
            Function::Reconstruct => Node::Array(ArrayParts::default()),
            Function::Dtype => Node::Dtype(match node(self, 0) {
                Node::Text(code) => Dtype::parse(&code),
                _ => None,
            }),
            Function::Scalar => {
                let Node::Dtype(dtype) = node(self, 0) else { return Ok(Node::Unknown) };
                Node::Array(ArrayParts { dtype, data: argument[1], ..ArrayParts::default() })
            }
            Function::FromBuffer => {
                let (Node::Dtype(dtype), Some(shape)) = (node(self, 1), self.sizes(argument[2]))
                else {
                    return Ok(Node::Unknown);
                };
                let fortran = matches!(node(self, 3), Node::Text(order) if order == "F");
                Node::Array(ArrayParts { dtype, shape, fortran, data: argument[0] })
            }
            Function::Encode => match argument[0].map(|id| self.node(id)) {
                Some(Node::Text(text)) => {
                    let bytes: Vec<u8> =
                        text.chars().map(|c| u32::from(c).min(255) as u8).collect();
                    self.copied(bytes.len())?;
                    Node::Bytes(Cow::Owned(bytes))
                }
                _ => Node::Unknown,
            },
            Function::ByteArray => match argument[0] {
                Some(id) => self.bytes_of(id)?.map_or(Node::Unknown, Node::Bytes),
                None => Node::Unknown,
            },
            Function::OrderedDictionary => Node::Dictionary(Vec::new()),
            Function::Other => Node::Unknown,
        })
    }

    /// Sets the content of an array, or the byte order of an element type.
    fn build(&mut self, object: Id, state: Id) {
        let Node::List(state) = self.node(state) else { return };
        let state: Vec<Id> = state.iter().take(8).copied().collect();
        let built = match self.node(object) {
            Node::Array(_) => {
                // A version may come first.
                let ([_, shape, dtype, fortran, data] | [shape, dtype, fortran, data]) =
                    *state.as_slice()
                else {
                    return;
                };
                let Node::Dtype(dtype) = *self.node(dtype) else { return };
                let Some(shape) = self.sizes(Some(shape)) else { return };
                let fortran = matches!(self.node(fortran), Node::Integer(1));
                Node::Array(ArrayParts { dtype, shape, fortran, data: Some(data) })
            }
            Node::Dtype(Some(dtype)) => {
                let order = match state.get(1).map(|id| self.node(*id)) {
                    Some(Node::Text(order)) => order.starts_with('>'),
                    Some(Node::Bytes(order)) => order.starts_with(b">"),
                    _ => false,
                };
                Node::Dtype(Some(Dtype { big_endian: order, ..*dtype }))
            }
            _ => return,
        };
        if let Some(place) = self.nodes.get_mut(object) {
            *place = built;
        }
    }

    /// Returns a tuple of sizes.
    fn sizes(&self, id: Option<Id>) -> Option<Vec<usize>> {
        let Node::List(items) = self.node(id?) else { return None };
        let size = |id: &Id| match self.node(*id) {
            Node::Integer(size) => usize::try_from(*size).ok(),
            _ => None,
        };
        items.iter().take(64).map(size).collect()
    }

    fn copied(&mut self, bytes: usize) -> Result<(), Fault> {
        self.copies_left = self.copies_left.checked_sub(bytes).ok_or_else(too_large)?;
        Ok(())
    }

    fn push(&mut self, node: Node<'a>) -> Result<(), Fault> {
        if self.nodes.len() >= MAX_NODES {
            return Err(too_large());
        }
        self.nodes.push(node);
        self.push_id(self.nodes.len() - 1)
    }

    fn push_id(&mut self, id: Id) -> Result<(), Fault> {
        if self.stack.len() >= MAX_NODES {
            return Err(too_large());
        }
        self.stack.push(id);
        Ok(())
    }

    fn pop(&mut self) -> Result<Id, Fault> {
        self.stack.pop().ok_or_else(damaged)
    }

    fn top(&self) -> Result<Id, Fault> {
        self.stack.last().copied().ok_or_else(damaged)
    }

    fn pop_mark(&mut self) -> Result<Vec<Id>, Fault> {
        let mark = self.marks.pop().ok_or_else(damaged)?;
        Ok(self.stack.split_off(mark.min(self.stack.len())))
    }

    fn byte(&mut self) -> Result<u8, Fault> {
        Ok(self.take(1)?[0])
    }

    fn take(&mut self, count: u64) -> Result<&'a [u8], Fault> {
        let end = usize::try_from(count).ok().and_then(|count| self.at.checked_add(count));
        let taken = end.and_then(|end| self.bytes.get(self.at..end)).ok_or_else(damaged)?;
        self.at += taken.len();
        Ok(taken)
    }

    /// Returns a number of at most eight bytes, the least significant one first.
    fn unsigned(&mut self, bytes: u64) -> Result<u64, Fault> {
        Ok(self.take(bytes)?.iter().rev().fold(0, |sum, byte| sum << 8 | u64::from(*byte)))
    }

    fn raw_line(&mut self) -> Result<&'a [u8], Fault> {
        let rest = self.bytes.get(self.at..).unwrap_or_default();
        let end = memchr::memchr(b'\n', rest).ok_or_else(damaged)?;
        self.at += end + 1;
        Ok(&rest[..end])
    }

    fn line(&mut self) -> Result<String, Fault> {
        let line = self.raw_line()?;
        self.copied(line.len())?;
        Ok(String::from_utf8_lossy(line).trim_end_matches('\r').to_owned())
    }
}

fn pairs(items: &[Id]) -> Vec<(Id, Id)> {
    items.chunks_exact(2).map(|pair| (pair[0], pair[1])).collect()
}

/// Returns the characters of a line of protocol 0, in which some are written as `\n`, `\x1f` or
/// `\u001f`.
fn unescaped(line: &[u8]) -> Vec<u32> {
    let mut out = Vec::with_capacity(line.len());
    let mut at = 0;
    while let Some(&byte) = line.get(at) {
        at += 1;
        if byte != b'\\' {
            out.push(u32::from(byte));
            continue;
        }
        let digits = match line.get(at) {
            Some(b'x') => 2,
            Some(b'u') => 4,
            Some(b'U') => 8,
            _ => 0,
        };
        let hex = line.get(at + 1..at + 1 + digits).and_then(|hex| std::str::from_utf8(hex).ok());
        if let Some(code) = hex.and_then(|hex| u32::from_str_radix(hex, 16).ok()) {
            out.push(code);
            at += 1 + digits;
            continue;
        }
        out.push(match line.get(at) {
            Some(b'n') => 10,
            Some(b'r') => 13,
            Some(b't') => 9,
            Some(other) => u32::from(*other),
            None => u32::from(b'\\'),
        });
        at += 1;
    }
    out
}

fn damaged() -> Fault {
    Fault::new(0, Message::word("pickled data that is damaged or cut off"), "NumPy arrays")
}

fn too_large() -> Fault {
    Fault::new(0, Message::word("pickled data of too many parts"), "NumPy arrays")
        .with_hint("save the arrays alone with numpy.save or numpy.savez")
}
