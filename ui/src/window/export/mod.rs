//! Pictures and picture sequences, made off the window's thread: progress, cancel, and a word at the end.

pub mod screenshot;

use crate::picture::{LONGEST_SIDE, Output, PictureJob, Shows, sequence};
use crate::window::app::App;
use crate::window::rendering::exchange::locked;
use crate::window::rendering::render_thread::{Picture, RenderCommand, Wake, give_way, panic_text};
use crate::window::state::{Exporting, PictureCommand, PictureFormat, PictureSize};
use afterimage::raster::stream::Target;
use afterimage::reference::ReferenceFrame;
use afterimage::render::aov::Aov;
use afterimage::render::bands::Background;
use afterimage::{Camera, Mode, RenderSettings, Tracer};
use crossbeam_channel::{Receiver, bounded};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};
use std::thread::JoinHandle;

/// What an export brings back: what to say, and how to make a film of it.
#[derive(Debug)]
pub(crate) struct Exported {
    pub(crate) text: String,
    pub(crate) film_command: Option<String>,
}

/// An export on its way. Dropping it cancels and waits: nothing half-written is left.
#[derive(Debug)]
pub(crate) struct Export {
    what: String,
    part: Arc<Mutex<f64>>,
    cancel: Arc<AtomicBool>,
    result: Receiver<Result<Exported, String>>,
    thread: Option<JoinHandle<()>>,
}

/// Tells the window how far the export is, and the export whether to go on.
pub(crate) struct Report {
    part: Arc<Mutex<f64>>,
    cancel: Arc<AtomicBool>,
    wake: Wake,
}

impl Report {
    fn at(&self, part: f64) {
        // Told from every thread after every tile: who would have to wait leaves it to the others.
        let Ok(mut shown) = self.part.try_lock() else { return };
        let is_news = (part * 200.0) as u32 != (*shown * 200.0) as u32;
        *shown = part;
        drop(shown);
        if is_news {
            (self.wake)();
        }
    }

    fn is_cancelled(&self) -> bool {
        self.cancel.load(Ordering::Relaxed)
    }
}

impl Export {
    fn start(
        what: String,
        threads: usize,
        wake: Wake,
        work: impl FnOnce(&Report) -> Result<Exported, String> + Send + 'static,
    ) -> std::io::Result<Self> {
        let (part, cancel) = (Arc::new(Mutex::new(0.0)), Arc::new(AtomicBool::new(false)));
        let (sender, result) = bounded(1);
        let report = Report { part: part.clone(), cancel: cancel.clone(), wake };
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .thread_name(|i| format!("export-{i}"))
            .start_handler(|_| give_way())
            .build()
            .map_err(std::io::Error::other)?;
        let run = move || {
            let made = catch_unwind(AssertUnwindSafe(|| pool.install(|| work(&report))));
            let made = made.unwrap_or_else(|panic| Err(format!("saving failed: {}", panic_text(&*panic))));
            // The window may be gone.
            let _ = sender.send(made);
            (report.wake)();
        };
        let thread = std::thread::Builder::new().name("afterimage-export".to_owned()).spawn(run)?;
        Ok(Self { what, part, cancel, result, thread: Some(thread) })
    }

    /// What is shown of it.
    pub(crate) fn shown(&self) -> Exporting {
        Exporting { what: self.what.clone(), part: *locked(&self.part) as f32 }
    }
}

impl Drop for Export {
    fn drop(&mut self) {
        self.cancel.store(true, Ordering::Relaxed);
        if let Some(thread) = self.thread.take() {
            // A thread that panicked has already said so.
            let _ = thread.join();
        }
    }
}

/// What is said of a picture that was cancelled; it is no failure.
const CANCELLED: &str = "";

impl App {
    /// Does what was asked for.
    pub(crate) fn picture(&mut self, command: PictureCommand) {
        let state = &mut self.state;
        match command {
            PictureCommand::Save => self.save_picture(self.state.picture.settings.background),
            PictureCommand::SaveWithoutBackground => self.save_picture(Background::LeftOut),
            PictureCommand::SaveSequence => self.save_sequence(),
            PictureCommand::ShowDialog(is_open) => state.picture.is_open = is_open,
            PictureCommand::Set(settings) => state.picture.settings = settings,
            PictureCommand::SetFolderText(text) => {
                let trimmed = text.trim();
                state.picture.settings.folder = (!trimmed.is_empty()).then(|| PathBuf::from(trimmed));
                state.picture.folder_text = text;
            }
            PictureCommand::Cancel => {
                if self.export.take().is_some() {
                    state.info("saving was cancelled");
                }
            }
        }
    }

    /// The folders that are tried, in this order.
    pub(crate) fn picture_folders(&self) -> Vec<PathBuf> {
        let chosen = self.state.picture.settings.folder.clone().or_else(|| self.request.pictures.clone());
        chosen.map_or_else(screenshot::default_folders, |folder| vec![folder])
    }

    fn picture_stem(&self) -> String {
        screenshot::stem(self.state.scene.as_ref().map_or("picture", |s| &s.name))
    }

    /// The picture of the present view, with the settings of the dialog.
    fn picture_job(&self, camera: Camera, background: Background) -> Result<PictureJob, String> {
        let settings = &self.state.picture.settings;
        let size = match settings.size {
            PictureSize::Viewport => self.viewport_size.map(|side| side.clamp(1, LONGEST_SIDE)),
            PictureSize::Pixels(size) => size,
        };
        if size.iter().any(|side| !(1..=LONGEST_SIDE).contains(side)) {
            return Err(format!("a picture is from 1 to {LONGEST_SIDE} pixels wide and high"));
        }
        let (quality, mut render) = (&self.state.quality, self.state.quality.walk.render);
        render.trace.samples = settings.samples.unwrap_or(render.trace.samples);
        render.mode = if background == Background::LeftOut { Mode::Full } else { settings.mode };
        let scene_name =
            self.state.scene.as_ref().map(|s| s.source.label()).ok_or("there is no scene yet")?;
        Ok(PictureJob {
            scene_name,
            camera,
            size,
            settings: RenderSettings { ..render },
            antialias: (render.mode == Mode::Full && settings.antialias > 1).then_some(settings.antialias),
            background,
            exposure_ev: quality.exposure_ev,
            tone_map: quality.tone_map,
        })
    }

    fn save_picture(&mut self, background: Background) {
        match self.picture_job(*self.state.navigation.fly.camera(), background) {
            Err(message) => self.state.error(message),
            // The references are with the thread that renders.
            Ok(job) if job.settings.mode != Mode::Full => drop(self.threads.send(RenderCommand::Picture)),
            Ok(job) => self.export_picture(job, Vec::new()),
        }
    }

    /// Goes on with a picture that reuses references, which are here now.
    pub(crate) fn save_from_references(&mut self, picture: Picture) {
        match self.picture_job(picture.camera, Background::Shown) {
            Err(message) => self.state.error(message),
            Ok(job) => self.export_picture(job, picture.references),
        }
    }

    fn export_picture(&mut self, job: PictureJob, references: Vec<Arc<ReferenceFrame>>) {
        if let Err(error) = job.check(&references) {
            self.state.error(error.to_string());
            return;
        }
        let (folders, stem) = (self.picture_folders(), self.picture_stem());
        let (extension, shows) = match self.state.picture.settings.format {
            PictureFormat::Png => ("png", Shows::Display),
            PictureFormat::Exr => ("exr", Shows::Linear(Aov::ALL.to_vec())),
        };
        let [width, height] = job.size;
        self.export(format!("Picture {width}x{height}"), move |tracer, report| {
            let mut refusal = "there is no folder to save pictures in".to_owned();
            for folder in folders {
                let target = Target::Next { folder, stem: stem.clone(), extension };
                let output = Output { target, shows: shows.clone() };
                if let Err(error) = output.target.probe() {
                    refusal = format!("{error}; choose another folder in Scene, Picture settings");
                    continue;
                }
                return save(&job, tracer, &references, &output, report);
            }
            Err(refusal)
        });
    }

    fn save_sequence(&mut self) {
        let walk = self.state.navigation.playback.path.clone();
        if walk.keyframes.len() < 2 {
            let text = "a sequence needs a camera path of two keys or more; K sets one where you stand";
            self.state.error(text);
            return;
        }
        let job = match self
            .picture_job(*self.state.navigation.fly.camera(), self.state.picture.settings.background)
        {
            Ok(job) => job,
            Err(message) => return self.state.error(message),
        };
        // A sequence is a film: every picture of it is the full tracer's.
        let mode = RenderSettings { mode: Mode::Full, ..job.settings };
        let antialias = Some(self.state.picture.settings.antialias).filter(|n| *n > 1);
        let job = PictureJob { settings: mode, antialias, ..job };
        let (folders, stem) = (self.picture_folders(), self.picture_stem());
        self.export(format!("Sequence of {} pictures", walk.frames), move |tracer, report| {
            let sequence = sequence::Sequence { job, walk };
            let stop = || report.is_cancelled();
            let made = sequence.make(tracer, &folders, &stem, &stop, &|part| report.at(part));
            let made = made.map_err(|e| e.to_string())?;
            if report.is_cancelled() {
                return Err(CANCELLED.to_owned());
            }
            Ok(Exported { text: made.text(), film_command: Some(made.film_command()) })
        });
    }

    /// Starts an export, unless one is on its way.
    fn export(
        &mut self,
        what: String,
        work: impl FnOnce(&Tracer, &Report) -> Result<Exported, String> + Send + 'static,
    ) {
        if self.export.is_some() {
            let text = "a picture is being saved; wait for it, or cancel it".to_owned();
            return self.state.error(text);
        }
        let Some(tracer) = self.obstacles.as_ref().map(|o| o.tracer().clone()) else { return };
        let all = std::thread::available_parallelism().map_or(1, usize::from);
        let threads = self.request.threads.unwrap_or(all);
        match Export::start(what, threads, self.wake.clone(), move |report| work(&tracer, report)) {
            Ok(export) => self.export = Some(export),
            Err(error) => self.state.error(format!("saving cannot be started: {error}")),
        }
    }

    /// Takes in how far the export is, and its end.
    pub(crate) fn poll_export(&mut self) {
        self.state.picture.exporting = self.export.as_ref().map(Export::shown);
        let Some(result) = self.export.as_ref().and_then(|e| e.result.try_recv().ok()) else { return };
        (self.export, self.state.picture.exporting) = (None, None);
        match result {
            Ok(exported) => {
                self.state.picture.film_command = exported.film_command;
                self.state.info(exported.text);
            }
            Err(text) if text == CANCELLED => {}
            Err(text) => self.state.error(text),
        }
    }
}

/// A picture that was cancelled is not kept: nobody wants it.
fn save(
    job: &PictureJob,
    tracer: &Tracer,
    references: &[Arc<ReferenceFrame>],
    output: &Output,
    report: &Report,
) -> Result<Exported, String> {
    let stop = || report.is_cancelled();
    let made =
        job.make_whole(tracer, references, std::slice::from_ref(output), &stop, &|part| report.at(part));
    match made {
        Err(error) => Err(format!("{error}; free some space or choose another folder")),
        Ok(None) => Err(CANCELLED.to_owned()),
        Ok(Some(made)) => {
            let names: Vec<String> = made.paths.iter().map(|p| p.display().to_string()).collect();
            Ok(Exported { text: format!("saved {}", names.join(", ")), film_command: None })
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use afterimage::raster::color::ToneMap;
    use afterimage::scene::builtin;

    #[test]
    #[cfg(target_os = "linux")]
    fn a_full_disk_is_told_with_what_to_do() {
        let tracer = Tracer::new(Arc::new(builtin::build("furnace").unwrap()));
        let job = PictureJob {
            scene_name: "builtin:furnace".to_owned(),
            camera: tracer.scene().views[0].camera,
            size: [64, 64],
            settings: RenderSettings { mode: Mode::Full, ..RenderSettings::default() },
            antialias: None,
            background: Background::Shown,
            exposure_ev: 0.0,
            tone_map: ToneMap::default(),
        };
        let output = Output { target: Target::File("/dev/full".into()), shows: Shows::Display };
        let (part, cancel) = (Arc::default(), Arc::default());
        let told = save(&job, &tracer, &[], &output, &Report { part, cancel, wake: Arc::new(|| {}) });
        let told = told.unwrap_err();
        assert!(told.contains("No space") && told.contains("free some space"), "{told}");
    }
}
