//! Tests of charts and pages: positions of points, and escaping of names.

use super::chart::{escaped, file, inline};
use super::page::html;
use super::plots::png;
use afterimage::experiment::run::report::{
    Axis, Block, Chart, Drawn, Picture, Point, Section, Series, Table,
};
use afterimage::experiment::run::{Manifest, Report};
use serde_json::json;

const HOSTILE: &str = "</script><img src=x onerror=alert(1)>&\"'";

fn chart() -> Chart {
    let point =
        |x: f64, y: f64, label: &str| Point { x_range: Some([x / 2.0, x * 2.0]), ..Point::new(x, y, label) };
    let points = vec![point(0.01, 30.0, "slow"), point(0.1, 40.0, HOSTILE), point(0.0, 35.0, "off the axis")];
    let series = |drawn, color: &str| Series {
        name: HOSTILE.to_owned(),
        drawn,
        color: color.to_owned(),
        points: points.clone(),
    };
    Chart {
        name: "error".to_owned(),
        title: HOSTILE.to_owned(),
        x: Axis::logarithmic("seconds"),
        y: Axis::linear("dB"),
        series: vec![series(Drawn::MarksAndLine, "#ff0000"), series(Drawn::Dashes, HOSTILE)],
    }
}

fn manifest() -> Manifest {
    serde_json::from_value(json!({
        "format": 1, "experiment": "table1", "version": "1", "scene": HOSTILE, "scene_sha256": "ab",
        "settings": { "size": [2, 2] }, "seed": 0, "shard": { "index": 0, "count": 1 }, "cells": 2, "cells_done": 1,
        "is_complete": false, "sessions": []
    }))
    .unwrap()
}

fn page() -> String {
    let folder = tempfile::tempdir().unwrap();
    std::fs::create_dir(folder.path().join("images")).unwrap();
    std::fs::write(folder.path().join("images/a.png"), b"\x89PNG").unwrap();
    let picture = |name: &str| Picture::new(name, HOSTILE);
    let table = Table {
        title: HOSTILE.to_owned(),
        columns: vec![HOSTILE.to_owned(), "value".to_owned()],
        rows: vec![vec![HOSTILE.into(), 0.12345678.into()]],
    };
    let blocks = vec![
        Block::Text(HOSTILE.to_owned()),
        Block::Table(table),
        Block::Chart(chart()),
        Block::Slider { title: HOSTILE.to_owned(), before: picture("a.png"), after: picture("a.png") },
        Block::Pictures(vec![picture("a.png"), picture("missing.png")]),
    ];
    let report = Report {
        headline: vec![HOSTILE.to_owned()],
        notes: vec![HOSTILE.to_owned()],
        sections: vec![Section { title: HOSTILE.to_owned(), blocks }],
        ..Report::default()
    };
    html(&manifest(), folder.path(), &report).unwrap()
}

#[test]
fn a_page_is_self_contained_and_escapes_names() {
    let page = page();
    assert_eq!(page.matches("<script>").count(), 1, "its own");
    assert!(!page.contains("<img src=x"), "a name became an element");
    assert_eq!(page.matches(r#"src="data:image/png;base64,iVBORw==""#).count(), 3);
    let without_names = page.replace("http://www.w3.org/2000/svg", "");
    for address in ["http://", "https://", "url(", "@import", "<link"] {
        assert!(!without_names.contains(address), "{address}");
    }
    assert!(page.contains("missing.png is not rendered yet"));
    assert!(page.contains(r#"data-number="0.12345678">0.1235"#), "sorted by all digits, shown by four");
    assert!(page.contains("1 of 2 cells are finished"));
}

#[test]
fn points_lie_at_their_values() {
    let svg = inline(&chart());
    let places: Vec<[f64; 2]> = svg
        .split(r#"<g class="mark">"#)
        .skip(1)
        .filter_map(|mark| {
            let (x, y) = mark.split_once("translate(")?.1.split_once(')')?.0.split_once(' ')?;
            Some([x.parse().ok()?, y.parse().ok()?])
        })
        .collect();
    let [[x1, y1], [x2, y2]] = places[..] else {
        panic!("zero has no place on a logarithmic axis: {places:?}")
    };
    assert!(x1 < x2 && y1 > y2, "right is more, up is more: {places:?}");
    // From 0.005 to 0.2, the ranges' ends, 0.01 to 0.1 is this share of the inner 92 % of the
    // width.
    let width = 760.0 - 76.0 - 20.0;
    let share = 10f64.ln() / 40f64.ln() / 1.08;
    assert!(((x2 - x1) / width - share).abs() < 1e-3, "{places:?}");
}

#[test]
fn a_rasterised_plot_has_marks_and_text() {
    let pixels = image::load_from_memory(&png(&file(&chart())).unwrap()).unwrap().to_rgb8();
    let count = |wanted: fn([u8; 3]) -> bool| pixels.pixels().filter(|p| wanted(p.0)).count();
    assert!(count(|[r, g, b]| r > 240 && g < 20 && b < 20) > 100, "red marks and lines");
    // Without its font there would be no dark pixel: axes and grid are grey.
    assert!(count(|[r, g, b]| r < 80 && g < 80 && b < 80) > 300, "letters");
    assert_eq!(pixels.get_pixel(2, 2).0, [255; 3]);
}

#[test]
fn a_chart_without_values_says_so() {
    assert!(inline(&Chart::default()).contains("nothing to show yet"));
    assert!(png(&file(&Chart::default())).is_ok());
    assert_eq!(escaped("a\u{0}<b>"), "a&lt;b&gt;");
}
