//! FBX documents as trees of named elements, written as text or binary.

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use flate2::Compression;
use flate2::write::ZlibEncoder;
use std::io::Write as _;

/// A value behind an element's name.
#[derive(Clone, Debug)]
pub(crate) enum Value {
    /// One byte.
    Char(u8),
    /// 32-bit integer.
    Int(i32),
    /// 64-bit integer.
    Long(i64),
    /// Number.
    Real(f64),
    /// Text.
    Text(String),
    /// The name of an object and its class, which text and binary files join in opposite order.
    Object(String, &'static str),
    /// The content of a file.
    Raw(Vec<u8>),
    /// Arrays.
    Ints(Vec<i32>),
    /// 64-bit integers.
    Longs(Vec<i64>),
    /// Single precision.
    Singles(Vec<f32>),
    /// Double precision.
    Reals(Vec<f64>),
}

/// An element with values and elements in it.
#[derive(Clone, Debug)]
pub(crate) struct Element {
    name: String,
    values: Vec<Value>,
    children: Vec<Element>,
}

impl Element {
    pub(crate) fn name(&self) -> &str {
        &self.name
    }

    pub(crate) fn children_mut(&mut self) -> &mut [Self] {
        &mut self.children
    }

    /// Adds an element.
    pub(crate) fn push(&mut self, child: Element) {
        self.children.push(child);
    }
}

/// Returns an element without others in it.
pub(crate) fn leaf(name: &str, values: Vec<Value>) -> Element {
    Element { name: name.into(), values, children: Vec::new() }
}

/// Returns an element with others in it.
pub(crate) fn branch(name: &str, values: Vec<Value>, children: Vec<Element>) -> Element {
    Element { name: name.into(), values, children }
}

/// Returns a property of a `Properties70` with numbers.
pub(crate) fn property(name: &str, kind: &str, numbers: &[f64]) -> Element {
    let text = |text: &str| Value::Text(text.into());
    let label = match kind {
        "int" => "Integer",
        "double" => "Number",
        "KTime" => "Time",
        "Vector3D" => "Vector",
        _ => "",
    };
    // Properties of these kinds can be animated.
    let flags =
        if kind.starts_with("Lcl") || kind == "Number" || kind == "Color" { "A" } else { "" };
    let mut values = vec![text(name), text(kind), text(label), text(flags)];
    values.extend(numbers.iter().map(|&number| match kind {
        "int" | "enum" | "bool" => Value::Int(number as i32),
        "KTime" => Value::Long(number as i64),
        _ => Value::Real(number),
    }));
    leaf("P", values)
}

/// The way in which a binary file is written.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Form {
    /// 7400, with places of 32 bits, or 7500 with those of 64.
    pub(crate) version: u32,
    /// Whether arrays are packed by zlib.
    pub(crate) is_packed: bool,
}

/// Writes a file of version 7400.
pub(crate) fn binary(elements: &[Element]) -> Vec<u8> {
    binary_in(Form { version: 7400, is_packed: false }, elements)
}

/// Writes a binary file.
pub(crate) fn binary_in(form: Form, elements: &[Element]) -> Vec<u8> {
    let mut bytes = b"Kaydara FBX Binary  \0\x1a\0".to_vec();
    bytes.extend(form.version.to_le_bytes());
    for element in elements {
        write_binary(form, element, &mut bytes);
    }
    bytes.extend(vec![0; form.head()]);
    bytes
}

impl Form {
    fn word(self) -> usize {
        if self.version >= 7500 { 8 } else { 4 }
    }

    /// Returns the size of an empty record.
    fn head(self) -> usize {
        3 * self.word() + 1
    }
}

fn write_binary(form: Form, element: &Element, bytes: &mut Vec<u8>) {
    let start = bytes.len();
    bytes.extend(vec![0; form.head() - 1]);
    bytes.push(element.name.len() as u8);
    bytes.extend(element.name.as_bytes());
    let values = bytes.len();
    for value in &element.values {
        write_value(form, value, bytes);
    }
    let length = bytes.len() - values;
    if !element.children.is_empty() {
        for child in &element.children {
            write_binary(form, child, bytes);
        }
        bytes.extend(vec![0; form.head()]);
    }
    for (place, word) in [bytes.len(), element.values.len(), length].into_iter().enumerate() {
        let at = start + place * form.word();
        bytes[at..at + form.word()].copy_from_slice(&(word as u64).to_le_bytes()[..form.word()]);
    }
}

fn write_value(form: Form, value: &Value, bytes: &mut Vec<u8>) {
    fn text(kind: u8, text: &[u8], bytes: &mut Vec<u8>) {
        bytes.push(kind);
        bytes.extend((text.len() as u32).to_le_bytes());
        bytes.extend(text);
    }
    let array = |kind: u8, count: usize, values: Vec<u8>, bytes: &mut Vec<u8>| {
        bytes.push(kind);
        let values = if form.is_packed {
            let mut packed = ZlibEncoder::new(Vec::new(), Compression::fast());
            packed.write_all(&values).and_then(|()| packed.finish()).expect("memory")
        } else {
            values
        };
        for word in [count as u32, u32::from(form.is_packed), values.len() as u32] {
            bytes.extend(word.to_le_bytes());
        }
        bytes.extend(values);
    };
    match value {
        Value::Char(value) => bytes.extend([b'C', *value]),
        Value::Int(value) => {
            bytes.push(b'I');
            bytes.extend(value.to_le_bytes());
        }
        Value::Long(value) => {
            bytes.push(b'L');
            bytes.extend(value.to_le_bytes());
        }
        Value::Real(value) => {
            bytes.push(b'D');
            bytes.extend(value.to_le_bytes());
        }
        Value::Text(value) => text(b'S', value.as_bytes(), bytes),
        Value::Object(name, class) => {
            text(b'S', format!("{name}\0\u{1}{class}").as_bytes(), bytes);
        }
        Value::Raw(value) => text(b'R', value, bytes),
        Value::Ints(values) => {
            array(b'i', values.len(), values.iter().flat_map(|v| v.to_le_bytes()).collect(), bytes);
        }
        Value::Longs(values) => {
            array(b'l', values.len(), values.iter().flat_map(|v| v.to_le_bytes()).collect(), bytes);
        }
        Value::Singles(values) => {
            array(b'f', values.len(), values.iter().flat_map(|v| v.to_le_bytes()).collect(), bytes);
        }
        Value::Reals(values) => {
            array(b'd', values.len(), values.iter().flat_map(|v| v.to_le_bytes()).collect(), bytes);
        }
    }
}

/// Writes a text file of version 7500 or 6100.
pub(crate) fn text(version: u32, elements: &[Element]) -> Vec<u8> {
    let [major, minor] = [version / 1000, version / 100 % 10];
    let mut text = format!("; FBX {major}.{minor}.0 project file\n\n");
    for element in elements {
        write_text(element, 0, &mut text);
    }
    text.into_bytes()
}

fn write_text(element: &Element, depth: usize, out: &mut String) {
    let tabs = "\t".repeat(depth);
    let array = |values: Vec<String>| {
        format!("*{} {{\n{tabs}\ta: {}\n{tabs}}}", values.len(), values.join(","))
    };
    let values: Vec<String> = element
        .values
        .iter()
        .map(|value| match value {
            Value::Char(value) => char::from(*value).to_string(),
            Value::Int(value) => value.to_string(),
            Value::Long(value) => value.to_string(),
            Value::Real(value) => value.to_string(),
            Value::Text(value) => format!("\"{value}\""),
            Value::Object(name, class) => format!("\"{class}::{name}\""),
            Value::Raw(value) => format!(",\n\"{}\"", STANDARD.encode(value)),
            Value::Ints(values) => array(each(values)),
            Value::Longs(values) => array(each(values)),
            Value::Singles(values) => array(each(values)),
            Value::Reals(values) => array(each(values)),
        })
        .collect();
    let values = values.join(", ");
    out.extend([tabs.as_str(), element.name.as_str(), ": ", values.as_str()]);
    if element.children.is_empty() {
        out.push('\n');
        return;
    }
    out.push_str(" {\n");
    for child in &element.children {
        write_text(child, depth + 1, out);
    }
    out.extend([tabs.as_str(), "}\n"]);
}

fn each<T: ToString>(values: &[T]) -> Vec<String> {
    values.iter().map(ToString::to_string).collect()
}
