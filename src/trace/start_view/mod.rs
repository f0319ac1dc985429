//! The view in which a model that brings none is entered: inside a room, or from where the whole
//! building is seen. All of it follows the building (`Scene::building_m`), not the ground around
//! it nor a few objects far away.
//!
//! | file | contents |
//! |---|---|
//! | `building` | rays that meet the building alone |
//! | `sight` | what a view shows: the share of the picture that is building |
//! | `rooms` | the place with the most space to stand in, and the view from there |
//! | `overview` | a view of the whole building from outside |
//! | `ranking` | the best of several values, whatever their rounding |

mod building;
mod overview;
mod ranking;
mod rooms;
mod sight;

use super::Tracer;
use crate::camera::{Camera, CameraPath};
use crate::scene::{Light, NamedView, orbit};
use building::Building;
use sight::Sight;

/// Smallest share of back faces among what the view from outside shows of the building at which the
/// model is one of rooms. Chosen by where models should begin: living room, staircase and office
/// inside, FZK house outside, the open Cornell box in front of its opening.
const MIN_BACKS: f64 = 0.4;

/// Smallest ratio of the effective numbers of materials that the views from inside and from outside
/// show at which the inside is the building's face: 5.0 and 1.1 in Sponza, whose outer walls are
/// blank, but 3.1 and 2.4 in the FZK house.
const MIN_RICHER: f64 = 2.0;

impl Tracer {
    /// Chooses the start view of a model that brings no view.
    ///
    /// It is a view from outside of the whole building; or one from inside a room, where the
    /// building is dark from outside, shows its back faces, or shows much more from inside. The
    /// view from outside is then the second, unless no light falls there: it would be black. Where
    /// the model brings no camera path, the path turns around in the room or leads once around the
    /// building.
    #[must_use]
    pub fn with_start_view(mut self) -> Self {
        if self.scene().brings_view {
            return self;
        }
        let outside = overview::best_overview(&self);
        let inside = rooms::best_view(&self).filter(|inside| self.is_entered(&outside, inside));
        let view = |name: &str, camera| NamedView { name: name.to_owned(), camera };
        let is_dark = self.is_dark_outside();
        self.change_views(|scene| {
            scene.views = match inside {
                Some(inside) if is_dark => vec![view("start", inside)],
                Some(inside) => vec![view("start", inside), view("outside", outside)],
                None => vec![view("start", outside)],
            };
            if !scene.brings_walk {
                scene.walk = match inside {
                    Some(inside) => CameraPath::turning(&inside),
                    None => orbit(scene.building_m, &outside),
                };
            }
        });
        self
    }

    /// Returns the share of a view's picture, 0..1, that shows building and neither the ground
    /// around it nor the sky. Counted by 32 x 18 rays; the picture is 16:9.
    pub fn building_share(&self, camera: &Camera) -> f64 {
        Sight::of(&Building::of(self), camera).building()
    }

    /// True where the building is entered rather than seen from outside.
    fn is_entered(&self, outside: &Camera, inside: &Camera) -> bool {
        let [outside, inside] = [outside, inside].map(|camera| Sight::of(&Building::of(self), camera));
        self.is_dark_outside()
            || outside.backs() >= MIN_BACKS
            || inside.materials() >= MIN_RICHER * outside.materials()
    }

    /// True where neither sun nor sky lights the model.
    fn is_dark_outside(&self) -> bool {
        !self.scene().lights.iter().any(|light| matches!(light, Light::Sun { .. } | Light::Sky))
    }
}
