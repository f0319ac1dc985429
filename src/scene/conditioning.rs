//! How demanding a scene is for single precision and for paths of limited length.

use serde::Serialize;

/// What was changed so that the scene can be traced, as counts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Repairs {
    /// Triangles dropped because a vertex is missing, not finite or too far away.
    pub triangles_not_finite: usize,
    /// Triangles dropped because they have no area in f32.
    pub triangles_without_area: usize,
    /// Triangles that rays ignore because an earlier one with the same corners looks the same.
    pub duplicates_hidden: usize,
    /// Triangles with the corners of an earlier one that rays still meet, because one of the two is
    /// glass, has an alpha texture or emits differently.
    pub duplicates_seen: usize,
    /// Materials scaled down because they reflected more light than arrives.
    pub materials_scaled: usize,
    /// Numbers of materials, lights and textures that were negative, not finite or out of range.
    pub values_clamped: usize,
    /// True if centre and scale follow most of the vertices because a few lie far outside.
    pub ignores_outliers: bool,
}

/// Condition numbers of a scene, and what was repaired.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Conditioning {
    /// Largest world coordinate over the smallest feature of 1 mm, with the origin of the file.
    pub coordinate_ratio_in_file: f64,
    /// Largest coordinate over 1 mm with the origin of scene space, which is what rays see. Safe
    /// below 1e5.
    pub coordinate_ratio: f64,
    /// Size in metres below which a feature loses its shape, where it is farthest from the origin
    /// of scene space.
    pub smallest_feature_m: f64,
    /// Largest share of light that a material reflects or transmits, which is the ratio of the
    /// geometric series of bounces.
    pub reflectance_max: f32,
    /// Name of the material with that share.
    pub reflectance_max_material: String,
    /// Brightest over dimmest emitted radiance; 1 if there is only one.
    pub light_ratio: f64,
    /// Number of triangles thinner than 2e-5. See `thinnest`.
    pub needles: usize,
    /// Smallest ratio of height to longest edge of all triangles.
    pub thinnest: f64,
    /// Number of triangles with the same corners as an earlier one.
    pub coplanar_duplicates: usize,
    /// What was changed so that the scene can be traced.
    #[serde(rename = "mended")]
    pub repairs: Repairs,
}

impl Conditioning {
    /// Describes the numbers in sentences for the user, one per fact.
    pub fn sentences(&self) -> Vec<String> {
        let material = match self.reflectance_max_material.as_str() {
            "" => "a material without a name".to_owned(),
            name => format!("'{name}'"),
        };
        let mut sentences = vec![
            format!(
                "largest coordinate over 1 mm: {:.1e} in the file, {:.1e} after moving the origin; features \
                 above {:.1e} m keep their shape everywhere",
                self.coordinate_ratio_in_file, self.coordinate_ratio, self.smallest_feature_m
            ),
            format!(
                "{material} passes on {:.3} of the light, the most of all materials; brightest over dimmest \
                 light {:.1e}",
                self.reflectance_max, self.light_ratio
            ),
            format!(
                "{} needles, the thinnest triangle {:.1e} of its length high; {} triangles coincide with an \
                 earlier one, of which the first is shown",
                self.needles, self.thinnest, self.coplanar_duplicates
            ),
        ];
        sentences.extend(self.repairs.sentence());
        sentences
    }
}

impl Repairs {
    fn sentence(&self) -> Option<String> {
        let has_repairs = *self != Self { duplicates_seen: self.duplicates_seen, ..Self::default() };
        has_repairs.then(|| {
            format!(
                "repaired: {} triangles without finite corners and {} without area dropped, {} duplicates \
                 hidden, {} materials scaled down, {} values clamped{}",
                self.triangles_not_finite,
                self.triangles_without_area,
                self.duplicates_hidden,
                self.materials_scaled,
                self.values_clamped,
                if self.ignores_outliers {
                    "; a few distant vertices ignored for centre and scale"
                } else {
                    ""
                }
            )
        })
    }
}
