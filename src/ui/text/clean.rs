//! The texts of the Clean lab.

use crate::ui::language::Word;
use segue_motion::clean::{Fault, FaultKind, SizeUnit};
use segue_text::{Message, msg};

/// The line about the Clean lab.
pub(crate) const CLEAN_ABOUT: Word =
    Word::new("Finds the faults of a recorded take, and mends them.");
/// The help text of the Clean lab.
pub(crate) const CLEAN_DETAILS: Word = Word::new(
    "A take is compared with itself: what a joint never does elsewhere is no movement. Mends are applied from top to bottom.",
);
/// The title of the list of faults.
pub(crate) const FAULTS: Word = Word::new("Faults found");
/// The list of faults without any.
pub(crate) const NO_FAULTS: Word = Word::new("No faults were found in this take.");
/// The list of faults while they are looked for.
pub(crate) const LOOKING_FOR_FAULTS: Word = Word::new("Looking for faults…");
/// The title of the rows that inject faults.
pub(crate) const INJECT_FAULTS: Word = Word::new("Inject faults");
/// The button that leaves a fault alone, or mends it after all.
pub(crate) const MEND_THIS: Word = Word::new("Mend this fault");
/// The button that mends everything.
pub(crate) const CLEAN_ALL: Word = Word::new("Clean all");
/// The hint of the button that mends everything.
pub(crate) const CLEAN_ALL_HINT: Word =
    Word::new("Switches every mend on, also of faults that are less certain.");
/// The titles of panes without and with mends.
pub(crate) const AS_RECORDED: Word = Word::new("with its faults");
/// The title of a cleaned pane.
pub(crate) const CLEANED: Word = Word::new("cleaned");
/// The title of a pane in which nothing had to be mended, or may be.
pub(crate) const NOTHING_MENDED: Word = Word::new("nothing mended");
/// The name of a mark of a fault on the timeline.
pub(crate) const FAULT: Word = Word::new("fault");

/// Returns the name of a kind of fault on screen.
pub(crate) const fn fault_kind(kind: FaultKind) -> Word {
    Word::new(match kind {
        FaultKind::Swap => "Swapped sides",
        FaultKind::Gap => "Gaps",
        FaultKind::Spike => "Spikes",
        FaultKind::Jitter => "Jitter",
        FaultKind::Drift => "Drift",
        FaultKind::Ground => "Ground height",
        FaultKind::Ends => "Ends",
        FaultKind::Skating => "Sliding feet",
        FaultKind::Rate => "Frame rate",
    })
}

/// Returns how many faults of a kind were found, and how many of them are mended.
pub(crate) fn faults_of_kind(kind: FaultKind, count: usize, mended: usize) -> Message {
    msg!("{kind}: {count} found, {mended} mended", kind = fault_kind(kind), count, mended)
}

/// Returns when a fault begins, how large it is, and its joints.
pub(crate) fn fault_line(fault: &Fault, secs: f64, joint: Option<Message>) -> Message {
    let size = size_of(fault);
    if let Some(joint) = joint {
        msg!("{secs:.2} s · {size} · {joint}", secs, size, joint)
    } else {
        msg!("{secs:.2} s · {size}", secs, size)
    }
}

/// Returns how sure a fault is.
pub(crate) fn confidence(fault: &Fault) -> Message {
    let percent = 100.0 * f64::from(fault.confidence);
    msg!("{percent:.0} % confidence: show it", percent)
}

fn size_of(fault: &Fault) -> Message {
    let size = f64::from(fault.size);
    match fault.unit {
        SizeUnit::Degrees => msg!("{size:.1}°", size),
        SizeUnit::Centimetres => msg!("{size:.1} cm", size),
        SizeUnit::Frames => msg!("{size:.0} frames", size),
        SizeUnit::DegreesPerSecond => msg!("{size:.1} °/s", size),
        SizeUnit::CentimetresPerSecond => msg!("{size:.1} cm/s", size),
        SizeUnit::FramesPerSecond => msg!("looks right at {size:.0} fps", size),
    }
}

/// Returns the joints of a fault: the first, and how many more.
pub(crate) fn joints(first: Message, more: usize) -> Message {
    if more == 0 { first } else { msg!("{first} and {more} more", first, more) }
}

/// Returns how many faults are not listed.
pub(crate) fn more_faults(count: usize) -> Message {
    msg!("and {count} more", count)
}

/// Returns the name of the button that mends a fault, for screen readers.
pub(crate) fn mend_this(fault: Message) -> Message {
    msg!("Mend this fault: {fault}", fault)
}

/// Returns how many faults were injected.
pub(crate) fn injected(count: usize) -> Message {
    msg!("{count, plural, one {# fault} other {# faults}} injected", count)
}

/// Returns what was cleaned, in a title.
pub(crate) fn mended(count: usize) -> Message {
    msg!("{count} faults mended", count)
}
