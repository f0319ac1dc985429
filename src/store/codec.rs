//! The pixels of a reference as bytes, and back.
//!
//! A pixel is stored if it has light, or if a look-up between four pixels may read it together with
//! one that has. A dense reference is stored whole. Columns of equal kind follow each other:
//!
//! 0. the state of the scene that the light was traced in, with its length
//! 1. table of the triangles that are shown, by hash
//! 2. one bit per pixel: it is stored
//! 3. one bit per stored pixel: its disparity is stored, because the ray's test on its triangle
//!    does not give these very bits
//! 4. per stored pixel: place of its triangle in the table, as difference to the one before
//! 5. disparities that are stored
//! 6. direct light, smooth light, reflections of the stored pixels

use super::bytes::{ByteReader, ByteWriter, list};
use super::content::SceneContent;
use super::summary::RecordSummary;
use crate::camera::{NEAREST_DEPTH, View};
use crate::reference::light::UNLIT;
use crate::reference::{ReferenceFrame, ReferenceParts};
use crate::trace::{NO_TRIANGLE, Tracer};
use rayon::prelude::*;
use std::collections::HashMap;

/// Returns the pixels of a reference as bytes.
pub(super) fn encode(reference: &ReferenceFrame, tracer: &Tracer, content: &SceneContent) -> Vec<u8> {
    let mask = stored_pixels(reference);
    let stored: Vec<u32> = (0..).zip(&mask).filter(|(_, stored)| **stored).map(|(pixel, _)| pixel).collect();
    let (table, places) = triangle_table(reference, &stored);
    let is_given: Vec<bool> = stored
        .iter()
        .map(|&pixel| {
            let (found, triangle) =
                (reference.disparity()[pixel as usize], reference.triangle()[pixel as usize]);
            let recomputed = disparity_of(tracer, &reference.view, pixel, triangle);
            recomputed.map(f32::to_bits) != Some(found.to_bits())
        })
        .collect();
    let given = stored.iter().zip(&is_given).filter(|(_, given)| **given);
    let given: Vec<u32> = given.map(|(&pixel, _)| reference.disparity()[pixel as usize].to_bits()).collect();
    let column = |words: &[u32]| stored.iter().map(|&pixel| words[pixel as usize]).collect::<Vec<u32>>();
    let mut to = ByteWriter::default();
    let (state, _) = content.state();
    to.u32(state.len() as u32);
    to.0.extend(state);
    to.u32(table.len() as u32);
    table.iter().for_each(|&triangle| to.u128(content.hash_of(triangle)));
    to.bits(&mask);
    to.u32(stored.len() as u32);
    to.bits(&is_given);
    to.planes(&places);
    to.u32(given.len() as u32);
    to.planes(&given);
    to.planes(&column(reference.packed_light().0));
    if reference.has_smooth_light() {
        to.planes(&column(reference.packed_smooth().0));
    }
    if reference.has_reflections() {
        to.0.extend(stored.iter().map(|&pixel| reference.reflections(pixel)));
    }
    to.0
}

/// Reads the pixels of a reference. Pixels on triangles that the scene no longer has are left
/// without light. `None` where the bytes are none of such a reference.
pub(super) fn decode(
    bytes: &[u8],
    summary: &RecordSummary,
    tracer: &Tracer,
    content: &SceneContent,
) -> Option<ReferenceFrame> {
    let columns = Columns::read(bytes, summary)?;
    let view = View::new(&summary.camera, &tracer.scene().frame, summary.size);
    let triangles: Vec<Option<u32>> = columns.table.iter().map(|&hash| content.triangle_of(hash)).collect();
    // Depth counts in scene units, which may have changed by a power of two.
    let scale = (summary.frame.units_per_metre / tracer.scene().frame.units_per_metre) as f32;
    let count = summary.pixels();
    let mut parts = ReferenceParts {
        camera: summary.camera,
        view,
        settings: summary.settings,
        disparity: vec![f32::NAN; count],
        triangle: vec![NO_TRIANGLE; count],
        light: vec![UNLIT; count],
        light_scale: summary.light_scale,
        smooth: if summary.has_smooth { vec![0; count] } else { Vec::new() },
        smooth_scale: summary.smooth_scale,
        reflections: if summary.has_reflections { vec![0; count] } else { Vec::new() },
        is_dense: summary.is_dense,
        is_refined: summary.is_refined,
    };
    let disparities: Vec<Option<(u32, f32)>> = (0..columns.stored.len())
        .into_par_iter()
        .with_min_len(1 << 10)
        .map(|at| {
            let triangle = triangles[columns.places[at] as usize]?;
            let disparity = match columns.given[at] {
                Some(given) => given * scale,
                None => disparity_of(tracer, &view, columns.stored[at], triangle)?,
            };
            Some((triangle, disparity))
        })
        .collect();
    for (at, found) in disparities.iter().enumerate() {
        let Some((triangle, disparity)) = *found else { continue };
        let pixel = columns.stored[at] as usize;
        (parts.triangle[pixel], parts.disparity[pixel]) = (triangle, disparity);
        parts.light[pixel] = columns.light[at];
        if let Some(smooth) = parts.smooth.get_mut(pixel) {
            *smooth = columns.smooth[at];
        }
        if let Some(reflections) = parts.reflections.get_mut(pixel) {
            *reflections = columns.reflections[at];
        }
    }
    Some(ReferenceFrame::from_parts(tracer, parts))
}

/// True where bytes are the pixels of a reference, of whatever scene.
pub(super) fn is_sound(bytes: &[u8], summary: &RecordSummary) -> bool {
    Columns::read(bytes, summary).is_some()
}

/// The state of the scene that the light of a reference was traced in.
pub(super) fn state_of(bytes: &[u8]) -> Option<&[u8]> {
    let mut from = ByteReader(bytes);
    let length = from.u32()? as usize;
    from.take(length)
}

/// One bool per pixel: it has light, or touches one that has. All of a dense reference.
fn stored_pixels(reference: &ReferenceFrame) -> Vec<bool> {
    let [width, height] = reference.view.size.map(|edge| edge as usize);
    if reference.is_dense() {
        return vec![true; width * height];
    }
    let mut mask = vec![false; width * height];
    for pixel in (0..width * height).filter(|&pixel| reference.has_light(pixel as u32)) {
        let (x, y) = (pixel % width, pixel / width);
        for row in y.saturating_sub(1)..(y + 2).min(height) {
            mask[row * width..][x.saturating_sub(1)..(x + 2).min(width)].fill(true);
        }
    }
    mask
}

/// The triangles of some pixels in the order of their first pixel, and for each pixel the
/// difference of its place in that table to the place before, folded so that small ones of both
/// signs are small numbers.
fn triangle_table(reference: &ReferenceFrame, stored: &[u32]) -> (Vec<u32>, Vec<u32>) {
    let (mut table, mut places) = (Vec::new(), HashMap::new());
    let mut last = 0u32;
    let differences = stored.iter().map(|&pixel| {
        let triangle = reference.triangle()[pixel as usize];
        let place = *places.entry(triangle).or_insert_with(|| {
            table.push(triangle);
            table.len() as u32 - 1
        });
        let difference = place.wrapping_sub(std::mem::replace(&mut last, place)) as i32;
        (difference << 1 ^ difference >> 31) as u32
    });
    let differences = differences.collect();
    (table, differences)
}

/// Undoes the differences of [`triangle_table`].
fn unfold(differences: &mut [u32]) {
    let mut last = 0u32;
    for word in differences {
        let difference = (*word >> 1) ^ (*word & 1).wrapping_neg();
        last = last.wrapping_add(difference);
        *word = last;
    }
}

/// The disparity of a pixel that shows a triangle, as the tracer finds it; `None` where the ray
/// misses it, or its hit is too near.
fn disparity_of(tracer: &Tracer, view: &View, pixel: u32, triangle: u32) -> Option<f32> {
    if triangle == NO_TRIANGLE {
        return Some(0.0);
    }
    let hit = tracer.hit_on_triangle(&Tracer::primary_ray(view, pixel), triangle)?;
    (hit.t >= NEAREST_DEPTH).then_some(1.0 / hit.t)
}

/// The columns of a record. All have as many entries as pixels are stored.
struct Columns {
    table: Vec<u128>,
    /// Pixels that are stored, ascending.
    stored: Vec<u32>,
    /// Disparities that are stored.
    given: Vec<Option<f32>>,
    /// Places in the table.
    places: Vec<u32>,
    light: Vec<u32>,
    /// Empty without smooth light.
    smooth: Vec<u32>,
    /// Empty without reflections.
    reflections: Vec<u8>,
}

impl Columns {
    fn read(bytes: &[u8], summary: &RecordSummary) -> Option<Self> {
        let mut from = ByteReader(bytes.get(4 + state_of(bytes)?.len()..)?);
        let table = list(&mut from, summary.pixels(), size_of::<u128>(), ByteReader::u128)?;
        let mask = from.bits(summary.pixels())?;
        let stored: Vec<u32> = (0..).zip(&mask).filter(|(_, bit)| **bit).map(|(pixel, _)| pixel).collect();
        let count = stored.len();
        (from.u32()? as usize == count).then_some(())?;
        let is_given = from.bits(count)?;
        let mut places = from.planes(count)?;
        unfold(&mut places);
        places.iter().all(|&place| (place as usize) < table.len()).then_some(())?;
        let given = given_disparities(&mut from, &is_given)?;
        let light = from.planes(count)?;
        let smooth = if summary.has_smooth { from.planes(count)? } else { Vec::new() };
        let reflections = if summary.has_reflections { from.take(count)?.to_vec() } else { Vec::new() };
        from.0.is_empty().then_some(Self { table, stored, given, places, light, smooth, reflections })
    }
}

/// Reads the disparities that are stored. None of them is negative or infinite.
fn given_disparities(from: &mut ByteReader<'_>, is_given: &[bool]) -> Option<Vec<Option<f32>>> {
    let count = from.u32()? as usize;
    (count == is_given.iter().filter(|given| **given).count()).then_some(())?;
    let words = from.planes(count)?;
    let is_sound = |word: &u32| {
        let disparity = f32::from_bits(*word);
        disparity.is_nan() || (0.0..=2.0 / NEAREST_DEPTH).contains(&disparity)
    };
    words.iter().all(is_sound).then_some(())?;
    let mut words = words.into_iter().map(f32::from_bits);
    Some(is_given.iter().map(|given| if *given { words.next() } else { None }).collect())
}
