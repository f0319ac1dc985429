//! The continuations of a path at a surface.

use glam::Vec3;

/// A direction in which a path continues.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scatter {
    /// Unit direction.
    pub direction: Vec3,
    /// Factor of the path's throughput, per channel: value times cosine over density, or the share
    /// that a specular direction carries.
    pub weight: Vec3,
    /// True where the path leaves on the far side of the surface.
    pub is_transmitted: bool,
}

/// Every direction in which a path continues, at most two: both branches of a dielectric, the one
/// of a mirror, or one sample of a lobe that is not specular.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ScatterSet([Option<Scatter>; 2]);

impl ScatterSet {
    /// No continuation: the light is absorbed.
    pub const EMPTY: Self = Self([None, None]);

    /// A reflected direction.
    #[inline]
    pub fn reflected(direction: Vec3, weight: Vec3) -> Self {
        Self([Some(Scatter { direction, weight, is_transmitted: false }), None])
    }

    /// A transmitted and a reflected direction, each with its weight.
    #[inline]
    pub fn split(transmitted: Option<(Vec3, Vec3)>, reflected: Option<(Vec3, Vec3)>) -> Self {
        let scatter =
            |is_transmitted| move |(direction, weight)| Scatter { direction, weight, is_transmitted };
        Self([transmitted.map(scatter(true)), reflected.map(scatter(false))])
    }

    /// The continuations, the one that carries more light first.
    #[inline]
    pub fn heaviest_first(mut self) -> impl Iterator<Item = Scatter> {
        let weight = |s: &Option<Scatter>| s.map_or(0.0, |s| s.weight.max_element());
        if weight(&self.0[0]) < weight(&self.0[1]) {
            self.0.swap(0, 1);
        }
        self.0.into_iter().flatten()
    }

    /// The sum of the weights' largest channels: what all continuations carry together.
    pub fn total_weight(&self) -> f32 {
        self.0.iter().flatten().map(|s| s.weight.max_element()).sum()
    }

    /// Returns one continuation, chosen with a probability proportional to what it carries and
    /// weighted by the inverse of that probability; `random` is in [0, 1).
    pub fn choose(self, random: f32) -> Option<Scatter> {
        let [Some(a), Some(b)] = self.0 else { return self.0[0].or(self.0[1]) };
        let (weight_a, weight_b) = (a.weight.max_element(), b.weight.max_element());
        let first = weight_a / (weight_a + weight_b);
        Some(if random < first {
            Scatter { weight: a.weight / first, ..a }
        } else {
            Scatter { weight: b.weight / (1.0 - first), ..b }
        })
    }
}
