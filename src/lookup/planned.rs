//! Which pixels of a planned reference earlier ones of the plan light already.
//!
//! Nothing is lit here: the references of a plan are pictures of first hits. A pixel is left to an
//! earlier reference by the rule with which frames look light up, and by the surface that a sample
//! covers, so that no pixel is left to a reference in which no look-up would find it.

use super::open_pixels::{hit_tiles, open_pixels};
use super::point::{LookupReference, LookupSet};
use super::policy::{COMPARABLE, MIN_COVERAGE};
use crate::camera::{Camera, View};
use crate::reference::ReferenceFrame;
use crate::trace::{TraceSettings, Tracer};
use glam::Vec3;
use rayon::prelude::*;
use std::collections::HashMap;

/// Side of the cubes of space by which the references that light a surface are found, scene units:
/// a 32nd to a 64th of the diagonal of the scene.
const SIDE: f32 = 16.0;

/// Pixels that a thread takes at a time.
const CHUNK: usize = 256;

/// The references of a plan as pictures of what they light.
#[derive(Debug, Default)]
pub(crate) struct PlannedPictures {
    pictures: Vec<ReferenceFrame>,
    /// For each cube of space, the pictures that light a surface in it.
    places: HashMap<[i32; 3], Vec<u32>>,
}

impl PlannedPictures {
    /// Adds a reference that lights what those before it do not light as finely: with at least a
    /// quarter of its samples per area. Returns the pixels that it lights, tile by tile. One that
    /// would light at most `least` pixels is not added, and lights none.
    ///
    /// `empty` is a set without references. The size must be at least two pixels a side.
    pub(crate) fn add(
        &mut self,
        tracer: &Tracer,
        camera: &Camera,
        size: [u32; 2],
        empty: &LookupSet<'_>,
        least: usize,
    ) -> Vec<u32> {
        let (mut picture, wanted) = surfaces(tracer, camera, size, empty);
        let normals = empty.normals();
        let pictures = self.pictures.iter();
        let earlier: Vec<LookupReference<'_>> = pictures
            .map(|picture| LookupReference::new(picture, (picture.packed_light().0, false), normals, 1))
            .collect();
        let is_open = |pixel: &u32, last: &mut Option<u32>| {
            Surface::of(&picture, tracer, *pixel)
                .is_some_and(|surface| !self.is_lit(&surface, &earlier, last))
        };
        let is_open = &is_open;
        let open: Vec<u32> = wanted
            .par_chunks(CHUNK)
            .flat_map_iter(|pixels| {
                let mut last = None;
                pixels.iter().copied().filter(move |pixel| is_open(pixel, &mut last))
            })
            .collect();
        if open.len() <= least {
            return Vec::new();
        }
        picture.store_lights(&open, std::iter::repeat_n(Vec3::ZERO, open.len()));
        self.note_places(&picture, &open);
        self.pictures.push(picture);
        open
    }

    /// True where an earlier reference lights a surface finely enough. `last` is the one that did
    /// so for the pixel before.
    fn is_lit(&self, surface: &Surface, earlier: &[LookupReference<'_>], last: &mut Option<u32>) -> bool {
        let Some(near) = self.places.get(&cube_of(surface.position)) else { return false };
        let lights = |at: u32| {
            let Surface { position, normal, triangle, density } = *surface;
            let found = earlier[at as usize].light_at::<false>(position, normal, triangle, |_| true);
            found.is_some_and(|light| light.coverage >= MIN_COVERAGE && light.density * COMPARABLE >= density)
        };
        if last.is_some_and(lights) {
            return true;
        }
        let found = near.iter().rev().copied().find(|&at| lights(at));
        *last = found.or(*last);
        found.is_some()
    }

    fn note_places(&mut self, picture: &ReferenceFrame, lit: &[u32]) {
        let number = self.pictures.len() as u32;
        for &pixel in lit {
            let cube = cube_of(picture.view.eye + picture.offset_from_eye(pixel));
            let numbers = self.places.entry(cube).or_default();
            if numbers.last() != Some(&number) {
                numbers.push(number);
            }
        }
    }
}

/// What a reference at a pose shows, without light, and the pixels whose light can be stored.
fn surfaces(
    tracer: &Tracer,
    camera: &Camera,
    size: [u32; 2],
    empty: &LookupSet<'_>,
) -> (ReferenceFrame, Vec<u32>) {
    let view = View::new(camera, &tracer.scene().frame, size);
    let tiles = hit_tiles(tracer, &view, empty);
    let settings = TraceSettings { samples: 1, bounces: 0, seed: 0 };
    let mut picture = ReferenceFrame::empty(tracer, camera, view, &settings);
    tiles.iter().for_each(|tile| tile.store_hits(&mut picture, tracer));
    picture.forget_ill_conditioned(tracer);
    let wanted = open_pixels(&tiles, &view);
    (picture, wanted)
}

fn cube_of(position: Vec3) -> [i32; 3] {
    (position / SIDE).floor().as_ivec3().to_array()
}

/// The surface that a pixel shows.
struct Surface {
    position: Vec3,
    /// Unit normal on the viewer's side.
    normal: Vec3,
    triangle: u32,
    /// Samples per unit of surface area, scene units.
    density: f32,
}

impl Surface {
    /// `None` where the pixel must not be used.
    fn of(picture: &ReferenceFrame, tracer: &Tracer, pixel: u32) -> Option<Self> {
        let (view, disparity) = (&picture.view, picture.disparity()[pixel as usize]);
        let triangle = picture.triangle()[pixel as usize];
        let offset = (disparity > 0.0).then(|| picture.offset_from_eye(pixel))?;
        let [a, b, c] = tracer.scene().corners(triangle);
        let normal = (b - a).cross(c - a).normalize_or(Vec3::Y);
        let normal = if normal.dot(offset) > 0.0 { -normal } else { normal };
        let step = view.scene_from_pixel.x_axis.length();
        let density = -normal.dot(offset) * disparity.powi(3) / (step * step);
        Some(Self { position: view.eye + offset, normal, triangle, density })
    }
}
