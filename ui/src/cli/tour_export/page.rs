//! The page of a tour.

use super::plan::dots;
use afterimage::scene::NamedView;
use afterimage::{Camera, Tracer};
use anyhow::Context;
use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use minijinja::Environment;
use minijinja::value::Serde;
use serde_json::{Value, json};
use std::f64::consts::PI;

const TEMPLATE: &str = include_str!("page.html");
const STYLE: &str = include_str!("page.css");
const SCRIPT: &str = include_str!("page.js");

/// Views closer than this have no link in each other's panorama, metres: they stand in one place.
const SAME_PLACE_M: f64 = 0.05;

/// Part of the way to another view that must be free: its eye may touch a wall.
const FREE_PART: f64 = 0.99;

/// A view of a tour.
#[derive(Clone, Debug)]
pub(super) struct TourView {
    name: String,
    camera: Camera,
    /// Links to the views that are seen from here.
    links: Vec<Link>,
    jpeg: Vec<u8>,
}

/// A link to another view, in its direction.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Link {
    /// Number of the other view.
    to: usize,
    /// Angle to the right of the middle of the panorama, radians.
    longitude: f64,
    /// Angle above the horizon, radians.
    latitude: f64,
    /// Distance in metres.
    distance_m: f64,
}

impl TourView {
    /// A view with its panorama, a JPEG file, and links to those of `all` that are seen from it.
    pub(super) fn new(view: &NamedView, jpeg: Vec<u8>, all: &[NamedView], tracer: &Tracer) -> Self {
        let link = |(to, other): (usize, &NamedView)| link(&view.camera, to, &other.camera, tracer);
        let links = all.iter().enumerate().filter_map(link).collect();
        Self { name: view.name.clone(), camera: view.camera, links, jpeg }
    }

    /// What a script reads of the view.
    pub(super) fn record(&self) -> Value {
        json!({
            "name": self.name,
            "eye": self.camera.eye.to_array(),
            "links": self.links.iter().map(|link| link.to).collect::<Vec<_>>(),
            "jpeg_bytes": self.jpeg.len(),
        })
    }

    fn data(&self) -> Value {
        let camera = &self.camera;
        let link = |link: &Link| json!([link.to, link.longitude, link.latitude, link.distance_m]);
        json!({
            "name": self.name,
            "yaw": camera.yaw,
            "pitch": camera.pitch,
            "fov": camera.fov_y,
            "links": self.links.iter().map(link).collect::<Vec<_>>(),
            "picture": format!("data:image/jpeg;base64,{}", STANDARD.encode(&self.jpeg)),
        })
    }
}

/// The link from a camera to another, unless a surface lies between them or they stand in one
/// place.
fn link(from: &Camera, to: usize, other: &Camera, tracer: &Tracer) -> Option<Link> {
    let way = other.eye - from.eye;
    let distance_m = way.length();
    let is_free = || tracer.probe(from.eye, way, distance_m * FREE_PART).is_none();
    if distance_m < SAME_PLACE_M || !is_free() {
        return None;
    }
    let turn = from.yaw - (-way.x).atan2(-way.z);
    let longitude = (turn + PI).rem_euclid(2.0 * PI) - PI;
    Some(Link { to, longitude, latitude: (way.y / distance_m).asin(), distance_m })
}

/// The page of a tour of a scene.
pub(super) fn html(scene: &str, views: &[TourView]) -> anyhow::Result<String> {
    let data = json!({ "views": views.iter().map(TourView::data).collect::<Vec<_>>() });
    let names: Vec<&str> = views.iter().map(|view| view.name.as_str()).collect();
    let places = dots(views.iter().map(|view| view.camera.eye));
    let plan = places.iter().zip(&names).map(|([x, y], name)| json!({ "x": x, "y": y, "name": name }));
    let values = json!({
        "scene": scene,
        "names": names,
        "plan": plan.collect::<Vec<_>>(),
        "style": STYLE,
        "script": SCRIPT,
        "data": in_script(&data),
    });
    // The extension of the template's name enables escaping.
    let mut environment = Environment::new();
    let page = environment
        .add_template("tour.html", TEMPLATE)
        .and_then(|()| environment.get_template("tour.html")?.render(Serde(&values)));
    page.context("the tour cannot be written")
}

/// JSON that can stand in a script element: no name in it can end the element.
fn in_script(data: &Value) -> String {
    data.to_string().replace('<', "\\u003c").replace('\u{2028}', "\\u2028").replace('\u{2029}', "\\u2029")
}

#[cfg(test)]
mod tests {
    use super::*;
    use afterimage::scene::builtin;
    use glam::DVec3;
    use std::sync::Arc;

    fn view(name: &str, eye: DVec3, at: DVec3) -> NamedView {
        NamedView { name: name.to_owned(), camera: Camera::look_at(eye, at, 60.0) }
    }

    #[test]
    fn links_point_at_the_views_that_are_seen() {
        let tracer = Tracer::new(Arc::new(builtin::build("furnace").unwrap()));
        let views = [
            view("middle", DVec3::ZERO, DVec3::NEG_Z),
            view("right", DVec3::X, DVec3::NEG_Z),
            view("up behind", DVec3::new(0.0, 1.0, 1.0), DVec3::NEG_Z),
            view("outside", DVec3::X * 9.0, DVec3::ZERO),
            view("middle too", DVec3::ZERO, DVec3::X),
        ];
        let shown = TourView::new(&views[0], Vec::new(), &views, &tracer);
        assert_eq!(shown.links.iter().map(|link| link.to).collect::<Vec<_>>(), [1, 2]);
        let near = |a: f64, b: f64| (a - b).abs() < 1e-9;
        let [right, behind] = [shown.links[0], shown.links[1]];
        assert!(near(right.longitude, PI / 2.0) && near(right.latitude, 0.0) && near(right.distance_m, 1.0));
        assert!(near(behind.longitude.abs(), PI) && near(behind.latitude, PI / 4.0), "{behind:?}");
    }

    #[test]
    fn names_cannot_become_parts_of_the_page() {
        let tracer = Tracer::new(Arc::new(builtin::build("furnace").unwrap()));
        let evil = "</script><script>alert('1')</script>&\"\u{2028}";
        let views = [view(evil, DVec3::ZERO, DVec3::NEG_Z)];
        let shown = [TourView::new(&views[0], vec![1, 2, 3], &views, &tracer)];
        let page = html(evil, &shown).unwrap();
        assert!(!page.contains("<script>alert"), "{page}");
        assert_eq!(page.matches("</script>").count(), 2, "the data and the program");
        assert!(page.contains("data:image/jpeg;base64,AQID"));
        // Nothing is loaded from elsewhere.
        assert!(
            page.contains("default-src 'none'") && !page.contains("http://") && !page.contains("https://")
        );
    }
}
