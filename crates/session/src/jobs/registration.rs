//! The registration of two clips.

use super::error::JobError;
use super::parcel::{put, take};
use super::task::{JobClip, Task};
use super::worker_memory::WorkerMemory;
use super::{Parcel, ParcelError};
use crate::labs::{DistanceMap, RegistrationRequest, registered, terms_of};
use segue_motion::registration::{
    DistanceMatrix, PairTerms, Registration, RegistrationParts, RegistrationPath,
};
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// The registration of B, on the skeleton of A, with A. The clips are A and B.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct RegistrationTask {
    /// Whether the distances are asked for.
    pub(crate) wants_matrix: bool,
    /// The number of frames between two samples.
    pub(crate) stride: usize,
    pub(crate) request: RegistrationRequest,
}

/// A registration.
#[derive(Debug)]
pub(crate) struct RegistrationAnswer {
    pub(crate) matrix: Option<DistanceMatrix>,
    /// The registration and that at equal speed; `None` where there is no path.
    pub(crate) curves: Option<[Registration; 2]>,
}

#[derive(Serialize, Deserialize)]
struct Head {
    matrix: Option<MatrixHead>,
    curves: Option<[CurvesHead; 2]>,
}

#[derive(Serialize, Deserialize)]
struct MatrixHead {
    window: usize,
    stride: usize,
    first: (usize, usize),
    columns: usize,
}

/// The lengths of the arrays of a registration.
#[derive(Serialize, Deserialize)]
struct CurvesHead {
    cells: usize,
    pins: usize,
    warp: usize,
    mean: usize,
}

impl Task for RegistrationTask {
    type Answer = RegistrationAnswer;

    fn run(
        &self,
        clips: &[JobClip],
        memory: &mut WorkerMemory,
    ) -> Result<RegistrationAnswer, JobError> {
        let [a, b] = clips else {
            return Err(JobError::NoResult);
        };
        let numbers = [a.number, b.number];
        let terms = if let Some(terms) = take_terms(memory, numbers, self.stride) {
            terms
        } else {
            let mut terms = terms_of(&a.motion, &b.motion, self.stride)?;
            terms.finish();
            terms
        };
        let window = self.request.window;
        let kept = memory.matrix.take().filter(|(of, stride, matrix)| {
            (*of, *stride, matrix.window()) == (numbers, self.stride, window.max(1))
        });
        let matrix = match kept {
            Some((_, _, matrix)) => matrix,
            None => Arc::new(terms.distances(window, &(0..usize::MAX), &(0..usize::MAX))?),
        };
        let motions = [Arc::clone(&a.motion), Arc::clone(&b.motion)];
        let map = DistanceMap::of_motions(DistanceMatrix::clone(&matrix), motions);
        let curves = registered(&terms, &map, &self.request).ok();
        keep_terms(memory, numbers, self.stride, terms);
        let answer = self.wants_matrix.then(|| DistanceMatrix::clone(&matrix));
        memory.matrix = Some((numbers, self.stride, matrix));
        Ok(RegistrationAnswer { matrix: answer, curves })
    }

    fn pack(_clips: &[JobClip], answer: RegistrationAnswer) -> Result<Parcel, ParcelError> {
        let parts = answer.curves.map(|curves| curves.map(|curves| curves.parts()));
        let head = Head {
            matrix: answer.matrix.as_ref().map(|matrix| MatrixHead {
                window: matrix.window(),
                stride: matrix.stride(),
                first: matrix.frames(0, 0),
                columns: matrix.columns(),
            }),
            curves: parts.as_ref().map(|parts| parts.each_ref().map(CurvesHead::of)),
        };
        let mut parcel = Parcel { head: serde_json::to_string(&head)?, ..Parcel::default() };
        parcel.floats = answer.matrix.map(DistanceMatrix::into_rms_m).unwrap_or_default();
        for parts in parts.iter().flatten() {
            put_parts(&mut parcel.bytes, parts);
        }
        Ok(parcel)
    }

    fn unpack(
        &self,
        _clips: &[JobClip],
        parcel: Parcel,
    ) -> Result<RegistrationAnswer, ParcelError> {
        let head: Head = serde_json::from_str(&parcel.head)?;
        let matrix = match head.matrix {
            Some(MatrixHead { window, stride, first, columns }) => Some(
                DistanceMatrix::of_rows(window, stride, first, columns, parcel.floats)
                    .ok_or(ParcelError::Arrays)?,
            ),
            None => None,
        };
        let mut bytes = &parcel.bytes[..];
        let mut curves_of = |head: CurvesHead| {
            let parts = take_parts(&head, &mut bytes)?;
            Registration::of_parts(parts).ok_or(ParcelError::Arrays)
        };
        let curves = match head.curves {
            Some([registration, lockstep]) => {
                Some([curves_of(registration)?, curves_of(lockstep)?])
            }
            None => None,
        };
        Ok(RegistrationAnswer { matrix, curves })
    }

    fn affinity(&self) -> u64 {
        self.stride as u64
    }
}

/// Takes the products of the frames of two clips out of the memory.
fn take_terms(memory: &mut WorkerMemory, clips: [u32; 2], stride: usize) -> Option<PairTerms> {
    let is_it = |kept: &([u32; 2], usize, PairTerms)| (kept.0, kept.1) == (clips, stride);
    let at = memory.pairs.iter().position(is_it)?;
    Some(memory.pairs.remove(at).2)
}

/// Puts products into the memory, and drops the oldest ones above its limit.
fn keep_terms(memory: &mut WorkerMemory, clips: [u32; 2], stride: usize, terms: PairTerms) {
    memory.pairs.push((clips, stride, terms));
    let mut bytes: usize = memory.pairs.iter().map(|(_, _, terms)| terms.bytes()).sum();
    while bytes > memory.max_bytes && !memory.pairs.is_empty() {
        bytes -= memory.pairs.remove(0).2.bytes();
    }
}

impl CurvesHead {
    fn of(parts: &RegistrationParts) -> Self {
        Self {
            cells: parts.path.cells.len(),
            pins: parts.path.pins.len(),
            warp: parts.warp.len(),
            mean: parts.mean.len(),
        }
    }
}

fn put_parts(bytes: &mut Vec<u8>, parts: &RegistrationParts) {
    for &(row, column) in parts.path.cells.iter().chain(&parts.path.pins) {
        put(bytes, &[row as u32, column as u32]);
    }
    put(bytes, &[parts.path.mean_m, parts.smoothing]);
    for &(x, y) in &parts.warp {
        put(bytes, &[x, y]);
    }
    for values in std::iter::once(&parts.mean).chain(&parts.curves) {
        put(bytes, values);
    }
}

fn take_parts(head: &CurvesHead, bytes: &mut &[u8]) -> Result<RegistrationParts, ParcelError> {
    let mut cells = |count: usize| -> Result<Vec<(usize, usize)>, ParcelError> {
        let cells = take::<[u32; 2]>(bytes, count)?;
        Ok(cells.into_iter().map(|[row, column]| (row as usize, column as usize)).collect())
    };
    let (cells, pins) = (cells(head.cells)?, cells(head.pins)?);
    let numbers = take::<f64>(bytes, 2)?;
    let warp = take::<[f64; 2]>(bytes, head.warp)?;
    let mut values = || take::<f64>(bytes, head.mean);
    Ok(RegistrationParts {
        path: RegistrationPath { cells, pins, mean_m: numbers[0] },
        smoothing: numbers[1],
        warp: warp.into_iter().map(|[x, y]| (x, y)).collect(),
        mean: values()?,
        curves: [values()?, values()?, values()?, values()?, values()?],
    })
}
