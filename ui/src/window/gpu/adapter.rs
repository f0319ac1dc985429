//! Prepares the graphics adapter and reports its errors.

use crate::window::{gpu::viewport, rendering::lock::locked, rendering::task::Wake};
use egui_wgpu::RenderState;
use std::sync::{Arc, Mutex};

/// Prepares the graphics adapter; returns its name if it renders in software.
pub(crate) fn prepare(
    graphics: &RenderState,
    trouble: &Arc<Mutex<Vec<String>>>,
    wake: &Wake,
) -> Option<String> {
    watch(graphics, trouble, wake);
    viewport::install(graphics);
    let adapter = graphics.adapter.get_info();
    log::info!("graphics: {} ({}, {:?})", adapter.name, adapter.backend, adapter.device_type);
    (adapter.device_type == egui_wgpu::wgpu::DeviceType::Cpu).then_some(adapter.name)
}

/// Turns errors of the graphics device into messages. By default, wgpu panics.
fn watch(graphics: &RenderState, trouble: &Arc<Mutex<Vec<String>>>, wake: &Wake) {
    let (errors, ring) = (trouble.clone(), wake.clone());
    graphics.device.on_uncaptured_error(Arc::new(move |error: egui_wgpu::wgpu::Error| {
        locked(&errors)
            .push(format!("the graphics card reported an error: {}", in_one_line(&error.to_string())));
        ring();
    }));
    let (errors, ring) = (trouble.clone(), wake.clone());
    graphics.device.set_device_lost_callback(move |reason, text| {
        let text = if text.is_empty() { format!("the driver says only: {reason:?}") } else { text };
        locked(&errors).push(format!(
            "the connection to the graphics card was lost ({text}); save the session with Ctrl+S, then start the program again"
        ));
        ring();
    });
}

/// Joins the lines of wgpu's messages.
fn in_one_line(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}
