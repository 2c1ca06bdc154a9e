//! The contacts of clips on the timeline, and their correction.

use crate::ui::kit::{self, Part, StanceEdit, StanceEvent, Stripe};
use crate::ui::out::Out;
use crate::ui::text;
use segue_motion::clip::{ContactCorrections, Contacts};
use segue_motion::skeleton::{Foot, Side};
use segue_session::{ContactClip, Key, Session};
use segue_text::Message;
use std::ops::Range;

/// The length of a contact that is added, seconds.
const NEW_SECS: f64 = 0.25;

/// Returns the labels of the stripes of clips: their names, where there are several.
pub(super) fn labels(clips: &[ContactClip], session: &Session) -> Vec<Message> {
    match clips {
        [_] => vec![text::CONTACTS.into()],
        clips => clips.iter().map(|clip| title(clip, session)).collect(),
    }
}

fn title(clip: &ContactClip, session: &Session) -> Message {
    session.library().get(&clip.id).map(|entry| entry.title()).unwrap_or_default()
}

/// Returns the stripes of clips whose contacts can be corrected.
pub(super) fn stripes<'a>(
    clips: &[ContactClip],
    labels: &'a [Message],
    session: &Session,
) -> Vec<Stripe<'a>> {
    let stripe = |(clip, label): (&ContactClip, &'a Message)| {
        let fps = clip.motion.clip().fps();
        let secs = |frames: &Range<usize>| frames.start as f64 / fps..frames.end as f64 / fps;
        let contacts = clip.motion.contacts();
        let corrections = clip.motion.contact_corrections();
        let count = corrections.list().len();
        Stripe {
            part: Part::A,
            label: label.into(),
            feet: (contacts.feet().iter())
                .map(|&foot| contacts.intervals(foot).iter().map(secs).collect())
                .collect(),
            edit: Some(StanceEdit {
                corrected: (contacts.feet().iter())
                    .map(|&foot| {
                        let own = corrections.list().iter().filter(|edit| edit.foot == foot);
                        own.map(|edit| secs(&edit.frames)).collect()
                    })
                    .collect(),
                hint: (count > 0).then(|| kit::corrected_hint(&title(clip, session), count)),
            }),
        }
    };
    clips.iter().zip(labels).map(stripe).collect()
}

/// Carries out a correction of the contacts of a clip.
pub(super) fn correct(event: StanceEvent, clip: &ContactClip, session: &Session, out: &mut Out) {
    let contacts = clip.motion.contacts();
    let wanted = corrected(contacts, event, clip.motion.clip().fps());
    let corrections = match wanted {
        Some(wanted) if wanted == *contacts => return,
        Some(wanted) => ContactCorrections::between(clip.motion.found_contacts(), &wanted),
        None => ContactCorrections::default(),
    };
    out.set(Key::ContactEdits, session.params().contact_edits_with(&clip.id, corrections));
}

/// Returns the contacts after a correction; `None` for those that were found.
fn corrected(contacts: &Contacts, event: StanceEvent, fps: f64) -> Option<Contacts> {
    let foot_at = |foot: usize| Foot::ALL.get(foot).copied().unwrap_or(Side::Left.into());
    // `max` takes NaN to 0.
    let frame = |secs: f64| (secs * fps).max(0.0);
    Some(match event {
        StanceEvent::Move { foot, stance, end, time } => {
            contacts.with_end_at(foot_at(foot), stance, end, frame(time).round() as usize)
        }
        StanceEvent::Add { foot, time } => {
            let length = (NEW_SECS * fps).round() as usize;
            contacts.with_stance_at(foot_at(foot), frame(time).floor() as usize, length)
        }
        StanceEvent::Remove { foot, stance } => {
            let frames = contacts.intervals(foot_at(foot)).get(stance).cloned().unwrap_or_default();
            contacts.with(foot_at(foot), frames, false)
        }
        StanceEvent::Reset => return None,
    })
}
