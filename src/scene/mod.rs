//! The scene: geometry, materials, textures and lights as plain data.
//!
//! A [`SceneBuilder`] collects a model in world metres and makes a [`Scene`] from it. Importers and
//! the embedded scenes use it alike, so that every scene has passed the same checks.

mod assemble;
mod bodies;
mod bounds;
mod builder;
mod building;
pub mod builtin;
mod coincident;
mod compute_conditioning;
mod conditioning;
mod connectivity;
pub mod content;
mod data;
pub mod daylight;
mod derive;
mod detail;
mod dim;
mod duplicates;
mod edit;
mod emissive;
mod error;
mod features;
mod ground;
mod ground_mesh;
mod group_lights;
mod hash;
mod light;
mod light_groups;
mod light_picture;
mod material;
mod material_at;
mod move_objects;
mod object_edits;
mod objects;
#[cfg(feature = "import")]
pub mod place;
mod profile;
mod sanitize;
pub mod shapes;
mod sky;
pub mod solar;
mod solids;
mod source_file;
mod sun;
mod texture;
mod views;
#[cfg(feature = "import")]
mod weak_lamps;

pub use crate::camera::SceneFrame;
#[cfg(feature = "import")]
pub(crate) use assemble::NO_LIGHT;
pub(crate) use bodies::ClosedBodies;
pub(crate) use bounds::is_valid_position;
pub use builder::SceneBuilder;
pub(crate) use coincident::{beats, share_plane};
pub use conditioning::{Conditioning, Repairs};
pub use data::{Scene, SolidSide};
pub(crate) use daylight::GROUND_ALBEDO;
pub use daylight::{Daylight, DaylightModel};
pub use detail::{Detail, NormalMap};
pub use edit::SceneEdit;
pub use error::{SceneError, Warning};
pub(crate) use features::MAX_SINGLE_LIGHTS;
pub use features::SceneFeatures;
pub use ground::{Ground, GroundAdvice, GroundChoice, GroundError, GroundedGeometry};
pub(crate) use light::point_on_mesh;
pub use light::{Beam, Light, LightPicture, SpotLight};
pub use light_groups::{
    LampGroup, LightGroup, LightGroupKind, LightGroups, LightSetting, LightSettings, MAX_LAMP_GROUPS,
    MAX_LIGHT_GROUPS, NO_LIGHT_GROUP,
};
pub use material::{Material, MaterialId, MaterialKind, SMOOTH};
pub use object_edits::{EditedObjects, ObjectEdit, ObjectEdits};
pub use objects::{ObjectKey, Objects};
pub use profile::{AimedProfile, LightProfile, ProfileAngles, ProfileLight};
pub use sky::{
    CieKind, CieSky, DimmedSky, Gradient, PhysicalSky, PictureSky, Sky, SkyImage, SkyImageError, SkyKind,
    SkySample,
};
pub use source_file::SourceFile;
pub use sun::Sun;
pub use texture::{Encoding, Sampling, Texture, TextureId, TextureRef, Wrap};
pub use views::NamedView;
pub(crate) use views::{USUAL_RISE, orbit, overview};
