//! Lamps so near to a point that points chosen evenly on them light it badly.
//!
//! A panel a hand's breadth below a ceiling lights the ceiling by the few points of it that are
//! nearest. Points chosen evenly on the panel seldom fall there, and bring thousands of times the
//! mean when they do: dots all over a picture of many bounces. The next ray of a path meets such a
//! lamp often and brings its radiance alone. So at a vertex of a path, each direction belongs to
//! one of the two: to a shadow ray where the sample would bring at most [`MOST`], else to the path.
//! The halves add up without weights, as in the maximum heuristic of Veach and Guibas, "Optimally
//! Combining Sampling Techniques for Monte Carlo Rendering", SIGGRAPH 1995.

use crate::scene::Light;
use crate::trace::{SurfacePoint, Tracer};
use std::f32::consts::PI;

/// Largest irradiance, relative to the lamp's radiance, of a sample that a shadow ray brings: four
/// times what a lamp all around a surface does. There the path finds the direction four times as
/// often as points on the lamp do.
pub(super) const MOST: f32 = 4.0 * PI;

impl Tracer {
    /// True where shadow rays leave the emission of `lamp` to the path that arrives from `vertex`.
    pub(in crate::trace) fn is_lamp_near(&self, vertex: &SurfacePoint, lamp: &SurfacePoint) -> bool {
        let scene = self.scene();
        // Most surfaces are no lamps: search the list of those only where a surface emits.
        if !scene.material_of(lamp.triangle).is_emissive() {
            return false;
        }
        let Some(light) = scene.lamp_of_triangle(lamp.triangle) else { return false };
        let area = match &scene.lights[light as usize] {
            Light::Quad { edge_u, edge_v, .. } => edge_u.cross(*edge_v).length(),
            Light::Triangles { area, picture: None, .. } => *area,
            _ => return false,
        };
        let d = lamp.position - vertex.position;
        let inverse = 1.0 / d.length_squared();
        let cosines =
            (vertex.shading_normal.dot(d) * inverse) * (lamp.geometric_normal.dot(d).abs() * inverse);
        cosines * area > MOST
    }
}
