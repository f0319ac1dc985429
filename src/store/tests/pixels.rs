//! What is read equals what was written.

use super::*;
use crate::math::key::Key;
use crate::reference::light::UNLIT;
use crate::render::{FrameRequest, Mode, RenderSettings, Renderer};
use crate::scene::Scene;
use crate::store::cells::{Cell, CellCounts};
use crate::store::codec::is_sound;
use crate::trace::NO_TRIANGLE;
use proptest::prelude::*;
use std::sync::LazyLock;

static STAGES: LazyLock<[Stage; 3]> =
    LazyLock::new(|| ["cornell", "cornell-glass", "mirrors"].map(Stage::new));

/// Every lit pixel and all around it have the same bits; the others are left out.
fn assert_same(written: &ReferenceFrame, read: &ReferenceFrame) {
    let [width, height] = written.view.size;
    let is_near_light = |x: u32, y: u32| {
        let (columns, rows) =
            (x.saturating_sub(1)..(x + 2).min(width), y.saturating_sub(1)..(y + 2).min(height));
        rows.flat_map(|y| columns.clone().map(move |x| y * width + x)).any(|pixel| written.has_light(pixel))
    };
    for pixel in 0..width * height {
        if written.is_dense() || is_near_light(pixel % width, pixel / width) {
            assert_eq!(bits(written, pixel), bits(read, pixel), "pixel {pixel}");
        } else {
            let (disparity, triangle, light, ..) = bits(read, pixel);
            assert!(f32::from_bits(disparity).is_nan() && triangle == NO_TRIANGLE && light == UNLIT);
        }
    }
    assert_eq!((written.camera, written.view, written.settings), (read.camera, read.view, read.settings));
    assert_eq!(
        (written.packed_light().1, written.packed_smooth().1),
        (read.packed_light().1, read.packed_smooth().1)
    );
    assert_eq!((written.lit(), written.is_dense(), written.epoch), (read.lit(), read.is_dense(), read.epoch));
    assert_eq!(written.tiles().ranges(), read.tiles().ranges());
}

/// The cells that a reference shows, with the number of lit pixels in each.
fn lit_cells(stage: &Stage, frame: &ReferenceFrame) -> Vec<(Cell, u32)> {
    let counts = CellCounts::of(frame, stage.tracer.scene()).counts;
    counts.into_iter().map(|count| (count.cell, count.lit)).collect()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(12))]

    #[test]
    fn a_reference_is_read_with_the_bits_that_were_written(
        scene in 0..3usize, width in 2..40u32, height in 2..40u32, bounces in 0..3u32,
        seed: u64, right in -0.3..0.3f64,
    ) {
        let stage = &STAGES[scene];
        let settings = TraceSettings { samples: 1, bounces, seed };
        for reference in stage.sparse([width, height], &settings, right) {
            let read = stage.stored(&reference);
            assert_same(&reference, &read);
            // What is read gives the same bytes again, and the same cells by their lit pixels. They
            // count the others too, but far from light no surface is stored.
            let bytes = |frame| encode(frame, &stage.tracer, &stage.content);
            assert_eq!(bytes(&reference), bytes(&read));
            assert_eq!(lit_cells(stage, &reference), lit_cells(stage, &read));
        }
        let dense = ReferenceFrame::trace(&stage.tracer, &stage.camera(right), [width, height], &settings, NEVER);
        let dense = dense.unwrap();
        assert_same(&dense, &stage.stored(&dense));
    }

    /// Checksums stop accidents; this is what stops the rest.
    #[test]
    fn damaged_pixels_are_refused_or_read_as_others_but_never_fail(changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..6), cut: prop::sample::Index) {
        let stage = &STAGES[0];
        static REFERENCE: LazyLock<ReferenceFrame> = LazyLock::new(|| STAGES[0].sparse([9, 7], &TRACE, 0.1)[0].clone());
        let mut pixels = encode(&REFERENCE, &stage.tracer, &stage.content);
        let mut summary = stage.summary(&REFERENCE).write();
        for (place, byte) in &changes {
            let (at, byte) = (place.index(summary.len() + pixels.len()), *byte);
            match summary.get_mut(at) {
                Some(place) => *place = byte,
                None => pixels[at - summary.len()] = byte,
            }
        }
        let whole = RecordSummary::read(&summary);
        for length in [pixels.len(), cut.index(pixels.len())] {
            let pixels = &pixels[..length];
            if let Some(summary) = whole.as_ref().filter(|summary| is_sound(pixels, summary))
                && let Some(read) = decode(pixels, summary, &stage.tracer, &stage.content)
            {
                let mut cache = ReferenceCache::new(stage.tracer.scene(), 1 << 30);
                cache.insert(Arc::new(read));
            }
        }
        assert!(RecordSummary::read(&summary[..cut.index(summary.len())]).is_none());
    }
}

#[test]
fn frames_from_stored_references_have_the_bits_of_frames_from_the_first_ones() {
    for stage in &*STAGES {
        let references = stage.sparse([64, 48], &TRACE, 0.2);
        let frame = |references: &[ReferenceFrame], mode| {
            let mut cache = ReferenceCache::new(stage.tracer.scene(), 1 << 30);
            for reference in references {
                cache.insert(Arc::new(reference.clone()));
            }
            let (camera, settings) = (stage.camera(0.1), RenderSettings { mode, trace: TRACE });
            let request = FrameRequest::new(&stage.tracer, &camera, [64, 48], &settings).reusing(&cache);
            Renderer::default().render(&request).radiance.clone()
        };
        let read = references.each_ref().map(|reference| stage.stored(reference));
        for mode in [Mode::Exact, Mode::Fast] {
            assert!(frame(&references, mode) == frame(&read, mode), "{mode:?}");
        }
    }
}

/// The same scene with its triangles and vertices in another order.
fn renumbered(scene: &Scene) -> Scene {
    let mut other = scene.clone();
    let mut order: Vec<usize> = (0..scene.triangles.len()).collect();
    order.sort_by_key(|&triangle| Key::of_pixel(1, triangle as u32).bits());
    other.triangles = Arc::new(order.iter().map(|&t| scene.triangles[t]).collect());
    other.triangle_materials = Arc::new(order.iter().map(|&t| scene.triangle_materials[t]).collect());
    if !scene.solids.is_empty() {
        other.solids = order.iter().map(|&t| scene.solids[t]).collect();
    }
    other
}

#[test]
fn triangles_with_other_numbers_keep_their_pixels_and_lost_ones_lose_theirs() {
    let stage = &STAGES[0];
    let [reference, _] = stage.sparse([40, 30], &TRACE, 0.1);
    let (pixels, summary) = (encode(&reference, &stage.tracer, &stage.content), stage.summary(&reference));
    let other = Tracer::new(Arc::new(renumbered(stage.tracer.scene())));
    let content = SceneContent::new(other.scene());
    assert!(summary.holds_in(&content));
    let read = decode(&pixels, &summary, &other, &content).unwrap();
    assert_eq!(read.lit(), reference.lit());
    for pixel in (0..1200).filter(|&pixel| reference.has_light(pixel)) {
        let corners = |frame: &ReferenceFrame, tracer: &Tracer| {
            tracer.scene().corners(frame.triangle()[pixel as usize])
        };
        assert_eq!(corners(&reference, &stage.tracer), corners(&read, &other));
        assert_eq!(
            (reference.light(pixel), reference.disparity()[pixel as usize]),
            (read.light(pixel), read.disparity()[pixel as usize])
        );
    }
    // One surface in another colour, or one light more.
    let mut painted = stage.tracer.scene().as_ref().clone();
    painted.materials[0].diffuse.x *= 0.5;
    assert!(!summary.holds_in(&SceneContent::new(&painted)));
    let mut lit = stage.tracer.scene().as_ref().clone();
    lit.sun = Some(crate::scene::Sun::clear_day());
    assert!(!summary.holds_in(&SceneContent::new(&lit)));
    // A scene in which other triangles stand elsewhere shares none of the pixels.
    let foreign = &STAGES[2];
    let read = decode(&pixels, &summary, &foreign.tracer, &foreign.content).unwrap();
    assert!((0..1200).all(|pixel| {
        !read.has_light(pixel)
            || foreign
                .content
                .triangle_of(stage.content.hash_of(reference.triangle()[pixel as usize]))
                .is_some()
    }));
    assert!(!summary.holds_in(&foreign.content) && summary.holds_in(&stage.content));
}
