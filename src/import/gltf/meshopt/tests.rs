//! Views encoded by the encoder of the extensions' author (meshoptimizer), with what its decoder
//! returns; and damaged ones.

use super::{Filter, Layout, Mode, decode};

/// A line each: kind, name, count, stride, filter, encoded bytes, decoded bytes.
const VIEWS: &str = include_str!("../../../../tests/data/meshopt.txt");

struct View {
    name: String,
    layout: Layout,
    encoded: Vec<u8>,
    decoded: Vec<u8>,
}

fn bytes(hex: &str) -> Vec<u8> {
    (0..hex.len() / 2).map(|i| u8::from_str_radix(&hex[2 * i..2 * i + 2], 16).unwrap()).collect()
}

fn views() -> Vec<View> {
    let view = |line: &str| {
        let words: Vec<&str> = line.split(' ').collect();
        let mode = match words[0] {
            "A" => Mode::Attributes,
            "T" => Mode::Triangles,
            _ => Mode::Indices,
        };
        let [count, stride] = [words[2], words[3]].map(|number| number.parse().unwrap());
        let layout = Layout { mode, filter: Filter::of(words[4]).unwrap(), count, stride };
        View { name: words[1].to_owned(), layout, encoded: bytes(words[5]), decoded: bytes(words[6]) }
    };
    VIEWS.lines().map(view).collect()
}

/// Triangles may begin with another corner.
fn sorted(layout: &Layout, bytes: &[u8]) -> Vec<u8> {
    let mut bytes = bytes.to_vec();
    if layout.mode == Mode::Triangles {
        for triangle in bytes.chunks_exact_mut(3 * layout.stride) {
            let mut corners: Vec<&[u8]> = triangle.chunks_exact(layout.stride).collect();
            let first = (0..3).min_by_key(|i| corners[*i]).unwrap();
            corners.rotate_left(first);
            triangle.copy_from_slice(&corners.concat());
        }
    }
    bytes
}

/// Filters are exact to one unit in the last place of what they return.
fn is_close(filter: Filter, stride: usize, a: &[u8], b: &[u8]) -> bool {
    let is_near = |a: u32, b: u32, bits: u32| {
        let distance = a.wrapping_sub(b) & ((1 << bits) - 1);
        distance <= 1 || distance == (1 << bits) - 1
    };
    match filter {
        Filter::None | Filter::Exponential => a == b,
        _ if stride == 4 => a.iter().zip(b).all(|(a, b)| is_near((*a).into(), (*b).into(), 8)),
        _ => a
            .as_chunks()
            .0
            .iter()
            .zip(b.as_chunks().0)
            .all(|(a, b)| is_near(u16::from_le_bytes(*a).into(), u16::from_le_bytes(*b).into(), 16)),
    }
}

#[test]
fn views_are_decoded_as_by_the_decoder_of_the_author() {
    for View { name, layout, encoded, decoded } in views() {
        let found = decode(&encoded, &layout).unwrap_or_else(|| panic!("{name} is not decoded"));
        let (found, expected) = (sorted(&layout, &found), sorted(&layout, &decoded));
        assert_eq!(found.len(), expected.len(), "{name}");
        assert!(is_close(layout.filter, layout.stride, &found, &expected), "{name}");
    }
}

#[test]
fn truncated_views_are_refused() {
    for View { name, layout, encoded, .. } in views() {
        for length in 0..encoded.len() {
            assert!(decode(&encoded[..length], &layout).is_none(), "{name}, {length} bytes");
        }
    }
}

/// Any byte may be anything, and any size may be claimed: what is returned has that size, and is
/// within the largest ratio of the format.
#[test]
fn damaged_views_never_grow() {
    for View { layout, encoded, .. } in views() {
        for at in 0..encoded.len() {
            for flip in [1, 0x80, 0xFF] {
                let mut damaged = encoded.clone();
                damaged[at] ^= flip;
                for count in [0, 1, layout.count, layout.count * 7 + 3, usize::MAX / 512] {
                    for stride in [0, 1, 2, 4, 8, 256, 1 << 40] {
                        let found = decode(&damaged, &Layout { count, stride, ..layout });
                        let is_bounded = |bytes: &Vec<u8>| {
                            bytes.len() == count * stride && bytes.len() <= 1024 * encoded.len()
                        };
                        assert!(found.as_ref().is_none_or(is_bounded));
                    }
                }
            }
        }
    }
}

/// The example in the text of the extension.
#[test]
fn the_example_of_the_specification_is_decoded() {
    let group = bytes("175ff0bc77a9210034b5");
    let deltas: [i8; 16] = [-1, -4, -3, 26, -91, 0, -6, 6, -4, -4, 5, -5, 1, -1, 0, 0];
    // Version 0, elements of four bytes: the first has the group, the others are zero.
    let mut encoded = vec![0xA0, 2];
    encoded.extend(group);
    encoded.extend([0, 0, 0]);
    encoded.extend([0; 32]);
    let layout = Layout { mode: Mode::Attributes, filter: Filter::None, count: 16, stride: 4 };
    let decoded = decode(&encoded, &layout).unwrap();
    let mut sum = 0i8;
    for (element, delta) in decoded.chunks_exact(4).zip(deltas) {
        sum = sum.wrapping_add(delta);
        assert_eq!(element, [sum as u8, 0, 0, 0]);
    }
}
