//! The rectangle of a pane.

/// A rectangle in physical pixels, from the top left corner of its stage.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[expect(missing_docs, reason = "the names say it all")]
pub struct Viewport {
    pub x: u32,
    pub y: u32,
    pub width: u32,
    pub height: u32,
}

impl Viewport {
    /// Returns width over height; 1 for an empty rectangle.
    #[must_use]
    pub fn aspect(&self) -> f32 {
        if self.width == 0 || self.height == 0 {
            1.0
        } else {
            self.width as f32 / self.height as f32
        }
    }

    /// Returns width and height as a vector, pixels.
    #[must_use]
    pub fn size(&self) -> glam::Vec2 {
        glam::Vec2::new(self.width as f32, self.height as f32)
    }

    /// Returns `count` rectangles side by side in a stage of the given size, `gap` pixels apart.
    pub fn columns(width: u32, height: u32, count: u32, gap: u32) -> impl Iterator<Item = Self> {
        let count = count.max(1);
        let inner = width.saturating_sub(gap * (count - 1));
        (0..count).map(move |i| {
            let start = inner * i / count;
            Self { x: start + gap * i, y: 0, width: inner * (i + 1) / count - start, height }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_of_any_number_fill_the_stage() {
        let panes: Vec<_> = Viewport::columns(1000, 500, 3, 2).collect();
        assert_eq!(panes.len(), 3);
        assert_eq!(panes[2].x + panes[2].width, 1000);
        assert!(panes.windows(2).all(|p| p[0].x + p[0].width + 2 == p[1].x));
        assert_eq!(Viewport::columns(0, 0, 3, 2).map(|v| v.width).sum::<u32>(), 0);
    }
}
