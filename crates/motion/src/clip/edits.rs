//! Edits of whole motions: parts of them, backwards, mirrored, at other rates and sizes.

use super::{Clip, ClipError, Interpolation, MirrorError, Motion, mirror, resample};
use crate::math::{Planar, curve, unwrap_near, wrap_angle};
use glam::{DVec2, Vec3};
use std::ops::Range;

impl Motion {
    /// Returns the frames of `range` as a motion. Contacts are those of the whole clip: a stance
    /// that the cut divides stays a stance. A part of a cycle is no cycle.
    ///
    /// # Errors
    /// [`ClipError::OutOfRange`] when the range is not inside the clip.
    pub fn cropped(&self, range: Range<usize>) -> Result<Self, ClipError> {
        let clip = self.clip().crop(range.clone())?;
        let (frames, seams) = (clip.frames(), self.seams().iter());
        let seams = seams.filter(|seam| seam.start < range.end && seam.end > range.start);
        let within = |frame: usize| frame.clamp(range.start, range.end) - range.start;
        let seams = seams.map(|seam| within(seam.start)..within(seam.end)).collect();
        let order: Vec<usize> = range.collect();
        let is_cycle = self.is_cycle() && frames == self.clip().frames();
        Ok(self.in_order(clip, &order).with_seams(seams).declared_cycle(is_cycle))
    }

    /// Returns the motion backwards: its last frame plays first. The body faces where it faced, so
    /// that it walks backward.
    #[must_use]
    pub fn reversed(&self) -> Self {
        let frames = self.clip().frames();
        let order: Vec<usize> = (0..frames).rev().collect();
        let at = |frame: usize| frames.saturating_sub(frame + 1);
        let seams = self.seams().iter().rev().map(|seam| at(seam.end)..at(seam.start)).collect();
        self.in_order(self.clip().reversed(), &order)
            .with_seams(seams)
            .declared_cycle(self.is_cycle())
    }

    /// Returns the mirror image in the plane x = 0 of the world ([`mirror`]). The contacts of the
    /// feet change sides.
    ///
    /// # Errors
    /// [`MirrorError`] as of [`mirror`].
    pub fn mirrored(&self) -> Result<Self, MirrorError> {
        let clip = mirror(self.clip(), self.roles())?;
        let frames = self.ground_frames().iter().map(Planar::mirrored).collect();
        Ok(self.edited(clip, frames).with_contacts(self.contacts().mirrored()))
    }

    /// Returns the motion at another frame rate ([`resample`]). The contacts of a frame are those
    /// of the nearest frame before; at its own rate the motion stays the same.
    ///
    /// # Errors
    /// [`ClipError::FrameRate`] as of [`resample`].
    pub fn resampled(&self, fps: f64, interpolation: Interpolation) -> Result<Self, ClipError> {
        if fps == self.clip().fps() {
            return Ok(self.clone());
        }
        let clip = resample(self.clip(), fps, interpolation)?;
        let (old, new) = (self.clip().frames().saturating_sub(1), clip.frames().saturating_sub(1));
        // Both ends are the same frames.
        let at = |frame: usize| (frame * old) as f64 / new.max(1) as f64;
        let places: Vec<f64> = (0..clip.frames()).map(at).collect();
        let nearest: Vec<usize> = places.iter().map(|place| place.round() as usize).collect();
        let frames = places.iter().map(|&place| self.frame_between(place, interpolation)).collect();
        let there = |frame: usize| {
            ((frame * new) as f64 / old.max(1) as f64).round().min(new as f64) as usize
        };
        let seams = self.seams_at(there);
        let contacts = self.contacts().of_frames(&nearest);
        Ok(self.edited(clip, frames).with_contacts(contacts).with_seams(seams))
    }

    /// Returns the motion with all lengths multiplied by `factor`, which is above 0
    /// ([`Clip::scaled`]). Contacts stay.
    #[must_use]
    pub fn scaled(&self, factor: f32) -> Self {
        let scaled = |frame: &Planar| Planar { shift: frame.shift * f64::from(factor), ..*frame };
        let frames = self.ground_frames().iter().map(scaled).collect();
        self.edited(self.clip().scaled(factor), frames)
            .with_contacts(self.contacts().clone())
            .with_ground_m(self.ground_m() * factor)
    }

    /// Returns the motion of an edited clip whose frames are these of this motion.
    fn in_order(&self, clip: Clip, order: &[usize]) -> Self {
        let frames = self.ground_frames();
        let frames = order.iter().filter_map(|&frame| frames.get(frame).copied()).collect();
        self.edited(clip, frames).with_contacts(self.contacts().of_frames(order))
    }

    /// Returns the motion of an edited clip, on ground of the same height and with the same seams.
    fn edited(&self, clip: Clip, ground_frames: Vec<Planar>) -> Self {
        self.same_body(clip, ground_frames)
            .with_ground_m(self.ground_m())
            .with_seams(self.seams().to_vec())
            .declared_cycle(self.is_cycle())
    }

    /// Returns the ground frame at a place between two frames, interpolated as poses are.
    fn frame_between(&self, place: f64, interpolation: Interpolation) -> Planar {
        let frames = self.ground_frames();
        let last = frames.len().saturating_sub(1);
        let (frame, part) = ((place.floor() as usize).min(last), place.fract());
        let Some(here) = frames.get(frame) else {
            return Planar::IDENTITY;
        };
        if part == 0.0 || interpolation == Interpolation::Nearest {
            let nearest = frames.get((place.round() as usize).min(last));
            return nearest.copied().unwrap_or(*here);
        }
        // Relative to this frame, so that single precision is enough.
        let relative = |frame: usize| {
            let there = frames.get(frame.min(last)).unwrap_or(here);
            let shift = there.shift - here.shift;
            let yaw = unwrap_near(there.yaw, here.yaw) - here.yaw;
            Vec3::new(shift.x as f32, yaw as f32, shift.y as f32)
        };
        let [before, next, after] = [frame.saturating_sub(1), frame + 1, frame + 2].map(relative);
        let part = part as f32;
        let moved = match interpolation {
            Interpolation::Cubic => curve::catmull_rom(before, Vec3::ZERO, next, after, part),
            _ => next * part,
        };
        Planar {
            yaw: wrap_angle(here.yaw + f64::from(moved.y)),
            shift: here.shift + DVec2::new(f64::from(moved.x), f64::from(moved.z)),
        }
    }
}

#[cfg(test)]
mod tests;
