//! Triangles whose light changes, cut into small pieces, by side, and grouped by place.

use crate::math::sampling::uniform_triangle;
use crate::scene::Scene;
use glam::Vec3;

/// Longest edge of a piece, as a share of the diagonal of the scene's box: light that arrives at
/// larger ones would differ too much from place to place.
const MAX_EDGE: f32 = 1.0 / 24.0;

/// Pieces beyond which triangles are no longer cut.
const MAX_PIECES: usize = 1 << 17;

/// Groups at most.
pub(super) const MAX_GROUPS: usize = 64;

/// A piece of one side of a triangle.
#[derive(Clone, Copy, Debug)]
pub(super) struct Piece {
    pub(super) corners: [Vec3; 3],
    /// The triangle that it is a piece of.
    pub(super) triangle: u32,
    /// Unit normal of the side.
    pub(super) normal: Vec3,
    pub(super) area: f32,
}

/// Pieces near each other that face similar directions.
#[derive(Clone, Debug)]
pub(super) struct Group {
    pub(super) centre: Vec3,
    pub(super) radius: f32,
    pub(super) area: f32,
    /// Unit mean of the normals, and the sine of the largest angle between it and one of them.
    cone: (Vec3, f32),
    pub(super) pieces: Vec<Piece>,
    /// Share of the area in each piece and all before it.
    cumulative: Vec<f32>,
}

impl Piece {
    fn new(corners: [Vec3; 3], triangle: u32, normal: Vec3) -> Self {
        let [a, b, c] = corners;
        Self { corners, triangle, normal, area: (b - a).cross(c - a).length() / 2.0 }
    }

    fn middle(&self) -> Vec3 {
        (self.corners[0] + self.corners[1] + self.corners[2]) / 3.0
    }

    /// The point of the piece for a point of the unit square.
    pub(super) fn point(&self, u: [f32; 2]) -> Vec3 {
        let [a, b, c] = self.corners;
        let [b1, b2] = uniform_triangle(u);
        a + (b - a) * b1 + (c - a) * b2
    }
}

impl Group {
    fn new(pieces: Vec<Piece>) -> Self {
        let corners = || pieces.iter().flat_map(|piece| piece.corners);
        let low = corners().fold(Vec3::INFINITY, Vec3::min);
        let high = corners().fold(Vec3::NEG_INFINITY, Vec3::max);
        let area: f32 = pieces.iter().map(|piece| piece.area).sum();
        let add = |sum: &mut f32, piece: &Piece| {
            *sum += piece.area / area;
            Some(*sum)
        };
        let cumulative = pieces.iter().scan(0.0, add).collect();
        let axis = pieces.iter().map(|piece| piece.normal * piece.area).sum::<Vec3>().normalize_or(Vec3::Y);
        let cosine = pieces.iter().map(|piece| piece.normal.dot(axis)).fold(1.0, f32::min);
        let sine = if cosine > 0.0 { (1.0 - cosine * cosine).max(0.0).sqrt() } else { 1.0 };
        let (centre, radius) = ((low + high) / 2.0, (high - low).length() / 2.0);
        Self { centre, radius, area, cone: (axis, sine), pieces, cumulative }
    }

    /// Bound on the cosine at the pieces for light that they send to a point, 0..1.
    pub(super) fn cosine_towards(&self, position: Vec3) -> f32 {
        let (to, (axis, sine)) = (position - self.centre, self.cone);
        let distance = to.length().max(f32::MIN_POSITIVE);
        ((axis.dot(to) + self.radius) / distance + sine).clamp(0.0, 1.0)
    }

    /// Chooses a piece by area.
    pub(super) fn piece(&self, u: f32) -> &Piece {
        let at = self.cumulative.partition_point(|&sum| sum <= u);
        &self.pieces[at.min(self.pieces.len() - 1)]
    }
}

/// Cuts both sides of some triangles into pieces and groups them.
pub(super) fn groups_of(scene: &Scene, triangles: &[u32]) -> Vec<Group> {
    let pieces = pieces_of(scene, triangles);
    let mut sides: [Vec<Piece>; 6] = Default::default();
    for piece in pieces {
        sides[side_of(piece.normal)].push(piece);
    }
    let mut groups: Vec<Group> = sides.into_iter().filter(|side| !side.is_empty()).map(Group::new).collect();
    while groups.len() < MAX_GROUPS {
        let size = |group: &Group| if group.pieces.len() > 1 { group.area * group.radius } else { 0.0 };
        let Some(largest) = (0..groups.len()).max_by(|&a, &b| size(&groups[a]).total_cmp(&size(&groups[b])))
        else {
            break;
        };
        if size(&groups[largest]) <= 0.0 {
            break;
        }
        let halves = halved(groups.swap_remove(largest).pieces);
        groups.extend(halves.map(Group::new));
    }
    groups
}

/// The axis and direction, 0..6, that a normal is nearest to.
pub(super) fn side_of(normal: Vec3) -> usize {
    let axis = normal.abs().max_position();
    2 * axis + usize::from(normal[axis] < 0.0)
}

/// Divides pieces into two halves along the longest edge of their box.
fn halved(mut pieces: Vec<Piece>) -> [Vec<Piece>; 2] {
    let middles = || pieces.iter().map(Piece::middle);
    let low = middles().fold(Vec3::INFINITY, Vec3::min);
    let high = middles().fold(Vec3::NEG_INFINITY, Vec3::max);
    let axis = (high - low).max_position();
    let half = pieces.len() / 2;
    pieces.select_nth_unstable_by(half, |a, b| a.middle()[axis].total_cmp(&b.middle()[axis]));
    let upper = pieces.split_off(half);
    [pieces, upper]
}

fn pieces_of(scene: &Scene, triangles: &[u32]) -> Vec<Piece> {
    let [low, high] = scene.bounds_m.map(|p| scene.frame.scene_from_world_f64(p).as_vec3());
    let most = MAX_EDGE * low.distance(high);
    let mut pieces = Vec::new();
    for &triangle in triangles {
        let corners = scene.corners(triangle);
        let [a, b, c] = corners;
        let normal = (b - a).cross(c - a).normalize_or(Vec3::Y);
        let mut open = vec![corners];
        while let Some([a, b, c]) = open.pop() {
            let edges = [(a - b).length(), (b - c).length(), (c - a).length()];
            let longest = (0..3).fold(0, |k, i| if edges[i] > edges[k] { i } else { k });
            if edges[longest] <= most || pieces.len() + open.len() >= MAX_PIECES {
                let piece = Piece::new([a, b, c], triangle, normal);
                pieces.push(piece);
                pieces.push(Piece { normal: -normal, ..piece });
                continue;
            }
            // Cut the longest edge in its middle.
            let corners = [a, b, c];
            let (p, q, r) = (corners[longest], corners[(longest + 1) % 3], corners[(longest + 2) % 3]);
            let middle = (p + q) / 2.0;
            open.extend([[p, middle, r], [middle, q, r]]);
        }
    }
    pieces
}
