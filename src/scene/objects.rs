//! The named objects of a model: `o` and `g` of an OBJ file, nodes of glTF.

use std::collections::HashMap;
use std::ops::Range;

/// Names an object of a model in a way that survives loading it again.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct ObjectKey {
    /// Name in the file.
    pub name: String,
    /// Which one of the objects of this name it is, in the order of the file, from 1.
    pub number: u32,
}

impl ObjectKey {
    /// The first object of a name.
    pub fn first(name: &str) -> Self {
        Self { name: name.to_owned(), number: 1 }
    }
}

impl std::fmt::Display for ObjectKey {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self.number {
            0 | 1 => f.write_str(&self.name),
            number => write!(f, "{} ({number})", self.name),
        }
    }
}

/// No object.
const NONE: u32 = u32::MAX;

/// The named objects of a scene, as runs of triangles. A triangle belongs to one object at most.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Objects {
    keys: Vec<ObjectKey>,
    /// First triangle of each run, ascending, and its object. A run ends where the next one begins.
    runs: Vec<(u32, u32)>,
}

impl Objects {
    /// Adds an object without triangles and returns its index.
    pub(crate) fn add(&mut self, name: &str) -> u32 {
        self.keys.push(ObjectKey { name: name.to_owned(), number: 0 });
        self.keys.len() as u32 - 1
    }

    /// Lets the triangles from `triangle` on belong to an object, or to none.
    pub(crate) fn begin(&mut self, triangle: u32, object: Option<u32>) {
        let object = object.unwrap_or(NONE);
        if self.runs.last().is_some_and(|last| last.0 == triangle) {
            self.runs.pop();
        }
        if self.runs.last().map_or(NONE, |last| last.1) != object {
            self.runs.push((triangle, object));
        }
    }

    /// Numbers the objects of each name.
    pub(super) fn number(&mut self) {
        let mut counts: HashMap<&str, u32> = HashMap::new();
        for key in &mut self.keys {
            let count = counts.entry(&key.name).or_default();
            *count += 1;
            key.number = *count;
        }
    }

    /// Follows the removal of triangles.
    pub(super) fn retain(&mut self, is_kept: &[bool]) {
        let runs = std::mem::take(&mut self.runs);
        let (mut from, mut kept) = (0, 0);
        for (first, object) in runs {
            let first = (first as usize).min(is_kept.len());
            kept += is_kept[from.min(first)..first].iter().filter(|kept| **kept).count() as u32;
            from = first;
            self.begin(kept, (object != NONE).then_some(object));
        }
    }

    /// The same objects without triangles.
    pub(super) fn without_triangles(&self) -> Self {
        Self { keys: self.keys.clone(), runs: Vec::new() }
    }

    /// All objects, in the order of the file. Some may have no triangles.
    pub fn keys(&self) -> &[ObjectKey] {
        &self.keys
    }

    /// The object of a triangle, by its index in [`Self::keys`].
    pub fn of_triangle(&self, triangle: u32) -> Option<usize> {
        let run = self.runs.partition_point(|run| run.0 <= triangle).checked_sub(1)?;
        let object = self.runs[run].1;
        (object != NONE).then_some(object as usize)
    }

    /// The runs of triangles, of which there are `count`, with the object of each.
    pub fn runs(&self, count: u32) -> impl Iterator<Item = (Range<u32>, Option<usize>)> + '_ {
        let ends = self.runs.iter().skip(1).map(|run| run.0).chain([count]);
        let before = self.runs.first().map_or(count, |run| run.0.min(count));
        let runs = self.runs.iter().zip(ends).map(move |(&(first, object), end)| {
            (first.min(count)..end.min(count), (object != NONE).then_some(object as usize))
        });
        std::iter::once((0..before, None)).chain(runs).filter(|(run, _)| !run.is_empty())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::key::Key;

    #[test]
    fn runs_say_the_object_of_every_triangle_also_after_some_are_removed() {
        for seed in 0..200 {
            let random = |k: u32, below: usize| (Key::of_pixel(seed, k).pair()[0] * below as f32) as usize;
            let (mut objects, mut of_triangle) = (Objects::default(), Vec::new());
            for name in ["a", "b", "a", "a"] {
                objects.add(name);
            }
            for step in 0..random(0, 9) as u32 {
                let object = (random(3 * step + 1, 5) as u32).checked_sub(1);
                objects.begin(of_triangle.len() as u32, object);
                let more = random(3 * step + 2, 4);
                of_triangle.extend(std::iter::repeat_n(object.map(|o| o as usize), more));
            }
            objects.number();
            assert_eq!(objects.keys().iter().map(|key| key.number).collect::<Vec<_>>(), [1, 1, 2, 3]);
            let check = |objects: &Objects, of_triangle: &[Option<usize>]| {
                let found: Vec<_> = (0..of_triangle.len() as u32).map(|t| objects.of_triangle(t)).collect();
                assert_eq!(found, of_triangle);
                let runs = objects.runs(of_triangle.len() as u32);
                let all: Vec<_> = runs.flat_map(|(run, object)| run.map(move |_| object)).collect();
                assert_eq!(all, of_triangle);
            };
            check(&objects, &of_triangle);
            let is_kept: Vec<bool> = (0..of_triangle.len() as u32).map(|t| random(100 + t, 3) > 0).collect();
            objects.retain(&is_kept);
            let mut kept = is_kept.iter();
            of_triangle.retain(|_| *kept.next().unwrap());
            check(&objects, &of_triangle);
        }
    }
}
