//! Parsing of the frames of a motion file: one pass over the bytes, one row in memory.

use super::convert::Converter;
use super::lexer::{
    Number, is_blank, is_digits, line_end, number, skip_blank, skip_blank_in_line, token_end,
};
use super::skeleton::AcclaimSkeleton;
use crate::error::Fault;
use crate::text::{name, quoted};
use crate::warning::{Tally, WarningKind};
use segue_text::msg;
use std::collections::HashSet;

/// Bytes between two reports of progress.
const PROGRESS_STEP: usize = 1 << 18;

/// Larger magnitudes come from overflow, not from measurement.
const MAX_MAGNITUDE: f64 = 1e30;

/// The reason why reading stopped before the end.
#[derive(Debug)]
pub(super) enum Stop {
    /// The file cannot be read.
    Fault(Fault),
    /// The caller asked to stop.
    Cancelled,
}

impl From<Fault> for Stop {
    fn from(fault: Fault) -> Self {
        Self::Fault(fault)
    }
}

/// The use of a joint's values in the file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum JointUse {
    /// The file has not named the joint so far.
    Unnamed,
    /// The values are read.
    Values,
    /// The values are skipped, because their number was wrong when the joint was first named.
    Nothing,
}

/// The numbers after a bone's name.
struct Run {
    count: usize,
    /// The offset of the last number.
    last_at: usize,
    /// Whether the file ends inside a number.
    cut: bool,
}

struct Frames<'r, 'a> {
    text: &'a [u8],
    at: usize,
    skeleton: &'r AcclaimSkeleton,
    tally: &'r mut Tally,
    /// The values of all joints. Values of the frame before are kept, so that a missing one is
    /// held.
    row: Vec<f64>,
    uses: Vec<JointUse>,
    /// The name of each joint as last spelled in the file, which saves a lookup.
    spelled: Vec<&'a [u8]>,
    /// The joint that followed each joint in the frame before.
    next: Vec<usize>,
    /// The last frame that named each joint; frames are counted from 1.
    named_in: Vec<usize>,
    unknown: HashSet<&'a [u8]>,
    /// The number of joints with values, in all and in this frame.
    used: usize,
    used_in_frame: usize,
    /// The number of values in this frame and in the one before.
    numbers: usize,
    numbers_before: usize,
    /// The frame being read, counted from 1; 0 before the first one.
    frame: usize,
    frame_at: usize,
    /// The number of the frame in the file.
    number: f64,
    values: u64,
    not_finite: u64,
    first_not_finite: usize,
}

/// Reads all frames into `converter` and returns the offset of the first one.
pub(super) fn frames(
    text: &[u8],
    skeleton: &AcclaimSkeleton,
    converter: &mut Converter<'_>,
    tally: &mut Tally,
    progress: &mut dyn FnMut(usize) -> bool,
) -> Result<usize, Stop> {
    let joints = skeleton.joints.len();
    let mut reader = Frames {
        text,
        at: 0,
        skeleton,
        tally,
        row: vec![0.0; skeleton.width],
        uses: vec![JointUse::Unnamed; joints],
        spelled: vec![b"".as_slice(); joints],
        next: vec![0; joints],
        named_in: vec![0; joints],
        unknown: HashSet::new(),
        used: 0,
        used_in_frame: 0,
        numbers: 0,
        numbers_before: 0,
        frame: 0,
        frame_at: 0,
        number: 0.0,
        values: 0,
        not_finite: 0,
        first_not_finite: 0,
    };
    let first_at = reader.read(converter, progress)?;
    reader.check()?;
    Ok(first_at)
}

impl Frames<'_, '_> {
    fn read(
        &mut self,
        converter: &mut Converter<'_>,
        progress: &mut dyn FnMut(usize) -> bool,
    ) -> Result<usize, Stop> {
        let (mut reported, mut first_at, mut joint) = (0, None, 0);
        loop {
            self.at = skip_blank(self.text, self.at);
            let at = self.at;
            if at - reported >= PROGRESS_STEP {
                reported = at;
                if !progress(at) {
                    return Err(Stop::Cancelled);
                }
            }
            let Some(&first) = self.text.get(at) else {
                break;
            };
            if first == b':' {
                self.header(converter);
                continue;
            }
            // Nearly always the bone that came next in the frame before.
            let guess = self.next.get(joint).copied().unwrap_or_default();
            if self.spells(guess) {
                let before = std::mem::replace(&mut joint, guess);
                self.at += self.spelled.get(guess).map_or(0, |name| name.len());
                if !self.bone(joint, at)? {
                    return self.truncated(first_at, at);
                }
                self.follows(before, joint);
                continue;
            }
            let token = self.text.get(at..token_end(self.text, at)).unwrap_or_default();
            if let Some(number) = frame_number(token) {
                self.end_frame(converter)?;
                first_at = first_at.or(Some(at));
                self.begin_frame(number, at, token.len());
                if self.at == self.text.len() && self.numbers_before > 0 {
                    return self.truncated(first_at, at);
                }
                continue;
            }
            if self.frame == 0 {
                return Err(Fault::new(at, quoted(token), "the number of a frame").into());
            }
            self.at += token.len();
            let Some(found) = self.skeleton.find(&name(token).0) else {
                let run = self.numbers(None);
                self.give_back_frame_number(&run);
                if run.count == 0 && self.at == self.text.len() {
                    return self.truncated(first_at, at);
                }
                if self.unknown.insert(token) {
                    let name = name(token).0;
                    self.tally.add(WarningKind::UnknownBones { name }, Some(at));
                }
                continue;
            };
            let before = std::mem::replace(&mut joint, found);
            if let Some(spelled) = self.spelled.get_mut(found) {
                *spelled = token;
            }
            if !self.bone(joint, at)? {
                return self.truncated(first_at, at);
            }
            self.follows(before, joint);
        }
        self.end_frame(converter)?;
        first_at.ok_or_else(|| {
            Fault::new(self.at, "the end of the file", "the number of a frame").into()
        })
    }

    /// Returns whether the name of a joint stands here, spelled as before.
    #[inline]
    fn spells(&self, joint: usize) -> bool {
        let rest = self.text.get(self.at..).unwrap_or_default();
        self.spelled.get(joint).is_some_and(|name| {
            !name.is_empty()
                && rest.starts_with(name)
                && rest.get(name.len()).is_none_or(|&b| is_blank(b))
        })
    }

    fn follows(&mut self, before: usize, joint: usize) {
        if let Some(next) = self.next.get_mut(before) {
            *next = joint;
        }
    }

    /// Reads a line that begins with a colon. `:DEGREES` and `:RADIANS` have an effect before the
    /// first frame.
    fn header(&mut self, converter: &mut Converter<'_>) {
        let word = self.text.get(self.at + 1..token_end(self.text, self.at)).unwrap_or_default();
        if self.frame == 0 && word.eq_ignore_ascii_case(b"radians") {
            converter.radians = true;
        } else if self.frame == 0 && word.eq_ignore_ascii_case(b"degrees") {
            converter.radians = false;
        }
        self.at = line_end(self.text, self.at);
    }

    fn begin_frame(&mut self, number: f64, at: usize, length: usize) {
        self.frame += 1;
        self.frame_at = at;
        self.at = at + length;
        if self.frame > 1 && number != self.number + 1.0 {
            self.tally.add(WarningKind::FrameNumbers, Some(at));
        }
        self.number = number;
    }

    fn end_frame(&mut self, converter: &mut Converter<'_>) -> Result<(), Fault> {
        if self.frame == 0 {
            return Ok(());
        }
        if self.used_in_frame < self.used {
            self.tally.add(WarningKind::MissingBones, Some(self.frame_at));
        }
        self.used_in_frame = 0;
        self.numbers_before = std::mem::take(&mut self.numbers);
        converter.row(&self.row).map_err(|fault| Fault { at: self.frame_at, ..fault })
    }

    /// Drops the frame in which the file ends.
    fn truncated(&mut self, first_at: Option<usize>, at: usize) -> Result<usize, Stop> {
        if self.frame <= 1 {
            return Err(Fault::new(at, "the end of the file", "a whole frame").into());
        }
        let (found, expected) = (self.numbers, self.numbers_before);
        self.tally.add(WarningKind::TruncatedRow { found, expected }, Some(self.frame_at));
        first_at.ok_or(Stop::Cancelled)
    }

    /// Reads the values of a bone whose name has been read. Returns `false` if the file ends first.
    #[inline]
    fn bone(&mut self, joint: usize, at: usize) -> Result<bool, Fault> {
        let usage = self.uses.get(joint).copied().unwrap_or(JointUse::Nothing);
        let expected = self.skeleton.values(joint);
        let first = self.skeleton.motors.get(joint).map_or(0, |motor| motor.first_value);
        let slots = (usage != JointUse::Nothing).then_some(first..first + expected);
        let mut run = self.numbers(slots.clone());
        if run.count != expected || run.cut {
            self.give_back_frame_number(&run);
            run.count -= usize::from(self.at == run.last_at && run.count > 0);
        }
        while run.count < expected && !run.cut && self.goes_on_below() {
            let more = self.numbers(slots.clone().map(|slots| slots.start + run.count..slots.end));
            run.count += more.count;
            run.cut = more.cut;
        }
        self.numbers += run.count;
        if run.count != expected || run.cut || usage != JointUse::Values {
            return self.odd_bone(joint, at, &run);
        }
        self.name_in_frame(joint);
        Ok(true)
    }

    #[inline]
    fn name_in_frame(&mut self, joint: usize) {
        if let Some(named) = self.named_in.get_mut(joint)
            && *named != self.frame
        {
            *named = self.frame;
            self.used_in_frame += 1;
        }
    }

    /// Handles a bone that is named for the first time, or has an unexpected number of values.
    #[cold]
    fn odd_bone(&mut self, joint: usize, at: usize, run: &Run) -> Result<bool, Fault> {
        let usage = self.uses.get(joint).copied().unwrap_or(JointUse::Nothing);
        let expected = self.skeleton.values(joint);
        let joint_name =
            || self.skeleton.joints.get(joint).map(|joint| joint.name.clone()).unwrap_or_default();
        let after = skip_blank(self.text, self.at);
        if run.cut
            || (run.count < expected && usage != JointUse::Nothing && after >= self.text.len())
        {
            return Ok(false);
        }
        match usage {
            JointUse::Nothing => return Ok(true),
            JointUse::Unnamed if run.count == expected => {
                if let Some(usage) = self.uses.get_mut(joint) {
                    *usage = JointUse::Values;
                }
                self.used += 1;
                self.name_in_frame(joint);
                return Ok(true);
            }
            _ => {}
        }
        let in_line = skip_blank_in_line(self.text, self.at);
        let junk = self.text.get(in_line..token_end(self.text, in_line)).unwrap_or_default();
        if run.count < expected && !junk.is_empty() && self.skeleton.find(&name(junk).0).is_none() {
            return Err(Fault::new(
                in_line,
                quoted(junk),
                msg!("a number for {name}", name = quoted(joint_name().as_bytes())),
            ));
        }
        if usage == JointUse::Unnamed {
            let name = joint_name();
            self.tally.add(WarningKind::ValueCount { name, found: run.count, expected }, Some(at));
            if let Some(usage) = self.uses.get_mut(joint) {
                *usage = JointUse::Nothing;
            }
            let first = self.skeleton.motors.get(joint).map_or(0, |motor| motor.first_value);
            self.row.iter_mut().skip(first).take(expected).for_each(|value| *value = 0.0);
            return Ok(true);
        }
        let motor = self.skeleton.motors.get(joint);
        let dofs: Vec<&str> = motor
            .map(|motor| motor.dofs.iter().map(|dof| dof.name()).collect())
            .unwrap_or_default();
        let found = msg!(
            "{count} values for {name}",
            count = run.count,
            name = quoted(joint_name().as_bytes())
        );
        Err(Fault::new(at, found, msg!("{expected}: {dofs}", dofs = dofs.join(" ")))
            .with_hint("complete the line or delete it, then drop the file again"))
    }

    /// Reads the numbers on the rest of the line into the row; a value that is not a number keeps
    /// the value that is there.
    #[inline]
    fn numbers(&mut self, slots: Option<std::ops::Range<usize>>) -> Run {
        let text = self.text;
        let mut run = Run { count: 0, last_at: self.at, cut: false };
        let (mut slot, end) = slots.map_or((0, 0), |slots| (slots.start, slots.end));
        loop {
            let at = skip_blank_in_line(text, self.at);
            self.at = at;
            let rest = text.get(at..).unwrap_or_default();
            if rest.first().is_none_or(|b| matches!(b, b'\n' | b'\r')) {
                return run;
            }
            // The common case: a plain number with white space after it.
            let value = match fast_float2::parse_partial::<f64, _>(rest) {
                Ok((value, length))
                    if value.abs() <= MAX_MAGNITUDE
                        && rest.get(length).is_none_or(|&next| is_blank(next)) =>
                {
                    self.at = at + length;
                    Some(value)
                }
                _ => match self.odd_number() {
                    OddNumber::Value(value) => value,
                    OddNumber::Cut => {
                        self.at = text.len();
                        run.cut = true;
                        return run;
                    }
                    OddNumber::None => return run,
                },
            };
            self.values += 1;
            run.count += 1;
            run.last_at = at;
            if slot < end {
                if let (Some(place), Some(value)) = (self.row.get_mut(slot), value) {
                    *place = value;
                }
                slot += 1;
            }
        }
    }

    /// Reads anything but a plain number.
    #[cold]
    fn odd_number(&mut self) -> OddNumber {
        let start = self.at;
        let (value, end, glued) = match number(self.text, start) {
            Number::Value { value, end, glued } => (Some(value), end, glued),
            Number::NotFinite { end, glued } => {
                if self.not_finite == 0 {
                    self.first_not_finite = start;
                }
                self.not_finite += 1;
                self.tally.add(WarningKind::NotFinite, Some(start));
                (None, end, glued)
            }
            Number::Cut => return OddNumber::Cut,
            Number::None => return OddNumber::None,
        };
        if glued {
            self.tally.add(WarningKind::MissingSpaces, Some(end));
        }
        self.at = end;
        OddNumber::Value(value)
    }

    /// Returns the last number before a name to the input: where frames do not end with lines, it
    /// is the number of the next frame.
    fn give_back_frame_number(&mut self, run: &Run) {
        let token =
            self.text.get(run.last_at..token_end(self.text, run.last_at)).unwrap_or_default();
        let line_goes_on = self.text.get(self.at).is_some_and(|b| !matches!(b, b'\n' | b'\r'));
        if run.count > 0 && line_goes_on && is_digits(token) {
            self.at = run.last_at;
        }
    }

    /// Returns whether the next line continues with numbers that are not a frame number.
    fn goes_on_below(&mut self) -> bool {
        if self.text.get(self.at).is_some_and(|b| !matches!(b, b'\n' | b'\r')) {
            return false;
        }
        let at = skip_blank(self.text, self.at);
        let token = self.text.get(at..token_end(self.text, at)).unwrap_or_default();
        let goes_on = !is_digits(token)
            && matches!(number(self.text, at), Number::Value { .. } | Number::NotFinite { .. });
        if goes_on {
            self.at = at;
        }
        goes_on
    }

    /// Checks the whole motion after its last frame: refuses it where it names no bone of the
    /// skeleton, or where more than 1 % of its values are not finite; warns of bones that it never
    /// moves.
    fn check(&mut self) -> Result<(), Fault> {
        if self.used == 0 {
            let expected = msg!(
                "a motion of the skeleton {name}",
                name = quoted(self.skeleton.name().as_bytes())
            );
            let fault = Fault::new(
                0,
                "no bone with the names and degrees of freedom of the skeleton",
                expected,
            );
            return Err(fault.with_hint("drop the ASF file that belongs to it"));
        }
        if self.not_finite * 100 > self.values {
            let found = msg!(
                "no number in {count} of {values} values",
                count = self.not_finite,
                values = self.values
            );
            let fault = Fault::new(self.first_not_finite, found, "at most 1 % of them");
            return Err(
                fault.with_hint("export the motion again: too much of it is lost to be filled in")
            );
        }
        for (index, (joint, usage)) in self.skeleton.joints.iter().zip(&self.uses).enumerate() {
            if *usage == JointUse::Unnamed && self.skeleton.values(index) > 0 {
                let name = joint.name.clone();
                self.tally.add(WarningKind::RestingBones { name }, None);
            }
        }
        Ok(())
    }
}

/// A value that is not a plain number.
enum OddNumber {
    /// A number; `None` where the last good one is held.
    Value(Option<f64>),
    /// The file ends inside a number.
    Cut,
    /// Anything else.
    None,
}

/// Returns the number of a frame, if the token is one.
fn frame_number(token: &[u8]) -> Option<f64> {
    let starts = matches!(token.first(), Some(b'0'..=b'9' | b'+' | b'-' | b'.'));
    let number = fast_float2::parse(token).ok().filter(|_| starts)?;
    (is_digits(token) || f64::is_finite(number)).then_some(number)
}

/// Returns the reason why the beginning of a file is not a motion: it has no first frame, or no
/// value in it.
pub(super) fn first_fault(text: &[u8]) -> Option<Fault> {
    if first_frame(text).iter().any(|(_, values)| *values > 0) {
        return None;
    }
    let mut at = skip_blank(text, 0);
    while text.get(at) == Some(&b':') {
        at = skip_blank(text, line_end(text, at));
    }
    let token_at = |at: usize| text.get(at..token_end(text, at)).unwrap_or_default();
    let first = token_at(at);
    if !is_digits(first) {
        return Some(Fault::at_token(at, first, "the number of a frame"));
    }
    at = skip_blank(text, at + first.len());
    Some(Fault::at_token(at, token_at(at), "a bone and its values"))
}

/// Returns the bones of the first frame and their numbers of values, as far as the beginning of a
/// file contains them.
pub(super) fn first_frame(text: &[u8]) -> Vec<(String, usize)> {
    let mut bones: Vec<(String, usize)> = Vec::new();
    let (mut at, mut frames) = (0, 0);
    loop {
        at = skip_blank(text, at);
        if text.get(at) == Some(&b':') {
            at = line_end(text, at);
            continue;
        }
        let token = text.get(at..token_end(text, at)).unwrap_or_default();
        at += token.len();
        if token.is_empty() {
            return bones;
        }
        if is_digits(token) {
            frames += 1;
            if frames == 2 {
                return bones;
            }
            continue;
        }
        if frames == 0 {
            return bones;
        }
        let mut values = 0;
        loop {
            at = skip_blank_in_line(text, at);
            match number(text, at) {
                Number::Value { end, .. } | Number::NotFinite { end, .. } => {
                    values += 1;
                    at = end;
                }
                Number::Cut | Number::None => break,
            }
        }
        bones.push((name(token).0, values));
    }
}
