//! Filters, which are applied to decoded elements.

/// How elements were changed before they were compressed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::import::gltf) enum Filter {
    None,
    /// Unit vectors on an octahedron.
    Octahedral,
    /// Rotations without their largest component.
    Quaternion,
    /// Numbers of 24 bits with an exponent.
    Exponential,
    /// Colours as luma and two differences.
    Color,
}

impl Filter {
    /// Returns the filter of a name in a file.
    pub(in crate::import::gltf) fn of(name: &str) -> Option<Self> {
        match name {
            "NONE" => Some(Self::None),
            "OCTAHEDRAL" => Some(Self::Octahedral),
            "QUATERNION" => Some(Self::Quaternion),
            "EXPONENTIAL" => Some(Self::Exponential),
            "COLOR" => Some(Self::Color),
            _ => None,
        }
    }

    /// True where the filter is defined for elements of this size in bytes.
    pub(super) fn fits(self, stride: usize) -> bool {
        match self {
            Self::None | Self::Exponential => true,
            Self::Octahedral | Self::Color => matches!(stride, 4 | 8),
            Self::Quaternion => stride == 8,
        }
    }

    /// Changes elements back to what they were.
    pub(super) fn apply(self, elements: &mut [u8], stride: usize) {
        match self {
            Self::None => {}
            Self::Exponential => elements.as_chunks_mut().0.iter_mut().for_each(exponential),
            Self::Quaternion => elements.as_chunks_mut().0.iter_mut().for_each(quaternion),
            Self::Octahedral if stride == 4 => {
                for element in elements.as_chunks_mut::<4>().0 {
                    let [x, y, z] = octahedral([0, 1, 2].map(|i| f32::from(element[i] as i8)));
                    let byte = |value: f32| (value * 127.0).round() as i8 as u8;
                    *element = [byte(x), byte(y), byte(z), element[3]];
                }
            }
            Self::Octahedral => {
                for element in elements.as_chunks_mut::<8>().0 {
                    let [x, y, one, rest] = words(element);
                    let unit = octahedral([x, y, one].map(|word| f32::from(word as i16)));
                    let [x, y, z] = unit.map(|value| (value * 32_767.0).round() as i16 as u16);
                    *element = bytes([x, y, z, rest]);
                }
            }
            Self::Color if stride == 4 => {
                for element in elements.as_chunks_mut::<4>().0 {
                    let [y, co, cg, a] = *element;
                    let color = color(y.into(), (co as i8).into(), (cg as i8).into(), a.into());
                    *element = color.map(|value| (value * 255.0).round() as u8);
                }
            }
            Self::Color => {
                for element in elements.as_chunks_mut::<8>().0 {
                    let [y, co, cg, a] = words(element);
                    let color = color(y.into(), (co as i16).into(), (cg as i16).into(), a.into());
                    *element = bytes(color.map(|value| (value * 65_535.0).round() as u16));
                }
            }
        }
    }
}

fn words(element: &[u8; 8]) -> [u16; 4] {
    [0, 2, 4, 6].map(|i| u16::from_le_bytes([element[i], element[i + 1]]))
}

fn bytes(words: [u16; 4]) -> [u8; 8] {
    let mut bytes = [0; 8];
    for (pair, word) in bytes.as_chunks_mut().0.iter_mut().zip(words) {
        *pair = word.to_le_bytes();
    }
    bytes
}

/// Returns the unit vector of a point of the octahedron, whose third value stands for one.
fn octahedral([x, y, one]: [f32; 3]) -> [f32; 3] {
    let (x, y) = (x / one, y / one);
    let z = 1.0 - x.abs() - y.abs();
    // The lower half is folded outwards.
    let fold = z.min(0.0);
    let (x, y) = (x - fold.copysign(x), y - fold.copysign(y));
    let length = (x * x + y * y + z * z).sqrt();
    [x / length, y / length, z / length]
}

fn quaternion(element: &mut [u8; 8]) {
    let stored = words(element);
    let one = f32::from((stored[3] | 3) as i16);
    let scale = std::f32::consts::FRAC_1_SQRT_2;
    let [x, y, z] = [0, 1, 2].map(|i| f32::from(stored[i] as i16) / one * scale);
    let w = (1.0 - x * x - y * y - z * z).max(0.0).sqrt();
    let largest = usize::from(stored[3] & 3);
    let mut rotation = [0; 4];
    for (i, value) in [w, x, y, z].into_iter().enumerate() {
        rotation[(largest + i) % 4] = (value * 32_767.0).round() as i16 as u16;
    }
    *element = bytes(rotation);
}

fn exponential(element: &mut [u8; 4]) {
    let bits = i32::from_le_bytes(*element);
    let (exponent, mantissa) = (bits >> 24, (bits << 8) >> 8);
    let value = f64::from(mantissa) * 2f64.powi(exponent);
    *element = (value as f32).to_le_bytes();
}

/// Returns red, green, blue and alpha from 0 to 1. The highest bit of alpha says how many bits the
/// values have.
fn color(y: u32, co: i32, cg: i32, alpha: u32) -> [f32; 4] {
    let most = match alpha.checked_ilog2() {
        Some(bit) => (2 << bit) - 1,
        None => 1,
    };
    let (y, low) = (y as i32, alpha & (most >> 1));
    let alpha = ((low << 1) | (low & 1)) as i32;
    let [red, green, blue] = [y + co - cg, y + cg, y - co - cg];
    [red, green, blue, alpha].map(|value| value as f32 / most as f32)
}
