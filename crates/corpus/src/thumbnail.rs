//! A strip of stick figures: a clip at a glance.

use crate::CorpusError;
use glam::{Vec2, Vec3};
use png::{BitDepth, ColorType, Compression, Encoder, Filter};
use segue_motion::clip::{Clip, character_frames};
use segue_motion::skeleton::{Role, Roles, Side};

/// The number of figures in a strip.
pub const THUMBNAIL_POSES: usize = 6;
/// Width and height of a strip, pixels.
pub const THUMBNAIL_SIZE: [usize; 2] = [CELL[0] * THUMBNAIL_POSES, CELL[1]];

/// Width and height of a figure, pixels.
const CELL: [usize; 2] = [44, 48];
/// Metres above the lower edge, and metres of its height.
const HEIGHT_M: [f32; 2] = [-0.1, 2.1];
/// Half of the thickness of a bone, pixels.
const RADIUS: f32 = 0.9;
/// The angle from which the character is seen: from its left, somewhat from ahead, radians.
const VIEW_YAW: f32 = 0.96;
/// Shades of a colour, beside transparent.
const SHADES: u8 = 5;

/// Colours: the middle of the body, its left, its right.
const COLORS: [[u8; 3]; 3] = [[128, 128, 128], [226, 130, 40], [58, 132, 214]];

/// Returns a PNG of 16 colours with figures at moments that are spread evenly over a clip on the
/// standard body, each at its own place: orange is left, blue right, the background transparent.
/// They are seen from the character's left.
///
/// # Errors
/// [`CorpusError::Compress`].
pub fn thumbnail(clip: &Clip, roles: &Roles) -> Result<Vec<u8>, CorpusError> {
    let mut strip = Strip::default();
    if let Some(last) = clip.frames().checked_sub(1) {
        let frames = character_frames(clip, roles);
        let sides = sides(clip, roles);
        for cell in 0..THUMBNAIL_POSES {
            let frame = (2 * cell + 1) * last / (2 * THUMBNAIL_POSES);
            let Some(character) = frames.get(frame) else { continue };
            let points = clip.world_pose(frame).positions;
            let seen = |point: Vec3| seen(character.inverse().apply(point), cell);
            for (joint, own) in clip.skeleton().joints().iter().enumerate() {
                let Some(parent) = own.parent else { continue };
                strip.draw(seen(points[parent]), seen(points[joint]), sides[joint], cell);
            }
        }
    }
    encoded(&strip.pixels)
}

/// Returns a strip as PNG, given the numbers of its pixels' colours: four bits each.
fn encoded(pixels: &[u8]) -> Result<Vec<u8>, CorpusError> {
    let palette = palette();
    let colors: Vec<u8> = palette.iter().flat_map(|color| [color[0], color[1], color[2]]).collect();
    let opacities: Vec<u8> = palette.iter().map(|color| color[3]).collect();
    let packed: Vec<u8> = pixels.chunks_exact(2).map(|pair| pair[0] << 4 | pair[1]).collect();
    let mut bytes = Vec::new();
    let [width, height] = THUMBNAIL_SIZE.map(|size| size as u32);
    let mut encoder = Encoder::new(&mut bytes, width, height);
    encoder.set_color(ColorType::Indexed);
    encoder.set_depth(BitDepth::Four);
    encoder.set_palette(colors);
    encoder.set_trns(opacities);
    encoder.set_compression(Compression::High);
    // Neighbours are equal, or differ by an edge.
    encoder.set_filter(Filter::NoFilter);
    let mut writer = encoder.write_header()?;
    writer.write_image_data(&packed)?;
    writer.finish()?;
    Ok(bytes)
}

/// Returns the colour of every joint's bone: 0 in the middle, 1 on the left, 2 on the right.
fn sides(clip: &Clip, roles: &Roles) -> Vec<u8> {
    let joints = clip.skeleton().joints();
    let mut sides = vec![0u8; joints.len()];
    for side in Side::BOTH {
        let limbs = match side {
            Side::Left => [Role::LeftThigh, Role::LeftUpperArm],
            Side::Right => [Role::RightThigh, Role::RightUpperArm],
        };
        for first in limbs.into_iter().filter_map(|role| roles.get_within(role, joints.len())) {
            sides[first] = side.index() as u8 + 1;
        }
    }
    for (joint, own) in joints.iter().enumerate() {
        if let Some(parent) = own.parent.filter(|_| sides[joint] == 0) {
            sides[joint] = sides[parent];
        }
    }
    sides
}

/// Returns the place of a point in the character's frame, pixels.
fn seen(point: Vec3, cell: usize) -> Vec2 {
    let (sin, cos) = (libm::sinf(VIEW_YAW), libm::cosf(VIEW_YAW));
    let scale = CELL[1] as f32 / HEIGHT_M[1];
    let across = point.x * cos - point.z * sin;
    let middle = (cell as f32 + 0.5) * CELL[0] as f32;
    Vec2::new(middle - across * scale, CELL[1] as f32 - (point.y - HEIGHT_M[0]) * scale)
}

/// A picture by the numbers of its colours.
struct Strip {
    pixels: Vec<u8>,
}

impl Default for Strip {
    fn default() -> Self {
        Self { pixels: vec![0; THUMBNAIL_SIZE[0] * THUMBNAIL_SIZE[1]] }
    }
}

impl Strip {
    /// Draws a bone into its cell. A pixel keeps the stronger of two shades.
    fn draw(&mut self, from: Vec2, to: Vec2, color: u8, cell: usize) {
        if !(from.is_finite() && to.is_finite()) {
            return;
        }
        let [left, right] = [cell, cell + 1].map(|cell| cell * CELL[0]);
        let (least, most) = (from.min(to) - RADIUS - 1.0, from.max(to) + RADIUS + 1.0);
        let columns = (least.x.max(left as f32) as usize)..(most.x.max(0.0) as usize).min(right);
        let rows = (least.y.max(0.0) as usize)..(most.y.max(0.0) as usize).min(CELL[1]);
        let along = to - from;
        for row in rows {
            for column in columns.clone() {
                let point = Vec2::new(column as f32 + 0.5, row as f32 + 0.5);
                let share = (point - from).dot(along) / along.length_squared().max(1e-6);
                let away = (from + along * share.clamp(0.0, 1.0)).distance(point);
                let cover = (RADIUS + 0.5 - away).clamp(0.0, 1.0);
                let shade = (cover * f32::from(SHADES)).round() as u8;
                let pixel = &mut self.pixels[row * THUMBNAIL_SIZE[0] + column];
                let before = if *pixel == 0 { 0 } else { (*pixel - 1) % SHADES + 1 };
                if shade > before {
                    *pixel = color * SHADES + shade;
                }
            }
        }
    }
}

/// Returns the colours by their numbers, with their opacities.
fn palette() -> Vec<[u8; 4]> {
    let shades = |color: [u8; 3]| {
        (1..=SHADES).map(move |shade| {
            let opacity = u32::from(shade) * 255 / u32::from(SHADES);
            [color[0], color[1], color[2], opacity as u8]
        })
    };
    std::iter::once([0; 4]).chain(COLORS.into_iter().flat_map(shades)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::StandardBody;
    use segue_motion::clip::Motion;
    use segue_motion::synth::{Action, Params, synthesize};

    /// Returns the size of a strip, and the numbers of its pixels' colours.
    fn decoded(bytes: &[u8]) -> ([usize; 2], Vec<u8>) {
        let mut decoder = png::Decoder::new(std::io::Cursor::new(bytes));
        decoder.set_transformations(png::Transformations::IDENTITY);
        let mut reader = decoder.read_info().unwrap();
        let mut packed = vec![0; reader.output_buffer_size().unwrap()];
        let info = reader.next_frame(&mut packed).unwrap();
        assert_eq!((info.color_type, info.bit_depth), (ColorType::Indexed, BitDepth::Four));
        let pixels = packed.iter().flat_map(|pair| [pair >> 4, pair & 15]).collect();
        ([info.width, info.height].map(|size| size as usize), pixels)
    }

    #[test]
    fn strip_shows_six_figures_with_both_sides() {
        let body = StandardBody::new().unwrap();
        let walk = Motion::analyze(synthesize(&Params::new(Action::Walk)).unwrap().clip);
        let placed = body.place(&walk).unwrap();
        let bytes = thumbnail(&placed.clip, body.roles()).unwrap();
        assert!(bytes.len() < 3_000, "{}", bytes.len());
        let (size, pixels) = decoded(&bytes);
        assert_eq!(size, THUMBNAIL_SIZE);
        for cell in 0..THUMBNAIL_POSES {
            let count = |color: u8| {
                let own = |(place, pixel): &(usize, &u8)| {
                    place % size[0] / CELL[0] == cell
                        && **pixel > color * SHADES
                        && **pixel <= (color + 1) * SHADES
                };
                pixels.iter().enumerate().filter(own).count()
            };
            assert!((0..3).all(|color| count(color) > 20), "{cell}: {:?}", [0, 1, 2].map(count));
        }
        assert_eq!(thumbnail(&placed.clip, body.roles()).unwrap(), bytes);
    }
}
