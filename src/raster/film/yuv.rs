//! Display colour as the luma and chroma of a film: 8 bits, 4:2:0, BT.709, limited range.
//!
//! Source: Recommendation ITU-R BT.709-6, items 3.2 to 3.5. Every sample is the exact value rounded
//! to the nearest integer, half up: the arithmetic is that of fractions, without floating point.

use rayon::prelude::*;

/// A picture as planes of samples, row-major from the top. Chroma has half the width and height.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Yuv420 {
    /// Width and height in pixels, both even.
    pub size: [u32; 2],
    /// Luma, 16 (black) to 235 (white).
    pub luma: Vec<u8>,
    /// Difference of blue from luma, 16 to 240; 128 is grey. A sample lies at the even columns of
    /// luma, between two rows.
    pub blue: Vec<u8>,
    /// Difference of red from luma, as [`Self::blue`].
    pub red: Vec<u8>,
}

/// Weights of red, green and blue in luma; together they are [`ONE`].
const LUMA: [u64; 3] = [2126, 7152, 722];

const ONE: u64 = 10_000;

/// Value of white, or of a primary, in 8 bits.
const FULL: u64 = 255;

/// Steps of 8-bit luma from black to white, and of chroma from one end to the other.
const LUMA_STEPS: u64 = 219;
const CHROMA_STEPS: u64 = 224;

/// Sum of the weights by which pixels are averaged to a sample of chroma: 1, 2, 1 in each of two
/// rows.
const CHROMA_WEIGHTS: u64 = 8;

impl Yuv420 {
    /// Converts 8-bit sRGB colours, row-major from the top. Both sides must be even; missing pixels
    /// are black.
    ///
    /// The colours are those that a display shows, and stay as they are: only their sums and
    /// differences are taken. Chroma is averaged over the three columns around its place and two
    /// rows; beyond the left edge, the first column counts again.
    pub fn of_srgb(size: [u32; 2], srgb: &[[u8; 3]]) -> Self {
        let [width, height] = size.map(|side| side as usize);
        let (half, chroma) = (width / 2, width * height / 4);
        let mut yuv =
            Self { size, luma: vec![16; width * height], blue: vec![128; chroma], red: vec![128; chroma] };
        let pairs = yuv.luma.par_chunks_exact_mut(2 * width.max(1));
        let pairs = pairs.zip(yuv.blue.par_chunks_exact_mut(half.max(1)));
        let pairs = pairs.zip(yuv.red.par_chunks_exact_mut(half.max(1)));
        let pairs = pairs.zip(srgb.par_chunks_exact(2 * width.max(1)));
        pairs.for_each(|(((luma, blue), red), rows)| {
            luma.iter_mut().zip(rows).for_each(|(luma, color)| *luma = luma_of(*color));
            let (upper, lower) = rows.split_at(width);
            for (column, (blue, red)) in blue.iter_mut().zip(red).enumerate() {
                let sum = around(upper, 2 * column, around(lower, 2 * column, [0; 3]));
                (*blue, *red) = (difference(sum, 2), difference(sum, 0));
            }
        });
        yuv
    }
}

/// Adds the colours of a row around a column, weighted by 1, 2 and 1.
fn around(row: &[[u8; 3]], column: usize, mut sum: [u64; 3]) -> [u64; 3] {
    for (at, weight) in [(column.saturating_sub(1), 1), (column, 2), (column + 1, 1)] {
        for (sum, channel) in sum.iter_mut().zip(row[at]) {
            *sum += weight * u64::from(channel);
        }
    }
    sum
}

/// Luma of colours that were added, times [`ONE`].
fn weighted(color: [u64; 3]) -> u64 {
    color.iter().zip(LUMA).map(|(channel, weight)| channel * weight).sum()
}

fn luma_of(color: [u8; 3]) -> u8 {
    const DIVISOR: u64 = ONE * FULL;
    (16 + (LUMA_STEPS * weighted(color.map(u64::from)) + DIVISOR / 2) / DIVISOR) as u8
}

/// Difference of one channel from luma, of a colour that was added [`CHROMA_WEIGHTS`] times.
fn difference(sum: [u64; 3], channel: usize) -> u8 {
    // A primary and its complement differ from their luma by this part of white.
    let reach = 2 * (ONE - LUMA[channel]);
    let divisor = reach * FULL * CHROMA_WEIGHTS;
    // 128 is added first, so that nothing is negative.
    ((128 * divisor + divisor / 2 + CHROMA_STEPS * ONE * sum[channel] - CHROMA_STEPS * weighted(sum))
        / divisor) as u8
}
