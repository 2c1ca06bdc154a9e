//! Bundled takes: asked for, waited for, and given to their entries of the library.

use super::Session;
use super::loading::Purpose;
use crate::command::Request;
use crate::library::Origin;
use crate::notice::Level;
use crate::reading::{Content, ReadReport, ReadSetup};
use crate::samples::{SETS, SINGLES, Sample, SampleSet};
use segue_formats::{ImportError, ImportOptions};
use segue_text::{Message, ToMessage, msg};
use std::sync::Arc;

/// No bundled take unpacks to more. A damaged file must not fill the memory.
const LARGEST_SAMPLE: usize = 64 << 20;

/// The takes that were asked for and have not come.
#[derive(Debug, Default)]
pub(super) struct AwaitedSamples {
    samples: Vec<&'static Sample>,
    /// How many were asked for since nothing was waited for.
    asked: usize,
    /// Those that did not come, and are not asked for until something else is done.
    failed: Vec<&'static Sample>,
}

impl Session {
    /// The bundled takes that belong to no set.
    #[must_use]
    pub fn samples() -> &'static [Sample] {
        &SINGLES
    }

    /// The sets of bundled takes.
    #[must_use]
    pub fn sample_sets() -> &'static [SampleSet] {
        &SETS
    }

    /// The bundled takes that were asked for and have not come.
    #[must_use]
    pub fn awaited_samples(&self) -> &[&'static Sample] {
        &self.awaited.samples
    }

    /// How many of the takes that were asked for together have come, and how many these are; `None`
    /// while none is waited for.
    #[must_use]
    pub fn samples_progress(&self) -> Option<(usize, usize)> {
        let AwaitedSamples { samples, asked, .. } = &self.awaited;
        (!samples.is_empty()).then(|| (asked - samples.len(), *asked))
    }

    /// Asks for a take, unless that is under way or was in vain a moment ago.
    pub(super) fn ask_for_sample(&mut self, sample: &'static Sample) {
        let AwaitedSamples { samples, asked, failed } = &mut self.awaited;
        if samples.contains(&sample) || failed.contains(&sample) {
            return;
        }
        *asked = if samples.is_empty() { 1 } else { *asked + 1 };
        samples.push(sample);
        self.requests.push(Request::Sample(sample));
        self.document.library.change(sample.id, |entry| entry.unread = None);
    }

    /// Puts all takes of a set into the library. Their motions are asked for; the first ones take
    /// the places of built-in clips in A and B.
    pub(super) fn load_samples(&mut self, set: &'static SampleSet) {
        let new: Vec<_> = set
            .samples
            .iter()
            .filter(|sample| self.document.library.get(sample.id).is_none())
            .collect();
        if new.is_empty() {
            self.say(Level::Info, msg!("{name} is in the library already.", name = set.label));
        } else {
            self.document.remember(None);
        }
        for sample in &new {
            self.document.bring_sample(sample.id);
        }
        self.document.offer_together(new.into_iter().map(|sample| sample.id));
        self.ask_for_missing_samples();
    }

    /// The id of a clip that a parameter may name: one of the library, or a bundled take, which
    /// joins the library when it is named.
    #[must_use]
    pub fn nameable(&self, reference: &str) -> Option<String> {
        self.document.nameable(reference)
    }

    /// Asks for the motions of all takes in the library that have none.
    pub(super) fn ask_for_missing_samples(&mut self) {
        let missing: Vec<_> =
            (self.document.library.entries().iter())
                .filter(|entry| entry.motion.is_none())
                .filter_map(|entry| {
                    if let Origin::Sample(sample) = entry.origin { Some(sample) } else { None }
                })
                .collect();
        for sample in missing {
            self.ask_for_sample(sample);
        }
    }

    /// Takes a bundled take that was asked for with [`Request::Sample`]; `packed` is its gzip file.
    /// Where files are read elsewhere, so is it, and is not there yet.
    ///
    /// # Errors
    /// [`ImportError`] when it is damaged; of one that is read elsewhere, that is told when it was
    /// read.
    pub fn load_sample(
        &mut self,
        sample: &'static Sample,
        packed: &[u8],
    ) -> Result<(), ImportError> {
        let setup = ReadSetup {
            options: ImportOptions { max_bytes: LARGEST_SAMPLE, ..ImportOptions::default() },
            ..ReadSetup::default()
        };
        let Some(read) = self.reads else {
            let size = packed.len() as u64;
            self.begin(
                sample.file,
                Content::Here(Arc::from(packed)),
                size,
                setup,
                Purpose::Sample(sample),
            );
            return Ok(());
        };
        let report = read(sample.file, packed, &setup, &mut |_| true).unwrap_or_default();
        self.take_sample(sample, report)
    }

    /// Says why a bundled take that was asked for has not come. It is asked for again when
    /// something else is done that needs it.
    pub fn fail_sample(&mut self, sample: &'static Sample, reason: impl Into<Message>) {
        let text = msg!(
            "{name} could not be loaded: {reason}.",
            name = sample.label,
            reason = reason.into()
        );
        self.document.library.change(sample.id, |entry| entry.unread = Some(text.clone()));
        self.awaited.samples.retain(|awaited| *awaited != sample);
        self.awaited.failed.push(sample);
        self.say(Level::Error, text);
        self.refresh();
    }

    /// What did not come may come now.
    pub(super) fn forget_failed_samples(&mut self) {
        self.awaited.failed.clear();
    }

    /// Gives a bundled take its motion.
    pub(super) fn take_sample(
        &mut self,
        sample: &'static Sample,
        report: ReadReport,
    ) -> Result<(), ImportError> {
        let read = report.files.into_iter().next().map(|file| file.result).transpose();
        let mut clips = match read {
            Ok(clips) => clips.unwrap_or_default(),
            Err(error) => {
                self.fail_sample(sample, error.to_message());
                return Err(error);
            }
        };
        self.awaited.samples.retain(|awaited| *awaited != sample);
        if !clips.clips.is_empty() {
            let clip = clips.clips.swap_remove(0);
            self.document.library.change(sample.id, |entry| {
                let motion = match &entry.roles_by_hand {
                    Some(roles) => clip.motion.with_corrected_roles(roles),
                    None => clip.motion,
                };
                entry.motion = Some(Arc::new(motion));
                entry.unread = None;
                entry.about = Some(clip.about);
                entry.warnings = clips.warnings;
            });
        }
        self.refresh();
        Ok(())
    }
}
