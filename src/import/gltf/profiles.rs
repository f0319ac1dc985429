//! Lamps with a measured profile: EXT_lights_ies.

use super::document::{Document, Found, List};
use super::{buffers::Buffers, schema, uri};
use crate::import::{ies, options::Limits, search::Finder, tally::Tally, trouble::Trouble};
use crate::scene::{AimedProfile, LightProfile, ProfileLight, SceneBuilder, is_valid_position};
use glam::{DMat4, DVec3};
use std::{collections::HashMap, sync::Arc};

/// The profiles of a file, each read once.
pub(super) struct Profiles<'f> {
    finder: &'f mut Finder,
    /// By index; `None` for a profile that could not be read, which was counted as a trouble.
    read: HashMap<usize, Option<(Arc<LightProfile>, f64)>>,
}

impl<'f> Profiles<'f> {
    pub(super) fn new(finder: &'f mut Finder) -> Self {
        Self { finder, read: HashMap::new() }
    }

    /// Adds the lamp of a node: its light goes along the node's -Z, and is measured in candela.
    pub(super) fn add_lamp(
        &mut self,
        (document, buffers): (&Document, &Buffers),
        lamp: &schema::NodeProfile,
        world: DMat4,
        builder: &mut SceneBuilder,
        tally: &mut Tally,
    ) {
        let index = lamp.light;
        if !self.read.contains_key(&index) {
            let profile = self.profile((document, buffers), index, tally);
            let profile = profile.map_err(|fault| document.note(fault, tally)).ok();
            self.read.insert(index, profile);
        }
        let Some(Some((profile, candela))) = self.read.get(&index) else { return };
        let color = DVec3::from_array(lamp.color.unwrap_or([1.0; 3])).clamp(DVec3::ZERO, DVec3::ONE);
        let intensity = color * lamp.multiplier.unwrap_or(1.0) * *candela;
        let (at, back) = (world.w_axis.truncate(), world.z_axis.truncate().try_normalize());
        let is_possible =
            intensity.min_element() >= 0.0 && intensity.max_element() <= f64::from(Limits::RADIANCE);
        let Some(back) = back.filter(|_| is_possible && is_valid_position(at)) else {
            document.note(document.fault(List::Profiles, index, Trouble::LIGHT, ""), tally);
            return;
        };
        builder.is_photometric = true;
        let front = world.x_axis.truncate().as_vec3();
        builder.profile_lights.push(ProfileLight {
            position_m: at,
            intensity: intensity.as_vec3(),
            profile: AimedProfile::new(profile.clone(), -back.as_vec3(), front),
        });
    }

    /// Reads a profile. Returns its largest intensity in candela as well.
    fn profile(
        &mut self,
        (document, buffers): (&Document, &Buffers),
        index: usize,
        tally: &mut Tally,
    ) -> Found<(Arc<LightProfile>, f64)> {
        let item: schema::Profile = document.item(List::Profiles, index)?;
        let fault = |detail: &str| document.fault(List::Profiles, index, Trouble::PROFILE, detail);
        let file = match (item.buffer_view, item.uri) {
            (Some(view), _) => ies::read(buffers.view(document, view)?.0),
            (None, Some(uri)) => match uri::data(&uri) {
                Some(data) => {
                    let broken = || document.fault(List::Profiles, index, Trouble::DATA_URI, "");
                    ies::read(&data.ok_or_else(broken)?)
                }
                None => ies::load(&uri::file_name(&uri), self.finder),
            },
            (None, None) => Err("it has neither uri nor bufferView".to_owned()),
        };
        let file = file.map_err(|cause| fault(&cause))?;
        if file.note.is_some() {
            document.note(document.fault(List::Profiles, index, Trouble::TILT, ""), tally);
        }
        Ok((Arc::new(file.profile), file.candela))
    }
}
