//! Links: the state of a session as a query string.

use super::bone_map::{BONES, BoneMap, MAX_LINKED_RIGS};
use super::outside::short;
use super::params::{Key, Param, Params, Value};
use percent_encoding::{AsciiSet, CONTROLS, utf8_percent_encode};
use segue_text::{Message, ToMessage, msg};

/// The characters that a query string must escape. Colons, commas, slashes and parentheses stay
/// readable, because every browser accepts them.
const ESCAPED: &AsciiSet = &CONTROLS
    .add(b' ')
    .add(b'"')
    .add(b'#')
    .add(b'%')
    .add(b'&')
    .add(b'+')
    .add(b'<')
    .add(b'>')
    .add(b'=')
    .add(b'`');

/// The content of a link, and the parts of it that could not be used.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Link {
    /// The values that were understood, in the order of the link.
    pub values: Vec<(Key, Value)>,
    /// The corrected body parts of the rigs that its clips have.
    pub bone_maps: Vec<BoneMap>,
    /// One sentence for each key that is unknown and each value that does not fit.
    pub problems: Vec<Message>,
}

/// Keys that belong to the page's loader, not to the state.
const LOADER_KEYS: &[&str] = &["backend"];

/// Reads a query string, with or without its `?`.
#[must_use]
pub fn read(query: &str) -> Link {
    let mut link = Link::default();
    for (name, text) in form_urlencoded::parse(query.trim_start_matches('?').as_bytes()) {
        match Key::from_name(&name) {
            Some(key) => match key.param().parse(&text) {
                Ok(value) => link.values.push((key, value)),
                Err(error) => link.problems.push(error.to_message()),
            },
            None if name == BONES => match BoneMap::from_link(&text) {
                Ok(map) if link.bone_maps.len() < MAX_LINKED_RIGS => link.bone_maps.push(map),
                Ok(_) => {
                    let reason = msg!("the first {max} rigs are used", max = MAX_LINKED_RIGS);
                    link.problems.push(msg!("{key}: {reason}", key = BONES, reason));
                }
                Err(error) => {
                    let reason = error.to_message();
                    link.problems.push(msg!("{key}: {reason}", key = BONES, reason));
                }
            },
            None if LOADER_KEYS.contains(&name.as_ref()) => {}
            None => {
                link.problems
                    .push(msg!("`{name}` is not a parameter of this version", name = short(&name)));
            }
        }
    }
    link
}

/// Returns the parameters that a link contains: those that differ from their defaults, in the order
/// of the table. The playhead is left out during playback.
pub(crate) fn named(params: &Params) -> impl Iterator<Item = (&'static Param, &Value)> {
    let is_playing = params.is_on(Key::Play);
    params.changed().filter(move |(param, _)| param.key != Key::Time || !is_playing)
}

/// Writes the parameters that differ from their defaults as a query string without `?`, in the
/// order of the table. The playhead is left out during playback.
#[must_use]
pub fn write(params: &Params) -> String {
    let mut query = String::new();
    for (param, value) in named(params) {
        add(&mut query, param.name, &param.format(value));
    }
    query
}

/// Adds the corrected body parts of rigs to a query string, as far as they are short.
pub(crate) fn add_bone_maps(query: &mut String, maps: &[BoneMap]) {
    for part in maps.iter().filter_map(BoneMap::to_link) {
        add(query, BONES, &part);
    }
}

fn add(query: &mut String, key: &str, text: &str) {
    if !query.is_empty() {
        query.push('&');
    }
    query.push_str(key);
    query.push('=');
    query.extend(utf8_percent_encode(text, ESCAPED));
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixtures::any_value;
    use crate::params::{Compare, PARAMS};
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn every_state_reads_back_from_its_link(values in (0..PARAMS.len()).map(any_value).collect::<Vec<_>>()) {
            let mut params = Params::default();
            for (key, value) in values {
                params.set(key, value).unwrap();
            }
            params.set(Key::Play, Value::Switch(false)).unwrap();
            let link = read(&write(&params));
            prop_assert_eq!(&link.problems, &Vec::<Message>::new());
            let mut back = Params::default();
            for (key, value) in link.values {
                back.set(key, value).unwrap();
            }
            prop_assert_eq!(back, params);
        }

        #[test]
        fn any_query_is_read_without_a_panic(query in ".{0,200}") {
            let _link = read(&query);
        }
    }

    #[test]
    fn links_are_short_and_readable() {
        let mut params = Params::default();
        assert_eq!(write(&params), "");
        params.set(Key::BlendWindow, Value::Number(24.0)).unwrap();
        params
            .set(
                Key::Compare,
                Value::Compare(Compare::full_half_third(Key::BlendWindow, 30.0, None)),
            )
            .unwrap();
        params.set(Key::A, Value::Text("01_01~3fa9c1d2".into())).unwrap();
        assert_eq!(
            write(&params),
            "a=01_01~3fa9c1d2&blend_window=24&compare=blend_window:30,15,10"
        );
    }

    #[test]
    fn list_that_cannot_be_read_is_named_with_its_place() {
        for (query, problem) in [
            (
                "pins=12-30,50",
                "pins: entry 2: found `50`, expected a frame of A and one of B, as in 12-30",
            ),
            (
                "clips=walk,(run",
                "clips: found `walk,(run`, expected brackets that close, and commas between the entries",
            ),
            (
                "match_clips=walk)",
                "match_clips: found `walk)`, expected brackets that close, and commas between the entries",
            ),
            (
                "warp_also=2:run",
                "warp_also: entry 1: found `2:run`, expected a weight from 0 to 1 and a clip, as in 0.3:run",
            ),
            (
                "warp_curve=0-101",
                "warp_curve: entry 1: found `0-101`, expected per cent of the blend and of B, as in 50-100",
            ),
            (
                "go_to=3",
                "go_to: entry 1: found `3`, expected seconds and a clip's place in the list, as in 12.5:3",
            ),
            (
                "walk_path=0:0,a",
                "walk_path: entry 2: found `a`, expected x and z in metres, as in 1.5:4",
            ),
            (
                "jump=0:1-x",
                "jump: found `0:1-x`, expected the clip and the frame that are left and those that are entered, as in 0:52-3:14",
            ),
            ("path=nonsense!", "path: this is not a path from a link: copy the whole link"),
            ("drive=0.0.0", "drive: found `0.0.0`, expected input of one tick or more"),
            (
                "tags=walk",
                "tags: entry 1: found `walk`, expected a clip, its seconds and a word, as in walk:0.2-1.5:exclude",
            ),
        ] {
            let link = read(query);
            assert_eq!((link.values, link.problems[0].to_string()), (vec![], problem.to_owned()));
        }
    }

    #[test]
    fn invalid_parts_of_a_link_are_named_and_the_rest_is_used() {
        let link = read("?blend_window=24&colour=red&weight_law=steep&align=off");
        assert_eq!(
            link.values,
            [(Key::BlendWindow, Value::Number(24.0)), (Key::Align, Value::Switch(false))]
        );
        let problems: Vec<String> = link.problems.iter().map(ToString::to_string).collect();
        assert_eq!(
            problems,
            [
                "`colour` is not a parameter of this version",
                "weight_law: found `steep`, expected smooth, linear, smoother"
            ]
        );
    }
}
