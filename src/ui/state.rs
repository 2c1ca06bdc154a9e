//! The state of the interface between frames.

pub(in crate::ui) mod clip_order;
mod convert;
mod library;
mod notices;
mod presenter;
mod strip;
mod swipe;

pub(crate) use clip_order::ClipOrder;
pub(crate) use convert::{ConvertShown, ConvertState};
pub(crate) use library::{HeldKeys, LibraryState};
pub(crate) use notices::NoticePlace;
pub(crate) use presenter::Presenter;
pub(crate) use strip::StripState;
pub(crate) use swipe::Swipe;

use super::bone_map::BoneMapState;
use super::labs::states::LabStates;
use super::language::Language;
use super::still::Stillness;
use eframe::egui::Rect;
use glam::{DVec2, Vec3};
use segue_scene::Camera;
use segue_session::export::ExportOptions;
use segue_session::{LabId, StorageState};

/// The layouts of the page, by available width.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Layout {
    /// Everything side by side.
    Desk,
    /// The library is a drawer.
    Tablet,
    /// One column: stage, timeline, parameters.
    Phone,
}

impl Layout {
    /// Returns the layout for a window of that width, points; `scale` is the theme's.
    pub(crate) fn of(width: f32, scale: f32) -> Self {
        if width < 640.0 * scale {
            Self::Phone
        } else if width < 960.0 * scale * scale {
            // Larger type also makes every panel wider, hence the square.
            Self::Tablet
        } else {
            Self::Desk
        }
    }
}

/// A text of a clip that is being typed.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Typing {
    /// The clip's id.
    pub(crate) id: String,
    /// The text so far.
    pub(crate) text: String,
}

/// The availability of pictures and videos, and the video under way.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Filming {
    /// Whether a picture can be saved.
    pub(crate) pictures: bool,
    /// Whether a video can be recorded.
    pub(crate) films: bool,
    /// The length of the video under way so far, seconds.
    pub(crate) secs: Option<f64>,
}

/// The input of a gamepad: sticks from -1 to 1, to the right and up.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Gamepad {
    /// The left stick.
    pub(crate) walk: [f32; 2],
    /// The right stick.
    pub(crate) look: [f32; 2],
    /// The button to run.
    pub(crate) run: bool,
    /// The button to strafe.
    pub(crate) strafe: bool,
}

/// The state of the interface.
#[derive(Clone, Debug)]
#[expect(clippy::struct_excessive_bools, reason = "each is a thing of its own that is open or not")]
pub(crate) struct UiState {
    /// Whether the drawer with the library is open.
    pub(crate) library_open: bool,
    /// The search, the order and the selection in the library.
    pub(crate) library: LibraryState,
    /// Whether the list of bundled takes is open.
    pub(crate) samples_open: bool,
    /// The row with the chip of the notices, as a panel has said.
    pub(crate) notice_place: Option<NoticePlace>,
    /// The number of the first notice that was never in the open list.
    pub(crate) seen_notices: u64,
    /// Whether the list of shortcuts is open.
    pub(crate) help_open: bool,
    /// Whether the parameters are in front of the lesson, where they share a place.
    pub(crate) lesson_behind: bool,
    /// The lesson whose answer is shown.
    pub(crate) answered: Option<String>,
    /// The least height of the timeline that shows all of it, points; of the last frame.
    pub(crate) timeline_least: f32,
    /// The height of the controls that the lesson mentions, below its text, points; `None` before
    /// they were drawn.
    pub(crate) lesson_controls: Option<f32>,
    /// The pane that a phone shows.
    pub(crate) shown_pane: usize,
    /// The finger that may swipe from one pane to the next.
    pub(crate) swipe: Option<Swipe>,
    /// The presenter mode.
    pub(crate) presenter: Presenter,
    /// The clip whose name is being typed.
    pub(crate) renaming: Option<Typing>,
    /// The clip whose frame rate is being typed.
    pub(crate) typed_fps: Option<Typing>,
    /// The clip whose details are open.
    pub(crate) details: Option<String>,
    /// Whether a tree of joints was shown in the last frame: the chosen joint is then marked on the
    /// stage.
    pub(crate) joints_open: bool,
    /// Whether the chosen joint is marked on the stage because it was chosen there.
    pub(crate) joint_marked: bool,
    /// The editor of body parts.
    pub(crate) bone_map: BoneMapState,
    /// The state of the labs.
    pub(crate) labs: LabStates,
    /// The input of the gamepad; `None` without one.
    pub(crate) gamepad: Option<Gamepad>,
    /// The cameras of all panes as they were drawn last.
    pub(crate) cameras: Vec<Option<Camera>>,
    /// The joints of the figures in all panes as they were drawn last: positions in the world, in
    /// the order of each skeleton.
    pub(crate) figures: Vec<Vec<Vec3>>,
    /// The line that is being drawn on the ground, (x, z) in metres; `None` while none is.
    pub(crate) drawing: Option<Vec<DVec2>>,
    /// The layout of the page.
    pub(crate) layout: Layout,
    /// The options for saving motions.
    pub(crate) export: ExportOptions,
    /// Whether the options for saving the result are open.
    pub(crate) save_open: bool,
    /// Whether all help texts are open.
    pub(crate) all_help: bool,
    /// The pane whose result is saved.
    pub(crate) saved_pane: usize,
    /// The language of the interface.
    pub(crate) language: Language,
    /// The pictures and videos that can be taken here.
    pub(crate) filming: Filming,
    /// The labs whose hint has been followed, and is not shown again.
    pub(crate) hints_used: Vec<LabId>,
    /// The state of the numbers below the stage.
    pub(crate) strip: StripState,
    /// The place of the stage, points.
    pub(crate) stage: Rect,
    /// Files that are being fetched, with the share of each that has arrived, 0 to 1, where it is
    /// known.
    pub(crate) fetching: Vec<(String, Option<f64>)>,
    /// The panel of conversions.
    pub(crate) convert: ConvertState,
    /// Whether corpora can be shown here.
    pub(crate) shows_corpora: bool,
    /// Whether a page around this one can read the files that are opened here.
    pub(crate) host_reads: bool,
    /// The progress of storing the work; `None` where it is not stored at all.
    pub(crate) stored: Option<StorageState>,
    /// The panels that stand still while the motion plays.
    pub(crate) stillness: Stillness,
}

impl Default for UiState {
    fn default() -> Self {
        Self {
            library_open: false,
            library: LibraryState::default(),
            samples_open: false,
            notice_place: None,
            seen_notices: 0,
            help_open: false,
            lesson_behind: false,
            answered: None,
            timeline_least: 0.0,
            lesson_controls: None,
            shown_pane: 0,
            swipe: None,
            presenter: Presenter::default(),
            renaming: None,
            typed_fps: None,
            details: None,
            joints_open: false,
            bone_map: BoneMapState::default(),
            joint_marked: false,
            labs: LabStates::default(),
            gamepad: None,
            cameras: Vec::new(),
            figures: Vec::new(),
            drawing: None,
            layout: Layout::Desk,
            export: ExportOptions::default(),
            save_open: false,
            all_help: false,
            saved_pane: 0,
            language: Language::default(),
            filming: Filming::default(),
            hints_used: Vec::new(),
            strip: StripState::default(),
            stage: Rect::NOTHING,
            fetching: Vec::new(),
            convert: ConvertState::default(),
            shows_corpora: false,
            host_reads: false,
            stored: None,
            stillness: Stillness::default(),
        }
    }
}
