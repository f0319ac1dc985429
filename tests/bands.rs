//! Pictures rendered in bands have the bits of the whole picture, and files are written from the
//! top.

use crate::rooms::{room_camera, room_tracer};
use afterimage::raster::load::{Picture, read_notes};
use afterimage::raster::save::{Channel, ChannelValues, Target, encode_png};
use afterimage::raster::stream::{Contents, PictureFile, Rows};
use afterimage::render::aov::{Aov, display_rows_alpha};
use afterimage::render::bands::{Background, Band, BandedPicture};
use afterimage::trace::{RayCounts, TraceSettings, Tracer};
use afterimage::{
    Camera, FrameRequest, Mode, RenderSettings, render::render_antialiased, trace::parallel::NEVER,
};
use glam::{DVec3, Vec3};
use std::sync::atomic::{AtomicU64, Ordering};

const SIZE: [u32; 2] = [53, 37];
const TRACE: TraceSettings = TraceSettings { samples: 2, bounces: 1, seed: 9 };

fn banded<'a>(tracer: &'a Tracer, camera: &'a Camera, passes: u32) -> BandedPicture<'a> {
    BandedPicture { tracer, camera, size: SIZE, trace: TRACE, passes, background: Background::Shown }
}

#[test]
fn bands_have_the_bits_of_the_whole_picture() {
    let (tracer, camera) = (room_tracer(true, true), room_camera());
    let settings = RenderSettings { mode: Mode::Full, trace: TRACE };
    for passes in [1, 3] {
        let whole = render_antialiased(&FrameRequest::new(&tracer, &camera, SIZE, &settings), passes);
        let rays = whole.stats.rays;
        let whole = Band::from(whole);
        let (picture, done) = (banded(&tracer, &camera, passes), AtomicU64::new(0));
        let (mut y, mut counted) = (0, RayCounts::default());
        for rows in [0..8, 8..24, 24..37] {
            let report = |work| {
                done.fetch_add(work, Ordering::Relaxed);
            };
            let (band, rays) = picture.render(rows.clone(), NEVER, &report).unwrap();
            counted += rays;
            let part = (y * SIZE[0]) as usize..(rows.end * SIZE[0]) as usize;
            assert_eq!(band.radiance, whole.radiance[part.clone()]);
            assert_eq!(band.disparity, whole.disparity[part.clone()]);
            assert_eq!(band.triangle, whole.triangle[part.clone()]);
            for aov in Aov::ALL {
                let names: Vec<String> = aov.channel_names().iter().map(|(n, _)| (*n).to_owned()).collect();
                for ((of_band, of_whole), name) in
                    aov.channels(&band, &tracer).iter().zip(aov.channels(&whole, &tracer)).zip(names)
                {
                    assert_eq!(of_band.name, name);
                    match (&of_band.values, &of_whole.values) {
                        (ChannelValues::Real(a), ChannelValues::Real(b)) => assert_eq!(*a, b[part.clone()]),
                        (ChannelValues::Index(a), ChannelValues::Index(b)) => assert_eq!(*a, b[part.clone()]),
                        _ => panic!("{name} has values of another kind"),
                    }
                }
            }
            y = rows.end;
        }
        assert_eq!((y, done.into_inner()), (SIZE[1], picture.work()));
        assert_eq!(counted, rays);
    }
}

#[test]
fn the_bands_of_a_picture_are_all_its_rows_once() {
    let tracer = room_tracer(false, false);
    let camera = room_camera();
    for size in [[1, 1], [53, 37], [1280, 720], [16384, 16384], [1 << 28, 1], [1, 65536]] {
        let bands: Vec<_> = BandedPicture { size, ..banded(&tracer, &camera, 1) }.bands().collect();
        assert_eq!((bands[0].start, bands.last().unwrap().end), (0, size[1]));
        assert!(bands.windows(2).all(|b| b[0].end == b[1].start && b[0].end % 8 == 0));
    }
}

#[test]
fn a_stop_ends_a_band() {
    let (tracer, camera) = (room_tracer(false, false), room_camera());
    assert!(banded(&tracer, &camera, 1).render(0..8, &|| true, &|_| {}).is_none());
}

#[test]
fn without_the_background_the_sky_is_transparent_and_all_else_is_unchanged() {
    let tracer = room_tracer(false, false);
    // Seen from outside, the room covers a part of the picture.
    let camera = Camera::look_at(DVec3::new(30.0, 1.0, 30.0), DVec3::new(0.0, 1.0, 5.0), 60.0);
    let shown = banded(&tracer, &camera, 4);
    let left_out = BandedPicture { background: Background::LeftOut, ..banded(&tracer, &camera, 4) };
    let (shown, _) = shown.render(0..37, NEVER, &|_| {}).unwrap();
    let (left_out, _) = left_out.render(0..37, NEVER, &|_| {}).unwrap();
    let pixels = display_rows_alpha(&left_out, 0.0, Default::default());
    let count = |alpha: u8| pixels.iter().filter(|p| p[3] == alpha).count();
    assert!(count(0) > 100 && count(255) > 10, "{} {}", count(0), count(255));
    assert!(pixels.iter().any(|p| (1..255).contains(&p[3])), "edges are covered in part");
    for (i, pixel) in pixels.iter().enumerate() {
        if pixel[3] == 0 {
            assert_eq!((*pixel, left_out.radiance[i]), ([0; 4], Vec3::ZERO));
        } else if pixel[3] == 255 {
            assert_eq!(left_out.radiance[i], shown.radiance[i]);
        }
    }
}

fn target(folder: &std::path::Path, name: &str) -> Target {
    Target::File(folder.join(name))
}

fn names(folder: &std::path::Path) -> usize {
    std::fs::read_dir(folder).unwrap().count()
}

#[test]
fn a_png_written_in_portions_is_the_one_written_at_once() {
    let folder = tempfile::tempdir().unwrap();
    let pixels: Vec<[u8; 3]> = (0..12u8).map(|i| [i, 2 * i, 200]).collect();
    let notes = [("Scene", "r\u{e4}um".to_owned())];
    let mut file = PictureFile::begin(target(folder.path(), "a.png"), Contents::Png, [3, 4], &notes).unwrap();
    file.write(Rows::Srgb(pixels[..3].to_vec())).unwrap();
    file.write(Rows::Srgb(pixels[3..].to_vec())).unwrap();
    assert!(!folder.path().join("a.png").exists(), "an unfinished file is not visible under its name");
    let path = file.finish(true).unwrap();
    std::fs::write(folder.path().join("b.png"), encode_png([3, 4], &pixels, &notes).unwrap()).unwrap();
    let picture = Picture::load(&path).unwrap();
    assert_eq!(picture, Picture::load(&folder.path().join("b.png")).unwrap());
    assert_eq!(read_notes(&path).unwrap(), [("Scene".to_owned(), "r\u{e4}um".to_owned())]);
    assert_eq!(names(folder.path()), 2);
}

#[test]
fn a_jpeg_written_in_portions_is_close_to_its_picture_and_has_all_notes() {
    let folder = tempfile::tempdir().unwrap();
    // Smooth, as most of a picture is; neither side is a multiple of a block.
    let (width, height) = (37, 45);
    let pixel = |i: usize| [(i % width * 6) as u8, (i / width * 5) as u8, 128];
    let pixels: Vec<[u8; 3]> = (0..width * height).map(pixel).collect();
    let long = "\u{e4}".repeat(80_000);
    let notes = [("Scene", "r\u{e4}um: 1".to_owned()), ("Document", long), ("Pose", String::new())];
    let begin = |quality| {
        let size = [width as u32, height as u32];
        PictureFile::begin(target(folder.path(), "a.jpg"), Contents::Jpeg(quality), size, &notes).unwrap()
    };
    let mut errors = Vec::new();
    for (quality, known) in [(90, height), (20, height), (90, 20)] {
        let mut file = begin(quality);
        for rows in [0..1, 1..9, 9..20, 20..height] {
            if rows.end <= known {
                file.write(Rows::Srgb(pixels[rows.start * width..rows.end * width].to_vec())).unwrap();
            }
        }
        let path = file.finish(known == height).unwrap();
        let read = read_notes(&path).unwrap();
        let complete = if known == height { "yes" } else { "no " };
        let expected =
            notes.iter().map(|(name, text)| (*name, text.as_str())).chain([("Complete", complete)]);
        assert!(read.iter().map(|(name, text)| (name.as_str(), text.as_str())).eq(expected), "{quality}");
        let picture = Picture::load(&path).unwrap();
        assert_eq!(picture.size, [width as u32, height as u32]);
        let off = |(v, p): (&Vec3, &[u8; 3])| (*v * 255.0 - Vec3::from(p.map(f32::from))).length();
        // The block of the last known row holds black ones too.
        let whole = known / 8 * 8 * width;
        errors.push(picture.values[..whole].iter().zip(&pixels).map(off).sum::<f32>() / whole as f32);
        assert!(
            picture.values[known.next_multiple_of(8).min(height) * width..].iter().all(|v| v.length() < 0.02)
        );
    }
    assert!(errors[0] < 3.0 && errors[1] > errors[0], "{errors:?}");
    drop(begin(90));
    let mut too_much = begin(90);
    let error = (0..200).find_map(|_| too_much.write(Rows::Srgb(pixels.clone())).err());
    let error = error.or_else(|| too_much.finish(true).err()).unwrap();
    assert!(error.to_string().contains("too many rows"), "{error}");
    assert!(begin(90).write(Rows::SrgbAlpha(vec![[0; 4]])).is_ok(), "the encoder finds it out");
    assert_eq!(names(folder.path()), 1);
}

#[test]
fn an_exr_written_in_portions_holds_every_layer() {
    let folder = tempfile::tempdir().unwrap();
    let colors: Vec<Vec3> =
        (0..7 * 40).map(|i| Vec3::new(i as f32 * 1e-6, 1e4 / (i + 1) as f32, 0.1)).collect();
    let ids: Vec<u32> = (0..7 * 40).map(|i| u32::MAX - i).collect();
    let channels =
        [("R", false), ("G", false), ("B", false), ("primitive.V", true)].map(|(n, i)| (n.to_owned(), i));
    let notes = [("Pose", "--eye 0,1,2".to_owned())];
    for is_complete in [true, false] {
        let to = target(folder.path(), "a.exr");
        let mut file = PictureFile::begin(to, Contents::Exr(channels.to_vec()), [7, 40], &notes).unwrap();
        for rows in if is_complete { vec![0..5, 5..23, 23..40] } else { vec![0..5, 5..23] } {
            let part = rows.start * 7..rows.end * 7;
            let mut values: Vec<ChannelValues> =
                Channel::rgb(&colors[part.clone()]).into_iter().map(|c| c.values).collect();
            values.push(ChannelValues::Index(ids[part].to_vec()));
            file.write(Rows::Channels(values)).unwrap();
        }
        let path = file.finish(is_complete).unwrap();
        let picture = Picture::load(&path).unwrap();
        let known = if is_complete { 7 * 40 } else { 7 * 23 };
        assert_eq!(picture.values[..known], colors[..known]);
        assert!(picture.values[known..].iter().all(|v| *v == Vec3::ZERO));
        let notes = read_notes(&path).unwrap();
        let note = |name: &str| notes.iter().find(|(n, _)| n == name).map(|(_, t)| t.trim().to_owned());
        let word = if is_complete { "yes" } else { "no" };
        assert_eq!((note("Pose").as_deref(), note("Complete").as_deref()), (Some("--eye 0,1,2"), Some(word)));
        let image = exr::prelude::read_first_flat_layer_from_file(&path).unwrap();
        let channel = |name: &str| {
            let list = &image.layer_data.channel_data.list;
            list.iter().find(|c| c.name.to_string() == name).unwrap().sample_data.clone()
        };
        let exr::prelude::FlatSamples::U32(stored) = channel("primitive.V") else { panic!("indices") };
        assert_eq!(stored[..known], ids[..known]);
    }
    assert_eq!(names(folder.path()), 1);
}

#[test]
fn names_are_numbered_and_an_abandoned_file_leaves_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let next = Target::Next { folder: folder.path().to_owned(), stem: "a".to_owned(), extension: "png" };
    let begin = || PictureFile::begin(next.clone(), Contents::PngAlpha, [1, 1], &[]).unwrap();
    for number in ["a-0001.png", "a-0002.png"] {
        let mut file = begin();
        file.write(Rows::SrgbAlpha(vec![[1, 2, 3, 4]])).unwrap();
        assert_eq!(file.finish(true).unwrap(), folder.path().join(number));
    }
    drop(begin());
    let mut too_much = begin();
    let error = (0..10).find_map(|_| too_much.write(Rows::SrgbAlpha(vec![[0; 4]])).err()).unwrap();
    assert!(error.to_string().contains("too many rows"), "{error}");
    assert_eq!(names(folder.path()), 2);
    let nowhere = Target::File(folder.path().join("none/a.png"));
    assert!(nowhere.probe().unwrap_err().to_string().contains("none"));
    assert!(PictureFile::begin(nowhere, Contents::Png, [1, 1], &[]).is_err());
}
