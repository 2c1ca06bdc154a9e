//! The look of Segue: colours, one type scale, one grid. No other file of the app has a colour or a
//! size of text.
//!
//! [`Theme::install`] gives a context the fonts and the style, at the start and whenever the theme
//! changes. Widgets read the theme with [`theme_of`], by one look-up.

mod palette;

use eframe::egui::{
    self, Color32, Context, CornerRadius, FontData, FontDefinitions, FontFamily, FontId, Id,
    Margin, Shadow, Stroke, Style, TextStyle, Ui, Vec2, Visuals, style,
};
use eframe::epaint::text::{FontInsert, FontPriority, InsertFontFamily};
use std::sync::Arc;

pub(crate) use palette::Palette;

/// Distances, in points, on a grid of four.
pub(crate) mod space {
    /// Between parts of a widget, such as an icon and its text.
    pub(crate) const XS: f32 = 4.0;
    /// Between neighbours, such as two buttons.
    pub(crate) const S: f32 = 8.0;
    /// Between the rows of a group.
    pub(crate) const M: f32 = 12.0;
    /// At the edge of a panel, and between groups.
    pub(crate) const L: f32 = 16.0;
}

/// Radii of corners, in points.
pub(crate) mod radius {
    /// Chips inside controls, badges, the bars of the timeline.
    pub(crate) const S: u8 = 4;
    /// Buttons and fields.
    pub(crate) const M: u8 = 7;
    /// Menus, drop zones, notices.
    pub(crate) const L: u8 = 10;
}

/// The least height of a target for pointer or finger, points.
pub(crate) const HIT: f32 = 24.0;

/// The least height of a target for a finger, points: that of a fingertip.
const TOUCH_HIT: f32 = 44.0;

/// A theme: dark or light, for a desk or for a projector, for a mouse or for fingers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[expect(clippy::struct_excessive_bools, reason = "each is a choice of its own")]
pub(crate) struct Theme {
    /// Light on dark.
    pub(crate) dark: bool,
    /// For a lecture hall: larger text and thicker lines.
    pub(crate) projector: bool,
    /// For the stage alone, seen from the last row: text larger still.
    pub(crate) presents: bool,
    /// For fingers: everything that can be pressed is as high as a fingertip.
    pub(crate) touch: bool,
}

impl Default for Theme {
    fn default() -> Self {
        Self { dark: true, projector: false, presents: false, touch: false }
    }
}

/// The type scale. Figures are tabular in all of it, so that changing numbers do not move.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Type {
    /// Titles of panes, and headings of dialogs.
    Title,
    /// Sentences and buttons.
    Body,
    /// Names, such as that of a clip or of the chosen tab.
    Strong,
    /// Headings of pages of text.
    Heading,
    /// Running text.
    Reading,
    /// Bold words in running text.
    ReadingStrong,
    /// Labels of parameters.
    Label,
    /// The value of a parameter.
    Number,
    /// Metrics under a pane.
    Metric,
    /// Help, units under metrics, second lines.
    Small,
    /// Small and semi-bold: chips, letters on badges, names on bars.
    SmallStrong,
    /// Headings of sections, in capitals.
    Caps,
}

impl Theme {
    /// Returns the colours of this theme.
    pub(crate) fn palette(self) -> &'static Palette {
        if self.dark { &palette::DARK } else { &palette::LIGHT }
    }

    /// Returns the scale of sizes, 1 at a desk.
    pub(crate) fn scale(self) -> f32 {
        if self.presents {
            1.5
        } else if self.projector {
            1.25
        } else {
            1.0
        }
    }

    /// Returns the font of a step of the type scale.
    pub(crate) fn font(self, step: Type) -> FontId {
        let (size, strong) = match step {
            Type::Heading => (19.0, true),
            Type::Title => (15.5, true),
            Type::Reading => (14.0, false),
            Type::ReadingStrong => (14.0, true),
            Type::Body | Type::Label => (13.0, false),
            Type::Strong | Type::Number => (13.0, true),
            Type::Metric => (16.0, true),
            Type::Small => (11.5, false),
            Type::SmallStrong => (11.0, true),
            Type::Caps => (11.0, false),
        };
        FontId::new(
            size * self.scale(),
            if strong { strong_family() } else { FontFamily::Proportional },
        )
    }

    /// Returns the least height and width of a target: [`HIT`], more for fingers.
    pub(crate) fn hit(self) -> f32 {
        if self.touch { TOUCH_HIT } else { HIT }
    }

    /// Returns the height of a row that can be pressed: at least [`Self::hit`], more on a
    /// projector.
    pub(crate) fn row_height(self) -> f32 {
        (28.0 * self.scale()).max(self.hit()).round()
    }

    /// Returns the width of hairlines and outlines.
    pub(crate) fn hairline(self) -> f32 {
        if self.projector || self.presents { 1.5 } else { 1.0 }
    }

    /// Returns the fonts of the app, which [`Self::install`] sets once per context.
    ///
    /// They are compiled in: a context without a font would show no text.
    pub(crate) fn fonts() -> FontDefinitions {
        let mut fonts = FontDefinitions::empty();
        let faces: [(&str, &'static [u8]); 2] = [
            ("Inter", include_bytes!("../../assets/fonts/Inter-Regular.ttf")),
            ("Inter SemiBold", include_bytes!("../../assets/fonts/Inter-SemiBold.ttf")),
        ];
        for (name, bytes) in faces {
            let mut face = FontData::from_static(bytes);
            // Each glyph is rasterised once, not for four fractions of a pixel, which is sharper
            // and saves much of the first frame's time.
            face.tweak.subpixel_binning = Some(false);
            fonts.font_data.insert(name.to_owned(), Arc::new(face));
        }
        let regular = vec!["Inter".to_owned()];
        fonts.families.insert(FontFamily::Monospace, regular.clone());
        fonts.families.insert(FontFamily::Proportional, regular);
        fonts
            .families
            .insert(strong_family(), vec!["Inter SemiBold".to_owned(), "Inter".to_owned()]);
        fonts
    }

    /// Applies the theme to a context: the fonts (the first time only), and the style of both of
    /// egui's themes.
    pub(crate) fn install(self, ctx: &Context) {
        let fonts_id = Id::unique("segue fonts");
        if !ctx.data(|data| data.get_temp::<bool>(fonts_id).unwrap_or(false)) {
            ctx.set_fonts(Self::fonts());
            ctx.data_mut(|data| data.insert_temp(fonts_id, true));
        }
        ctx.data_mut(|data| data.insert_temp(theme_id(), self));
        ctx.set_theme(if self.dark { egui::Theme::Dark } else { egui::Theme::Light });
        let style = Arc::new(self.style());
        ctx.set_style_of(egui::Theme::Dark, style.clone());
        ctx.set_style_of(egui::Theme::Light, style);
    }

    /// Returns egui's style for this theme, for the few widgets of egui that the kit uses
    /// unchanged.
    pub(crate) fn style(self) -> Style {
        let mut style = Style {
            text_styles: [
                (TextStyle::Small, self.font(Type::Small)),
                (TextStyle::Body, self.font(Type::Body)),
                (TextStyle::Button, self.font(Type::Body)),
                (TextStyle::Heading, self.font(Type::Title)),
                (TextStyle::Monospace, self.font(Type::Body)),
            ]
            .into(),
            visuals: self.visuals(),
            animation_time: 0.13,
            ..Style::default()
        };
        let spacing = &mut style.spacing;
        spacing.item_spacing = Vec2::new(space::S, space::S);
        spacing.button_padding = Vec2::new(space::M, space::XS);
        spacing.interact_size = Vec2::new(self.hit(), self.row_height());
        spacing.window_margin = Margin::same(12);
        spacing.menu_margin = Margin::same(6);
        spacing.menu_spacing = space::XS;
        spacing.tooltip_width = 300.0 * self.scale();
        spacing.scroll = style::ScrollStyle { bar_width: 8.0, ..style::ScrollStyle::floating() };
        style.interaction.selectable_labels = false;
        style.interaction.tooltip_delay = 0.45;
        style
    }

    /// Draws with this theme, on a page that may have another.
    pub(crate) fn within<R>(self, ui: &mut Ui, add: impl FnOnce(&mut Ui) -> R) -> R {
        let page = theme_of(ui);
        if page == self {
            return add(ui);
        }
        let style = std::mem::replace(ui.style_mut(), self.style());
        ui.ctx().data_mut(|data| data.insert_temp(theme_id(), self));
        let added = add(ui);
        ui.ctx().data_mut(|data| data.insert_temp(theme_id(), page));
        *ui.style_mut() = style;
        added
    }

    fn visuals(self) -> Visuals {
        let p = self.palette();
        let mut visuals = if self.dark { Visuals::dark() } else { Visuals::light() };
        let line = Stroke::new(self.hairline(), p.line);
        let widget = |fill: Color32, stroke: Stroke, text: Color32| style::WidgetVisuals {
            bg_fill: fill,
            weak_bg_fill: fill,
            bg_stroke: stroke,
            corner_radius: CornerRadius::same(radius::M),
            fg_stroke: Stroke::new(1.5, text),
            expansion: 0.0,
        };
        visuals.widgets.noninteractive = widget(p.panel, line, p.text);
        visuals.widgets.inactive = widget(p.panel_raised, line, p.text);
        visuals.widgets.hovered =
            widget(p.hover, Stroke::new(self.hairline(), p.line_strong), p.text);
        visuals.widgets.active =
            widget(p.pressed, Stroke::new(self.hairline(), p.line_strong), p.text);
        visuals.widgets.open = widget(p.hover, line, p.text);
        visuals.selection.bg_fill = p.accent_wash;
        visuals.selection.stroke = Stroke::new(1.5, p.accent_ink);
        visuals.hyperlink_color = p.accent_ink;
        visuals.weak_text_color = Some(p.muted);
        visuals.faint_bg_color = p.panel_raised;
        visuals.extreme_bg_color = p.ground;
        visuals.text_edit_bg_color = Some(p.ground);
        visuals.code_bg_color = p.panel_raised;
        visuals.warn_fg_color = p.warning;
        visuals.error_fg_color = p.bad;
        visuals.panel_fill = p.panel;
        visuals.window_fill = p.panel_raised;
        visuals.window_stroke = line;
        visuals.window_corner_radius = CornerRadius::same(radius::L);
        visuals.menu_corner_radius = CornerRadius::same(radius::L);
        let shadow = Shadow { offset: [0, 6], blur: 20, spread: 0, color: p.shadow };
        visuals.window_shadow = shadow;
        visuals.popup_shadow = shadow;
        visuals.text_cursor.stroke = Stroke::new(1.5, p.accent_ink);
        visuals.slider_trailing_fill = true;
        // Hinting moves the dots of semi-bold letters onto their stems at these sizes.
        visuals.text_options.font_hinting = false;
        visuals.disabled_alpha = 0.45;
        visuals
    }
}

/// Adds a face for letters that the others lack. It is used from the next frame on.
pub(crate) fn add_face(name: &str, mut face: FontData, ctx: &Context) {
    face.tweak.subpixel_binning = Some(false);
    let families = [FontFamily::Proportional, FontFamily::Monospace, strong_family()]
        .map(|family| InsertFontFamily { family, priority: FontPriority::Lowest });
    ctx.add_font(FontInsert::new(name, face, families.into()));
}

fn strong_family() -> FontFamily {
    FontFamily::Name("strong".into())
}

fn theme_id() -> Id {
    Id::unique("segue theme")
}

/// Returns the theme of a context; the default where none was installed.
pub(crate) fn theme_of(ui: &Ui) -> Theme {
    ui.ctx().data(|data| data.get_temp(theme_id())).unwrap_or_default()
}

/// Returns the colours of the installed theme.
pub(crate) fn palette_of(ui: &Ui) -> &'static Palette {
    theme_of(ui).palette()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn digits_are_tabular_in_every_step_of_the_scale() {
        let ctx = Context::default();
        Theme::default().install(&ctx);
        let mut widths = Vec::new();
        let output = ctx.run_ui(egui::RawInput::default(), |ui| {
            let steps = [
                Type::Title,
                Type::Body,
                Type::Number,
                Type::Metric,
                Type::Small,
                Type::SmallStrong,
            ];
            widths = ui.fonts_mut(|fonts| {
                let font = |step| Theme::default().font(step);
                steps
                    .map(|step| {
                        ('0'..='9')
                            .map(|digit| fonts.glyph_width(&font(step), digit))
                            .collect::<Vec<_>>()
                    })
                    .to_vec()
            });
        });
        output.drop_without_applying_deltas();
        for step in widths {
            assert!(step[0] > 0.0 && step.iter().all(|&width| width == step[0]), "{step:?}");
        }
    }

    #[test]
    fn projector_theme_enlarges_text_in_the_same_order() {
        let (desk, hall) = (Theme::default(), Theme { projector: true, ..Theme::default() });
        for step in [Type::Title, Type::Body, Type::Small, Type::Caps] {
            assert!(hall.font(step).size > desk.font(step).size);
        }
        assert!(desk.font(Type::Title).size > desk.font(Type::Body).size);
        assert!(desk.font(Type::Body).size > desk.font(Type::Small).size);
        assert!(desk.row_height() >= HIT);
        let fingers = Theme { touch: true, ..desk };
        assert!(fingers.row_height() >= 44.0 && fingers.font(Type::Body) == desk.font(Type::Body));
    }
}
