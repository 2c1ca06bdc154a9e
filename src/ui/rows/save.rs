//! The rows that save a motion as a file: its format and options.

use crate::ui::kit::{self, Button, Icon};
use crate::ui::language::{Text, Word};
use crate::ui::out::{Action, Out};
use crate::ui::state::UiState;
use crate::ui::text;
use crate::ui::theme::{space, theme_of};
use eframe::egui::{Align, Layout, Ui, UiBuilder};
use segue_formats::bvh::RotationOrder;
use segue_motion::clip::UpAxis;
use segue_session::export::{ExportBody, ExportFormat, ExportOptions, ExportRoot};

/// Metres per unit of length of saved files, with the name of the unit.
const UNITS: [(Option<f64>, Word); 3] =
    [(None, text::AS_FILE), (Some(1.0), Word::new("m")), (Some(0.01), Word::new("cm"))];

/// Those of FBX, which begin with the usual one.
const FBX_UNITS: [(Option<f64>, Word); 2] = [UNITS[2], UNITS[1]];

/// The up axes of saved files.
const AXES: [(Option<UpAxis>, Text<'_>); 3] = [
    (None, Text::Word(text::AS_FILE)),
    (Some(UpAxis::Y), Text::Data("Y")),
    (Some(UpAxis::Z), Text::Data("Z")),
];

/// Those of FBX, which begin with the usual one.
const FBX_AXES: [(Option<UpAxis>, Text<'_>); 2] = [AXES[1], AXES[2]];

/// The body in a saved file.
const BODIES: [(ExportBody, Word); 2] =
    [(ExportBody::Character, text::BODY_CHARACTER), (ExportBody::Plain, text::BODY_PLAIN)];

/// The joint of a saved file that has the motion over the ground.
const ROOTS: [(ExportRoot, Word); 3] = [
    (ExportRoot::AsIs, text::ROOT_AS_IT_IS),
    (ExportRoot::InPlace, text::ROOT_IN_PLACE),
    (ExportRoot::Ground, text::ROOT_ON_GROUND),
];

const ORDERS: [(Option<RotationOrder>, Text<'_>); 7] = [
    (None, Text::Word(text::AS_FILE)),
    (Some(RotationOrder::Zxy), Text::Data("Z X Y")),
    (Some(RotationOrder::Zyx), Text::Data("Z Y X")),
    (Some(RotationOrder::Xyz), Text::Data("X Y Z")),
    (Some(RotationOrder::Xzy), Text::Data("X Z Y")),
    (Some(RotationOrder::Yxz), Text::Data("Y X Z")),
    (Some(RotationOrder::Yzx), Text::Data("Y Z X")),
];

const RATES: [(Option<f64>, Word); 4] = [
    (None, text::AS_IT_IS),
    (Some(30.0), Word::new("30 fps")),
    (Some(60.0), Word::new("60 fps")),
    (Some(120.0), Word::new("120 fps")),
];

/// Draws the row that saves a motion, and its options, folded. `which` is a clip's id, or
/// `result:1` for the second pane.
pub(crate) fn save_rows_ui(which: &str, state: &mut UiState, out: &mut Out, ui: &mut Ui) {
    format_row_ui(which, state, out, ui);
    kit::folded_ui(text::SAVE_OPTIONS, ui, |ui| options_ui(&mut state.export, ui));
}

/// Draws the row that saves a motion, and its options below it.
pub(super) fn save_options_ui(which: &str, state: &mut UiState, out: &mut Out, ui: &mut Ui) {
    format_row_ui(which, state, out, ui);
    options_ui(&mut state.export, ui);
}

/// Draws the choice of a format and its options.
pub(crate) fn format_rows_ui(export: &mut ExportOptions, ui: &mut Ui) {
    let formats = ExportFormat::ALL.map(|format| (format, text::format(format)));
    if let Some(format) = kit::choice_row_ui(text::SAVE_AS, export.format, &formats, ui) {
        export.format = format;
    }
    options_ui(export, ui);
}

/// Draws the choice of the format, and the button that saves.
fn format_row_ui(which: &str, state: &mut UiState, out: &mut Out, ui: &mut Ui) {
    let theme = theme_of(ui);
    let button = theme.row_height();
    let rect = kit::paint::full_width(button, ui);
    let formats = ExportFormat::ALL.map(|format| (format, text::format(format)));
    let row = rect.with_max_x(rect.right() - button - space::S);
    ui.scope_builder(UiBuilder::new().id_salt("format").max_rect(row), |ui| {
        if let Some(format) = kit::choice_row_ui(text::SAVE_AS, state.export.format, &formats, ui) {
            state.export.format = format;
        }
    });
    let place = rect.with_min_x(rect.right() - button);
    let builder = UiBuilder::new()
        .id_salt("save")
        .max_rect(place)
        .layout(Layout::right_to_left(Align::Center));
    let save = Button::icon_only(Icon::Download, text::SAVE).outlined();
    if ui.scope_builder(builder, |ui| kit::button_ui(save, ui)).inner.clicked() {
        out.actions.push(Action::Save { which: which.to_owned(), how: state.export });
    }
}

/// Draws the options of the chosen format.
fn options_ui(export: &mut ExportOptions, ui: &mut Ui) {
    match export.format {
        ExportFormat::Csv | ExportFormat::Vrma | ExportFormat::Npz | ExportFormat::G1Csv => {}
        ExportFormat::Glb => {
            if let Some(body) = kit::choice_row_ui(text::SAVE_BODY, export.body, &BODIES, ui) {
                export.body = body;
            }
        }
        ExportFormat::Fbx => {
            let unit = export.metres_per_unit.or(FBX_UNITS[0].0);
            if let Some(unit) = kit::choice_row_ui(text::SAVE_UNIT, unit, &FBX_UNITS, ui) {
                export.metres_per_unit = unit;
            }
            let up = export.up.or(FBX_AXES[0].0);
            if let Some(up) = kit::choice_row_ui(text::UP_AXIS, up, &FBX_AXES, ui) {
                export.up = up;
            }
        }
        ExportFormat::Bvh => {
            if let Some(unit) =
                kit::choice_row_ui(text::SAVE_UNIT, export.metres_per_unit, &UNITS, ui)
            {
                export.metres_per_unit = unit;
            }
            if let Some(up) = kit::choice_row_ui(text::UP_AXIS, export.up, &AXES, ui) {
                export.up = up;
            }
            if let Some(order) =
                kit::choice_row_ui(text::ROTATION_ORDER, export.rotation_order, &ORDERS, ui)
            {
                export.rotation_order = order;
            }
        }
    }
    // A format without a skeleton of its own has no place for the root bone, the last choice.
    let has_root_bones = export.format.has_root_bones();
    let roots = if has_root_bones { &ROOTS[..] } else { &ROOTS[..2] };
    let root = if has_root_bones || export.root != ExportRoot::Ground {
        export.root
    } else {
        ExportRoot::AsIs
    };
    if let Some(root) = kit::choice_row_ui(text::SAVE_ROOT, root, roots, ui) {
        export.root = root;
    }
    if export.format != ExportFormat::Csv {
        rate_ui(&mut export.fps, ui);
    }
}

fn rate_ui(fps: &mut Option<f64>, ui: &mut Ui) {
    if let Some(rate) = kit::choice_row_ui(text::FRAME_RATE, *fps, &RATES, ui) {
        *fps = rate;
    }
}
