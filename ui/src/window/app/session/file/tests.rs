//! Session files are read as they were written, and what is wrong with one is reported.

use super::*;

pub(in crate::window::app::session) fn session() -> SessionFile {
    let camera = Camera::look_at(DVec3::new(0.1, 1.6, 1.0 / 3.0), DVec3::ZERO, 60.0);
    let path = CameraPath::still(&camera);
    SessionFile {
        version: VERSION,
        scene: "builtin:gallery".to_owned(),
        unit: Some("mm".to_owned()),
        up: Some("+Z".to_owned()),
        session: None,
        render_scale: Some(0.5),
        budget_ms: None,
        keep_improving: None,
        placement: Some(("grid".to_owned(), 5.0)),
        max_references: Some(8),
        cache_mb: Some(512),
        measures: vec![[DVec3::ZERO, DVec3::new(0.1, 2.0, 1.0 / 3.0)]],
        section: Some(SectionView::new([DVec3::ZERO, DVec3::ONE], DVec3::ZERO, DVec3::X)),
        sun: Some(SunTable::of(&SunControls::default())),
        edits: Some("[[object]]\nname = 'a'\nhidden = true\n".parse().unwrap()),
        mode: Mode::Exact,
        samples: 4,
        bounces: BounceLimit::ALL,
        exposure: Exposure::Stops(-0.5),
        tone_map: "linear".to_owned(),
        camera,
        views: vec![View { name: "r\u{e4}um \"1\"".to_owned(), key: Some(2), camera }],
        path: Some(path),
        other: Table::new(),
    }
}

fn parse(text: &str) -> anyhow::Result<SessionFile> {
    SessionFile::parse(text, Path::new("a.afterimage-session.toml"))
}

#[test]
fn a_session_comes_back_bit_for_bit_and_keeps_what_it_does_not_know() {
    let text = session().text(None).unwrap();
    assert_eq!(parse(&text).unwrap(), session());
    let numbered = parse(&text.replace("bounces = \"all\"", "bounces = 1")).unwrap();
    assert_eq!(numbered.bounces, BounceLimit(1), "as older versions have written it");
    let automatic = SessionFile { exposure: Exposure::Auto, ..session() };
    assert_eq!(parse(&automatic.text(None).unwrap()).unwrap(), automatic);
    let older = text.replace("exposure = ", "exposure_ev = ");
    assert_eq!(parse(&older).unwrap(), session());
    let first = text.replace("version = 2", "version = 1");
    assert_eq!(parse(&first).unwrap().camera, session().camera);
    let newer = format!("guests = 3\n{text}\n[weather]\nrain = true\n");
    let read = parse(&newer).unwrap();
    assert_eq!(read.camera, session().camera);
    let again = read.text(None).unwrap();
    assert!(again.contains("guests = 3") && again.contains("[weather]"), "{again}");
}

#[test]
fn other_versions_and_broken_files_are_reported() {
    let text = session().text(None).unwrap();
    let error = |text: &str| parse(text).unwrap_err().to_string();
    assert!(error(&text.replace("version = 2", "version = 3")).contains("newer program"));
    assert!(error("hello = 1").contains("not a session"));
    assert!(error("version = 1\nscene =\n").contains("line 2"));
    assert!(
        error(&text.replace("samples = 4", "samples = 'many'")).contains("a.afterimage-session.toml, line")
    );
    assert!(error(&text.replace("yaw = ", "yaw = nan # ")).contains("impossible"));
    assert!(error(&text.replace("hours = ", "hours = nan # ")).contains("sun"));
    let many = format!("measures = [{}]", "[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0]],".repeat(MAX_ENTRIES + 1));
    let line = text.lines().find(|line| line.starts_with("measures")).unwrap();
    assert!(error(&text.replace(line, &many)).contains("at most"));
    assert!(error(&text.replace("bounces = \"all\"", "bounces = 65")).contains("from 0 to 64"));
    assert!(is_session(Path::new("x/a.afterimage-session.toml")) && !is_session(Path::new("a.toml")));
}
