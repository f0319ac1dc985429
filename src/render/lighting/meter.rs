//! Illuminance at sensors in free space, measured until its error is small.

use crate::math::key::Key;
use crate::raster::color::luminance;
use crate::trace::{RayCounts, TraceSettings, Tracer, parallel::Stop};
use glam::{DVec3, Vec3};
use rayon::prelude::*;
use std::f64::consts::PI;

/// A small flat sensor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sensor {
    /// Position in world metres.
    pub position_m: DVec3,
    /// Unit vector that the sensor faces.
    pub facing: Vec3,
}

/// Illuminance at a sensor, and its error.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Reading {
    /// Illuminance in lux.
    pub lux: f64,
    /// Standard error of the illuminance in lux, estimated from the spread of the passes; infinite
    /// after fewer than two.
    pub standard_error_lux: f64,
}

/// Passes below which the errors, estimated from their spread, are themselves too uncertain.
const MIN_PASSES: u32 = 4;

/// Share of the mean reading below which a sensor counts as dark: its error is compared with that.
const MIN_SHARE_OF_MEAN: f64 = 0.1;

/// Sums of the passes of one sensor, lux.
#[derive(Clone, Copy, Debug, Default)]
struct Sums {
    light: f64,
    squares: f64,
}

/// Measures the illuminance at sensors, pass after pass. Each pass is an independent unbiased
/// estimate, so the spread of the passes is the error of their mean.
#[derive(Debug)]
pub struct LightMeter<'a> {
    tracer: &'a Tracer,
    sensors: Vec<Sensor>,
    trace: TraceSettings,
    sums: Vec<Sums>,
    passes: u32,
    /// Rays that were traced.
    pub rays: RayCounts,
}

impl<'a> LightMeter<'a> {
    /// A meter that has measured nothing yet. `trace` has the samples of a pass, the bounces, and
    /// the seed.
    pub fn new(tracer: &'a Tracer, sensors: Vec<Sensor>, trace: TraceSettings) -> Self {
        let sums = vec![Sums::default(); sensors.len()];
        Self { tracer, sensors, trace, sums, passes: 0, rays: RayCounts::default() }
    }

    /// Measures one more pass on the threads of the current pool, the same bits at any number of
    /// them. Returns false after a stop; the pass does not count then.
    pub fn pass(&mut self, stop: Stop<'_>) -> bool {
        let (tracer, trace, pass) = (self.tracer, self.trace, self.passes);
        let measure = |(number, sensor): (usize, &Sensor)| {
            let mut rays = RayCounts::default();
            let lux = (!stop()).then(|| lux(tracer, sensor, &trace, [number as u32, pass], &mut rays))?;
            Some((lux, rays))
        };
        let read: Option<Vec<_>> = self.sensors.par_iter().enumerate().map(measure).collect();
        let Some(read) = read else { return false };
        for (sums, (lux, rays)) in self.sums.iter_mut().zip(read) {
            sums.light += lux;
            sums.squares += lux * lux;
            self.rays += rays;
        }
        self.passes += 1;
        true
    }

    /// Number of passes that were measured.
    pub fn passes(&self) -> u32 {
        self.passes
    }

    /// The sensors, in the order of the readings.
    pub fn sensors(&self) -> &[Sensor] {
        &self.sensors
    }

    /// Returns the readings so far, one for each sensor.
    pub fn readings(&self) -> Vec<Reading> {
        let count = f64::from(self.passes);
        let read = |sums: &Sums| {
            let lux = sums.light / count.max(1.0);
            let variance = (sums.squares / count.max(1.0) - lux * lux).max(0.0);
            let standard_error_lux =
                if self.passes < 2 { f64::INFINITY } else { (variance / (count - 1.0)).sqrt() };
            Reading { lux, standard_error_lux }
        };
        self.sums.iter().map(read).collect()
    }

    /// True where 95 % of the sensors have a standard error of at most `share` (such as 0.02 for
    /// 2 %) of their reading, or of a tenth of the mean where they read less than that.
    pub fn is_within(&self, share: f64) -> bool {
        let readings = self.readings();
        let mean = readings.iter().map(|r| r.lux).sum::<f64>() / readings.len().max(1) as f64;
        let is_off = |r: &&Reading| r.standard_error_lux > share * r.lux.max(MIN_SHARE_OF_MEAN * mean);
        self.passes >= MIN_PASSES && readings.iter().filter(is_off).count() * 20 <= readings.len()
    }
}

/// One estimate of the illuminance at a sensor. `numbers` are those of the sensor and of the pass.
fn lux(
    tracer: &Tracer,
    sensor: &Sensor,
    trace: &TraceSettings,
    [number, pass]: [u32; 2],
    rays: &mut RayCounts,
) -> f64 {
    let scene = tracer.scene();
    let position = scene.frame.scene_from_world_f64(sensor.position_m).as_vec3();
    let key = Key::of_pixel(trace.seed, number).with(pass);
    let light = tracer.light_at_sensor((position, sensor.facing), trace, key.into(), rays);
    // A white surface of radiance L receives the irradiance pi L.
    f64::from(luminance(light.total())) * PI * f64::from(scene.nits_per_unit())
}
