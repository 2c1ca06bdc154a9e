//! The details of a clip and their corrections: below its row in the library, and in the View lab.

use super::bone_map::bone_map_ui;
use super::kit::{self, Tree, TreeRow};
use super::language::{Text, Word, say};
use super::out::Out;
use super::rows::{body_parts_asked_for, save_rows_ui};
use super::state::{Typing, UiState};
use super::text;
use super::theme::{Type, palette_of, space, theme_of};
use eframe::egui::{RichText, Ui};
use segue_formats::ImportOptions;
use segue_formats::robot_csv::HingeLimits;
use segue_motion::clip::{Motion, UpAxis, ground_speed};
use segue_motion::math::sort::sort_by_key;
use segue_motion::skeleton::{Channel, Skeleton};
use segue_session::{
    Command, Entry, FileCommand, Key, Origin, Session, SourceFile, Value, format_number, joint_of,
    word_of_joint,
};
use segue_text::{Message, msg};

/// The height above which the tree of joints scrolls, points.
const TREE_HEIGHT: f32 = 264.0;

/// Draws the panel of a clip. `saved` is the id of the motion that is saved from here, if one is.
pub(crate) fn clip_panel_ui(
    entry: &Entry,
    saved: Option<&str>,
    session: &Session,
    state: &mut UiState,
    out: &mut Out,
    ui: &mut Ui,
) {
    for warning in &entry.warnings {
        sentence_ui(warning, palette_of(ui).warning, ui);
    }
    let Some(motion) = &entry.motion else {
        let status = text::status(entry);
        if !status.is_empty() && entry.warnings.is_empty() {
            sentence_ui(status, palette_of(ui).muted, ui);
        }
        if entry.is_known() && !session.is_reading_clip(&entry.id) {
            out.commands.push(Command::File(FileCommand::Read(entry.id.clone())));
        }
        return;
    };
    facts_ui(motion, session, ui);
    if let Origin::File(file) = &entry.origin {
        ui.add_space(space::XS);
        overrides_ui(entry, file, motion, state, out, ui);
    }
    if let Some(saved) = saved {
        ui.add_space(space::S);
        save_rows_ui(saved, state, out, ui);
    }
    ui.add_space(space::XS);
    state.joints_open |= kit::folded_ui(text::JOINTS, ui, |ui| joints_ui(motion, session, out, ui));
    let is_asked_for = body_parts_asked_for(&entry.id, ui);
    state.joints_open |= kit::folded_unless_ui(is_asked_for, text::BODY_PARTS, ui, |ui| {
        bone_map_ui(entry, motion, session, &mut state.bone_map, out, ui);
    });
}

fn sentence_ui<'a>(sentence: impl Into<Text<'a>>, color: eframe::egui::Color32, ui: &mut Ui) {
    ui.label(RichText::new(say(sentence, ui)).font(theme_of(ui).font(Type::Small)).color(color));
}

fn facts_ui(motion: &Motion, session: &Session, ui: &mut Ui) {
    let clip = motion.clip();
    let is_analyzing = session.is_analyzing(motion);
    let derived = |fact: &dyn Fn() -> String| if is_analyzing { "…".into() } else { fact() };
    let ground = || format_number(f64::from(motion.ground_m()) * 100.0, 0.1);
    let speed = || format!("{:.2}", ground_speed(motion.ground_frames(), clip.fps()));
    let facts = [
        (text::LENGTH, format!("{:.2}", clip.duration_secs()), "s"),
        (text::FRAMES, clip.frames().to_string(), ""),
        (text::FRAME_RATE, format_number(clip.fps(), 0.01), "fps"),
        (text::JOINTS, clip.skeleton().len().to_string(), ""),
        (text::BODY_HEIGHT, format!("{:.2}", motion.roles().body_height(clip.skeleton())), "m"),
        (text::GROUND, derived(&ground), "cm"),
        (text::MEAN_SPEED, derived(&speed), "m/s"),
    ];
    for (label, value, unit) in facts {
        kit::value_row_ui(label, &value, Word::new(unit), ui);
    }
    let muted = palette_of(ui).muted;
    if HingeLimits::of(clip.skeleton()).is_some() {
        sentence_ui(text::HINGE_COLORS, muted, ui);
    }
    let channels = channels_in_words(clip.skeleton());
    if !channels.is_empty() {
        sentence_ui(&channels, muted, ui);
    }
}

/// Metres per unit of length that files come in.
const UNITS: [(f64, Word); 6] = [
    (1.0, Word::new("m")),
    (0.01, Word::new("cm")),
    (0.001, Word::new("mm")),
    (0.0254, Word::new("inch")),
    (0.3048, Word::new("foot")),
    (segue_formats::CMU_METRES_PER_UNIT, Word::new("CMU, 5.64 cm")),
];

/// Frame rates that files come in.
const RATES: [f64; 5] = [24.0, 25.0, 30.0, 60.0, 120.0];

/// Draws the rows that correct the detected properties.
fn overrides_ui(
    entry: &Entry,
    file: &SourceFile,
    motion: &Motion,
    state: &mut UiState,
    out: &mut Out,
    ui: &mut Ui,
) {
    let options = file.options;
    let mut reread = |options: ImportOptions| {
        out.commands.push(Command::File(FileCommand::Reimport(entry.id.clone(), options)));
    };
    let provenance = motion.clip().provenance();

    let known =
        UNITS.iter().find(|(metres, _)| (metres / provenance.metres_per_unit - 1.0).abs() < 1e-6);
    let unit = known.map_or_else(
        || msg!("{metres} m", metres = format_number(provenance.metres_per_unit, 1e-6)),
        |&(_, name)| name.into(),
    );
    let found = as_found(&unit, options.metres_per_unit.is_none());
    let mut choices = vec![(None, Text::from(&found))];
    choices.extend(UNITS.map(|(metres, name)| (Some(metres), name.into())));
    if let Some(metres_per_unit) =
        kit::choice_row_ui(text::UNIT, options.metres_per_unit, &choices, ui)
    {
        reread(ImportOptions { metres_per_unit, ..options });
    }

    let axis = |up| if up == UpAxis::Y { "Y" } else { "Z" };
    let found = as_found(&Message::data(axis(provenance.up)), options.up.is_none());
    let named = |up| (Some(up), Text::Data(axis(up)));
    let choices = [(None, Text::from(&found)), named(UpAxis::Y), named(UpAxis::Z)];
    if let Some(up) = kit::choice_row_ui(text::UP_AXIS, options.up, &choices, ui) {
        reread(ImportOptions { up, ..options });
    }

    if let Some(Rate::Given(fps)) = rate_ui(entry, options.fps, state, ui) {
        reread(ImportOptions { fps, ..options });
    }

    if entry.about.as_ref().is_some_and(|about| about.t_pose_first_row)
        && let Some(drop_t_pose) = kit::switch_row_ui(text::DROP_T_POSE, options.drop_t_pose, ui)
    {
        reread(ImportOptions { drop_t_pose, ..options });
    }
}

fn as_found(value: &Message, is_found: bool) -> Message {
    if is_found { msg!("{value}, detected", value) } else { text::AS_FOUND.into() }
}

/// A choice in the list of frame rates.
#[derive(Clone, Copy, PartialEq)]
enum Rate {
    Given(Option<f64>),
    /// A number that is typed.
    Other,
}

/// Draws the choice of the frame rate. Returns a new choice.
fn rate_ui(entry: &Entry, fps: Option<f64>, state: &mut UiState, ui: &mut Ui) -> Option<Rate> {
    let typed = fps.filter(|fps| !RATES.contains(fps));
    let rates = RATES.into_iter().chain(typed);
    let rates: Vec<(f64, String)> = rates.map(|rate| (rate, format_number(rate, 0.01))).collect();
    let mut choices = vec![(Rate::Given(None), Text::from(text::AS_FILE))];
    choices.extend(rates.iter().map(|(rate, name)| (Rate::Given(Some(*rate)), Text::Data(name))));
    choices.push((Rate::Other, text::OTHER.into()));
    let typing = state.typed_fps.as_mut().filter(|typing| typing.id == entry.id);
    let chosen = if typing.is_some() { Rate::Other } else { Rate::Given(fps) };
    let Some(typing) = typing else {
        let picked = kit::choice_row_ui(text::FRAME_RATE, chosen, &choices, ui);
        if picked == Some(Rate::Other) {
            state.typed_fps = Some(Typing { id: entry.id.clone(), text: String::new() });
        }
        return picked;
    };
    let field = kit::text_field_ui(text::TYPED_RATE, text::TYPED_RATE, &mut typing.text, ui);
    if !field.response.has_focus() && !field.committed {
        field.response.request_focus();
    }
    let escaped = ui.input(|input| input.key_pressed(eframe::egui::Key::Escape));
    if !field.committed && !escaped {
        return None;
    }
    let rate = rate_of(&typing.text);
    state.typed_fps = None;
    rate.filter(|_| field.committed).map(|fps| Rate::Given(Some(fps)))
}

/// Returns the frame rate in a typed text.
fn rate_of(text: &str) -> Option<f64> {
    let number = text.trim().trim_end_matches("fps").trim_end().replace(',', ".");
    number.parse::<f64>().ok().filter(|fps| (0.1..=10_000.0).contains(fps))
}

/// Draws the tree of joints. The chosen one has its curve plotted, and is marked on the stage.
fn joints_ui(motion: &Motion, session: &Session, out: &mut Out, ui: &mut Ui) {
    let joints = motion.clip().skeleton().joints();
    let parents: Vec<Option<usize>> = joints.iter().map(|joint| joint.parent).collect();
    let tree = Tree {
        label: text::JOINT_TREE,
        parents: &parents,
        chosen: joint_of(motion, session.params().text(Key::Joint)),
        max_height: TREE_HEIGHT * theme_of(ui).scale(),
    };
    let hinges = HingeLimits::of(motion.clip().skeleton());
    let range = |joint: usize| hinges.as_ref().and_then(|hinges| hinges.range_degrees(joint));
    let row = |joint: usize| TreeRow {
        name: joints[joint].name.clone(),
        detail: motion
            .roles()
            .role_of(joint)
            .map_or(Word::default(), |role| Word::new(role.name_in(motion.roles().body_plan()))),
        hint: range(joint).map_or_else(
            || in_words(&joints[joint].channels),
            |[least, greatest]| msg!("turns from {least:.0}° to {greatest:.0}°", least, greatest),
        ),
    };
    if let Some(joint) = kit::tree_ui(&tree, row, ui) {
        out.set_once(Key::Joint, Value::Text(word_of_joint(motion, joint).to_owned()));
    }
}

/// Returns channels in words: `position X Y Z, rotation Z X Y`; empty without channels.
fn in_words(channels: &[Channel]) -> Message {
    let letters = |of: fn(Channel) -> Option<&'static str>| {
        channels.iter().filter_map(|&channel| of(channel)).collect::<Vec<_>>().join(" ")
    };
    let place = letters(|channel| match channel {
        Channel::XPosition => Some("X"),
        Channel::YPosition => Some("Y"),
        Channel::ZPosition => Some("Z"),
        _ => None,
    });
    let turn = letters(|channel| match channel {
        Channel::XRotation => Some("X"),
        Channel::YRotation => Some("Y"),
        Channel::ZRotation => Some("Z"),
        _ => None,
    });
    match [place.is_empty(), turn.is_empty()] {
        [true, true] => Message::default(),
        [false, true] => msg!("position {place}", place),
        [true, false] => msg!("rotation {turn}", turn),
        [false, false] => msg!("position {place}, rotation {turn}", place, turn),
    }
}

/// Returns the channels of a file in words: those of the root, and those of the other joints, the
/// most common ones first. Empty without channels.
fn channels_in_words(skeleton: &Skeleton) -> Message {
    let Some((root, others)) = skeleton.joints().split_first() else {
        return Message::default();
    };
    let mut kinds: Vec<(Message, usize)> = Vec::new();
    for words in
        others.iter().map(|joint| in_words(&joint.channels)).filter(|words| !words.is_empty())
    {
        match kinds.iter_mut().find(|(known, _)| *known == words) {
            Some((_, count)) => *count += 1,
            None => kinds.push((words, 1)),
        }
    }
    sort_by_key(&mut kinds, |(_, count)| std::cmp::Reverse(*count));
    let mut sentences = Vec::new();
    let of_root = in_words(&root.channels);
    if !of_root.is_empty() {
        sentences.push(msg!("Root: {channels}.", channels = of_root));
    }
    match kinds.as_slice() {
        [] => {}
        [(words, _)] => sentences.push(msg!("Joints: {channels}.", channels = words.clone())),
        [(words, _), rest @ ..] => {
            let rest: usize = rest.iter().map(|(_, count)| count).sum();
            sentences.push(msg!(
                "Joints: {channels}; {rest}.",
                channels = words.clone(),
                rest = text::others(rest)
            ));
        }
    }
    Message::joined(sentences, " ")
}

#[cfg(test)]
mod tests {
    use super::*;
    use segue_motion::skeleton::Joint;

    #[test]
    fn channels_are_described_in_words() {
        use Channel::{XPosition, XRotation, YPosition, YRotation, ZPosition, ZRotation};
        let joint = |parent, channels: &[Channel]| Joint {
            name: "j".into(),
            parent,
            offset: glam::Vec3::Y,
            end_site: None,
            channels: channels.to_vec(),
        };
        let all = [XPosition, YPosition, ZPosition, ZRotation, XRotation, YRotation];
        let mut joints = vec![joint(None, &all)];
        let skeleton = |joints: &[Joint]| Skeleton::new(joints.to_vec()).unwrap();
        assert_eq!(
            channels_in_words(&skeleton(&joints)).to_string(),
            "Root: position X Y Z, rotation Z X Y."
        );
        joints.extend([joint(Some(0), &all[3..]), joint(Some(1), &[]), joint(Some(1), &all[3..])]);
        assert_eq!(
            channels_in_words(&skeleton(&joints)).to_string(),
            "Root: position X Y Z, rotation Z X Y. Joints: rotation Z X Y."
        );
        joints.push(joint(Some(1), &[XRotation]));
        assert_eq!(
            channels_in_words(&skeleton(&joints)).to_string(),
            "Root: position X Y Z, rotation Z X Y. Joints: rotation Z X Y; 1 has others."
        );
        assert_eq!(channels_in_words(&skeleton(&[joint(None, &[])])).to_string(), "");
    }

    #[test]
    fn typed_rate_out_of_range_is_refused() {
        assert_eq!(
            [" 119.88 ", "50 fps", "29,97"].map(rate_of),
            [Some(119.88), Some(50.0), Some(29.97)]
        );
        assert_eq!(["", "fast", "0", "-30", "inf", "1e9"].map(rate_of), [None; 6]);
    }
}
