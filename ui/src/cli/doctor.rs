//! `afterimage doctor`: version, machine, graphics and paths, as a bug report needs them.

use super::{commit, failure::Failure, flags::Flags, output, paths};
use afterimage::experiment::run::Machine;
use serde_json::{Value, json};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;

pub(crate) fn run(flags: &Flags, user_file: Option<&Path>) -> Result<(), Failure> {
    let object = object(user_file);
    output::result(flags.json, &object, || table(&object));
    Ok(())
}

fn object(user_file: Option<&Path>) -> Value {
    let variable = |name: &str| std::env::var_os(name).map(|v| v.to_string_lossy().into_owned());
    let folder = |path: Option<std::path::PathBuf>| path.map(|p| p.display().to_string());
    let (adapters, graphics_error) = match adapters() {
        Ok(found) => (found, None),
        Err(cause) => (Vec::new(), Some(cause)),
    };
    let machine = Machine::here();
    json!({
        "version": env!("CARGO_PKG_VERSION"),
        "commit": commit::COMMIT,
        "build": commit::BUILD,
        "os": machine.os,
        "system": machine.system,
        "processor": machine.processor,
        "memory_gb": machine.memory_gb,
        "arch": machine.arch,
        "threads": rayon::current_num_threads(),
        "machine_threads": std::thread::available_parallelism().map_or(0, usize::from),
        "simd": {
            "in_use": [afterimage::math::simd::chosen()],
            "built_for": simd_built_for(),
            "available": simd_available(),
        },
        "adapters": adapters,
        "graphics_error": graphics_error,
        "display": {
            "WAYLAND_DISPLAY": variable("WAYLAND_DISPLAY"),
            "WAYLAND_SOCKET": variable("WAYLAND_SOCKET"),
            "DISPLAY": variable("DISPLAY"),
            "XDG_SESSION_TYPE": variable("XDG_SESSION_TYPE"),
        },
        "paths": {
            "config": folder(paths::config_folder()),
            "settings": folder(user_file.map(Path::to_owned)),
            "has_settings": user_file.is_some_and(Path::is_file),
            "state": folder(paths::state_folder()),
            "cache": folder(paths::cache_folder()),
        },
    })
}

/// Lists the graphics adapters. A driver that panics must not end the report.
fn adapters() -> Result<Vec<Value>, String> {
    let list = || {
        let instance = wgpu::Instance::default();
        pollster::block_on(instance.enumerate_adapters(wgpu::Backends::all()))
            .iter()
            .map(|adapter| {
                let info = adapter.get_info();
                json!({
                    "name": info.name,
                    "backend": info.backend.to_string(),
                    "kind": device_type(info.device_type),
                    "driver": format!("{} {}", info.driver, info.driver_info).trim(),
                })
            })
            .collect()
    };
    let hook = std::panic::take_hook();
    std::panic::set_hook(Box::new(|_| ()));
    let found = catch_unwind(AssertUnwindSafe(list)).map_err(|_| "the graphics driver failed".to_owned());
    std::panic::set_hook(hook);
    found
}

fn device_type(kind: wgpu::DeviceType) -> &'static str {
    match kind {
        wgpu::DeviceType::Other => "Other",
        wgpu::DeviceType::IntegratedGpu => "IntegratedGpu",
        wgpu::DeviceType::DiscreteGpu => "DiscreteGpu",
        wgpu::DeviceType::VirtualGpu => "VirtualGpu",
        wgpu::DeviceType::Cpu => "Cpu",
    }
}

/// SIMD instruction sets that the build requires.
fn simd_built_for() -> Vec<&'static str> {
    let all = [
        (cfg!(target_feature = "sse2"), "sse2"),
        (cfg!(target_feature = "sse4.1"), "sse4.1"),
        (cfg!(target_feature = "avx"), "avx"),
        (cfg!(target_feature = "avx2"), "avx2"),
        (cfg!(target_feature = "fma"), "fma"),
        (cfg!(target_feature = "neon"), "neon"),
    ];
    all.into_iter().filter_map(|(is, name)| is.then_some(name)).collect()
}

#[cfg(target_arch = "x86_64")]
fn simd_available() -> Vec<&'static str> {
    let all = [
        (true, "sse2"),
        (is_x86_feature_detected!("sse4.1"), "sse4.1"),
        (is_x86_feature_detected!("avx"), "avx"),
        (is_x86_feature_detected!("avx2"), "avx2"),
        (is_x86_feature_detected!("fma"), "fma"),
        (is_x86_feature_detected!("avx512f"), "avx512f"),
    ];
    all.into_iter().filter_map(|(is, name)| is.then_some(name)).collect()
}

#[cfg(not(target_arch = "x86_64"))]
fn simd_available() -> Vec<&'static str> {
    simd_built_for()
}

fn table(object: &Value) -> String {
    let text = |value: &Value| match value {
        Value::Null => "-".to_owned(),
        Value::String(s) => s.clone(),
        Value::Array(list) if list.is_empty() => "none".to_owned(),
        Value::Array(list) => list.iter().filter_map(Value::as_str).collect::<Vec<_>>().join(" "),
        other => other.to_string(),
    };
    let at = |pointer: &str| object.pointer(pointer).map_or("-".to_owned(), text);
    let has_settings = object["paths"]["has_settings"] == true;
    let missing = if has_settings { "" } else { " (no such file: the defaults apply)" };
    let mut rows = vec![
        ("version", commit::version()),
        ("system", format!("{} ({} {})", at("/system"), at("/os"), at("/arch"))),
        ("processor", at("/processor")),
        ("memory", format!("{} GB", at("/memory_gb"))),
        ("threads", format!("{} of {}", at("/threads"), at("/machine_threads"))),
        ("SIMD in use", at("/simd/in_use")),
        ("SIMD available", at("/simd/available")),
        (
            "display",
            format!("DISPLAY {}, WAYLAND_DISPLAY {}", at("/display/DISPLAY"), at("/display/WAYLAND_DISPLAY")),
        ),
        ("settings", format!("{}{missing}", at("/paths/settings"))),
        ("sessions", at("/paths/state")),
        ("cache", at("/paths/cache")),
    ];
    let adapters = object["adapters"].as_array().map_or(&[][..], Vec::as_slice);
    if adapters.is_empty() {
        rows.push(("graphics", format!("no adapter {}", object["graphics_error"].as_str().unwrap_or(""))));
    }
    for adapter in adapters {
        let word = |key: &str| adapter[key].as_str().unwrap_or("-").to_owned();
        rows.push((
            "graphics",
            format!("{} ({}, {}, {})", word("name"), word("backend"), word("kind"), word("driver")),
        ));
    }
    output::table(&rows)
}
