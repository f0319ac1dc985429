//! Panoramas and the tour of them: their files, and what is refused.

use super::{Bench, assert_keys, number, stderr};
use afterimage::raster::load::read_notes;
use serde_json::json;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::process::Command;

const POSE: &str = "--eye 0,1.6,3 --look-at 0.4,1.4,0";
const QUICK: &str = "--samples 1 --bounces 1 --json";

#[test]
fn a_panorama_is_a_picture_that_viewers_recognise() {
    let bench = Bench::new();
    let line = format!("render room.obj {POSE} {QUICK} --projection equirectangular --size 64x32");
    let answer = bench.json(&format!("{line} -o a.png --linear a.exr"));
    assert_keys(&answer, &["scene", "projection", "mode", "size", "samples", "secs", "exposure_ev"]);
    assert_eq!((&answer["size"], &answer["mode"]), (&json!([64, 32]), &json!("exact")));
    assert_eq!(answer["is_complete"], json!(true));
    assert!(number(&answer, "/secs/references") > 0.0);
    let picture = image::open(bench.path("a.png")).unwrap();
    assert_eq!([picture.width(), picture.height()], [64, 32]);
    let notes = read_notes(&bench.path("a.png")).unwrap();
    let note = |name: &str| notes.iter().find(|(n, _)| n == name).map(|(_, text)| text.clone()).unwrap();
    let xmp = note("XML:com.adobe.xmp");
    for field in
        ["ProjectionType=\"equirectangular\"", "FullPanoWidthPixels=\"64\"", "FullPanoHeightPixels=\"32\""]
    {
        assert!(xmp.contains(&format!("GPano:{field}")), "{xmp}");
    }
    assert!(note("Settings").contains("--projection equirectangular"));
    assert!(bench.path("a.exr").is_file());
    // Every pixel traced is the other way to the same picture.
    for mode in ["--mode full", "--mode fast", "--antialias 2"] {
        bench.json(&format!("{line} {mode} -o b.png"));
        let other = bench.json("compare a.png b.png --json");
        assert!(number(&other, "/psnr_db") > 14.0, "{mode}: {other}");
    }
}

#[test]
fn what_does_not_go_with_a_panorama_is_refused_in_one_line() {
    let bench = Bench::new();
    let files = bench.names("");
    for (flags, words) in [
        ("--size 64x48", "twice as wide as high"),
        ("--size 65536x32768", "maximum is 32768x16384"),
        ("--types t.png", "--types is for --projection perspective"),
        ("--reference 1,1,1:0,0,0", "--reference is for"),
        ("--show clay", "--show is for"),
        ("--seconds 1", "--seconds is for"),
        ("--no-background", "--no-background is for"),
        ("--mode paper", "use exact, fast or full"),
        ("--isolines", "are for --show illuminance"),
    ] {
        let size = if flags.contains("--size") { "" } else { "--size 64x32" };
        let line = format!("render room.obj --projection equirectangular {size} -o a.png {flags}");
        let output = bench.run(&line);
        assert_eq!(output.status.code(), Some(2), "{flags}: {}", stderr(&output));
        assert!(
            stderr(&output).contains(words) && stderr(&output).lines().count() == 1,
            "{}",
            stderr(&output)
        );
    }
    for (flags, words) in [
        ("--width 3", "--width is for --projection orthographic"),
        ("--projection orthographic --width 0", "0.001 to 1000000"),
        ("--projection orthographic --types t.png", "--types is for --projection perspective"),
        ("--lens 50 --fov-y 40", "cannot be used with"),
    ] {
        let output = bench.run(&format!("render room.obj -o a.png {flags}"));
        assert_eq!(output.status.code(), Some(2), "{flags}: {}", stderr(&output));
        assert!(stderr(&output).contains(words), "{flags}: {}", stderr(&output));
    }
    let output = bench.run("render room.obj --projection equirectangular --size 64x32 -o none/a.png");
    assert_eq!(output.status.code(), Some(1));
    for (flags, code, words) in [
        ("-o tour.html --views kitchen", 2, "has no view 'kitchen'"),
        ("-o tour.txt", 2, "must end in .html"),
        ("-o none/tour.html", 1, "cannot write none/tour.html"),
        ("-o tour.html --size 100x100", 2, "twice as wide as high"),
        ("-o tour.html --mode paper", 2, "use exact, fast or full"),
    ] {
        let output = bench.run(&format!("tour-export room.obj {flags}"));
        assert_eq!(output.status.code(), Some(code), "{flags}: {}", stderr(&output));
        assert!(stderr(&output).contains(words), "{flags}: {}", stderr(&output));
    }
    assert_eq!(bench.names(""), files, "nothing is half-written");
}

/// A plan of a room of 4 by 8 m from below its lamp, at five pixels a metre: the lamp's side is at
/// the top, as -Z is in every plan.
#[test]
fn an_orthographic_plan_is_at_scale() {
    let bench = Bench::new();
    let line = "render room.obj --projection orthographic --eye 0,2.8,0 --look-at 0,0,0 --bounces 0 --samples 1 --json";
    let answer = bench.json(&format!("{line} --size 40x60 --width 8 -o plan.png"));
    assert_eq!(answer["projection"], json!("orthographic"));
    let plan = image::open(bench.path("plan.png")).unwrap().to_rgb8();
    let is_floor = |x: u32, y: u32| plan.get_pixel(x, y).0[0] > 0;
    for y in 0..60 {
        let inside = (10..50).contains(&y);
        assert_eq!((0..40).filter(|x| is_floor(*x, y)).count(), if inside { 20 } else { 0 }, "row {y}");
    }
    let notes = read_notes(&bench.path("plan.png")).unwrap();
    assert!(notes.iter().all(|(name, _)| name != "XML:com.adobe.xmp"));
    assert!(notes.iter().any(|(_, text)| text.contains("--projection orthographic --width 8")));
    // Without a width it is the whole model.
    bench.json(&format!("{line} --size 40x60 -o all.exr"));
}

#[test]
fn a_lens_is_a_field_of_view() {
    let bench = Bench::new();
    let small = "--size 36x24 --samples 1 --bounces 0 --json";
    bench.json(&format!("render room.obj {POSE} {small} --lens 18 -o lens.png"));
    // 18 mm before a film 36 mm wide: 90 degrees across, and 67.38 upwards in a picture of 3:2.
    bench.json(&format!("render room.obj {POSE} {small} --fov-y 67.380135 -o angle.png"));
    let other = bench.json("compare lens.png angle.png --json");
    assert!(other["psnr_db"].is_null() || number(&other, "/psnr_db") > 40.0, "{other}");
}

/// Ten views in a session next to the model, the last with a name that is no harmless text.
const EVIL: &str = "<b>desk</b> & \\\"chair\\\"";

fn with_ten_views() -> Bench {
    let bench = Bench::new();
    let mut session = String::from("version = 2\n");
    for i in 0..10 {
        let name = if i == 9 { EVIL.to_owned() } else { format!("place {i}") };
        let (x, z) = (f64::from(i % 3) * 0.5 - 1.4, 3.0 - 0.6 * f64::from(i));
        let _ = write!(
            session,
            "[[views]]\nname = \"{name}\"\n[views.camera]\neye = [{x}, 1.5, {z}]\nyaw = {}\npitch = 0.1\nfov_y = 1.0\n",
            0.7 * f64::from(i)
        );
    }
    std::fs::write(bench.path("room.afterimage-session.toml"), session).unwrap();
    bench
}

#[test]
fn a_tour_is_one_file_of_all_views_with_links_between_them() {
    let bench = with_ten_views();
    let answer = bench.json(&format!("tour-export room.obj {QUICK} --mode fast --size 32x16 -o tour.html"));
    let views = answer["views"].as_array().unwrap();
    // The view of the model itself comes first.
    assert_eq!(views.len(), 11);
    assert!(views.iter().skip(1).all(|view| view["links"].as_array().unwrap().len() >= 5), "{views:?}");
    let page = std::fs::read_to_string(bench.path("tour.html")).unwrap();
    assert_eq!(page.len() as f64, number(&answer, "/bytes"));
    assert_eq!(page.matches("data:image/jpeg;base64,").count(), 11);
    assert!(!page.contains("<b>desk") && page.contains("&lt;b&gt;desk"));
    let few = bench
        .json(&format!("tour-export room.obj {QUICK} --mode fast --size 32x16 -o few.html --views start"));
    assert_eq!(few["views"].as_array().unwrap().len(), 1);
}

/// A browser without a window; `None` where none is installed.
fn browser() -> Option<PathBuf> {
    let names = ["chromium", "chromium-browser", "google-chrome", "chrome"];
    let folders: Vec<PathBuf> = std::env::split_paths(&std::env::var_os("PATH")?).collect();
    names.iter().find_map(|name| folders.iter().map(|folder| folder.join(name)).find(|path| path.is_file()))
}

/// Opens a page from disk, lets its scripts run, and returns the document as it is then.
fn opened(browser: &Path, page: &Path, flags: &[&str]) -> String {
    let profile = tempfile::tempdir().unwrap();
    let output = Command::new(browser)
        .args(["--headless=new", "--no-sandbox", "--disable-dev-shm-usage", "--disable-extensions"])
        .args(["--disable-background-networking", "--no-first-run", "--window-size=800,600"])
        .args(flags)
        .arg(format!("--user-data-dir={}", profile.path().display()))
        .args(["--virtual-time-budget=60000", "--dump-dom"])
        .arg(format!("file://{}", page.display()))
        .output()
        .unwrap();
    String::from_utf8_lossy(&output.stdout).into_owned()
}

/// A browser that draws nothing on a screen never asks a page to draw: frames follow timers.
const WITHOUT_SCREEN: &str =
    "<head><script>window.requestAnimationFrame = (draw) => setTimeout(draw, 0);</script>";

/// Clicks through the tour as a visitor would, and notes what is shown.
const VISIT: &str = r##"<script>
(async () => {
  const frame = () => new Promise((resolve) => requestAnimationFrame(resolve));
  const until = async (done) => { for (let i = 0; i < 600 && !done(); i++) { await frame(); } };
  const arrival = (view) => until(() => document.body.dataset.view == view && document.body.dataset.ready == "true");
  const press = (key) => window.dispatchEvent(new KeyboardEvent("keydown", { key }));
  const canvas = document.getElementById("picture");
  const color = async () => {
    press("ArrowRight");
    await frame();
    const gl = canvas.getContext("webgl2") || canvas.getContext("webgl");
    if (!gl) { return [0, 0, 0, 0]; }
    const pixel = new Uint8Array(4);
    gl.readPixels(canvas.width / 2, canvas.height / 2, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, pixel);
    return [...pixel];
  };
  const found = { names: [], colors: [], links: 0, message: "", flat: "" };
  // The first picture may still be on its way to the screen.
  await color();
  for (const button of [...document.querySelectorAll("nav button")]) {
    button.click();
    await arrival(button.dataset.view);
    found.names.push(document.getElementById("name").textContent);
    found.colors.push(await color());
  }
  for (let turn = 0; turn < 60 && found.links < 3; turn++) {
    const link = [...document.querySelectorAll("#links button")].find((button) => !button.hidden);
    if (link) {
      const name = link.textContent;
      link.click();
      await until(() => document.getElementById("name").textContent == name && document.body.dataset.ready == "true");
      found.links += document.getElementById("name").textContent == name;
    }
    press("ArrowRight");
    await frame();
    await frame();
  }
  found.message = document.getElementById("message").textContent;
  found.flat = document.getElementById("flat").src.slice(0, 15);
  document.body.dataset.found = btoa(JSON.stringify(found));
})();
</script></body>"##;

fn visited(browser: &Path, page: &Path, flags: &[&str]) -> serde_json::Value {
    use base64::Engine as _;
    let document = opened(browser, page, flags);
    let start = document.find("data-found=\"").unwrap_or_else(|| panic!("no visit: {document:.2000}"));
    let text = document[start + 12..].split('"').next().unwrap();
    serde_json::from_slice(&base64::engine::general_purpose::STANDARD.decode(text).unwrap()).unwrap()
}

/// Opens a tour of ten views from disk in a browser, if one is installed, and clicks through it.
#[test]
fn a_browser_shows_every_view_of_a_tour_and_follows_its_links() {
    let Some(browser) = browser() else { return };
    let bench = with_ten_views();
    bench.json(&format!("tour-export room.obj {QUICK} --mode fast --size 64x32 -o tour.html"));
    let page = std::fs::read_to_string(bench.path("tour.html")).unwrap();
    let visit = bench.path("visit.html");
    std::fs::write(&visit, page.replace("<head>", WITHOUT_SCREEN).replace("</body>", VISIT)).unwrap();
    let found = visited(&browser, &visit, &["--use-angle=swiftshader", "--enable-unsafe-swiftshader"]);
    let names: Vec<&str> = found["names"].as_array().unwrap().iter().map(|n| n.as_str().unwrap()).collect();
    assert_eq!(names.len(), 11);
    assert_eq!((names[1], names[10]), ("place 0", "<b>desk</b> & \"chair\""));
    assert_eq!(found["links"], json!(3), "{found}");
    assert_eq!(found["message"], json!(""));
    let is_lit = |color: &serde_json::Value| number(color, "/0") > 10.0 && number(color, "/3") == 255.0;
    assert!(found["colors"].as_array().unwrap().iter().all(is_lit), "{found}");
    // Without 3D graphics, the page says so and shows the panoramas flat.
    let found = visited(&browser, &visit, &["--disable-3d-apis", "--disable-gpu"]);
    assert!(found["message"].as_str().unwrap().contains("WebGL"), "{found}");
    assert_eq!((&found["flat"], found["names"].as_array().unwrap().len()), (&json!("data:image/jpeg"), 11));
}
