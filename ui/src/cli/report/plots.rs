//! Writes charts as SVG files, and as PNG files for programs without SVG.

use super::chart::file;
use afterimage::{experiment::run::report::Chart, raster::save::write_atomically};
use anyhow::Context;
use resvg::tiny_skia::{Pixmap, Transform};
use resvg::usvg::{Options, Tree};
use std::{path::Path, sync::Arc};

/// Pixels of the PNG per SVG unit.
const PIXELS_PER_UNIT: f32 = 1.5;

/// Writes every chart as SVG and as PNG.
pub(super) fn write(folder: &Path, charts: &[&Chart]) -> anyhow::Result<()> {
    if charts.is_empty() {
        return Ok(());
    }
    std::fs::create_dir_all(folder).with_context(|| folder.display().to_string())?;
    for chart in charts {
        let svg = file(chart);
        let name = file_name(&chart.name);
        write_atomically(&folder.join(format!("{name}.svg")), svg.as_bytes())?;
        let png = png(&svg).with_context(|| format!("the chart '{name}' cannot be drawn"))?;
        write_atomically(&folder.join(format!("{name}.png")), &png)?;
    }
    Ok(())
}

/// File name of a chart: other characters than ASCII letters, digits and dashes are replaced.
fn file_name(name: &str) -> String {
    name.chars().map(|c| if c.is_ascii_alphanumeric() || c == '-' { c } else { '_' }).collect()
}

/// Rasterises a drawing. Its text uses the embedded font, so that plots are the same on all
/// machines.
pub(super) fn png(svg: &str) -> anyhow::Result<Vec<u8>> {
    let mut options = Options::default();
    let fonts = Arc::make_mut(&mut options.fontdb);
    fonts.load_font_data(epaint_default_fonts::UBUNTU_LIGHT.to_vec());
    fonts.set_sans_serif_family("Ubuntu");
    let tree = Tree::from_str(svg, &options)?;
    let [width, height] =
        [tree.size().width(), tree.size().height()].map(|side| (side * PIXELS_PER_UNIT).round() as u32);
    let mut pixels = Pixmap::new(width, height).context("it has no pixels")?;
    resvg::render(&tree, Transform::from_scale(PIXELS_PER_UNIT, PIXELS_PER_UNIT), &mut pixels.as_mut());
    Ok(pixels.encode_png()?)
}
