use afterimage::scene::builtin;
use afterimage::trace::*;
use afterimage::{Mode, RenderSettings, Renderer};
use afterimage::reference::*;
use afterimage::trace::parallel::NEVER;
use std::sync::Arc;
fn main() {
    let scene = Arc::new(builtin::build("gallery").unwrap());
    let tracer = Tracer::new(scene.clone());
    let size = [1280u32, 720];
    let t16 = TraceSettings { samples: 4, bounces: 0, seed: 0 };
    let mode = if std::env::args().nth(2).as_deref() == Some("fast") { Mode::Fast } else { Mode::Exact };
    let n: u32 = std::env::args().nth(1).map_or(150, |a| a.parse().unwrap());
    let mut r = Renderer::default();
    let cam = |f: u32| scene.walk.camera(f, 300).unwrap();
    let mut cache = ReferenceCache::new(&scene, 4 << 30);
    for (k, o) in [0i32, -6, 4, 12, -12, 2, 8, -3, 16, -16].into_iter().enumerate() {
        let t = TraceSettings { seed: (k as u64 + 1) << 32, ..t16 };
        let lookup = cache.lookup(tracer.epoch());
        let f = ReferenceFrame::trace_sparse(&tracer, &cam((n as i32 + o) as u32), size, &t, &lookup, NEVER).unwrap();
        cache.insert(Arc::new(f));
    }
    let t16 = TraceSettings { samples: 16, ..t16 };
    let lookup = cache.lookup(tracer.epoch());
    let mut best = [f64::INFINITY; 4];
    for i in 0..std::env::args().nth(3).map_or(40u32, |a| a.parse().unwrap()) {
        let e = r.render_by_lookup(&tracer, &cam(n + 1 + i % 3), size, &RenderSettings { mode, trace: t16 }, &lookup, NEVER);
        let s = e.stats.secs;
        for (b, v) in best.iter_mut().zip([s.frame, s.warp, s.secondary, s.trace]) { *b = b.min(v); }
    }
    println!("frame {:.4} resolve {:.4} secondary {:.4} trace {:.4} {:?} {:?}", best[0], best[1], best[2], best[3], r.frame().stats.types, r.frame().stats.rays);
}
