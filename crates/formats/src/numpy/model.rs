//! Models of the SMPL family, which the user has: the true bones of a body.
//!
//! A model's rest mesh is `v_template` plus `shapedirs` · betas, and its joints are `J_regressor` ·
//! mesh (Loper et al. 2015, equations 8 and 10). Both are linear, so that the joints are kept as
//! those of the mean body and their change with each of the betas: a few KB in place of 100 MB.

use super::array::Array;
use super::body;
use super::bundle::Bundle;
use super::container::read_npz;
use super::write::NpzWriter;
use super::{check_size, wrong_shape};
use crate::ImportOptions;
use crate::error::{Fault, ImportError};
use crate::warning::Tally;
use glam::{DVec3, Vec3};
use segue_motion::skeleton::Joint;
use segue_text::msg;

/// The greatest number of betas that are used; SMPL-X has 300, and motions have 10 or 16.
const MAX_BETAS: usize = 300;

/// The arrays of a model from which its joints follow.
const NEEDED: [&str; 3] = ["v_template", "J_regressor", "kintree_table"];

/// The joints of a model by the shape of the body.
#[derive(Clone, Debug, PartialEq)]
pub struct SmplModel {
    /// The name of its file.
    pub file: String,
    /// Joints of the mean body, metres.
    mean: Vec<DVec3>,
    /// For each of the betas the change of every joint, metres.
    changes: Vec<Vec<DVec3>>,
}

/// Returns whether the arrays of a `.npz` file are those of a model, by their paths.
pub(super) fn is_model(paths: &[String]) -> bool {
    let has = |name: &str| paths.iter().any(|path| path.strip_suffix(".npy") == Some(name));
    NEEDED.iter().all(|name| has(name)) || (has("J_mean") && has("J_changes"))
}

/// Reads a model: the `.npz` file of SMPL-H or SMPL-X as it is published, or one that
/// [`SmplModel::to_bytes`] wrote.
///
/// # Errors
/// [`ImportError`] when it is no model, or one of another number of joints.
pub fn read_model(
    name: &str,
    bytes: &[u8],
    options: &ImportOptions,
) -> Result<SmplModel, ImportError> {
    check_size(name, bytes, options)?;
    let wanted =
        |key: &str| NEEDED.contains(&key) || matches!(key, "shapedirs" | "J_mean" | "J_changes");
    let read = |bundle: &Bundle<'_>| {
        let mut tally = Tally::default();
        match (bundle.get("J_mean"), bundle.get("J_changes")) {
            (Some(mean), Some(changes)) => SmplModel::of_joints(name, mean, changes, &mut tally),
            _ => SmplModel::of_mesh(name, bundle, &mut tally),
        }
    };
    read_npz(bytes, options.max_bytes, &wanted)
        .and_then(|bundle| read(&bundle))
        .map_err(|fault| fault.locate(name, b""))
}

impl SmplModel {
    fn of_mesh(name: &str, bundle: &Bundle<'_>, tally: &mut Tally) -> Result<Self, Fault> {
        let (Some(template), Some(regressor)) =
            (bundle.get("v_template"), bundle.get("J_regressor"))
        else {
            return Err(Fault::new(0, bundle.description(), "a body model of the SMPL family"));
        };
        let ([vertices, 3], [joints, columns]) = (template.shape(), regressor.shape()) else {
            return Err(wrong_shape(template.shape(), "(vertices,3)"));
        };
        let (vertices, joints) = (*vertices, *joints);
        if *columns != vertices {
            return Err(wrong_shape(regressor.shape(), &format!("(joints,{vertices})")));
        }
        check_count(joints)?;
        let weights = regressor.view().numbers(tally)?;
        // A joint is the mean of a few hundred vertices; the others have no weight.
        let weights: Vec<Vec<(usize, f64)>> = (weights.chunks_exact(vertices.max(1)))
            .map(|row| {
                let each = row.iter().enumerate().filter(|(_, weight)| **weight != 0.0);
                each.map(|(vertex, weight)| (vertex, f64::from(*weight))).collect()
            })
            .collect();
        let joints_of = |values: &[f32]| -> Vec<DVec3> {
            let point = |vertex: usize| {
                values.get(3 * vertex..3 * vertex + 3).map_or(Vec3::ZERO, Vec3::from_slice)
            };
            let sum = |row: &Vec<(usize, f64)>| {
                row.iter().map(|(vertex, weight)| *weight * point(*vertex).as_dvec3()).sum()
            };
            weights.iter().map(sum).collect()
        };
        let mean = joints_of(&template.view().numbers(tally)?);
        let mut changes = Vec::new();
        if let Some(directions) = bundle.get("shapedirs").filter(|own| own.is_number()) {
            let view = directions.view();
            let [rows, 3, betas] = *view.shape() else {
                return Err(wrong_shape(view.shape(), "(vertices,3,betas)"));
            };
            if rows != vertices {
                return Err(wrong_shape(view.shape(), &format!("({vertices},3,betas)")));
            }
            for beta in 0..betas.min(MAX_BETAS) {
                changes.push(joints_of(&view.at(2, beta).numbers(tally)?));
            }
        }
        Ok(Self { file: name.to_owned(), mean, changes })
    }

    fn of_joints(
        name: &str,
        mean: &Array<'_>,
        changes: &Array<'_>,
        tally: &mut Tally,
    ) -> Result<Self, Fault> {
        let ([joints, 3], [_, also, 3]) = (mean.shape(), changes.shape()) else {
            return Err(wrong_shape(mean.shape(), "(joints,3)"));
        };
        if joints != also {
            return Err(wrong_shape(changes.shape(), &format!("(betas,{joints},3)")));
        }
        check_count(*joints)?;
        let points = |array: &Array<'_>, tally: &mut Tally| -> Result<Vec<DVec3>, Fault> {
            let numbers = array.view().numbers(tally)?;
            Ok(numbers.chunks_exact(3).map(|v| Vec3::from_slice(v).as_dvec3()).collect())
        };
        let (mean, all) = (points(mean, tally)?, points(changes, tally)?);
        let changes = all.chunks_exact(mean.len()).map(<[DVec3]>::to_vec).collect();
        Ok(Self { file: name.to_owned(), mean, changes })
    }

    /// Returns the model as a small `.npz` file, from which [`read_model`] reads it again.
    #[must_use]
    pub fn to_bytes(&self) -> Vec<u8> {
        let numbers = |points: &[DVec3]| -> Vec<f32> {
            points.iter().flat_map(|point| point.as_vec3().to_array()).collect()
        };
        let mut npz = NpzWriter::default();
        npz.floats("J_mean", &[self.mean.len(), 3], &numbers(&self.mean));
        let changes: Vec<f32> = self.changes.iter().flat_map(|one| numbers(one)).collect();
        npz.floats("J_changes", &[self.changes.len(), self.mean.len(), 3], &changes);
        npz.finish()
    }

    /// Returns the number of joints.
    #[must_use]
    pub fn joints(&self) -> usize {
        self.mean.len()
    }

    /// Returns the index of the model for a motion of `count` joints: one that has the joints, of
    /// the gender if there is one, neutral otherwise.
    pub(super) fn best(models: &[&Self], count: usize, gender: Option<&str>) -> Option<usize> {
        let gender = gender.map(str::to_lowercase);
        let fits = |model: &&Self| model.joints() >= count || count == 24;
        let rank = |model: &Self| {
            let own = gender_of(&model.file);
            let is_of_gender = own.is_some() && own == gender.as_deref();
            (is_of_gender, model.joints() == count, own == Some("neutral"))
        };
        let known = models.iter().enumerate().filter(|(_, model)| fits(model));
        // Of equals the first one.
        known.rev().max_by_key(|(_, model)| rank(model)).map(|(index, _)| index)
    }

    /// Moves the joints that the model has to where it has them.
    pub(super) fn shape(&self, joints: &mut [Joint], betas: &[f64]) {
        let places: Vec<DVec3> = (0..self.mean.len())
            .map(|joint| {
                let change = |(beta, change): (&f64, &Vec<DVec3>)| {
                    change.get(joint).map_or(DVec3::ZERO, |change| *change * *beta)
                };
                self.mean[joint] + betas.iter().zip(&self.changes).map(change).sum::<DVec3>()
            })
            .collect();
        let own = body::joints(self.mean.len());
        let place = |name: &str| {
            let index = own.iter().position(|joint| joint.name == name)?;
            places.get(index).copied()
        };
        let names: Vec<String> = joints.iter().map(|joint| joint.name.clone()).collect();
        for joint in joints {
            let Some(here) = place(&joint.name) else { continue };
            let above = joint.parent.and_then(|parent| names.get(parent));
            match above {
                None => joint.offset = here.as_vec3(),
                Some(above) => {
                    if let Some(above) = place(above) {
                        joint.offset = (here - above).as_vec3();
                    }
                }
            }
        }
    }
}

fn check_count(joints: usize) -> Result<(), Fault> {
    if matches!(joints, 24 | 52 | 55) {
        return Ok(());
    }
    let found = msg!("a body model of {joints} joints", joints);
    Err(Fault::new(0, found, "SMPL with 24, SMPL-H with 52 or SMPL-X with 55 joints"))
}

/// Returns the gender in the name of a model's file.
fn gender_of(file: &str) -> Option<&'static str> {
    let name = file.to_lowercase();
    // The word `male` is also in `female`.
    ["neutral", "female", "male"].into_iter().find(|gender| name.contains(gender))
}
