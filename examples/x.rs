use afterimage::scene::builtin;
use afterimage::trace::*;
use afterimage::camera::View;
use std::sync::Arc;
use std::time::Instant;
fn main() {
    let scene = Arc::new(builtin::build(&std::env::args().nth(1).unwrap_or("gallery".into())).unwrap());
    let tracer = Tracer::new(scene.clone());
    let size = [1280u32, 720];
    for f in [0u32, 40, 60, 120, 180, 240, 280] {
        let camera = scene.walk.camera(f, 300).unwrap();
        let view = View::new(&camera, &scene.frame, size);
        let order = afterimage::trace::parallel::tile_order(size);
        let start = Instant::now();
        let single: Vec<_> = order.iter().map(|&p| tracer.closest(&Tracer::primary_ray(&view, p))).collect();
        let a = start.elapsed().as_secs_f64();
        let mut tile = primary_tile(&view, [0, 0]);
        let mut hits = TileHits::NONE;
        let mut bad = 0;
        let mut b = f64::INFINITY;
        for _ in 0..3 {
            bad = 0;
            let start = Instant::now();
            let mut i = 0;
            for y in (0..size[1]).step_by(8) {
                for x in (0..size[0]).step_by(8) {
                    tracer.closest_in_tile(&view, [x, y], &mut tile, &mut hits);
                    for k in 0..64 {
                        bad += (hits.hit(k) != single[i]) as u32;
                        i += 1;
                    }
                }
            }
            b = b.min(start.elapsed().as_secs_f64());
        }
        println!("frame {f}: single {:.1} ns, tile {:.1} ns, bad {bad}", a * 1e9 / 921600.0, b * 1e9 / 921600.0);
    }
}
