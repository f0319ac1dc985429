//! DDS pictures without compression, of which the decoder of the `image` crate reads none.
//!
//! Source: "Programming Guide for DDS", Microsoft: the header DDS_HEADER and DDS_PIXELFORMAT.

use image::RgbaImage;

/// Bytes before the pixels: a word that names the format, and the header.
const HEADER_BYTES: usize = 128;

/// Flags of the pixel format: alpha, grey and colours without compression.
const ALPHA: u32 = 0x1;
const RGB: u32 = 0x40;
const LUMINANCE: u32 = 0x2_0000;

/// Format of uncompressed pixels.
struct Plain {
    width: u32,
    height: u32,
    bytes_per_pixel: usize,
    /// Bits of red, green, blue and alpha within a pixel; zero for a channel that is not there.
    masks: [u32; 4],
}

impl Plain {
    /// Returns the format of a file; `None` for other files.
    fn of(bytes: &[u8]) -> Option<Self> {
        if bytes.len() < HEADER_BYTES || !bytes.starts_with(b"DDS ") {
            return None;
        }
        let word = |at: usize| {
            let four = bytes.get(at..at + 4).and_then(|four| four.try_into().ok());
            four.map_or(0, u32::from_le_bytes)
        };
        let (flags, bits) = (word(80), word(88));
        let [r, g, b, a] = [92, 96, 100, 104].map(word);
        let a = if flags & ALPHA != 0 { a } else { 0 };
        let masks = match flags {
            _ if flags & RGB != 0 => [r, g, b, a],
            _ if flags & LUMINANCE != 0 => [r, r, r, a],
            _ => return None,
        };
        let is_known = matches!(bits, 8 | 16 | 24 | 32);
        let format = Self { width: word(16), height: word(12), bytes_per_pixel: bits as usize / 8, masks };
        is_known.then_some(format)
    }
}

/// Returns width and height of an uncompressed DDS file; `None` for other files.
pub(super) fn plain_size(bytes: &[u8]) -> Option<(u32, u32)> {
    Plain::of(bytes).map(|format| (format.width, format.height))
}

/// Returns the first picture of an uncompressed DDS file; `None` for other files. Pixels that are
/// missing at the end are black.
pub(super) fn plain(bytes: &[u8]) -> Option<RgbaImage> {
    let format = Plain::of(bytes)?;
    let pixels = bytes[HEADER_BYTES..].chunks_exact(format.bytes_per_pixel);
    let mut raw = Vec::new();
    let count = (format.width as usize).checked_mul(format.height as usize)?;
    raw.try_reserve_exact(count.checked_mul(4)?).ok()?;
    for pixel in pixels.take(count) {
        let word = pixel.iter().rev().fold(0u32, |word, byte| word << 8 | u32::from(*byte));
        raw.extend(format.masks.map(|mask| channel(word, mask)));
        if let (0, Some(alpha)) = (format.masks[3], raw.last_mut()) {
            *alpha = 255;
        }
    }
    raw.resize(count * 4, 0);
    RgbaImage::from_raw(format.width, format.height, raw)
}

/// Returns the bits of a mask, scaled to 8 bits.
fn channel(word: u32, mask: u32) -> u8 {
    if mask == 0 {
        return 0;
    }
    let shift = mask.trailing_zeros();
    let (value, most) = (u64::from((word & mask) >> shift), u64::from(mask >> shift));
    ((value * 255 + most / 2) / most) as u8
}
