//! Finishes the pixels that the look-up left open: mirrors and glass, guesses, and what no reference saw.

use super::{Mode, RenderSettings};
use crate::camera::View;
use crate::lookup::{LookupSet, PointCache, SurfaceKey, TracedPoint};
use crate::math::Ray;
use crate::math::key::Key;
use crate::trace::{Hit, PixelTrace, RayCounts, SurfacePoint, TraceSettings, Tracer};
use glam::Vec3;
use std::ops::AddAssign;

/// A guess that is off by more than this share of the brighter of the two gives way to what was traced. Below it the
/// look-up, a mean over references, has less noise than sixteen rays. 0.15, 0.1 and 0.06 gave
/// ever less error on a frame of the gallery's walk that has little noise; with 0.06 noisy ones stay below the full tracer's.
const BAD_GUESS: f32 = 0.06;

/// What a place showed when it was traced, the guess or what was traced, it goes on showing until a guess is so many times
/// farther off, or nearer. References come and go, guesses with them, and at one threshold the colour would go to and fro.
const HYSTERESIS: f32 = 1.5;

/// Points that one pixel's mirrors and glass leave at most, so that memory is bounded; a frame after it finds these and
/// leaves the next.
pub(super) const MAX_POINTS: usize = 4;

/// What finishing pixels takes and leaves.
#[derive(Debug, Default)]
pub(super) struct Spent {
    pub(super) rays: RayCounts,
    /// Traced where no reference knows the light.
    pub(super) points: Vec<TracedPoint>,
}

impl AddAssign for Spent {
    fn add_assign(&mut self, mut other: Self) {
        self.rays += other.rays;
        self.points.append(&mut other.points);
    }
}

/// What pixels are finished with.
#[derive(Clone, Copy)]
pub(super) struct Finish<'a> {
    tracer: &'a Tracer,
    lookup: &'a LookupSet<'a>,
    view: &'a View,
    points: &'a PointCache,
    settings: &'a TraceSettings,
    /// Whether guesses are checked, or taken as they are.
    checks: bool,
}

/// What became of a guess.
#[derive(Clone, Copy, Debug)]
pub(super) struct Checked {
    pub(super) radiance: Vec3,
    /// What was traced took its place.
    pub(super) is_traced: bool,
}

/// How a pixel sees a point.
struct Seen {
    pixel: u32,
    /// Length of the way to it, scene units.
    distance: f32,
    /// The share of the pixel that it is, 0..1.
    share: f32,
    /// Of the random numbers.
    key: Key,
}

impl<'a> Finish<'a> {
    pub(super) fn new(
        tracer: &'a Tracer,
        lookup: &'a LookupSet<'a>,
        view: &'a View,
        points: &'a PointCache,
        settings: &'a RenderSettings,
    ) -> Self {
        Self { tracer, lookup, view, points, settings: &settings.trace, checks: settings.mode == Mode::Exact }
    }

    /// The light that a pixel's mirror or glass shows.
    pub(super) fn specular_of(&self, pixel: u32, triangle: u32, spent: &mut Spent) -> Vec3 {
        let (ray, Some(hit)) = self.hit(pixel, triangle) else { return Vec3::ZERO };
        self.specular(&self.tracer.surface(&ray, &hit), &ray, &hit, pixel, spent)
    }

    /// Shades a pixel; what its mirror or glass shows is looked up.
    pub(super) fn shade(&self, pixel: u32, triangle: u32, spent: &mut Spent) -> PixelTrace {
        let (ray, hit) = self.hit(pixel, triangle);
        let key = Key::of_pixel(self.settings.seed, pixel);
        let (mut traced, point) = self.tracer.shade_hit(&ray, hit, self.settings, key, &mut spent.rays);
        if let (Some(hit), Some(point)) = (hit, point) {
            traced.radiance += self.specular(&point, &ray, &hit, pixel, spent);
        }
        traced
    }

    /// A pixel whose light the look-up guessed: the guess of its diffuse radiance is held against what is traced there.
    pub(super) fn check(&self, pixel: u32, triangle: u32, guess: Vec3, spent: &mut Spent) -> Checked {
        let (ray, Some(hit)) = self.hit(pixel, triangle) else {
            return Checked { radiance: guess, is_traced: false };
        };
        let point = self.tracer.surface(&ray, &hit);
        let key = Key::of_pixel(self.settings.seed, pixel);
        let seen = Seen { pixel, distance: distance(&ray, &hit), share: 1.0, key };
        let diffuse = self.checked(guess, &point, &seen, spent);
        let specular = self.specular(&point, &ray, &hit, pixel, spent);
        Checked { radiance: diffuse.radiance + specular, ..diffuse }
    }

    /// The ray of a pixel, and where it meets the triangle it is known to see.
    fn hit(&self, pixel: u32, triangle: u32) -> (Ray, Option<Hit>) {
        let ray = Tracer::primary_ray(self.view, pixel);
        (ray, self.tracer.hit_on_triangle(&ray, triangle))
    }

    /// The specular radiance of a pixel's first surface, with the light of all that it mirrors or lets through looked up.
    fn specular(&self, point: &SurfacePoint, ray: &Ray, hit: &Hit, pixel: u32, spent: &mut Spent) -> Vec3 {
        let tracer = self.tracer;
        if !tracer.is_view_dependent(point) {
            return Vec3::ZERO;
        }
        let (key, distance) = (Key::of_pixel(self.settings.seed, pixel), distance(ray, hit));
        let most_points = spent.points.len() + MAX_POINTS;
        let mut secondary = 0;
        let (radiance, _) =
            tracer.follow_specular(point, ray.direction, key, &mut secondary, |next, vertex| {
                let (share, key) = (vertex.share, vertex.key);
                let seen = Seen { pixel, distance: distance + vertex.length, share, key };
                let radiance = self.diffuse(next, &seen, spent);
                spent.points.truncate(most_points);
                radiance
            });
        spent.rays.secondary += secondary;
        radiance
    }

    /// The diffuse radiance of a point that a mirror or a pane shows.
    fn diffuse(&self, point: &SurfacePoint, seen: &Seen, spent: &mut Spent) -> Vec3 {
        let albedo = point.albedo(self.tracer.scene());
        let SurfaceKey { position, normal, footprint } = self.place(point, seen);
        let found = (albedo != Vec3::ZERO)
            .then(|| {
                if self.checks {
                    self.lookup.light_at(position, normal, point.triangle, footprint)
                } else {
                    self.lookup.unchecked_light_at(position, normal, point.triangle)
                }
            })
            .flatten();
        match found {
            Some(found) if found.is_guess => {
                self.checked(self.lit(point, found.light), point, seen, spent).radiance
            }
            Some(found) => self.lit(point, found.light),
            None => self.unseen(point, seen, spent),
        }
    }

    /// The diffuse radiance of a point that no reference knows; traced once for all frames.
    fn unseen(&self, point: &SurfacePoint, seen: &Seen, spent: &mut Spent) -> Vec3 {
        let samples = self.settings.samples_for(seen.share);
        let near = self.place(point, seen);
        match self.points.find(&near, samples) {
            Some(kept) if !kept.is_at_edge => self.lit(point, kept.light),
            Some(_) => match self.points.find(&near.exact(), samples) {
                Some(kept) => self.lit(point, kept.light),
                None => self.traced(point, seen, spent, &[near.exact()], None),
            },
            None => self.traced(point, seen, spent, &[near], None),
        }
    }

    /// The diffuse radiance of a point that was guessed. What was traced nearby can confirm a guess; only what was traced at
    /// the very place replaces it, because it is at the edges of shadows that guesses are bad. The very place is asked about last: it is kept
    /// beside what is near, and each place that is asked about is one more that the processor has to wait for.
    fn checked(&self, guess: Vec3, point: &SurfacePoint, seen: &Seen, spent: &mut Spent) -> Checked {
        let samples = self.settings.samples_for(seen.share);
        let near = self.place(point, seen);
        let mut trace = |places: &[SurfaceKey]| {
            let traced = self.traced(point, seen, spent, places, Some(guess));
            self.better(guess, traced, 1.0)
        };
        let Some(kept) = self.points.find(&near, samples) else { return trace(&[near, near.exact()]) };
        let most = if kept.took_over { 1.0 / HYSTERESIS } else { 1.0 };
        if !kept.is_at_edge && !self.is_bad(guess, self.lit(point, kept.light), most) {
            return Checked { radiance: guess, is_traced: false };
        }
        match self.points.find(&near.exact(), samples) {
            Some(kept) => {
                let most = if kept.took_over { 1.0 / HYSTERESIS } else { HYSTERESIS };
                self.better(guess, self.lit(point, kept.light), most)
            }
            None => trace(&[near.exact()]),
        }
    }

    /// Traces the diffuse radiance of a point and keeps its light under some names, and whether it is to take a guess's
    /// place.
    fn traced(
        &self,
        point: &SurfacePoint,
        seen: &Seen,
        spent: &mut Spent,
        places: &[SurfaceKey],
        guess: Option<Vec3>,
    ) -> Vec3 {
        let rays = &mut spent.rays;
        let [radiance, light] =
            self.tracer.diffuse_radiance_and_light(point, seen.share, self.settings, seen.key, rays);
        if point.albedo(self.tracer.scene()) != Vec3::ZERO {
            let (samples, noise) = (self.settings.samples_for(seen.share), self.settings.noise());
            let (pixel, near) = (seen.pixel, self.place(point, seen));
            let took_over = guess.is_some_and(|guess| self.is_bad(guess, radiance, 1.0));
            spent.points.extend(places.iter().map(|&place| {
                let is_very_place = place != near;
                TracedPoint { place, light, samples, noise, pixel, is_very_place, took_over }
            }));
        }
        radiance
    }

    fn place(&self, point: &SurfacePoint, seen: &Seen) -> SurfaceKey {
        let footprint = self.view.scene_from_pixel.x_axis.length() * seen.distance;
        SurfaceKey { position: point.position, normal: point.geometric_normal, footprint }
    }

    /// True where a guess is off what was traced by more than `most` times the noise.
    fn is_bad(&self, guess: Vec3, traced: Vec3, most: f32) -> bool {
        let most = most * BAD_GUESS * self.settings.noise() * traced.max(guess).max_element();
        (traced - guess).abs().max_element() > most
    }

    fn better(&self, guess: Vec3, traced: Vec3, most: f32) -> Checked {
        let is_traced = self.is_bad(guess, traced, most);
        Checked { radiance: if is_traced { traced } else { guess }, is_traced }
    }

    /// The diffuse radiance of a point in some light.
    fn lit(&self, point: &SurfacePoint, light: Vec3) -> Vec3 {
        let scene = self.tracer.scene();
        scene.materials[point.material.0 as usize].emission + point.albedo(scene) * light
    }
}

/// Length of a primary ray up to its hit.
fn distance(ray: &Ray, hit: &Hit) -> f32 {
    hit.t * ray.direction.length()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::reference::ReferenceCache;
    use crate::scene::builtin;
    use std::sync::Arc;

    /// Whether what was traced is shown for guesses that are off by so many times the noise, where the first guess was.
    fn is_traced(first_off: f32, off: [f32; 3]) -> [bool; 3] {
        let scene = Arc::new(builtin::build("furnace").unwrap());
        let tracer = Tracer::new(scene.clone());
        let view = View::new(scene.start(), &scene.frame, [9, 9]);
        let (pixel, settings) = (40, RenderSettings { mode: Mode::Exact, ..RenderSettings::default() });
        let triangle = tracer.closest(&Tracer::primary_ray(&view, pixel)).expect("a hit").triangle;
        let cache = ReferenceCache::new(&scene, 0);
        let lookup = LookupSet::new(&cache, tracer.epoch());
        let (mut points, mut spent) = (PointCache::default(), Spent::default());
        let truth = Finish::new(&tracer, &lookup, &view, &points, &settings)
            .check(pixel, triangle, Vec3::ZERO, &mut Spent::default())
            .radiance;
        let guess = |off: f32| truth * (1.0 - off * BAD_GUESS * settings.trace.noise());
        let first = Finish::new(&tracer, &lookup, &view, &points, &settings);
        assert_eq!(
            first.check(pixel, triangle, guess(first_off), &mut spent).is_traced,
            first_off > 1.0,
            "at first there is one threshold"
        );
        points.enter(tracer.epoch(), &mut spent.points);
        let finish = Finish::new(&tracer, &lookup, &view, &points, &settings);
        off.map(|off| finish.check(pixel, triangle, guess(off), &mut spent).is_traced)
    }

    #[test]
    fn a_place_goes_on_showing_what_it_showed_until_the_guess_is_clearly_better_or_worse() {
        assert_eq!(is_traced(0.5, [0.9, 1.2, 1.7]), [false, false, true]);
        assert_eq!(is_traced(2.0, [1.1, 0.8, 0.5]), [true, true, false]);
    }
}
