//! Results of labs, made by the session as the command line and the page make them.

use crate::clip::Clip;
use crate::cores::detached;
use crate::errors::{batch_error, lab_error};
use crate::metrics::MetricValue;
use crate::origin::Origin;
use crate::words::lab_of;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use rayon::prelude::*;
use segue_batch::{
    BatchError, Clip as BatchClip, Clips, Driven, Ingredients, PAGE, known_clip, lab_of_link,
    page_link, query_of, value_of,
};
use segue_motion::clip::Motion;
use segue_motion::skin::Character;
use segue_session::choices::LabId;
use segue_session::reading::ReadFile;
use segue_session::{FoundFault, Key, Outcome, Session, Transition, Value};
use std::sync::Arc;

/// A result of a lab: a clip, and what is known about it.
#[pyclass(module = "segue", name = "Result", frozen, extends = Clip)]
pub(crate) struct LabResult {
    /// The name by which it differs from others that were made together.
    #[pyo3(get)]
    variant: Option<String>,
    /// The query of the link that makes it.
    #[pyo3(get)]
    query: String,
    metrics: Vec<MetricValue>,
    #[pyo3(get)]
    notes: Vec<String>,
    faults: Vec<FaultFacts>,
    transition: Option<Transition>,
}

/// A fault of a cleaned take.
struct FaultFacts {
    kind: &'static str,
    frames: (usize, usize),
    joints: Vec<String>,
    size: f32,
    unit: &'static str,
    confidence: f32,
    is_mended: bool,
}

#[pymethods]
impl LabResult {
    #[getter]
    fn metrics<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        MetricValue::as_dict(py, &self.metrics)
    }

    /// The link that makes it in the page, served by this machine.
    #[getter]
    fn link(&self) -> String {
        format!("{PAGE}?{}", self.query)
    }

    #[getter]
    fn transition<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyDict>>> {
        let Some(made) = &self.transition else {
            return Ok(None);
        };
        let dict = PyDict::new(py);
        dict.set_item("start_s", made.start_secs)?;
        dict.set_item("end_s", made.end_secs)?;
        dict.set_item("leave_a_s", made.leave_a_secs)?;
        dict.set_item("enter_b_s", made.enter_b_secs)?;
        dict.set_item("window_frames", made.window_frames)?;
        dict.set_item("distance_cm", made.distance_cm)?;
        Ok(Some(dict))
    }

    #[getter]
    fn faults<'py>(&self, py: Python<'py>) -> PyResult<Vec<Bound<'py, PyDict>>> {
        let as_dict = |fault: &FaultFacts| {
            let dict = PyDict::new(py);
            dict.set_item("kind", fault.kind)?;
            dict.set_item("frames", fault.frames)?;
            dict.set_item("joints", &fault.joints)?;
            dict.set_item("size", fault.size)?;
            dict.set_item("unit", fault.unit)?;
            dict.set_item("confidence", fault.confidence)?;
            dict.set_item("is_mended", fault.is_mended)?;
            Ok(dict)
        };
        self.faults.iter().map(as_dict).collect()
    }
}

/// A result before Python has it.
pub(crate) struct Made {
    motion: Arc<Motion>,
    character: Option<Arc<Character>>,
    origin: Origin,
    result: LabResult,
}

impl Made {
    /// Returns the result as an object.
    pub(crate) fn into_object(self, py: Python<'_>) -> PyResult<Py<LabResult>> {
        let Self { motion, character, origin, result } = self;
        let clip = Clip::new(motion, character, origin, Vec::new());
        Py::new(py, PyClassInitializer::from(clip).add_subclass(result))
    }
}

/// All that a result is made from.
pub(crate) struct Recipe {
    pub(crate) lab: LabId,
    pub(crate) link: Option<String>,
    pub(crate) clips: Vec<Origin>,
    pub(crate) body: Option<Origin>,
    pub(crate) values: Vec<(Key, Value)>,
}

impl Recipe {
    /// Returns the files of all clips, each once.
    pub(crate) fn files(&self) -> Vec<Arc<ReadFile>> {
        let mut files: Vec<Arc<ReadFile>> = Vec::new();
        for file in self.clips.iter().chain(&self.body).flat_map(|clip| &clip.files) {
            if !files.iter().any(|own| Arc::ptr_eq(own, file)) {
                files.push(Arc::clone(file));
            }
        }
        files
    }

    /// Returns a session with everything loaded and set.
    ///
    /// # Errors
    /// `segue.LabError` if clips or values do not fit the lab.
    pub(crate) fn driven(&self) -> PyResult<Driven> {
        let clips = self.clips.iter().map(Origin::as_clip).collect::<PyResult<Vec<_>>>()?;
        let body = self.body.as_ref().map(Origin::as_clip).transpose()?;
        let made = |origin: &&Origin| origin.own_file().is_none();
        let mut beside: Vec<Arc<ReadFile>> = Vec::new();
        for file in self.clips.iter().chain(&self.body).filter(made).flat_map(|own| &own.files) {
            beside.push(Arc::clone(file));
        }
        let mut driven = Driven::new(&Ingredients {
            link: self.link.as_deref(),
            clips,
            body: body.as_ref(),
            beside: &beside,
            values: &self.values,
            ..Ingredients::of(self.lab)
        })
        .map_err(batch_error)?;
        if Clips::of(self.lab) == Clips::Each
            && self.link.is_none()
            && let Some(id) = driven.ids.first()
        {
            let values = vec![(Key::A, Value::Text(id.clone()))];
            driven.set(values).map_err(batch_error)?;
        }
        Ok(driven)
    }

    /// Makes the results: one, or one for each value that is compared.
    ///
    /// # Errors
    /// `segue.LabError` with the reason why there is none.
    fn make(&self) -> PyResult<Vec<Made>> {
        let mut driven = self.driven()?;
        driven.settle();
        collect(&driven, &self.files())
    }
}

impl Origin {
    /// Returns the file of which it is a clip; `None` if it is made, or built in.
    fn own_file(&self) -> Option<&Arc<ReadFile>> {
        let is_made = self.id.as_ref().is_none_or(|id| id.ends_with(')'));
        self.files.first().filter(|_| !is_made && self.files.len() == 1)
    }

    /// Returns the clip for a session.
    fn as_clip(&self) -> PyResult<BatchClip> {
        let id = self.id.clone().ok_or_else(|| {
            lab_error(
                "this result is made of results of results, which no link can say: use its as_file(), or save it and load that",
            )
        })?;
        Ok(match self.own_file() {
            Some(file) => BatchClip::Read(Arc::clone(file), id),
            None => BatchClip::Known(id),
        })
    }
}

/// Returns the results of a session that has done its work, one for each pane.
///
/// # Errors
/// `segue.LabError` with the reason why there is none.
pub(crate) fn collect(driven: &Driven, files: &[Arc<ReadFile>]) -> PyResult<Vec<Made>> {
    let query = query_of(&page_link(&driven.session, ""));
    let notes = driven.all_notes();
    let character = driven.session.character().map(Arc::new);
    let made = driven.results().into_iter().enumerate().map(|(pane, (variant, result))| {
        let outcome = result.map_err(|reason| lab_error(reason.to_string()))?.outcome;
        let id = driven.session.result_id(pane).ok();
        Ok(Made {
            motion: Arc::clone(&outcome.motion),
            character: character.clone(),
            origin: Origin { id, files: files.to_vec() },
            result: LabResult {
                variant,
                query: query.clone(),
                metrics: outcome.metrics.iter().map(MetricValue::of).collect(),
                notes: notes.clone(),
                faults: faults_of(outcome),
                transition: outcome.transition,
            },
        })
    });
    made.collect()
}

/// Returns the faults of a cleaned take.
fn faults_of(outcome: &Outcome) -> Vec<FaultFacts> {
    let joints = outcome.motion.clip().skeleton().joints();
    let Some(facts) = outcome.cleaned() else {
        return Vec::new();
    };
    let of_fault = |found: &FoundFault| {
        let fault = &found.fault;
        let named = fault.joints.iter().filter_map(|joint| joints.get(*joint));
        FaultFacts {
            kind: fault.kind.word(),
            frames: (fault.frames.start, fault.frames.end),
            joints: named.map(|joint| joint.name.clone()).collect(),
            size: fault.size,
            unit: fault.unit.text(),
            confidence: fault.confidence,
            is_mended: facts.mends && found.is_chosen,
        }
    };
    facts.faults.iter().map(of_fault).collect()
}

/// Reads values of parameters, which must be those of a lab, or `compare`.
pub(crate) fn values_of(lab: LabId, values: &[(String, String)]) -> PyResult<Vec<(Key, Value)>> {
    let read = |(name, text): &(String, String)| {
        let (key, value) = value_of(name, text).map_err(batch_error)?;
        if key != Key::Compare && !key.param().is_ingredient_of(lab) {
            let word = lab.word();
            return Err(lab_error(format!(
                "`{name}` is not a parameter of `{word}`: segue.parameters({word:?}) lists them"
            )));
        }
        Ok((key, value))
    };
    values.iter().map(read).collect()
}

fn origins(clips: &[PyRef<'_, Clip>]) -> Vec<Origin> {
    clips.iter().map(|clip| clip.origin()).collect()
}

/// Makes results by a lab, of the clips together.
#[pyfunction]
#[pyo3(signature = (lab, clips, values, body=None))]
pub(crate) fn make(
    py: Python<'_>,
    lab: &str,
    clips: Vec<PyRef<'_, Clip>>,
    values: Vec<(String, String)>,
    body: Option<PyRef<'_, Clip>>,
) -> PyResult<Vec<Py<LabResult>>> {
    let lab = lab_of(lab)?;
    let values = values_of(lab, &values)?;
    let body = body.map(|body| body.origin());
    let recipe = Recipe { lab, link: None, clips: origins(&clips), body, values };
    let made = detached(py, || recipe.make())?;
    made.into_iter().map(|made| made.into_object(py)).collect()
}

/// Makes a result of each clip by a lab, on all cores.
#[pyfunction]
#[pyo3(signature = (lab, clips, values, body=None))]
pub(crate) fn make_each(
    py: Python<'_>,
    lab: &str,
    clips: Vec<PyRef<'_, Clip>>,
    values: Vec<(String, String)>,
    body: Option<PyRef<'_, Clip>>,
) -> PyResult<Vec<Vec<Py<LabResult>>>> {
    let lab = lab_of(lab)?;
    let values = values_of(lab, &values)?;
    let body = body.map(|body| body.origin());
    let recipe = |clip: Origin| Recipe {
        lab,
        link: None,
        clips: vec![clip],
        body: body.clone(),
        values: values.clone(),
    };
    let recipes: Vec<Recipe> = origins(&clips).into_iter().map(recipe).collect();
    let made: Vec<PyResult<Vec<Made>>> =
        detached(py, || recipes.par_iter().map(Recipe::make).collect());
    let as_objects = |made: PyResult<Vec<Made>>| {
        made?.into_iter().map(|made| made.into_object(py)).collect::<PyResult<Vec<_>>>()
    };
    made.into_iter().map(as_objects).collect()
}

/// Returns the query of the link of a lab's result, without making it.
#[pyfunction]
#[pyo3(signature = (lab, clips, values, body=None))]
pub(crate) fn query(
    py: Python<'_>,
    lab: &str,
    clips: Vec<PyRef<'_, Clip>>,
    values: Vec<(String, String)>,
    body: Option<PyRef<'_, Clip>>,
) -> PyResult<String> {
    let lab = lab_of(lab)?;
    let values = values_of(lab, &values)?;
    let body = body.map(|body| body.origin());
    let recipe = Recipe { lab, link: None, clips: origins(&clips), body, values };
    detached(py, || Ok(query_of(&page_link(&recipe.driven()?.session, ""))))
}

/// Makes the results of a link; the clips are those of the files that it names.
#[pyfunction]
pub(crate) fn open_link(
    py: Python<'_>,
    link: String,
    clips: Vec<PyRef<'_, Clip>>,
) -> PyResult<Vec<Py<LabResult>>> {
    let clips = origins(&clips);
    let made = detached(py, || {
        let lab = lab_of_link(&link).map_err(batch_error)?;
        Recipe { lab, link: Some(link), clips, body: None, values: Vec::new() }.make()
    })?;
    made.into_iter().map(|made| made.into_object(py)).collect()
}

/// Returns a clip that needs no file: a synthesised or bundled one, or a recipe of some.
#[pyfunction]
pub(crate) fn builtin(py: Python<'_>, name: String) -> PyResult<Clip> {
    let (motion, id) = detached(py, || {
        let lab = lab_of("view")?;
        let id = known_clip(&Session::new(), &name).ok_or_else(|| {
            lab_error(format!("there is no built-in clip {name:?}: segue.builtins() lists them"))
        })?;
        let clips = vec![BatchClip::Known(id.clone())];
        let driven = || -> Result<Driven, BatchError> {
            let mut driven = Driven::new(&Ingredients { clips, ..Ingredients::of(lab) })?;
            driven.set(vec![(Key::A, Value::Text(id.clone()))])?;
            Ok(driven)
        };
        let mut driven = driven().map_err(batch_error)?;
        driven.settle();
        let made = driven.session.first_result().map_err(|no| lab_error(no.to_string()))?;
        Ok::<_, PyErr>((Arc::clone(&made.outcome.motion), id))
    })?;
    Ok(Clip::new(motion, None, Origin { id: Some(id), files: Vec::new() }, Vec::new()))
}

/// Returns the names of the clips that need no file.
#[pyfunction]
pub(crate) fn builtins() -> Vec<String> {
    let session = Session::new();
    let made = session.library().entries().iter().map(|entry| entry.id.clone());
    let sets = Session::sample_sets().iter().flat_map(|set| set.samples);
    let takes = Session::samples().iter().chain(sets).map(|sample| sample.id.to_owned());
    let mut all: Vec<String> = made.collect();
    for take in takes {
        if !all.contains(&take) {
            all.push(take);
        }
    }
    all
}
