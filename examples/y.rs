use afterimage::scene::builtin;
use afterimage::trace::*;
use afterimage::{Mode, RenderSettings, Renderer, Camera};
use afterimage::reference::*;
use afterimage::trace::parallel::NEVER;
use afterimage::raster::metrics::psnr_db;
use afterimage::raster::load::display_of;
use std::sync::Arc;
fn main() {
    let name = std::env::args().nth(1).unwrap_or("gallery".into());
    let scene = Arc::new(builtin::build(&name).unwrap());
    let tracer = Tracer::new(scene.clone());
    let size = [1280u32, 720];
    let t16 = TraceSettings { samples: 16, bounces: 0, seed: 0 };
    let tt = TraceSettings { samples: std::env::var("T").map_or(64, |t| t.parse().unwrap()), bounces: 0, seed: 0x99887766 };
    let mut r = Renderer::default();
    let mut truth_r = Renderer::default();
    for start in [20u32, 60, 260] {
        let cam = |f: u32| scene.walk.camera(f, 300).unwrap();
        let truth_path = format!("/tmp/exp/{name}-{start}.raw");
        let view_cam: Camera = cam(start);
        let truth = truth_r.render(&tracer, &view_cam, size, &RenderSettings { mode: Mode::Full, trace: tt }, &[], NEVER).radiance.clone();
        let _ = truth_path;
        let full = r.render(&tracer, &view_cam, size, &RenderSettings { mode: Mode::Full, trace: t16 }, &[], NEVER);
        let full_secs = full.stats.secs.frame;
        let full_radiance = full.radiance.clone();
        let d = |r: &[glam::Vec3]| display_of(r);
        let mut cache = ReferenceCache::new(&scene, 1 << 30);
        let full_tri = full.triangle.clone();
        println!("frame {start}: full {full_secs:.3} s {:.2} dB", psnr_db(&d(&full_radiance), &d(&truth)));
        for (k, offset) in [6i32, -6, 3, -3].into_iter().enumerate() {
            let t = TraceSettings { seed: (k as u64 + 1) << 32, ..t16 };
            let c = cam((start as i32 + offset) as u32);
            let lookup = cache.lookup(tracer.epoch());
            let f = ReferenceFrame::trace_sparse(&tracer, &c, size, &t, &lookup, NEVER).unwrap();
            println!("   reference at {offset:+}: {:.3} s, lit {:.1} %", f.secs, 100.0 * f.lit() as f64 / f.view.pixel_count() as f64);
            cache.insert(Arc::new(f));
            let lookup = cache.lookup(tracer.epoch());
            let mut best = f64::INFINITY;
            for _ in 0..3 {
                let e = r.render_by_lookup(&tracer, &view_cam, size, &RenderSettings { mode: Mode::Exact, trace: t16 }, &lookup, NEVER);
                best = best.min(e.stats.secs.frame);
            }
            let e = r.frame();
            let s = e.stats.secs;
            let bad = e.triangle.iter().zip(&full_tri).filter(|(a, b)| a != b).count();
            println!("   exact {best:.4} s = {:.1}x; resolve {:.4} secondary {:.4} unseen {:.4}; types {:?}; {:.2} dB; ", full_secs / best, s.warp, s.secondary, s.trace, e.stats.types, psnr_db(&d(&e.radiance), &d(&truth))); let _ = bad;
            if k == 9 {
                let (de, dt, df) = (d(&e.radiance), d(&truth), d(&full_radiance));
                let n = de.len() as f64;
                let err = |a: glam::Vec3, b: glam::Vec3| ((a - b).length_squared() / 3.0) as f64;
                let known = |i: usize| e.types[i] != afterimage::reproject::PixelType::Unseen;
                let full_mse: f64 = (0..de.len()).map(|i| err(df[i], dt[i])).sum::<f64>() / n;
                let mut es: Vec<f64> = (0..de.len()).map(|i| err(de[i], dt[i])).collect();
                let mse: f64 = es.iter().sum::<f64>() / n;
                let mut ix: Vec<usize> = (0..de.len()).collect();
                ix.sort_by(|a, b| es[*b].total_cmp(&es[*a]));
                for &i in ix.iter().step_by(30).take(0) { println!("        ({},{}) {:?} tri {} exact {:.3} truth {:.3} full {:.3} err {:.1e}", i % 1280, i / 1280, e.types[i], e.triangle[i], de[i].y, dt[i].y, df[i].y, es[i]); }
                for part in [20usize, 100, 1000, 10000, 100000] { let s: f64 = ix[..part].iter().map(|&i| es[i]).sum::<f64>() / n; print!("  top {part}: {:.1}%", 100.0 * s / mse); }
                println!();
                es.sort_by(|a, b| b.total_cmp(a));
                let mut s = mse; let mut k2 = 0;
                while s > full_mse { s -= es[k2] / n; k2 += 1; }
                println!("      mse {mse:.2e} full {full_mse:.2e}; oracle share {:.2} %", 100.0 * k2 as f64 / n);
            }
            let img = afterimage::render::aov::display_picture(e, 0.0, afterimage::raster::color::ToneMap::Aces);
            let mut buf = image::RgbImage::new(size[0], size[1]);
            for (p, c) in buf.pixels_mut().zip(&img) { *p = image::Rgb(*c); }
            buf.save(format!("/tmp/exp/{name}-{start}-{k}.png")).unwrap();
            for ((p, c), t) in buf.pixels_mut().zip(&img).zip(&e.types) { *p = if *t == afterimage::reproject::PixelType::Unseen { image::Rgb([255, 0, 0]) } else { image::Rgb(*c) }; }
            buf.save(format!("/tmp/exp/{name}-{start}-{k}-types.png")).unwrap();
            for (p, c) in buf.pixels_mut().zip(&d(&truth)) { *p = image::Rgb((*c * 255.0).to_array().map(|v| v as u8)); }
            buf.save(format!("/tmp/exp/{name}-{start}-truth.png")).unwrap();
            for (p, c) in buf.pixels_mut().zip(&d(&e.radiance)) { *p = image::Rgb((*c * 255.0).to_array().map(|v| v as u8)); }
            buf.save(format!("/tmp/exp/{name}-{start}-{k}-lin.png")).unwrap();
            // error map
            let err: Vec<f32> = d(&e.radiance).iter().zip(&d(&truth)).map(|(a, b)| (*a - *b).abs().max_element()).collect();
            for (p, e) in buf.pixels_mut().zip(&err) { let v = (e * 2550.0).min(255.0) as u8; *p = image::Rgb([v, v, v]); }
            buf.save(format!("/tmp/exp/{name}-{start}-{k}-err.png")).unwrap();
        }
    }
}
