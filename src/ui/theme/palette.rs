//! Every colour of the app, by role, once for dark and once for light.

use eframe::egui::Color32;

/// The colours of one theme, named by meaning.
///
/// A is warm, B is cool, and their result has the accent. For each of them there is a *fill* (bars,
/// curves, handles), an *ink* (the same hue, dark or light enough to be read as text on panels),
/// and a colour of text on the fill.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Palette {
    /// The ground of the page and of the stage.
    pub(crate) ground: Color32,
    /// The panels: top bar, library, parameters, timeline.
    pub(crate) panel: Color32,
    /// Controls on a panel: buttons, wells of segmented controls, menus.
    pub(crate) panel_raised: Color32,
    /// A raised control, or a row of a list, under the pointer.
    pub(crate) hover: Color32,
    /// A raised control pressed or chosen.
    pub(crate) pressed: Color32,
    /// Hairlines between panels and rows, and the outline of controls.
    pub(crate) line: Color32,
    /// Outlines that are the control itself: the dashed drop zone, a switch that is off, a mark on
    /// a track.
    pub(crate) line_strong: Color32,
    /// The empty part of a slider's or a progress bar's track.
    pub(crate) track: Color32,
    /// Primary text.
    pub(crate) text: Color32,
    /// Units, help and second lines; AA on every panel.
    pub(crate) muted: Color32,
    /// The first clip: warm.
    pub(crate) a: Color32,
    /// The first clip as text on a panel.
    pub(crate) a_ink: Color32,
    /// Text on [`Self::a`].
    pub(crate) on_a: Color32,
    /// The second clip: cool.
    pub(crate) b: Color32,
    /// The second clip as text on a panel.
    pub(crate) b_ink: Color32,
    /// Text on [`Self::b`].
    pub(crate) on_b: Color32,
    /// The result and values that are set: curves, the filled part of a slider, the focus ring.
    pub(crate) accent: Color32,
    /// The accent as text on a panel.
    pub(crate) accent_ink: Color32,
    /// The fill of the primary button and of a switch that is on.
    pub(crate) accent_fill: Color32,
    /// Text on [`Self::accent_fill`].
    pub(crate) accent_text: Color32,
    /// The accent as a quiet ground: chips, the transition across the timeline. Translucent.
    pub(crate) accent_wash: Color32,
    /// Success, as text: the best of several.
    pub(crate) good: Color32,
    /// Failure, as text: the worst of several, an error.
    pub(crate) bad: Color32,
    /// [`Self::bad`] as a quiet ground. Translucent.
    pub(crate) bad_wash: Color32,
    /// A warning, as text and icon: unusual input that was read.
    pub(crate) warning: Color32,
    /// [`Self::warning`] as a quiet ground. Translucent.
    pub(crate) warning_wash: Color32,
    /// The round handle of a slider and the play button.
    pub(crate) handle: Color32,
    /// The icon on [`Self::handle`].
    pub(crate) on_handle: Color32,
    /// Extra characters: neither A, B nor the result.
    pub(crate) others: [Color32; 4],
    /// Shadows. Translucent.
    pub(crate) shadow: Color32,
    /// Distances, from near to far. The nearest have the ground's colour, so that curves stand out
    /// in the valleys.
    pub(crate) heat: [Color32; 5],
    /// The opacity of a ghost, 0..=1.
    pub(crate) ghost_alpha: f32,
    /// Colours of the 3D stage that panels do not have.
    pub(crate) stage: StagePalette,
}

/// The colours of the stage (sRGB).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct StagePalette {
    /// The background at the top of a pane.
    pub(crate) sky: Color32,
    /// The lightest part of the background, behind the body.
    pub(crate) horizon: Color32,
    /// The ground plane near the body.
    pub(crate) ground: Color32,
    /// Fine lines of the grid.
    pub(crate) grid: Color32,
    /// Every fifth line of the grid.
    pub(crate) grid_major: Color32,
    /// The body.
    pub(crate) clay: Color32,
    /// The line around each limb.
    pub(crate) clay_outline: Color32,
    /// The darkness of the body's shadow on the ground, 0..=1.
    pub(crate) shadow_alpha: f32,
}

/// Returns an opaque colour of `0xrrggbb`.
const fn hex(rgb: u32) -> Color32 {
    let [_, r, g, b] = rgb.to_be_bytes();
    Color32::from_rgb(r, g, b)
}

/// Returns a colour of `0xrrggbb` with an opacity out of 255, premultiplied in gamma space
/// as egui blends.
const fn wash(rgb: u32, alpha: u8) -> Color32 {
    let [_, r, g, b] = rgb.to_be_bytes();
    let alpha_wide = alpha as u16;
    Color32::from_rgba_premultiplied(
        (r as u16 * alpha_wide / 255) as u8,
        (g as u16 * alpha_wide / 255) as u8,
        (b as u16 * alpha_wide / 255) as u8,
        alpha,
    )
}

/// Light on dark, the usual palette.
pub(crate) const DARK: Palette = Palette {
    ground: hex(0x0f_1115),
    panel: hex(0x15_181e),
    panel_raised: hex(0x1b_1f27),
    hover: hex(0x20_252e),
    pressed: hex(0x2a_303b),
    line: hex(0x26_2b35),
    line_strong: hex(0x3d_4553),
    track: hex(0x2a_2f39),
    text: hex(0xe8_eaf0),
    muted: hex(0x93_9bab),
    a: hex(0xf2_a35e),
    a_ink: hex(0xf2_a35e),
    on_a: hex(0x2a_1703),
    b: hex(0x5f_a8f5),
    b_ink: hex(0x6f_b1f7),
    on_b: hex(0x05_1a33),
    accent: hex(0x58_d6a9),
    accent_ink: hex(0x58_d6a9),
    accent_fill: hex(0x58_d6a9),
    accent_text: hex(0x04_2018),
    accent_wash: wash(0x58_d6a9, 36),
    good: hex(0x58_d6a9),
    bad: hex(0xff_7a6b),
    bad_wash: wash(0xff_7a6b, 34),
    warning: hex(0xf0_c05a),
    warning_wash: wash(0xf0_c05a, 30),
    handle: hex(0xe8_eaf0),
    on_handle: hex(0x15_181e),
    others: [hex(0x5f_a8f5), hex(0xc0_8df0), hex(0xf0_8fb4), hex(0xa9_c75a)],
    shadow: wash(0x00_0000, 110),
    heat: [hex(0x0c_0e13), hex(0x20_2b45), hex(0x47_4a80), hex(0x8f_6496), hex(0xd9_a394)],
    ghost_alpha: 0.42,
    stage: StagePalette {
        sky: hex(0x0f_1115),
        horizon: hex(0x1a_1e26),
        ground: hex(0x12_151a),
        grid: hex(0x23_2832),
        grid_major: hex(0x30_3743),
        clay: hex(0xc9_cedb),
        clay_outline: hex(0x4b_5262),
        shadow_alpha: 0.55,
    },
};

/// Dark on light: for bright rooms and paper.
pub(crate) const LIGHT: Palette = Palette {
    ground: hex(0xee_f0f4),
    panel: hex(0xff_ffff),
    panel_raised: hex(0xf4_f6f9),
    hover: hex(0xec_eff4),
    pressed: hex(0xe0_e5ec),
    line: hex(0xdf_e3ea),
    line_strong: hex(0xb4_bcc9),
    track: hex(0xdd_e1e9),
    text: hex(0x1b_2030),
    muted: hex(0x5c_6577),
    a: hex(0xe0_8a3e),
    a_ink: hex(0xa3_530c),
    on_a: hex(0x2a_1703),
    b: hex(0x4a_93e4),
    b_ink: hex(0x1c_62b0),
    on_b: hex(0x04_152b),
    accent: hex(0x16_9d72),
    accent_ink: hex(0x0c_7555),
    accent_fill: hex(0x0d_7a58),
    accent_text: hex(0xff_ffff),
    accent_wash: wash(0x16_9d72, 30),
    good: hex(0x0c_7555),
    bad: hex(0xc0_3526),
    bad_wash: wash(0xd6_483a, 24),
    warning: hex(0x85_5d00),
    warning_wash: wash(0xe0_a81c, 36),
    handle: hex(0x1b_2030),
    on_handle: hex(0xff_ffff),
    others: [hex(0x2f_7fd6), hex(0x8a_52cc), hex(0xc4_4f82), hex(0x66_8512)],
    shadow: wash(0x1b_2030, 44),
    heat: [hex(0xff_ffff), hex(0xd6_e0f2), hex(0xa8_a9d8), hex(0x8b_62a4), hex(0x55_2a5b)],
    ghost_alpha: 0.34,
    stage: StagePalette {
        sky: hex(0xf4_f6f9),
        horizon: hex(0xe6_e9ef),
        ground: hex(0xe9_ecf1),
        grid: hex(0xd3_d8e1),
        grid_major: hex(0xbf_c6d2),
        clay: hex(0x93_9ab0),
        clay_outline: hex(0xe8_ebf1),
        shadow_alpha: 0.28,
    },
};

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns the relative luminance, WCAG 2.2.
    fn luminance(color: Color32) -> f64 {
        let channel = |value: u8| {
            let value = f64::from(value) / 255.0;
            if value <= 0.040_45 { value / 12.92 } else { ((value + 0.055) / 1.055).powf(2.4) }
        };
        0.2126 * channel(color.r()) + 0.7152 * channel(color.g()) + 0.0722 * channel(color.b())
    }

    /// Returns the contrast ratio of two opaque colours, WCAG 2.2: 1 (none) to 21 (black on white).
    fn contrast(one: Color32, other: Color32) -> f64 {
        let (one, other) = (luminance(one), luminance(other));
        (one.max(other) + 0.05) / (one.min(other) + 0.05)
    }

    /// Returns a translucent colour blended onto an opaque one, as egui does (premultiplied, in
    /// gamma space).
    fn over(top: Color32, under: Color32) -> Color32 {
        under.blend(top)
    }

    fn themes() -> [(&'static str, Palette); 2] {
        [("dark", DARK), ("light", LIGHT)]
    }

    #[test]
    fn contrast_is_the_standards() {
        assert!((contrast(Color32::BLACK, Color32::WHITE) - 21.0).abs() < 1e-9);
        // #767676 on white is the lightest grey that passes AA: 4.54.
        assert!((contrast(hex(0x76_7676), Color32::WHITE) - 4.54).abs() < 0.01);
    }

    #[test]
    fn text_reaches_aa_on_its_grounds() {
        for (theme, p) in themes() {
            let mut pairs = Vec::new();
            let inks = [
                ("text", p.text),
                ("muted", p.muted),
                ("a", p.a_ink),
                ("b", p.b_ink),
                ("accent", p.accent_ink),
                ("good", p.good),
                ("bad", p.bad),
                ("warning", p.warning),
            ];
            let grounds = [
                ("ground", p.ground),
                ("panel", p.panel),
                ("raised", p.panel_raised),
                ("hover", p.hover),
                ("sky", p.stage.sky),
                ("horizon", p.stage.horizon),
            ];
            for (ink_name, ink) in inks {
                pairs.extend(grounds.iter().map(|&(name, under)| (ink_name, ink, name, under)));
            }
            pairs.extend([
                ("text", p.text, "pressed", p.pressed),
                // An automatic value on a card, and a selected formula.
                ("accent", p.accent_ink, "its wash, raised", over(p.accent_wash, p.panel_raised)),
                ("on a", p.on_a, "a", p.a),
                ("on b", p.on_b, "b", p.b),
                ("accent text", p.accent_text, "accent fill", p.accent_fill),
                ("on handle", p.on_handle, "handle", p.handle),
                ("accent", p.accent_ink, "its wash", over(p.accent_wash, p.panel)),
                ("accent", p.accent_ink, "its wash on the stage", over(p.accent_wash, p.stage.sky)),
                ("bad", p.bad, "its wash", over(p.bad_wash, p.panel)),
                ("warning", p.warning, "its wash", over(p.warning_wash, p.panel)),
                ("text", p.text, "warning wash", over(p.warning_wash, p.panel_raised)),
            ]);
            for (ink_name, ink, under_name, under) in pairs {
                let ratio = contrast(ink, under);
                assert!(ratio >= 4.5, "{theme}: {ink_name} on {under_name} is {ratio:.2}");
            }
        }
    }

    #[test]
    fn controls_reach_a_contrast_of_3_on_panels() {
        // WCAG 1.4.11: the parts that identify a control reach a contrast of 3.
        for (theme, p) in themes() {
            for (name, fill) in [
                ("accent", p.accent),
                ("handle", p.handle),
                ("accent fill", p.accent_fill),
                ("other", p.others[0]),
                ("other", p.others[1]),
                ("other", p.others[2]),
                ("other", p.others[3]),
            ] {
                let ratio = contrast(fill, p.panel);
                assert!(ratio >= 3.0, "{theme}: {name} on panel is {ratio:.2}");
            }
        }
    }

    #[test]
    fn colours_of_a_are_warm_and_of_b_cool() {
        for (_, p) in themes() {
            assert!(p.a.r() > p.a.b() && p.b.b() > p.b.r());
        }
    }
}
