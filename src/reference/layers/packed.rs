//! Layers of light in packed tiles, and their sum.

use crate::raster::rgb9e5::Rgb9e5Scale;
use crate::reference::light::{UNLIT, not_unlit};
use crate::trace::{TILE_RAYS, TILE_SIDE};
use glam::Vec3;
use rayon::prelude::*;

/// Place of a tile that holds no light.
const DARK: u32 = u32::MAX;

/// Light in the tiles of a picture that are not dark.
#[derive(Debug)]
pub(super) struct PackedTiles {
    scale: Rgb9e5Scale,
    /// Largest value of each channel.
    largest: Vec3,
    /// Number of each tile among those that hold light, or [`DARK`].
    places: Vec<u32>,
    /// The words of the pixels of each tile that holds light.
    words: Vec<u32>,
}

impl PackedTiles {
    /// Packs the light of the listed pixels, which come tile by tile. Light that is not finite
    /// becomes zero.
    pub(super) fn new(size: [u32; 2], pixels: &[u32], light: impl Iterator<Item = Vec3> + Clone) -> Self {
        let finite = light.clone().filter(|light| light.is_finite());
        let largest = finite.fold(Vec3::ZERO, Vec3::max);
        let scale = Rgb9e5Scale::for_largest(largest.max_element());
        let [columns, rows] = size.map(|side| side.div_ceil(TILE_SIDE as u32) as usize);
        let mut packed = Self { scale, largest, places: vec![DARK; columns * rows], words: Vec::new() };
        for (&pixel, light) in pixels.iter().zip(light) {
            let word = if light.is_finite() { scale.pack(light) } else { 0 };
            if word != 0 {
                let (tile, at) = place_of(pixel, size[0]);
                let place = packed.place(tile);
                packed.words[place * TILE_RAYS + at] = word;
            }
        }
        packed.words.shrink_to_fit();
        packed
    }

    /// The place of a tile, which it gets where it had none.
    fn place(&mut self, tile: usize) -> usize {
        if self.places[tile] == DARK {
            self.places[tile] = (self.words.len() / TILE_RAYS) as u32;
            self.words.resize(self.words.len() + TILE_RAYS, 0);
        }
        self.places[tile] as usize
    }

    /// Adds the light of a tile, multiplied with a factor per channel.
    #[inline(always)]
    fn add_tile(&self, tile: usize, factor: Vec3, sums: &mut [Vec3; TILE_RAYS]) {
        let place = self.places[tile] as usize;
        let words = self.words.get(place * TILE_RAYS..place * TILE_RAYS + TILE_RAYS);
        for (sum, &word) in sums.iter_mut().zip(words.unwrap_or(&[])) {
            *sum += self.scale.unpack(word) * factor;
        }
    }

    fn bytes(&self) -> usize {
        4 * (self.places.len() + self.words.len())
    }
}

/// Tile of a pixel, and its place there.
fn place_of(pixel: u32, width: u32) -> (usize, usize) {
    let (side, x, y) = (TILE_SIDE as u32, pixel % width, pixel / width);
    let tile = (y / side) * width.div_ceil(side) + x / side;
    (tile as usize, ((y % side) * side + x % side) as usize)
}

/// The light of one group.
#[derive(Debug)]
pub(super) struct Layer {
    pub(super) direct: PackedTiles,
    pub(super) smooth: PackedTiles,
}

/// The packed light of the pixels of a reference, row-major, and the scales to unpack it.
#[derive(Clone, Debug)]
pub(crate) struct LightWords {
    pub(crate) light: Vec<u32>,
    pub(crate) light_scale: Rgb9e5Scale,
    /// Empty without bounces.
    pub(crate) smooth: Vec<u32>,
    pub(crate) smooth_scale: Rgb9e5Scale,
}

impl LightWords {
    /// The same light with each channel multiplied by a factor.
    pub(crate) fn scaled(&self, factor: Vec3) -> Self {
        /// Largest value that a scale holds, so that products stay finite.
        const LARGEST: f32 = f32::MAX / 4.0;
        /// Words that a thread takes at a time.
        const CHUNK: usize = 1 << 14;
        let scaled = |words: &[u32], scale: Rgb9e5Scale, has_holes: bool| {
            let new = Rgb9e5Scale::for_largest((scale.largest() * factor.max_element()).min(LARGEST));
            let mut scaled = words.to_vec();
            scaled.par_chunks_mut(CHUNK).for_each(|words| {
                for word in words.iter_mut().filter(|word| !has_holes || **word != UNLIT) {
                    let sum = new.pack_sum(scale.unpack(*word) * factor);
                    *word = if has_holes { not_unlit(sum) } else { sum };
                }
            });
            (scaled, new)
        };
        let (light, light_scale) = scaled(&self.light, self.light_scale, true);
        let (smooth, smooth_scale) = scaled(&self.smooth, self.smooth_scale, false);
        Self { light, light_scale, smooth, smooth_scale }
    }

    /// Memory in bytes.
    pub(crate) fn bytes(&self) -> usize {
        4 * (self.light.len() + self.smooth.len())
    }
}

/// The light of a reference by groups of lights, all of them at full light.
#[derive(Debug)]
pub(crate) struct LightLayers {
    /// Hash of the scene at full light.
    pub(super) scene: String,
    pub(super) size: [u32; 2],
    /// One bit for each pixel of a tile whose light is known.
    pub(super) lit: Vec<u64>,
    pub(super) layers: Vec<Layer>,
    pub(super) has_smooth: bool,
}

impl LightLayers {
    /// True where this is the light of a scene, given by its hash at full light.
    pub(crate) fn are_of(&self, scene: &str) -> bool {
        self.scene == scene
    }

    /// Memory in bytes.
    pub(crate) fn bytes(&self) -> usize {
        let layers = self.layers.iter().map(|layer| layer.direct.bytes() + layer.smooth.bytes());
        8 * self.lit.len() + layers.sum::<usize>()
    }

    /// Sums the groups, each multiplied with its factor per channel.
    pub(crate) fn sum(&self, factors: &[Vec3]) -> LightWords {
        let (light, light_scale) = self.sum_of(factors, |layer| &layer.direct, true);
        let (smooth, smooth_scale) = match self.has_smooth {
            true => self.sum_of(factors, |layer| &layer.smooth, false),
            false => (Vec::new(), Rgb9e5Scale::for_largest(1.0)),
        };
        LightWords { light, light_scale, smooth, smooth_scale }
    }

    /// Sums one part of the light; with holes, pixels whose light is not known are [`UNLIT`].
    fn sum_of(
        &self,
        factors: &[Vec3],
        part: impl Fn(&Layer) -> &PackedTiles,
        has_holes: bool,
    ) -> (Vec<u32>, Rgb9e5Scale) {
        let parts = self.layers.iter().map(part).zip(factors.iter().copied());
        let parts: Vec<(&PackedTiles, Vec3)> = parts.filter(|(_, factor)| *factor != Vec3::ZERO).collect();
        // A bound on the sum, so that it is packed in one pass.
        let largest: Vec3 = parts.iter().map(|(tiles, factor)| tiles.largest * *factor).sum();
        let scale = Rgb9e5Scale::for_largest(largest.max_element());
        let [width, height] = self.size.map(|side| side as usize);
        let mut words = vec![if has_holes { UNLIT } else { 0 }; width * height];
        let columns = width.div_ceil(TILE_SIDE);
        words.par_chunks_mut((width * TILE_SIDE).max(1)).enumerate().for_each(|(row, words)| {
            for column in 0..columns {
                let (tile, mut sums) = (row * columns + column, [Vec3::ZERO; TILE_RAYS]);
                let lit = self.lit[tile];
                if lit == 0 {
                    continue;
                }
                parts.iter().for_each(|(tiles, factor)| tiles.add_tile(tile, *factor, &mut sums));
                for (y, line) in words.chunks_mut(width).enumerate() {
                    let line = &mut line[column * TILE_SIDE..width.min((column + 1) * TILE_SIDE)];
                    for (x, word) in line.iter_mut().enumerate() {
                        let at = y * TILE_SIDE + x;
                        if lit >> at & 1 == 1 {
                            let sum = scale.pack_sum(sums[at]);
                            *word = if has_holes { not_unlit(sum) } else { sum };
                        }
                    }
                }
            }
        });
        (words, scale)
    }
}

/// One bit for each of the listed pixels, by tile.
pub(super) fn bits_of(size: [u32; 2], pixels: impl Iterator<Item = u32>) -> Vec<u64> {
    let [columns, rows] = size.map(|side| side.div_ceil(TILE_SIDE as u32) as usize);
    let mut bits = vec![0; columns * rows];
    for pixel in pixels {
        let (tile, at) = place_of(pixel, size[0]);
        bits[tile] |= 1 << at;
    }
    bits
}
