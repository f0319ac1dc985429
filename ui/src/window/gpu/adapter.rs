//! The graphics card: made ready, and watched.

use crate::window::gpu::viewport;
use crate::window::rendering::lock::locked;
use crate::window::rendering::task::Wake;
use egui_wgpu::RenderState;
use std::sync::{Arc, Mutex};

/// Makes the graphics card ready; returns its name where it is none, but the processor.
pub(crate) fn prepare(
    graphics: &RenderState,
    trouble: &Arc<Mutex<Vec<String>>>,
    wake: &Wake,
) -> Option<String> {
    watch(graphics, trouble, wake);
    viewport::install(graphics);
    let adapter = graphics.adapter.get_info();
    (adapter.device_type == egui_wgpu::wgpu::DeviceType::Cpu).then_some(adapter.name)
}

/// Errors of the graphics card become messages; wgpu's own answer would be a panic.
fn watch(graphics: &RenderState, trouble: &Arc<Mutex<Vec<String>>>, wake: &Wake) {
    let (errors, ring) = (trouble.clone(), wake.clone());
    graphics.device.on_uncaptured_error(Arc::new(move |error: egui_wgpu::wgpu::Error| {
        locked(&errors)
            .push(format!("the graphics card reported an error: {}", in_one_line(&error.to_string())));
        ring();
    }));
    let (errors, ring) = (trouble.clone(), wake.clone());
    graphics.device.set_device_lost_callback(move |reason, text| {
        let text = if text.is_empty() { format!("{reason:?}") } else { text };
        locked(&errors).push(format!(
            "the graphics card was lost ({text}); save the session with Ctrl+S, then start the program again"
        ));
        ring();
    });
}

/// wgpu tells causes line by line.
fn in_one_line(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}
