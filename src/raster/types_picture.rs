//! The picture of how each pixel came to its colour. Told apart by colour-blind people, and in grey.

/// Type 1: reused.
pub const TYPE1_SRGB: [u8; 3] = [0x00, 0x72, 0xb2];

/// Type 2: mirror or glass.
pub const TYPE2_SRGB: [u8; 3] = [0xf0, 0xe4, 0x42];

/// Type 3: traced.
pub const TYPE3_SRGB: [u8; 3] = [0xd5, 0x5e, 0x00];

/// The colour of a pixel's type, by the paper's number. Exactly one of three, never a blend.
pub fn type_color(number: u8) -> [u8; 3] {
    match number {
        1 => TYPE1_SRGB,
        2 => TYPE2_SRGB,
        _ => TYPE3_SRGB,
    }
}
