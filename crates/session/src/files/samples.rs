//! Bundled takes: requested, and added to their entries of the library.

use super::intake::{AwaitedSamples, FileIntake, Purpose};
use crate::command::Request;
use crate::document::Document;
use crate::library::Origin;
use crate::notice::{Level, Notices};
use crate::reading::{Content, ReadReport, ReadSetup};
use crate::samples::{Sample, SampleSet};
use segue_formats::{ImportError, ImportOptions};
use segue_text::{Message, ToMessage, msg};
use std::sync::Arc;

/// The greatest size of an unpacked take, bytes: a damaged file must not fill the memory.
const MAX_SAMPLE_BYTES: usize = 64 << 20;

impl FileIntake {
    /// Returns the bundled takes that were requested and have not arrived.
    pub(crate) fn awaited_samples(&self) -> &[&'static Sample] {
        &self.samples.samples
    }

    /// Returns how many of the takes that were requested together have arrived, and their number;
    /// `None` while none is awaited.
    pub(crate) fn samples_progress(&self) -> Option<(usize, usize)> {
        let AwaitedSamples { samples, asked, .. } = &self.samples;
        (!samples.is_empty()).then(|| (asked - samples.len(), *asked))
    }

    /// Requests a take, unless it is awaited, or has failed since the last command.
    pub(crate) fn request_sample(&mut self, document: &mut Document, sample: &'static Sample) {
        let AwaitedSamples { samples, asked, failed } = &mut self.samples;
        if samples.contains(&sample) || failed.contains(&sample) {
            return;
        }
        *asked = if samples.is_empty() { 1 } else { *asked + 1 };
        samples.push(sample);
        self.requests.push(Request::Sample(sample));
        document.library.change(sample.id, |entry| entry.unread = None);
    }

    /// Adds all takes of a set to the library. Requests their motions; the first ones take the
    /// slots of built-in clips in A and B.
    pub(crate) fn load_samples(
        &mut self,
        document: &mut Document,
        notices: &mut Notices,
        set: &'static SampleSet,
    ) {
        let new: Vec<_> =
            set.samples.iter().filter(|sample| document.library.get(sample.id).is_none()).collect();
        if new.is_empty() {
            notices.say(Level::Info, msg!("{name} is in the library already.", name = set.label));
        } else {
            document.remember(None);
        }
        for sample in &new {
            document.ensure_sample(sample.id);
        }
        document.offer_together(new.into_iter().map(|sample| sample.id));
        self.request_missing_samples(document);
    }

    /// Requests the motions of all takes in the library that have none.
    pub(crate) fn request_missing_samples(&mut self, document: &mut Document) {
        let missing: Vec<_> =
            (document.library.entries().iter())
                .filter(|entry| entry.motion.is_none())
                .filter_map(|entry| {
                    if let Origin::Sample(sample) = entry.origin { Some(sample) } else { None }
                })
                .collect();
        for sample in missing {
            self.request_sample(document, sample);
        }
    }

    /// Loads a bundled take that was requested with [`Request::Sample`]; `packed` is its gzip file.
    /// If files are read elsewhere, this only begins to read it.
    ///
    /// # Errors
    /// [`ImportError`] if it is damaged. If it is read elsewhere, that is reported after reading.
    pub(crate) fn load_sample(
        &mut self,
        document: &mut Document,
        notices: &mut Notices,
        sample: &'static Sample,
        packed: &[u8],
    ) -> Result<(), ImportError> {
        let setup = ReadSetup {
            options: ImportOptions { max_bytes: MAX_SAMPLE_BYTES, ..ImportOptions::default() },
            bone_maps: Arc::clone(document.library.bone_maps()),
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
        self.take_sample(document, notices, sample, report)
    }

    /// Reports why a requested take has not arrived. The next command that needs it requests it
    /// again.
    pub(crate) fn fail_sample(
        &mut self,
        document: &mut Document,
        notices: &mut Notices,
        sample: &'static Sample,
        reason: impl Into<Message>,
    ) {
        let text = msg!(
            "{name} could not be loaded: {reason}.",
            name = sample.label,
            reason = reason.into()
        );
        document.library.change(sample.id, |entry| entry.unread = Some(text.clone()));
        self.samples.samples.retain(|awaited| *awaited != sample);
        self.samples.failed.push(sample);
        notices.say(Level::Error, text);
    }

    /// Allows takes that failed to be requested again.
    pub(crate) fn forget_failed_samples(&mut self) {
        self.samples.failed.clear();
    }

    /// Gives a bundled take its motion.
    pub(crate) fn take_sample(
        &mut self,
        document: &mut Document,
        notices: &mut Notices,
        sample: &'static Sample,
        report: ReadReport,
    ) -> Result<(), ImportError> {
        let read = report.files.into_iter().next().map(|file| file.result).transpose();
        let mut clips = match read {
            Ok(clips) => clips.unwrap_or_default(),
            Err(error) => {
                self.fail_sample(document, notices, sample, error.to_message());
                return Err(error);
            }
        };
        self.samples.samples.retain(|awaited| *awaited != sample);
        if !clips.clips.is_empty() {
            let clip = clips.clips.swap_remove(0);
            let maps = Arc::clone(document.library.bone_maps());
            document.library.change(sample.id, |entry| {
                let motion = match &entry.roles_by_hand {
                    Some(roles) => clip.motion.with_corrected_roles(roles),
                    None => clip.motion,
                };
                entry.set_motion(Arc::new(motion));
                entry.unread = None;
                entry.about = Some(clip.about);
                entry.warnings = clips.warnings;
                entry.take_mapped_roles(&maps);
            });
        }
        Ok(())
    }
}
