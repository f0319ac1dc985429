//! Sample points that are well spread over the samples of a pixel, over neighbouring pixels, and in
//! every pair of dimensions.
//!
//! Source: the first two dimensions of Sobol's sequence, Owen-scrambled by hashing and padded
//! (Burley, "Practical Hash-based Owen Scrambling", JCGT 2020); pixels are numbered along a Morton
//! curve, so that the samples of a square of pixels form one stretch of the sequence (Ahmed and
//! Wonka, "Screen-Space Blue-Noise Diffusion of Monte Carlo Sampling Error", ACM TOG 2020). We
//! differ: the curve covers squares of 128 pixels, each with a scrambling of its own, so that an
//! index has 32 bits.

use super::key::{Key, unit_interval};

/// Bits per axis of a pixel's place in its square.
const SQUARE_BITS: u32 = 7;

/// Largest number of samples of a pixel whose points are spread over neighbouring pixels too.
const MAX_SHARED_SAMPLES: u32 = 1 << (32 - 2 * SQUARE_BITS);

/// Bits of a pixel's number in its square.
const PLACES: u32 = (1 << (2 * SQUARE_BITS)) - 1;

/// Columns of the matrix that tells the second coordinate's pixels from the first's, for samples
/// whose number is not known. Each is the bit of its place and lower ones, so every square of
/// pixels is well spread along both coordinates, whatever the number of samples. Of 28,000 matrices
/// this one left the fewest boxes of two dimensions empty, for up to 32 samples and squares of up
/// to 8 pixels: 11 % on average, against 30 % of random points (the higher columns are Pascal's).
const MIXING: [u32; 14] = [1, 3, 7, 13, 29, 32, 113, 181, 257, 771, 1285, 3855, 4369, 13107];

/// The sample points of one pixel, or of one surface point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sequence {
    seed: u64,
    first: u32,
    /// The pixel's number in its square, where its number of samples is not known.
    place: Option<u32>,
}

impl Sequence {
    /// The points of a place that has no neighbours.
    pub fn of_key(key: Key) -> Self {
        Self { seed: key.bits(), first: 0, place: None }
    }

    /// The points of a pixel that takes `samples` samples.
    pub fn of_pixel(seed: u64, [x, y]: [u32; 2], samples: u32) -> Self {
        let stride = samples.max(1).next_power_of_two();
        if stride > MAX_SHARED_SAMPLES {
            return Self::of_key(Key::of_pixel(seed, x).with(y));
        }
        let (square, place) = place_in_square(seed, [x, y]);
        Self { seed: square.bits(), first: place * stride, place: None }
    }

    /// The points of a pixel that takes samples as long as there is time: the first 2^k are well
    /// spread for every k, over the pixel and over neighbouring pixels.
    pub fn of_growing_pixel(seed: u64, at: [u32; 2]) -> Self {
        let (square, place) = place_in_square(seed, at);
        Self { seed: square.bits(), first: 0, place: Some(place) }
    }

    /// A key for the random numbers of one sample that need no spreading.
    pub fn key(&self, sample: u32) -> Key {
        let key = Key::of_pixel(self.seed, self.first.wrapping_add(sample));
        self.place.map_or(key, |place| key.with(place))
    }

    /// Point `sample` of a pair of dimensions in the unit square, each coordinate in [0, 1).
    #[inline]
    pub fn pair(&self, sample: u32, dimension: u32) -> [f32; 2] {
        let seed = mix64(self.seed ^ u64::from(dimension).wrapping_mul(0x9e37_79b9_7f4a_7c15));
        let [order, x, y] = [seed as u32, (seed >> 32) as u32, (seed >> 16) as u32 ^ 0x5bd1_e995];
        // Each pair of dimensions visits the points in an order of its own. The bits of the index
        // in reverse are the first coordinate.
        let first = laine_karras(self.first.wrapping_add(sample).reverse_bits(), order);
        let (mut first, mut second) = (first, second_dimension(first));
        if let Some(place) = self.place {
            let place = laine_karras(place.reverse_bits(), y ^ 0x68e3_1da4).reverse_bits() & PLACES;
            let [x, y] = of_place(place);
            (first, second) = (first ^ x, second ^ y);
        }
        let coordinates = [(first, x), (second, y)];
        coordinates.map(|(coordinate, seed)| unit_interval(scramble(coordinate, seed)))
    }
}

/// The random numbers of one surface point: keys for its lights, a sequence for its paths.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PointSeed {
    /// Key of the point.
    pub key: Key,
    /// Points of the paths that start there.
    pub sequence: Sequence,
}

impl PointSeed {
    /// The seed of what a pixel of a picture shows first, which takes `samples` paths.
    pub fn of_pixel(seed: u64, pixel: u32, width: u32, samples: u32) -> Self {
        let at = [pixel % width.max(1), pixel / width.max(1)];
        Self { key: Key::of_pixel(seed, pixel), sequence: Sequence::of_pixel(seed, at, samples) }
    }

    /// The seed of what a pixel of a picture shows first, whose samples may be continued.
    pub fn of_growing_pixel(seed: u64, pixel: u32, width: u32) -> Self {
        let at = [pixel % width.max(1), pixel / width.max(1)];
        Self { key: Key::of_pixel(seed, pixel), sequence: Sequence::of_growing_pixel(seed, at) }
    }
}

impl From<Key> for PointSeed {
    /// The seed of a point that has no neighbours.
    fn from(key: Key) -> Self {
        Self { key, sequence: Sequence::of_key(key) }
    }
}

/// Spreads the low 16 bits of a number over the even bits of the result.
fn spread_bits(x: u32) -> u32 {
    let x = (x | x << 8) & 0x00ff_00ff;
    let x = (x | x << 4) & 0x0f0f_0f0f;
    let x = (x | x << 2) & 0x3333_3333;
    (x | x << 1) & 0x5555_5555
}

/// Coordinate of Sobol's second dimension for an index whose bits are reversed: the product with
/// Pascal's triangle modulo two, a butterfly of five steps.
#[inline]
const fn second_dimension(reversed: u32) -> u32 {
    let x = reversed ^ (reversed & 0x5555_5555) << 1;
    let x = x ^ (x & 0x3333_3333) << 2;
    let x = x ^ (x & 0x0f0f_0f0f) << 4;
    let x = x ^ (x & 0x00ff_00ff) << 8;
    x ^ x << 16
}

/// Part of the second coordinate that a pixel's number in its square adds: the product of its bits,
/// mixed by [`MIXING`], with Pascal's triangle, half of the bits at a time.
const MIXED: [[u32; 1 << SQUARE_BITS]; 2] = {
    let mut parts = [[0; 1 << SQUARE_BITS]; 2];
    let mut bits = 0;
    while bits < 1 << SQUARE_BITS {
        let mut bit = 0;
        while bit < SQUARE_BITS {
            if bits >> bit & 1 == 1 {
                parts[0][bits] ^= second_dimension(MIXING[bit as usize]);
                parts[1][bits] ^= second_dimension(MIXING[(bit + SQUARE_BITS) as usize]);
            }
            bit += 1;
        }
        bits += 1;
    }
    parts
};

/// What a pixel's number in its square adds to both coordinates of its samples.
#[inline]
fn of_place(place: u32) -> [u32; 2] {
    let half = (1 << SQUARE_BITS) - 1;
    let [low, high] = [place & half, place >> SQUARE_BITS & half].map(|bits| bits as usize);
    [second_dimension(place), MIXED[0][low] ^ MIXED[1][high]]
}

/// The key of a pixel's square, and the pixel's number there along a Morton curve.
fn place_in_square(seed: u64, [x, y]: [u32; 2]) -> (Key, u32) {
    let mask = (1 << SQUARE_BITS) - 1;
    let place = spread_bits(x & mask) | spread_bits(y & mask) << 1;
    (Key::of_pixel(seed, x >> SQUARE_BITS).with(y >> SQUARE_BITS), place)
}

/// Scrambles a coordinate: each bit is flipped by a hash of the bits above it.
#[inline]
fn scramble(coordinate: u32, seed: u32) -> u32 {
    laine_karras(coordinate.reverse_bits(), seed).reverse_bits()
}

/// A hash in which each bit depends on the bits below it only (Laine and Karras, "Stratified
/// Sampling for Stochastic Transparency", 2011, with the constants of Vegdahl, 2021).
#[inline]
fn laine_karras(mut x: u32, seed: u32) -> u32 {
    x ^= x.wrapping_mul(0x3d20_adea);
    x = x.wrapping_add(seed);
    x = x.wrapping_mul((seed >> 16) | 1);
    x ^= x.wrapping_mul(0x0552_6c56);
    x ^ x.wrapping_mul(0x53a2_2864)
}

/// The finalizer of MurmurHash3 for 64 bits.
#[inline]
fn mix64(mut x: u64) -> u64 {
    x = (x ^ x >> 33).wrapping_mul(0xff51_afd7_ed55_8ccd);
    x = (x ^ x >> 33).wrapping_mul(0xc4ce_b9fe_1a85_ec53);
    x ^ x >> 33
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Sobol's second dimension by its direction numbers.
    fn slow_second_dimension(mut index: u32) -> u32 {
        let (mut coordinate, mut direction) = (0, 1u32 << 31);
        while index != 0 {
            if index & 1 == 1 {
                coordinate ^= direction;
            }
            (index, direction) = (index >> 1, direction ^ direction >> 1);
        }
        coordinate
    }

    #[test]
    fn the_butterfly_gives_the_coordinates_of_the_direction_numbers() {
        for i in 0..10_000u32 {
            let index = i.wrapping_mul(0x9e37_79b9);
            assert_eq!(second_dimension(index.reverse_bits()), slow_second_dimension(index), "{index}");
        }
    }

    /// True where every elementary interval of an area of one over the number of points holds one.
    fn is_net(points: &[[f32; 2]]) -> bool {
        let bits = points.len().trailing_zeros();
        (0..=bits).all(|across| {
            let [columns, rows] = [1u32 << across, 1u32 << (bits - across)].map(|n| n as f32);
            let mut boxes: Vec<(u32, u32)> =
                points.iter().map(|p| ((p[0] * columns) as u32, (p[1] * rows) as u32)).collect();
            boxes.sort_unstable();
            boxes.windows(2).all(|pair| pair[0] != pair[1])
        })
    }

    #[test]
    fn samples_of_a_pixel_and_of_squares_of_pixels_are_nets_in_every_pair_of_dimensions() {
        for dimension in [0, 1, 7, 1 << 20] {
            for samples in [1, 2, 16, 64] {
                for side in [1, 2, 4, 8] {
                    let pixels = (0..side * side).map(|i| [128 + 40 + i % side, 16 + i / side]);
                    let points: Vec<[f32; 2]> = pixels
                        .flat_map(|at| {
                            let sequence = Sequence::of_pixel(5, at, samples);
                            (0..samples).map(move |i| sequence.pair(i, dimension))
                        })
                        .collect();
                    assert!(is_net(&points), "{samples} samples of {side} by {side} pixels");
                }
            }
        }
    }

    #[test]
    fn every_beginning_of_a_growing_pixel_is_a_net_and_spread_over_squares_along_both_axes() {
        for (dimension, samples) in [(0, 1), (1, 2), (7, 4), (1 << 20, 16), (3, 64)] {
            for side in [1, 2, 4, 8] {
                let pixels = (0..side * side).map(|i| [128 + 40 + i % side, 16 + i / side]);
                let points: Vec<[f32; 2]> = pixels
                    .flat_map(|at| {
                        let sequence = Sequence::of_growing_pixel(5, at);
                        (0..samples).map(move |i| sequence.pair(i, dimension))
                    })
                    .collect();
                assert!(side > 1 || is_net(&points), "{samples} samples");
                for axis in 0..2 {
                    let count = points.len() as f32;
                    let mut strata: Vec<u32> = points.iter().map(|p| (p[axis] * count) as u32).collect();
                    strata.sort_unstable();
                    let is_spread = strata.iter().zip(0..).all(|(stratum, i)| *stratum == i);
                    assert!(is_spread, "{samples} samples of {side} by {side} pixels, axis {axis}");
                }
            }
        }
    }

    #[test]
    fn seeds_and_dimensions_are_independent() {
        let correlation = |a: &dyn Fn(u32) -> f32, b: &dyn Fn(u32) -> f32| {
            let count = 4096;
            (0..count).map(|i| (a(i) - 0.5) * (b(i) - 0.5)).sum::<f32>() / count as f32 * 12.0
        };
        let first = |seed: u64, dimension: u32| {
            move |i: u32| Sequence::of_pixel(seed, [i % 64, i / 64], 1).pair(0, dimension)[0]
        };
        for (a, b) in [((1, 0), (2, 0)), ((1, 0), (1, 1)), ((1, 3), (1, 4)), ((1, 0), (1 << 32, 0))] {
            let value = correlation(&first(a.0, a.1), &first(b.0, b.1));
            assert!(value.abs() < 0.06, "{a:?} and {b:?}: {value}");
        }
    }
}
