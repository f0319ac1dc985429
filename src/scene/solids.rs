//! Which dielectric triangles bound a closed body, and on which side its inside lies.

use super::{Material, MaterialId, SolidSide};
use glam::{DVec3, Vec3};
use std::collections::HashMap;

/// One entry per triangle where the scene has glass, else nothing.
///
/// Glass triangles connected by shared vertex positions form a body. It is solid where every edge belongs to exactly
/// two of its triangles; the sign of its volume tells which way its triangles are wound, so wrong winding in a file
/// does not matter. Anything open is a thin sheet.
pub(super) fn classify(
    positions: &[Vec3],
    triangles: &[[u32; 3]],
    triangle_materials: &[MaterialId],
    materials: &[Material],
) -> Vec<SolidSide> {
    let is_glass = |t: usize| materials[triangle_materials[t].0 as usize].is_glass();
    let glass: Vec<usize> = (0..triangles.len()).filter(|&t| is_glass(t)).collect();
    if glass.is_empty() {
        return Vec::new();
    }
    let mut ids: HashMap<[u32; 3], u32> = HashMap::new();
    let welded: Vec<[u32; 3]> = glass
        .iter()
        .map(|&t| {
            triangles[t].map(|v| {
                let next = ids.len() as u32;
                // +0 and -0 are one position.
                *ids.entry((positions[v as usize] + 0.0).to_array().map(f32::to_bits)).or_insert(next)
            })
        })
        .collect();
    let mut sides = vec![SolidSide::Thin; triangles.len()];
    for body in bodies(&welded, ids.len()) {
        if !is_closed(&body, &welded) {
            continue;
        }
        let volume: f64 = body.iter().map(|&i| signed_volume(triangles[glass[i]], positions)).sum();
        let side = if volume >= 0.0 { SolidSide::InsideBehind } else { SolidSide::InsideInFront };
        for i in body {
            sides[glass[i]] = side;
        }
    }
    sides
}

fn signed_volume(triangle: [u32; 3], positions: &[Vec3]) -> f64 {
    let [a, b, c]: [DVec3; 3] = triangle.map(|v| positions[v as usize].as_dvec3());
    a.dot(b.cross(c)) / 6.0
}

fn bodies(welded: &[[u32; 3]], vertex_count: usize) -> Vec<Vec<usize>> {
    let mut parent: Vec<u32> = (0..vertex_count as u32).collect();
    fn root(parent: &mut [u32], mut i: u32) -> u32 {
        while parent[i as usize] != i {
            parent[i as usize] = parent[parent[i as usize] as usize];
            i = parent[i as usize];
        }
        i
    }
    for t in welded {
        for v in &t[1..] {
            let (a, b) = (root(&mut parent, t[0]), root(&mut parent, *v));
            parent[a.max(b) as usize] = a.min(b);
        }
    }
    let mut body_of_root: HashMap<u32, usize> = HashMap::new();
    let mut bodies: Vec<Vec<usize>> = Vec::new();
    for (i, t) in welded.iter().enumerate() {
        let body = *body_of_root.entry(root(&mut parent, t[0])).or_insert_with(|| {
            bodies.push(Vec::new());
            bodies.len() - 1
        });
        bodies[body].push(i);
    }
    bodies
}

/// Every directed edge is met by exactly one edge the other way: closed, and wound alike throughout.
fn is_closed(body: &[usize], welded: &[[u32; 3]]) -> bool {
    let mut balance: HashMap<(u32, u32), i32> = HashMap::new();
    let mut count: HashMap<(u32, u32), u32> = HashMap::new();
    for &i in body {
        let t = welded[i];
        for k in 0..3 {
            let (a, b) = (t[k], t[(k + 1) % 3]);
            let edge = (a.min(b), a.max(b));
            *balance.entry(edge).or_default() += if a < b { 1 } else { -1 };
            *count.entry(edge).or_default() += 1;
        }
    }
    balance.values().all(|&b| b == 0) && count.values().all(|&c| c == 2)
}
