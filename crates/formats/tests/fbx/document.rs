//! FBX documents as trees of named elements, written as text or binary.

/// A value behind an element's name.
#[derive(Clone, Debug)]
pub(crate) enum Value {
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

/// Writes a file of version 7400.
pub(crate) fn binary(elements: &[Element]) -> Vec<u8> {
    let mut bytes = b"Kaydara FBX Binary  \0\x1a\0".to_vec();
    bytes.extend(7400_u32.to_le_bytes());
    for element in elements {
        write_binary(element, &mut bytes);
    }
    bytes.extend([0; 13]);
    bytes
}

fn write_binary(element: &Element, bytes: &mut Vec<u8>) {
    let start = bytes.len();
    bytes.extend([0; 12]);
    bytes.push(element.name.len() as u8);
    bytes.extend(element.name.as_bytes());
    let values = bytes.len();
    for value in &element.values {
        write_value(value, bytes);
    }
    let length = bytes.len() - values;
    if !element.children.is_empty() {
        for child in &element.children {
            write_binary(child, bytes);
        }
        bytes.extend([0; 13]);
    }
    let head = [bytes.len(), element.values.len(), length].map(|word| (word as u32).to_le_bytes());
    bytes[start..start + 12].copy_from_slice(head.as_flattened());
}

fn write_value(value: &Value, bytes: &mut Vec<u8>) {
    fn text(text: &[u8], bytes: &mut Vec<u8>) {
        bytes.push(b'S');
        bytes.extend((text.len() as u32).to_le_bytes());
        bytes.extend(text);
    }
    fn array<const N: usize>(
        kind: u8,
        values: impl ExactSizeIterator<Item = [u8; N]>,
        bytes: &mut Vec<u8>,
    ) {
        bytes.push(kind);
        // Count, no compression, size.
        for word in [values.len() as u32, 0, (N * values.len()) as u32] {
            bytes.extend(word.to_le_bytes());
        }
        values.for_each(|value| bytes.extend(value));
    }
    match value {
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
        Value::Text(value) => text(value.as_bytes(), bytes),
        Value::Object(name, class) => text(format!("{name}\0\u{1}{class}").as_bytes(), bytes),
        Value::Ints(values) => array(b'i', values.iter().map(|value| value.to_le_bytes()), bytes),
        Value::Longs(values) => array(b'l', values.iter().map(|value| value.to_le_bytes()), bytes),
        Value::Singles(values) => {
            array(b'f', values.iter().map(|value| value.to_le_bytes()), bytes);
        }
        Value::Reals(values) => array(b'd', values.iter().map(|value| value.to_le_bytes()), bytes),
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
            Value::Int(value) => value.to_string(),
            Value::Long(value) => value.to_string(),
            Value::Real(value) => value.to_string(),
            Value::Text(value) => format!("\"{value}\""),
            Value::Object(name, class) => format!("\"{class}::{name}\""),
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
