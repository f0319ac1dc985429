//! Mode 1: triangles that share edges and vertices with those before them.

use super::bytes::{Bytes, unzigzag};

/// The last sixteen things of a kind, the newest first. `None` for one that was not written yet.
struct Recent<T> {
    ring: [Option<T>; 16],
    next: usize,
}

impl<T: Copy> Recent<T> {
    fn new() -> Self {
        Self { ring: [None; 16], next: 0 }
    }

    fn push(&mut self, new: T) {
        self.ring[self.next % 16] = Some(new);
        self.next = (self.next + 1) % 16;
    }

    fn get(&self, back: u8) -> Option<T> {
        self.ring[(self.next + 31 - usize::from(back)) % 16]
    }
}

/// Decodes `count` indices, three a triangle.
pub(super) fn decode(data: &[u8], count: usize) -> Option<Vec<u32>> {
    let data = data.strip_prefix(&[0xE1])?;
    if !count.is_multiple_of(3) {
        return None;
    }
    let (codes, rest) = data.split_at_checked(count / 3)?;
    let (extra, table) = rest.split_at_checked(rest.len().checked_sub(16)?)?;
    let is_valid = |byte: &u8| byte >> 4 != 0xF && byte & 0xF != 0xF;
    if !table.iter().all(is_valid) {
        return None;
    }
    let mut decoder = Decoder {
        extra: Bytes(extra),
        next: 0,
        last: 0,
        edges: Recent::new(),
        vertices: Recent::new(),
        indices: Vec::new(),
    };
    decoder.indices.try_reserve_exact(count).ok()?;
    codes.iter().try_for_each(|code| decoder.triangle(*code, table))?;
    decoder.extra.0.is_empty().then_some(decoder.indices)
}

struct Decoder<'a> {
    extra: Bytes<'a>,
    /// The index that no triangle has used yet.
    next: u32,
    /// The index that was stored last.
    last: u32,
    edges: Recent<[u32; 2]>,
    vertices: Recent<u32>,
    indices: Vec<u32>,
}

impl Decoder<'_> {
    fn triangle(&mut self, code: u8, table: &[u8]) -> Option<()> {
        match (code >> 4, code & 0xF) {
            (0xF, entry @ 0..0xE) => {
                let pair = table[usize::from(entry)];
                let a = self.new_index();
                self.free(a, pair)
            }
            (0xF, entry) => {
                let pair = self.extra.byte()?;
                if pair == 0 {
                    self.next = 0;
                }
                let a = if entry == 0xE { self.new_index() } else { self.stored()? };
                self.free(a, pair)
            }
            (edge, vertex) => self.at_edge(edge, vertex),
        }
    }

    /// A triangle at a recent edge.
    fn at_edge(&mut self, edge: u8, vertex: u8) -> Option<()> {
        let [a, b] = self.edges.get(edge)?;
        let c = match vertex {
            0 => self.new_index(),
            0xD => self.step(u32::MAX),
            0xE => self.step(1),
            0xF => self.stored()?,
            recent => self.vertices.get(recent)?,
        };
        self.edges.push([c, b]);
        self.edges.push([a, c]);
        if matches!(vertex, 0 | 0xD..) {
            self.vertices.push(c);
        }
        self.indices.extend([a, b, c]);
        Some(())
    }

    /// A triangle without a recent edge. The halves of `pair` say where its other vertices are
    /// from.
    fn free(&mut self, a: u32, pair: u8) -> Option<()> {
        let (high, low) = (pair >> 4, pair & 0xF);
        let b = self.vertex(high)?;
        let c = self.vertex(low)?;
        self.edges.push([b, a]);
        self.edges.push([c, b]);
        self.edges.push([a, c]);
        self.vertices.push(a);
        for (source, vertex) in [(high, b), (low, c)] {
            if matches!(source, 0 | 0xF) {
                self.vertices.push(vertex);
            }
        }
        self.indices.extend([a, b, c]);
        Some(())
    }

    fn vertex(&mut self, source: u8) -> Option<u32> {
        match source {
            0 => Some(self.new_index()),
            0xF => self.stored(),
            recent => self.vertices.get(recent - 1),
        }
    }

    fn new_index(&mut self) -> u32 {
        let new = self.next;
        self.next = new.wrapping_add(1);
        new
    }

    fn stored(&mut self) -> Option<u32> {
        let delta = unzigzag(self.extra.varint()?);
        Some(self.step(delta))
    }

    fn step(&mut self, delta: u32) -> u32 {
        self.last = self.last.wrapping_add(delta);
        self.last
    }
}
