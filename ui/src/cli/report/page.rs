//! The report as one HTML file. It needs no network access, and escapes all names and texts.

use super::{chart::inline, text::shown};
use afterimage::experiment::run::report::{Block, Picture, Section, Table};
use afterimage::experiment::run::{Manifest, Report};
use anyhow::Context;
use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use minijinja::Environment;
use minijinja::value::Serde;
use serde_json::{Value, json};
use std::path::Path;

const TEMPLATE: &str = include_str!("page.html");
pub(super) const STYLE: &str = include_str!("page.css");
const SCRIPT: &str = include_str!("page.js");

/// The page of a report, with the pictures in `folder` embedded.
pub(super) fn html(manifest: &Manifest, folder: &Path, report: &Report) -> anyhow::Result<String> {
    let images = folder.join("images");
    let sections: Vec<Value> = report.sections.iter().map(|s| section(s, &images)).collect();
    let values = json!({
        "style": STYLE,
        "script": SCRIPT,
        "experiment": manifest.identity.experiment,
        "scene": manifest.identity.scene,
        "is_complete": manifest.is_complete,
        "cells_done": manifest.cells_done,
        "cells": manifest.cells,
        "headline": report.headline,
        "notes": report.notes,
        "sections": sections,
        "facts": facts(manifest),
    });
    render(TEMPLATE, &values)
}

/// A page from its template.
pub(super) fn render(template: &str, values: &Value) -> anyhow::Result<String> {
    // The extension of the template's name enables escaping.
    let mut environment = Environment::new();
    let page = environment
        .add_template("report.html", template)
        .and_then(|()| environment.get_template("report.html")?.render(Serde(values)));
    page.context("the report page cannot be written")
}

fn section(section: &Section, images: &Path) -> Value {
    let blocks: Vec<Value> = section.blocks.iter().map(|b| block(b, images)).collect();
    json!({ "title": section.title, "blocks": blocks })
}

fn block(block: &Block, images: &Path) -> Value {
    match block {
        Block::Text(text) => json!({ "kind": "text", "text": text }),
        Block::Table(found) => json!({ "kind": "table", "table": table(found) }),
        Block::Chart(chart) => json!({ "kind": "chart", "svg": inline(chart), "name": chart.name }),
        Block::Slider { title, before, after } => {
            let [before, after] = [before, after].map(|p| picture(p, images));
            json!({ "kind": "slider", "title": title, "before": before, "after": after })
        }
        Block::Pictures(found) => {
            let pictures: Vec<Value> = found.iter().map(|p| picture(p, images)).collect();
            json!({ "kind": "pictures", "pictures": pictures })
        }
    }
}

/// A picture embedded in the page; its source is null if its cell is not finished.
fn picture(picture: &Picture, images: &Path) -> Value {
    let bytes = std::fs::read(images.join(&picture.file)).ok();
    let source = bytes.map(|bytes| format!("data:image/png;base64,{}", STANDARD.encode(bytes)));
    json!({ "source": source, "caption": picture.caption, "file": picture.file })
}

/// A table; each cell has the text to show and the number to sort by.
fn table(table: &Table) -> Value {
    let cell = |value: &Value| json!({ "shown": shown(value), "number": value.as_f64() });
    let rows: Vec<Vec<Value>> = table.rows.iter().map(|row| row.iter().map(cell).collect()).collect();
    json!({ "title": table.title, "columns": table.columns, "rows": rows })
}

/// Settings and machines that the results depend on.
fn facts(manifest: &Manifest) -> Vec<[String; 2]> {
    let identity = &manifest.identity;
    let mut facts = vec![
        ["scene SHA-256".to_owned(), identity.scene_sha256.clone()],
        ["version".to_owned(), identity.version.clone()],
    ];
    facts.extend(identity.settings.0.iter().map(|(name, value)| [name.replace('_', " "), plain(value)]));
    for session in &manifest.sessions {
        let machine = &session.machine;
        let commit = session.commit.as_deref().unwrap_or("unknown");
        let build = if session.is_release_build { "release" } else { "debug" };
        let memory = machine.memory_gb.map_or(String::new(), |gb| format!(", {gb} GB"));
        facts.push(["command".to_owned(), session.argv.join(" ")]);
        facts.push([
            "ran on".to_owned(),
            format!(
                "{} ({} logical cores{memory}), {} {}, {} threads, commit {commit}, {build} build",
                machine.processor, machine.logical_cores, machine.os, machine.arch, session.threads
            ),
        ]);
    }
    facts
}

fn plain(value: &Value) -> String {
    value.as_str().map_or_else(|| value.to_string(), str::to_owned)
}
