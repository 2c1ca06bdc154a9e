//! The values of a pickle. They refer to each other by index, so that a value may contain itself.

use crate::numpy::header::{Dtype, ElementKind};
use std::borrow::Cow;

/// The index of a value.
pub(super) type Id = usize;

/// A value.
#[derive(Clone, Debug)]
pub(super) enum Node<'a> {
    /// `None`, and everything that is not understood.
    Unknown,
    Integer(i64),
    Float(f64),
    Text(String),
    Bytes(Cow<'a, [u8]>),
    /// A list, or a tuple.
    List(Vec<Id>),
    Dictionary(Vec<(Id, Id)>),
    Function(Function),
    Dtype(Option<Dtype>),
    Array(ArrayParts),
}

/// The parts of an array.
#[derive(Clone, Debug, Default)]
pub(super) struct ArrayParts {
    pub(super) dtype: Option<Dtype>,
    pub(super) shape: Vec<usize>,
    pub(super) fortran: bool,
    /// Bytes, or a list of the objects.
    pub(super) data: Option<Id>,
}

impl ArrayParts {
    pub(super) fn is_of_objects(&self) -> bool {
        self.dtype.is_some_and(|dtype| dtype.kind == ElementKind::Object)
    }
}

/// The functions that arrays are made with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Function {
    /// An array without content, which follows.
    Reconstruct,
    /// An array from its bytes (protocol 5).
    FromBuffer,
    /// A `NumPy` number.
    Scalar,
    /// An element type.
    Dtype,
    /// Bytes from a text (protocols 0 to 2).
    Encode,
    /// An empty dictionary.
    OrderedDictionary,
    /// Bytes that can be changed.
    ByteArray,
    /// Any other function: it is not called.
    Other,
}

impl Function {
    pub(super) fn named(module: &str, name: &str) -> Self {
        match (module, name) {
            ("numpy.core.multiarray" | "numpy._core.multiarray", "_reconstruct") => {
                Self::Reconstruct
            }
            ("numpy.core.multiarray" | "numpy._core.multiarray", "scalar") => Self::Scalar,
            ("numpy.core.numeric" | "numpy._core.numeric", "_frombuffer") => Self::FromBuffer,
            ("numpy", "dtype") => Self::Dtype,
            ("_codecs", "encode") => Self::Encode,
            ("collections", "OrderedDict") => Self::OrderedDictionary,
            ("builtins" | "__builtin__", "bytearray") => Self::ByteArray,
            _ => Self::Other,
        }
    }
}
