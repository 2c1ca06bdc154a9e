//! The HIERARCHY section of a BVH file.

use super::lexer::{Lexer, Stop};
use crate::error::Fault;
use crate::text::{name, quoted, short};
use crate::warning::WarningKind;
use segue_motion::skeleton::Channel;
use segue_text::msg;

/// The greatest depth of joints: no skeleton is deeper, and later stages may recurse.
pub(crate) const MAX_DEPTH: usize = 4096;

/// A joint of the file: file units, file axes.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct FileJoint {
    pub(super) name: String,
    /// An index into all joints of the file; `None` for a ROOT.
    pub(super) parent: Option<usize>,
    pub(super) offset: [f64; 3],
    pub(super) end_site: Option<[f64; 3]>,
}

/// One number of a row. `channel` is `None` where the number is skipped: scale, and channels of End
/// Sites.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Column {
    pub(super) joint: usize,
    pub(super) channel: Option<Channel>,
}

/// The HIERARCHY section. Every ROOT is followed by all of its joints, parents first.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Hierarchy {
    pub(super) joints: Vec<FileJoint>,
    /// The content of a row, in the order of the CHANNELS lines.
    pub(super) columns: Vec<Column>,
}

/// The current position in the tree.
struct Scope {
    joint: usize,
    is_end_site: bool,
    has_offset: bool,
    /// The place of the joint, for messages.
    at: usize,
}

/// The meaning of a channel's name.
enum ChannelName {
    /// A channel that moves or rotates the joint.
    Kept(Channel),
    /// A scale channel, whose numbers are skipped.
    Scale,
}

/// Returns the channel of a name, in any case.
fn channel_name(token: &[u8]) -> Option<ChannelName> {
    let (axis, kind) = token.split_first()?;
    let axis = b"xyz".iter().position(|a| *a == axis.to_ascii_lowercase())?;
    let is = |names: [&str; 2]| names.iter().any(|n| kind.eq_ignore_ascii_case(n.as_bytes()));
    if is(["position", "translation"]) {
        let channels = [Channel::XPosition, Channel::YPosition, Channel::ZPosition];
        channels.get(axis).copied().map(ChannelName::Kept)
    } else if is(["rotation", "rot"]) {
        let channels = [Channel::XRotation, Channel::YRotation, Channel::ZRotation];
        channels.get(axis).copied().map(ChannelName::Kept)
    } else if is(["scale", "scaling"]) {
        Some(ChannelName::Scale)
    } else {
        None
    }
}

/// Reads up to the MOTION section or the end of the file. Iterative: the depth of the tree takes
/// heap, not stack.
pub(super) fn hierarchy(lexer: &mut Lexer<'_>) -> Result<Hierarchy, Stop> {
    let mut tree = Hierarchy::default();
    let mut open: Vec<Scope> = Vec::new();
    loop {
        let token = lexer.peek();
        let start = lexer.at;
        let is = |keyword: &str| token.eq_ignore_ascii_case(keyword.as_bytes());
        let end_of_joints = is("MOTION") || starts_motion_header(token);
        match open.last_mut() {
            None if token.is_empty() || end_of_joints => {
                if tree.joints.is_empty() {
                    return Err(lexer.unexpected("`HIERARCHY` and a `ROOT`").into());
                }
                return Ok(tree);
            }
            None if is("HIERARCHY") => lexer.at += token.len(),
            None if is("ROOT") || (is("JOINT") && !tree.joints.is_empty()) => {
                lexer.at += token.len();
                open.push(begin_joint(lexer, &mut tree, None, start)?);
            }
            None => {
                let expected = if tree.joints.is_empty() {
                    "`HIERARCHY` and a `ROOT`"
                } else {
                    "`MOTION` or another `ROOT`"
                };
                return Err(lexer.unexpected(expected).into());
            }
            Some(scope) if is("}") => {
                lexer.at += token.len();
                if !scope.has_offset && !scope.is_end_site {
                    lexer.tally.add(WarningKind::MissingOffset, Some(scope.at));
                }
                open.pop();
            }
            Some(scope) if is("OFFSET") => {
                lexer.at += token.len();
                let offset = [lexer.number()?, lexer.number()?, lexer.number()?];
                let Some(joint) = tree.joints.get_mut(scope.joint) else {
                    continue;
                };
                if !scope.is_end_site {
                    joint.offset = offset;
                } else if scope.has_offset || joint.end_site.is_some() {
                    lexer.tally.add(WarningKind::SeveralEndSites, Some(start));
                } else if offset != [0.0; 3] {
                    // An End Site at the joint itself only marks a leaf: the bone has no length.
                    joint.end_site = Some(offset);
                }
                scope.has_offset = true;
            }
            Some(scope) if is("CHANNELS") => {
                lexer.at += token.len();
                channels(lexer, &mut tree, scope, start)?;
            }
            Some(scope) if !scope.is_end_site && (is("JOINT") || is("END") || is("ENDSITE")) => {
                let parent = scope.joint;
                if is("JOINT") && open.len() >= MAX_DEPTH {
                    let found = msg!("joints nested more than {MAX_DEPTH} deep");
                    return Err(Fault::new(start, found, msg!("at most {MAX_DEPTH} levels")).into());
                }
                lexer.at += token.len();
                open.push(if is("JOINT") {
                    begin_joint(lexer, &mut tree, Some(parent), start)?
                } else {
                    // `Site`, and a name after it.
                    lexer.rest_of_line();
                    open_brace(lexer)?;
                    Scope { joint: parent, is_end_site: true, has_offset: false, at: start }
                });
            }
            Some(scope) => {
                let joint = tree
                    .joints
                    .get(scope.joint)
                    .map_or_else(String::new, |j| quoted(j.name.as_bytes()));
                let expected = match (token.is_empty() || end_of_joints, scope.is_end_site) {
                    (true, _) => msg!("`}}` for joint {joint}"),
                    (_, true) => "`OFFSET` or `}`".into(),
                    _ => "`OFFSET`, `CHANNELS`, `JOINT`, `End Site` or `}`".into(),
                };
                return Err(lexer.unexpected(expected).into());
            }
        }
    }
}

/// Returns whether a token begins the header of a MOTION section without a MOTION line: `Frames:4`
/// or `Frame`.
pub(super) fn starts_motion_header(token: &[u8]) -> bool {
    token.get(..5).is_some_and(|head| head.eq_ignore_ascii_case(b"frame"))
}

fn begin_joint(
    lexer: &mut Lexer<'_>,
    tree: &mut Hierarchy,
    parent: Option<usize>,
    at: usize,
) -> Result<Scope, Stop> {
    let mut written = lexer.rest_of_line();
    if written.is_empty() && !matches!(lexer.peek(), b"{" | b"") {
        // The name stands on a line of its own.
        written = lexer.rest_of_line();
    }
    let (name, is_utf8) = name(written);
    if !is_utf8 {
        lexer.tally.add(WarningKind::Latin1Names, Some(at));
    }
    open_brace(lexer)?;
    tree.joints.push(FileJoint { name, parent, offset: [0.0; 3], end_site: None });
    Ok(Scope { joint: tree.joints.len() - 1, is_end_site: false, has_offset: false, at })
}

fn open_brace(lexer: &mut Lexer<'_>) -> Result<(), Stop> {
    if lexer.peek() == b"{" {
        lexer.at += 1;
        Ok(())
    } else {
        Err(lexer.unexpected("`{`").into())
    }
}

/// Reads `CHANNELS 6 Xposition …`. Names are read as long as there are any; the number only matters
/// where a name is wrong.
fn channels(
    lexer: &mut Lexer<'_>,
    tree: &mut Hierarchy,
    scope: &Scope,
    start: usize,
) -> Result<(), Stop> {
    let mut declared = String::new();
    let mut count = None;
    let token = lexer.peek();
    if let Ok(number) = fast_float2::parse::<f64, _>(token) {
        lexer.at += token.len();
        declared = short(token);
        count = Some(number);
    }
    let mut named = 0_usize;
    loop {
        let token = lexer.peek();
        let Some(name) = channel_name(token) else {
            break;
        };
        let kept = match name {
            _ if scope.is_end_site => {
                lexer.tally.add(WarningKind::EndSiteChannels, Some(lexer.at));
                None
            }
            ChannelName::Scale => {
                lexer.tally.add(WarningKind::ScaleChannels, Some(lexer.at));
                None
            }
            ChannelName::Kept(channel) => Some(channel),
        };
        lexer.at += token.len();
        tree.columns.push(Column { joint: scope.joint, channel: kept });
        named += 1;
    }
    let next = lexer.peek();
    let ends = [
        b"{".as_slice(),
        b"}",
        b"JOINT",
        b"END",
        b"ENDSITE",
        b"OFFSET",
        b"CHANNELS",
        b"MOTION",
        b"",
    ];
    let is_end = ends.iter().any(|end| next.eq_ignore_ascii_case(end));
    match count {
        None if named == 0 => return Err(lexer.unexpected("a number of channels").into()),
        _ if !is_end => {
            let expected = "a channel (`Xposition` … `Zposition`, `Xrotation` … `Zrotation`)";
            return Err(lexer.unexpected(expected).into());
        }
        Some(count) if count == named as f64 => {}
        _ => {
            let declared = if declared.is_empty() { "nothing".to_owned() } else { declared };
            lexer.tally.add(WarningKind::ChannelCount { declared, named }, Some(start));
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(text: &str) -> Result<Hierarchy, Stop> {
        hierarchy(&mut Lexer::new(text.as_bytes(), false))
    }

    fn fault(text: &str) -> (usize, String, String) {
        match parse(text) {
            Err(Stop::Fault(fault)) => {
                (fault.at, fault.found.to_string(), fault.expected.to_string())
            }
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn hierarchy_in_any_layout_is_read() {
        let tree = parse(
            "root A { channels 1 zROTATION offset 1 2 3 JOINT B C { OFFSET 4 5 6} \
             END SITE x{OFFSET 7 8 9}}",
        )
        .unwrap();
        assert_eq!(tree.joints[0].offset, [1.0, 2.0, 3.0]);
        assert_eq!(tree.joints[0].end_site, Some([7.0, 8.0, 9.0]));
        assert_eq!((tree.joints[1].name.as_str(), tree.joints[1].parent), ("B C", Some(0)));
        assert_eq!(tree.columns, [Column { joint: 0, channel: Some(Channel::ZRotation) }]);
    }

    #[test]
    fn hierarchy_names_on_their_own_line_or_missing_are_read() {
        let tree = parse("ROOT\n  Hips \n{ JOINT\n { } }").unwrap();
        assert_eq!(tree.joints.iter().map(|j| j.name.as_str()).collect::<Vec<_>>(), ["Hips", ""]);
    }

    #[test]
    fn hierarchy_mistakes_are_refused_with_their_place() {
        assert_eq!(fault("").2, "`HIERARCHY` and a `ROOT`");
        assert_eq!(fault("PK\u{3}").1, "`PK\\u{3}`");
        assert_eq!(fault("ROOT A\nOFFSET"), (7, "`OFFSET`".into(), "`{`".into()));
        assert_eq!(fault("ROOT A {\nMOTION").2, "`}` for joint `A`");
        assert_eq!(fault("ROOT A { OFFSET 1 2 }"), (20, "`}`".into(), "a number".into()));
        assert_eq!(fault("ROOT A { OFFSET nan 2 3 }").1, "`nan`");
        assert_eq!(fault("ROOT A { CHANNELS 2 Xrotation Wrotation }").1, "`Wrotation`");
        assert_eq!(fault("ROOT A { CHANNELS }").2, "a number of channels");
        assert_eq!(fault("ROOT A { End Site { JOINT B { } } }").2, "`OFFSET` or `}`");
        assert_eq!(fault("ROOT A { } }").1, "`}`");
        assert_eq!(fault("ROOT A { foo }").1, "`foo`");
    }

    #[test]
    fn hierarchy_depth_is_limited() {
        let nested = |depth: usize| {
            format!("ROOT r {{ {} {}", "JOINT j { ".repeat(depth - 1), "}".repeat(depth))
        };
        assert_eq!(parse(&nested(3000)).unwrap().joints.len(), 3000);
        assert_eq!(parse(&nested(MAX_DEPTH)).unwrap().joints.len(), MAX_DEPTH);
        assert!(fault(&nested(MAX_DEPTH + 1)).1.contains("4096 deep"));
        assert!(fault(&"ROOT r { ".repeat(2)).1.contains("ROOT"));
    }
}
