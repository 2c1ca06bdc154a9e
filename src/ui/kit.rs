//! The widgets the whole app is built from.
//!
//! Each is one file and a function that takes `&mut Ui` last and ends in `_ui`. None changes the
//! app: each is given a state and returns what the user asks for. All take their colours, sizes and
//! spaces from the theme, name themselves to screen readers, and can be worked by mouse, by touch
//! and by keyboard.
//!
//! A row keeps its identity by its label (a drag or the focus survives when rows above come and
//! go), so labels are unique within a `Ui`; use `push_id` where two panes show the same ones.

mod assistive;
mod button;
mod chip;
mod clip_row;
mod cost_bars;
mod curves;
mod dialog;
mod drop_zone;
mod field;
#[cfg(all(test, feature = "ui-tests"))]
mod gallery;
mod heat_map;
mod help;
mod histogram;
pub(crate) mod icon;
mod keys;
mod long_line;
mod matrix;
mod menu;
mod metrics;
mod notice;
pub(crate) mod paint;
mod pane;
mod part_bar;
mod places;
mod pointer_label;
mod profile;
mod section;
mod segmented;
mod slider_row;
mod stick;
mod strip;
mod switch_row;
mod tabs;
#[cfg(all(test, feature = "ui-tests"))]
mod tests;
mod time_axis;
mod timeline;
mod transport;
mod tree;
mod weight_curve;
mod words;

pub(crate) use assistive::{describe, set_role};
pub(crate) use button::{Button, button_ui, icon_button_ui};
pub(crate) use chip::{Mood, Part, recording_ui};
pub(crate) use clip_row::{ClipRow, ClipRowEvent, SlotLetter, clip_row_ui, group_head_ui};
pub(crate) use cost_bars::{CostBars, CostRow, cost_bars_ui};
pub(crate) use curves::{Curves, Series, SeriesValues};
pub(crate) use dialog::{dialog_ui, max_dialog_width};
pub(crate) use drop_zone::{DropButton, drop_buttons_ui, drop_zone_ui};
pub(crate) use field::{search_field_ui, text_field_ui, value_row_ui};
pub(crate) use heat_map::{
    Feet, HeatMap, HeatMapEvent, MapCurve, Shades, heat_legend_ui, heat_map_ui,
};
pub(crate) use help::{about_ui, set_all_help};
pub(crate) use histogram::{Histogram, histogram_ui};
pub(crate) use icon::{Icon, paint_icon, paint_logo};
pub(crate) use matrix::{Matrix, MatrixMark, TILE, Tile, matrix_ui, tiles_id};
pub(crate) use menu::{
    MenuItem, choice_row_ui, helped_choice_row_ui, menu_item_ui, menu_line_ui, menu_ui,
    popup_returning_keyboard_ui, switches_menu_ui, until_choice,
};
pub(crate) use metrics::{GridRoom, Metric, MetricGrid, Rank, metric_cell_ui, metric_row_ui};
pub(crate) use notice::{
    Notice, NoticeChip, NoticeEvent, brief_progress_ui, caption_ui, notices_ui, progress_row_ui,
};
pub(crate) use pane::{PaneTitle, pane_header_height, pane_header_ui};
pub(crate) use part_bar::{PartBar, PartBarResponse, part_bar_ui};
pub(crate) use places::{Chosen, PlaceBar, Places, StripPlace, places_ui};
pub(crate) use pointer_label::pointer_label_ui;
pub(crate) use profile::profile_ui;
pub(crate) use section::{
    folded_ui, folded_unless_ui, note_ui, section_header_ui, section_header_width,
    section_header_with_button_ui, section_mark_ui,
};
pub(crate) use segmented::{labelled_segmented_ui, segmented_ui};
pub(crate) use slider_row::{Mark, SliderResponse, SliderRow, Source, slider_row_ui};
pub(crate) use stick::{stick_size, stick_ui};
pub(crate) use strip::{Arc, Fate, Stretch, Strip, drawn_arcs, strip_ui};
pub(crate) use switch_row::{helped_switch_row_ui, switch_row_ui};
pub(crate) use tabs::tabs_ui;
pub(crate) use timeline::{
    Moment, StanceEdit, StanceEvent, Stripe, Timeline, TimelineEvent, Track, corrected_hint,
    take_least_bottom, timeline_ui,
};
pub(crate) use transport::{Transport, TransportEvent, play_button_ui, transport_ui};
pub(crate) use tree::{Tree, TreeRow, tree_ui};
pub(crate) use weight_curve::{WeightCurveEvent, WeightCurveRow, weight_curve_ui};
#[cfg(all(test, feature = "ui-tests"))]
pub(crate) use words::DISMISS;
