//! A report as lines of text.

use afterimage::experiment::run::Report;
use afterimage::experiment::run::report::{Block, Table};
use serde_json::Value;
use std::path::Path;

/// The sentences and tables of a report; its pictures and charts are only in the folder, if one is
/// kept.
pub(in crate::cli) fn report(folder: Option<&Path>, report: &Report) -> String {
    let mut lines = report.headline.join("\n") + "\n";
    lines.extend(report.notes.iter().map(|note| format!("note: {note}\n")));
    for section in &report.sections {
        for block in &section.blocks {
            match block {
                Block::Table(content) => lines += &format!("\n{}\n{}", content.title, table(content)),
                Block::Text(text) => lines += &format!("\n{text}\n"),
                Block::Chart(_) | Block::Slider { .. } | Block::Pictures(_) => {}
            }
        }
    }
    if let Some(folder) = folder {
        lines += &format!("\nwritten to {}\n", folder.display());
    }
    lines
}

/// A value as text: integers with all digits, other numbers with four significant figures.
pub(super) fn shown(value: &Value) -> String {
    match value {
        Value::Null => String::new(),
        Value::String(text) => text.clone(),
        Value::Number(number) => match (number.as_i64(), number.as_f64()) {
            (Some(whole), _) => whole.to_string(),
            (None, Some(number)) => four_figures(number),
            (None, None) => number.to_string(),
        },
        other => other.to_string(),
    }
}

fn four_figures(number: f64) -> String {
    if number == 0.0 {
        return "0".to_owned();
    }
    let places = 3 - (number.abs().log10().floor() as i32);
    match usize::try_from(places) {
        Ok(places) if places <= 9 => format!("{number:.places$}"),
        Ok(_) => format!("{number:.3e}"),
        Err(_) => format!("{number:.0}"),
    }
}

fn table(table: &Table) -> String {
    let cells: Vec<Vec<String>> = std::iter::once(table.columns.clone())
        .chain(table.rows.iter().map(|row| row.iter().map(shown).collect()))
        .collect();
    let width = |column: usize| {
        cells.iter().filter_map(|row| row.get(column)).map(|c| c.chars().count()).max().unwrap_or(0)
    };
    let widths: Vec<usize> = (0..table.columns.len()).map(width).collect();
    let line = |row: &Vec<String>| {
        let padded = row.iter().zip(&widths).enumerate().map(|(column, (cell, &width))| match column {
            0 => format!("{cell:<width$}"),
            _ => format!("{cell:>width$}"),
        });
        padded.collect::<Vec<_>>().join("  ").trim_end().to_owned() + "\n"
    };
    cells.iter().map(line).collect()
}
