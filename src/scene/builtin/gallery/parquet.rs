//! The parquet of the rooms: blocks of oak in a herringbone pattern.

use crate::scene::{Encoding, Texture};
use glam::{DVec2, DVec3};

/// Side length of the texture in texels. It repeats every [`PERIOD`] widths of a block.
const SIDE: u32 = 256;
/// Length of a block in widths.
const LENGTH: i64 = 4;
/// Blocks along a side of the texture: the pattern repeats after twice the length of a block.
const PERIOD: f64 = (4 * LENGTH) as f64;
/// Mean sRGB colour of the wood.
const OAK: DVec3 = DVec3::new(0.72, 0.58, 0.43);

/// Returns the pattern as a texture.
pub(super) fn herringbone() -> Texture {
    let share = |i: u32| (f64::from(i) + 0.5) / f64::from(SIDE) * PERIOD;
    let texels = (0..SIDE).flat_map(|y| (0..SIDE).map(move |x| (x, y)));
    let texels = texels.map(|(x, y)| texel(DVec2::new(share(x), share(y)))).collect();
    Texture { width: SIDE, height: SIDE, texels, encoding: Encoding::Srgb }
}

fn texel(p: DVec2) -> [u8; 4] {
    let block = block_at(p);
    let tone = 1.0 + 0.10 * (random(block.number, 1) - 0.5) * 2.0;
    let warmth = DVec3::new(1.0, 1.0 - 0.03 * random(block.number, 2), 1.0 - 0.08 * random(block.number, 3));
    let phase = 6.0 * random(block.number, 4);
    let (along, across) = (block.along, block.across);
    let grain = (across * 23.0 + phase + 0.9 * (along * 2.1 + phase).sin()).sin()
        + 0.6 * (across * 47.0 - phase + 0.7 * (along * 3.3).sin()).sin();
    let to_edge = across.min(1.0 - across).min(along).min(LENGTH as f64 - along);
    let joint = if to_edge < 0.035 { 0.62 } else { 1.0 };
    let color = OAK * warmth * tone * (1.0 + 0.035 * grain) * joint;
    let [r, g, b] = color.to_array().map(|c| (c.clamp(0.0, 1.0) * 255.0).round() as u8);
    [r, g, b, 255]
}

/// A point on a block.
struct Block {
    number: i64,
    /// Distances from an end and from a side, in widths of a block.
    along: f64,
    across: f64,
}

/// Returns the block at a point: in the row `y`, blocks along x begin at `y` and every two lengths
/// after it; between them lie the ends of blocks along y.
fn block_at(p: DVec2) -> Block {
    let [x, y] = [p.x.floor() as i64, p.y.floor() as i64];
    let period = 2 * LENGTH;
    let step = (x - y).rem_euclid(period);
    let wrap = |t: i64| t.rem_euclid(PERIOD as i64);
    if step < LENGTH {
        let start = x - step;
        let number = wrap(start) * 64 + wrap(y);
        return Block { number, along: p.x - start as f64, across: p.y - y as f64 };
    }
    // In the column `x`, the block along y begins where `x - y` is the last step of its period.
    let start = y - (period - 1 - step);
    let number = 4096 + wrap(x) * 64 + wrap(start);
    Block { number, along: p.y - start as f64, across: p.x - x as f64 }
}

/// Returns a value of 0 to 1 that depends on a block.
///
/// Source: the finaliser of Steele, Lea and Flood 2014, "Fast splittable pseudorandom number
/// generators".
fn random(block: i64, salt: i64) -> f64 {
    let mut bits = (block * 16 + salt).unsigned_abs().wrapping_mul(0x9e37_79b9_7f4a_7c15);
    bits = (bits ^ bits >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    bits = (bits ^ bits >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
    (bits >> 32) as f64 / 4_294_967_296.0
}
