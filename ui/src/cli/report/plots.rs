//! Charts as files: SVG, and PNG for where SVG is not shown.

use super::super::failure::Failure;
use super::chart::file;
use afterimage::experiment::run::report::Chart;
use afterimage::raster::save::write_atomically;
use resvg::tiny_skia::{Pixmap, Transform};
use resvg::usvg::{Options, Tree};
use std::path::Path;
use std::sync::Arc;

/// Pixels of the PNG per unit of the drawing.
const PIXELS_PER_UNIT: f32 = 1.5;

/// Writes every chart twice.
pub(super) fn write(folder: &Path, charts: &[&Chart]) -> Result<(), Failure> {
    if charts.is_empty() {
        return Ok(());
    }
    std::fs::create_dir_all(folder).map_err(|e| Failure::Failed(format!("{}: {e}", folder.display())))?;
    for chart in charts {
        let svg = file(chart);
        let name = file_name(&chart.name);
        write_atomically(&folder.join(format!("{name}.svg")), svg.as_bytes())?;
        let png =
            png(&svg).map_err(|e| Failure::Failed(format!("the chart '{name}' cannot be drawn: {e}")))?;
        write_atomically(&folder.join(format!("{name}.png")), &png)?;
    }
    Ok(())
}

/// Letters, digits and dashes only, whatever an experiment calls its chart.
fn file_name(name: &str) -> String {
    name.chars().map(|c| if c.is_ascii_alphanumeric() || c == '-' { c } else { '_' }).collect()
}

/// Text is set in the program's own font, so that a plot is the same on a machine that has none.
pub(super) fn png(svg: &str) -> Result<Vec<u8>, String> {
    let mut options = Options::default();
    let fonts = Arc::make_mut(&mut options.fontdb);
    fonts.load_font_data(epaint_default_fonts::UBUNTU_LIGHT.to_vec());
    fonts.set_sans_serif_family("Ubuntu");
    let tree = Tree::from_str(svg, &options).map_err(|e| e.to_string())?;
    let [width, height] =
        [tree.size().width(), tree.size().height()].map(|side| (side * PIXELS_PER_UNIT).round() as u32);
    let mut pixels = Pixmap::new(width, height).ok_or("it has no pixels")?;
    resvg::render(&tree, Transform::from_scale(PIXELS_PER_UNIT, PIXELS_PER_UNIT), &mut pixels.as_mut());
    pixels.encode_png().map_err(|e| e.to_string())
}
