//! Parsing of a skeleton file: its sections, its bones and their hierarchy.

use super::lexer::Lexer;
use crate::error::Fault;
use crate::text::quoted;
use std::collections::HashSet;

/// The sections of skeleton files.
const SECTIONS: [&str; 8] =
    [":version", ":name", ":units", ":documentation", ":root", ":bonedata", ":hierarchy", ":skin"];

/// One degree of freedom: one value per frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Dof {
    /// A translation along an axis (0 to 2).
    Move(usize),
    /// A rotation about an axis (0 to 2).
    Turn(usize),
    /// A change of the bone's length.
    Stretch,
}

impl Dof {
    const ALL: [(&'static str, Self); 7] = [
        ("tx", Self::Move(0)),
        ("ty", Self::Move(1)),
        ("tz", Self::Move(2)),
        ("rx", Self::Turn(0)),
        ("ry", Self::Turn(1)),
        ("rz", Self::Turn(2)),
        ("l", Self::Stretch),
    ];

    fn of(token: &[u8]) -> Option<Self> {
        Self::ALL
            .iter()
            .find(|(name, _)| token.eq_ignore_ascii_case(name.as_bytes()))
            .map(|(_, dof)| *dof)
    }

    pub(super) fn name(self) -> &'static str {
        Self::ALL.iter().find(|(_, dof)| *dof == self).map_or("", |(name, _)| name)
    }
}

/// A bone, or the root, in the file's units.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct FileBone<'a> {
    pub(super) name: &'a [u8],
    pub(super) at: usize,
    pub(super) direction: [f64; 3],
    pub(super) length: f64,
    /// The rotations about X, Y and Z that make the bone's own axes; the root's `orientation`.
    pub(super) axis: [f64; 3],
    /// The order of these rotations, about fixed axes; the first one is applied first.
    pub(super) axis_order: [usize; 3],
    pub(super) dofs: Vec<Dof>,
}

impl FileBone<'_> {
    fn at(at: usize) -> Self {
        Self {
            name: b"root",
            at,
            direction: [0.0; 3],
            length: 0.0,
            axis: [0.0; 3],
            axis_order: [0, 1, 2],
            dofs: Vec::new(),
        }
    }
}

/// An occurrence of a name in the hierarchy.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Mention<'a> {
    pub(super) name: &'a [u8],
    pub(super) at: usize,
}

/// The content of a skeleton file.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Asf<'a> {
    /// The `length` of `:units`, if it is a length.
    pub(super) length: Option<f64>,
    pub(super) radians: bool,
    pub(super) root: FileBone<'a>,
    pub(super) root_position: [f64; 3],
    pub(super) bones: Vec<FileBone<'a>>,
    /// Pairs of parent and child.
    pub(super) links: Vec<(Mention<'a>, Mention<'a>)>,
}

fn is(token: &[u8], word: &str) -> bool {
    token.eq_ignore_ascii_case(word.as_bytes())
}

/// Returns whether a token begins a section of a skeleton file.
pub(super) fn is_section(token: &[u8]) -> bool {
    SECTIONS.iter().any(|section| is(token, section))
}

/// Reads a skeleton file.
pub(super) fn read<'a>(lexer: &mut Lexer<'a>) -> Result<Asf<'a>, Fault> {
    let mut asf = Asf {
        length: None,
        radians: false,
        root: FileBone::at(0),
        root_position: [0.0; 3],
        bones: Vec::new(),
        links: Vec::new(),
    };
    let mut has = [false; 3];
    loop {
        let token = lexer.peek();
        if token.is_empty() {
            break;
        }
        if token.first() != Some(&b':') {
            return Err(lexer.unexpected("a section of a skeleton, such as `:root`"));
        }
        let at = lexer.at;
        if is(token, ":units") {
            lexer.take();
            units(lexer, &mut asf);
        } else if is(token, ":root") {
            lexer.take();
            asf.root.at = at;
            root(lexer, &mut asf)?;
            has[0] = true;
        } else if is(token, ":bonedata") {
            lexer.take();
            bones(lexer, &mut asf.bones)?;
            has[1] = true;
        } else if is(token, ":hierarchy") {
            lexer.take();
            hierarchy(lexer, &mut asf.links);
            has[2] = true;
        } else {
            lexer.skip_to_section();
        }
    }
    let missing = [":root", ":bonedata", ":hierarchy"].into_iter().zip(has).find(|(_, has)| !has);
    match missing {
        Some((section, _)) => Err(lexer.unexpected(format!("`{section}`"))),
        None => Ok(asf),
    }
}

/// Returns whether a token ends a section.
fn section_ends(token: &[u8]) -> bool {
    matches!(token.first(), None | Some(b':'))
}

/// Reads the units. If they are missing or invalid, the defaults stay: a unit inferred from the
/// size of the skeleton, and degrees.
fn units(lexer: &mut Lexer<'_>, asf: &mut Asf<'_>) {
    while !section_ends(lexer.peek()) {
        let key = lexer.take();
        if is(key, "length") {
            asf.length = lexer.number().ok().filter(|length| *length > 0.0);
        } else if is(key, "angle") {
            asf.radians =
                lexer.peek_in_line().first().is_some_and(|b| b.eq_ignore_ascii_case(&b'r'));
        }
        lexer.skip_line();
    }
}

fn root(lexer: &mut Lexer<'_>, asf: &mut Asf<'_>) -> Result<(), Fault> {
    let root = &mut asf.root;
    while !section_ends(lexer.peek()) {
        let key = lexer.take();
        if is(key, "order") {
            root.dofs = dofs(lexer)?;
        } else if is(key, "axis") {
            root.axis_order = axis_order(lexer)?;
        } else if is(key, "position") {
            asf.root_position = lexer.three_numbers()?;
        } else if is(key, "orientation") {
            root.axis = lexer.three_numbers()?;
        } else {
            lexer.skip_line();
        }
    }
    if root.dofs.is_empty() {
        root.dofs = Dof::ALL.iter().take(6).map(|(_, dof)| *dof).collect();
    }
    Ok(())
}

/// Reads names of degrees of freedom up to the first token that is not one.
fn dofs(lexer: &mut Lexer<'_>) -> Result<Vec<Dof>, Fault> {
    let mut list = Vec::new();
    while let Some(dof) = Dof::of(lexer.peek()) {
        if list.contains(&dof) {
            return Err(lexer.unexpected("each degree of freedom once"));
        }
        lexer.take();
        list.push(dof);
    }
    Ok(list)
}

/// Reads an order of axes such as `XYZ`, which is also the default.
fn axis_order(lexer: &mut Lexer<'_>) -> Result<[usize; 3], Fault> {
    let token = lexer.peek_in_line();
    if token.is_empty() {
        return Ok([0, 1, 2]);
    }
    let place = |b: &u8| b"xyz".iter().position(|axis| *axis == b.to_ascii_lowercase());
    let order: Option<Vec<usize>> = token.iter().map(place).collect();
    match order.as_deref() {
        Some(&[a, b, c]) if a != b && b != c && a != c => {
            lexer.take();
            Ok([a, b, c])
        }
        _ => Err(lexer.unexpected("an order of axes, such as `XYZ`")),
    }
}

/// Returns whether a token begins a field of a bone.
fn is_field(token: &[u8]) -> bool {
    [
        "id",
        "name",
        "direction",
        "length",
        "axis",
        "dof",
        "limits",
        "bodymass",
        "cofmass",
        "begin",
        "end",
    ]
    .iter()
    .any(|field| is(token, field))
}

fn bones<'a>(lexer: &mut Lexer<'a>, bones: &mut Vec<FileBone<'a>>) -> Result<(), Fault> {
    let mut names: HashSet<&[u8]> = bones.iter().map(|bone| bone.name).collect();
    while !section_ends(lexer.peek()) {
        if !is(lexer.peek(), "begin") {
            return Err(lexer.unexpected("`begin` of a bone"));
        }
        let bone = bone(lexer)?;
        if !names.insert(bone.name) || is(bone.name, "root") {
            return Err(Fault::new(bone.at, quoted(bone.name), "a name that no other bone has"));
        }
        bones.push(bone);
    }
    Ok(())
}

fn bone<'a>(lexer: &mut Lexer<'a>) -> Result<FileBone<'a>, Fault> {
    let begin = lexer.at;
    lexer.take();
    let mut bone = FileBone { name: b"", ..FileBone::at(begin) };
    loop {
        let key = lexer.peek();
        if section_ends(key) || is(key, "begin") {
            return Err(lexer.unexpected("`end` of the bone"));
        }
        lexer.take();
        if is(key, "end") {
            break;
        } else if is(key, "name") {
            bone.name = lexer.peek_in_line();
            bone.at = lexer.at;
            lexer.at += bone.name.len();
        } else if is(key, "direction") {
            bone.direction = lexer.three_numbers()?;
        } else if is(key, "length") {
            bone.length = lexer.number()?;
        } else if is(key, "axis") {
            bone.axis = lexer.three_numbers()?;
            bone.axis_order = axis_order(lexer)?;
        } else if is(key, "dof") {
            bone.dofs = dofs(lexer)?;
            let rest = lexer.peek_in_line();
            if !rest.is_empty() && !is_field(rest) {
                return Err(lexer.unexpected("a degree of freedom: tx, ty, tz, rx, ry, rz or l"));
            }
        } else {
            // The numbers of a field that does not affect the motion, such as limits.
            while !section_ends(lexer.peek()) && !is_field(lexer.peek()) {
                lexer.take();
            }
        }
    }
    if bone.name.is_empty() {
        return Err(Fault::new(begin, "a bone without a name", "a `name` in every bone"));
    }
    Ok(bone)
}

/// Reads lines of a parent and its children.
fn hierarchy<'a>(lexer: &mut Lexer<'a>, links: &mut Vec<(Mention<'a>, Mention<'a>)>) {
    while !section_ends(lexer.peek()) {
        let parent = mention(lexer);
        if is(parent.name, "begin") || is(parent.name, "end") {
            continue;
        }
        while !lexer.peek_in_line().is_empty() {
            links.push((parent, mention(lexer)));
        }
    }
}

fn mention<'a>(lexer: &mut Lexer<'a>) -> Mention<'a> {
    let name = lexer.take();
    Mention { name, at: lexer.at - name.len() }
}
