//! How many samples each light of a cell gets.
//!
//! Up to [`MAX_LIGHTS`] lights get all samples that are asked for. More lights share the samples of
//! that many, so that the cost of a point is bounded. A light's share (0..1) of its samples grows
//! with the light that it is estimated to bring to the cell; the brightest lights keep all of
//! theirs. A light that expects less than one sample is left to chance, and counts for as much more
//! where it is chosen: the estimate stays unbiased.
//!
//! Source: Shirley, Wang and Zimmerman, "Monte Carlo Techniques for Direct Lighting Calculations",
//! ACM TOG 15(1), 1996 (section 5: lights chosen by their estimated contribution to a cell), and
//! Madow, "On the Theory of Systematic Sampling, II", 1949: one random offset places the samples
//! of all lights at equal distances along the sum of their shares. We differ: shares are limited to
//! one light's own samples, and the estimates contain the visibility of the light from the cell.

/// Number of lights that get all their samples; more lights in a cell share the samples of this
/// many. No scene of the embedded ones and no real model at hand has a cell with more, so pictures
/// of these do not depend on it.
pub(super) const MAX_LIGHTS: usize = 64;

/// Part of the samples that all lights share equally, whatever their estimates: an estimate that is
/// too low by any factor multiplies the weight of a sample by at most ten times the number of
/// lights over [`MAX_LIGHTS`].
const EQUAL_PART: f64 = 0.1;

/// The share of a light that gets all its samples. Shares are whole numbers, so that their sums are
/// exact and any number of samples divides them in the same way on every machine.
const ALL: u32 = 1 << SHARE_BITS;
const SHARE_BITS: u32 = 25;

/// Dimension of the offset that places shared samples, in addition to those of the lights.
pub(super) const SHARING: u32 = u32::MAX;

/// The lights that matter in a cell, and their shares of the samples.
#[derive(Debug)]
pub(in crate::trace) struct CellLights {
    /// Indices into the scene's lights, ascending.
    indices: Box<[u32]>,
    /// Sum of the shares up to and including each light; empty where no light has to share.
    ends: Box<[u32]>,
}

/// A light and its number of samples at a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct LightTurn {
    /// Index into the scene's lights.
    pub(super) index: u32,
    /// Number of samples, at least one.
    pub(super) samples: u32,
    /// Factor of the estimate of the light's irradiance.
    pub(super) weight: f32,
}

impl CellLights {
    /// Lights with the irradiance that each is estimated to bring to the cell; estimates need no
    /// unit.
    pub(super) fn new(lights: &[(u32, f32)]) -> Self {
        let indices = lights.iter().map(|(index, _)| *index).collect();
        let ends = if lights.len() > MAX_LIGHTS { ends(&shares(lights)) } else { Box::default() };
        Self { indices, ends }
    }

    /// Number of lights.
    pub(super) fn len(&self) -> usize {
        self.indices.len()
    }

    /// True where a light, given by its index in the scene, matters in the cell.
    pub(super) fn contains(&self, light: u32) -> bool {
        self.indices.binary_search(&light).is_ok()
    }

    /// True where the lights share samples.
    pub(super) fn is_shared(&self) -> bool {
        !self.ends.is_empty()
    }

    /// The lights to sample at a point: each with `samples`, or with its part of the samples of
    /// [`MAX_LIGHTS`] lights. `random` returns a number in [0, 1) that places shared samples.
    #[inline(always)]
    pub(super) fn turns(&self, samples: u32, random: impl FnOnce() -> f32) -> LightTurns<'_> {
        let offset = if self.is_shared() { offset(random()) } else { 0 };
        LightTurns { lights: self, at: 0, samples, offset, used: 0 }
    }
}

/// Distance of the first sample from the start of the shares, uniform below [`ALL`].
fn offset(random: f32) -> u32 {
    ((random * ALL as f32) as u32).min(ALL - 1)
}

/// The shares of lights (0..1), which sum to [`MAX_LIGHTS`]: proportional to the estimates, with a
/// part divided equally, and at most 1.
fn shares(lights: &[(u32, f32)]) -> Vec<f64> {
    let estimate = |light: &(u32, f32)| f64::from(light.1).clamp(0.0, f64::from(f32::MAX));
    let sum: f64 = lights.iter().map(estimate).sum();
    let equal = 1.0 / lights.len() as f64;
    let weight = |light| if sum > 0.0 { estimate(light) / sum } else { equal };
    let weights: Vec<f64> =
        lights.iter().map(|light| EQUAL_PART * equal + (1.0 - EQUAL_PART) * weight(light)).collect();
    // What a light cannot use is divided among the others, until no share is above 1.
    let mut shares = vec![0.0; lights.len()];
    loop {
        let open = || weights.iter().zip(&shares).filter(|(_, share)| **share < 1.0);
        let left = MAX_LIGHTS.saturating_sub(lights.len() - open().count()) as f64;
        let scale = left / open().map(|(weight, _)| weight).sum::<f64>();
        let mut has_changed = false;
        for (share, weight) in shares.iter_mut().zip(&weights).filter(|(share, _)| **share < 1.0) {
            *share = (weight * scale).min(1.0);
            has_changed |= *share == 1.0;
        }
        if !has_changed {
            return shares;
        }
    }
}

/// The running sum of the shares as whole numbers. No share is zero: that would be a bias.
fn ends(shares: &[f64]) -> Box<[u32]> {
    let mut end = 0;
    let whole = |share: &f64| ((share * f64::from(ALL)) as u32).clamp(1, ALL);
    shares
        .iter()
        .map(|share| {
            end += whole(share);
            end
        })
        .collect()
}

/// Iterates over the lights that get samples at a point.
pub(super) struct LightTurns<'a> {
    lights: &'a CellLights,
    /// Position of the next light in the cell.
    at: usize,
    /// Number of samples of a light that does not share.
    samples: u32,
    offset: u32,
    /// Number of shared samples that the lights before the next one got.
    used: u64,
}

impl Iterator for LightTurns<'_> {
    type Item = LightTurn;

    #[inline(always)]
    fn next(&mut self) -> Option<LightTurn> {
        if self.lights.is_shared() {
            return self.next_shared();
        }
        let index = *self.lights.indices.get(self.at)?;
        self.at += 1;
        Some(LightTurn { index, samples: self.samples, weight: 1.0 })
    }
}

impl LightTurns<'_> {
    /// Sample number k lies at `k * ALL + offset` on the line on which each light covers its share
    /// times `samples`.
    fn next_shared(&mut self) -> Option<LightTurn> {
        let (ends, samples) = (&self.lights.ends, u64::from(self.samples));
        // Find the light of the next sample: mostly the next light.
        let place = self.used << SHARE_BITS | u64::from(self.offset);
        let is_before = |end: &u32| u64::from(*end) * samples <= place;
        if ends.get(self.at).is_some_and(is_before) {
            self.at += ends[self.at..].partition_point(is_before);
        }
        let at = self.at;
        let end = u64::from(*ends.get(at)?);
        // Count the samples that lie before the light's end.
        let until = (end * samples + u64::from(ALL - 1 - self.offset)) >> SHARE_BITS;
        let count = (until - self.used) as u32;
        (self.used, self.at) = (until, at + 1);
        let share = end - at.checked_sub(1).map_or(0, |before| u64::from(ends[before]));
        let expected = (share * samples) as f32 / ALL as f32;
        Some(LightTurn {
            index: self.lights.indices[at],
            samples: count,
            weight: if expected < 1.0 { 1.0 / expected } else { 1.0 },
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Lights of which a few are bright, and every seventh is estimated to bring nothing.
    fn lights(count: u32) -> Vec<(u32, f32)> {
        let estimate = |i: u32| if i.is_multiple_of(7) { 0.0 } else { 1000.0 / (1.0 + i as f32).powi(2) };
        (0..count).map(|i| (2 * i, estimate(i))).collect()
    }

    fn turns_at(lights: &CellLights, samples: u32, offset: u32) -> LightTurns<'_> {
        LightTurns { lights, at: 0, samples, offset, used: 0 }
    }

    #[test]
    fn few_lights_do_not_share() {
        let cell = CellLights::new(&lights(MAX_LIGHTS as u32));
        let turns: Vec<LightTurn> = cell.turns(5, || 0.0).collect();
        assert!(!cell.is_shared() && turns.len() == MAX_LIGHTS);
        assert!(
            turns.iter().zip(0..).all(|(t, i)| *t == LightTurn { index: 2 * i, samples: 5, weight: 1.0 })
        );
        assert_eq!(CellLights::new(&[]).turns(5, || 0.0).count(), 0);
    }

    #[test]
    fn samples_are_bounded_and_none_is_lost() {
        for count in [65, 100, 1000] {
            let cell = CellLights::new(&lights(count));
            for samples in [1, 3, 16, 1 << 20] {
                for offset in [0, 1, ALL / 3, ALL - 1] {
                    let turns: Vec<LightTurn> = turns_at(&cell, samples, offset).collect();
                    let sum: u64 = turns.iter().map(|t| u64::from(t.samples)).sum();
                    let most = MAX_LIGHTS as u64 * u64::from(samples);
                    // Shares are rounded down by less than a unit each.
                    let least = most - (u64::from(count) * u64::from(samples)).div_ceil(u64::from(ALL)) - 1;
                    assert!((least..=most).contains(&sum), "{count} lights, {samples}: {sum} of {most}");
                    assert!(turns.iter().all(|t| (1..=samples).contains(&t.samples) && t.weight >= 1.0));
                    assert!(turns.windows(2).all(|t| t[0].index < t[1].index));
                }
            }
        }
    }

    #[test]
    fn the_brightest_lights_get_all_their_samples_and_the_weight_of_every_light_is_one_on_average() {
        const OFFSETS: u32 = 1 << 14;
        let cell = CellLights::new(&lights(300));
        for samples in [1, 4] {
            let mut weights = vec![0.0f64; 300];
            for number in 0..OFFSETS {
                for turn in turns_at(&cell, samples, number * (ALL / OFFSETS)) {
                    weights[turn.index as usize / 2] += f64::from(turn.weight) / f64::from(OFFSETS);
                    assert!(turn.index != 2 || (turn.samples, turn.weight) == (samples, 1.0));
                }
            }
            // The least share is a tenth of 64 / 300: offsets resolve it to a third of a percent.
            assert!(weights.iter().all(|w| (w - 1.0).abs() < 0.005), "{weights:?}");
        }
    }

    #[test]
    fn estimates_without_a_sense_divide_the_samples_equally() {
        for estimate in [0.0, f32::NAN, f32::INFINITY, -1.0] {
            let lights: Vec<(u32, f32)> = (0..128).map(|i| (i, estimate)).collect();
            let found = shares(&lights);
            assert!(found.iter().all(|s| (s - 0.5).abs() < 1e-9), "{estimate}: {}", found[0]);
        }
    }
}
