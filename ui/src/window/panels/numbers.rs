//! Sliders and number fields. They change a value only when the user does: drawing them, or walking
//! over them with Tab, neither rounds a value nor clamps it. What is typed counts on Enter, or when
//! the field is left; Escape drops it.

use super::clock::{clock_hours, clock_text};
use egui::{DragValue, Id, Key, Response, Slider, SliderClamping, Ui, emath::Numeric};
use std::ops::RangeInclusive;

/// How a number is shown and changed. Values outside the range are shown as they are; what the user
/// sets is within it.
#[derive(Clone, Debug)]
pub struct Number {
    /// Range of the shown number.
    range: RangeInclusive<f64>,
    decimals: usize,
    unit: &'static str,
    /// The number is shown multiplied by this.
    factor: f64,
    step: f64,
    is_logarithmic: bool,
    /// Change for a point of dragging in a field.
    speed: f64,
    /// The number is hours of a day, shown and typed as hours and minutes.
    is_clock: bool,
}

impl Number {
    /// A number with a fixed number of decimals and a unit, which is empty or begins with a space
    /// where one belongs.
    pub fn new(range: RangeInclusive<f64>, decimals: usize, unit: &'static str) -> Self {
        let speed = 10f64.powi(-(decimals as i32));
        let (factor, step) = (1.0, 0.0);
        Self { range, decimals, unit, factor, step, is_logarithmic: false, speed, is_clock: false }
    }

    /// A time of day in hours, shown and typed as hours and minutes.
    pub fn clock() -> Self {
        Self { is_clock: true, speed: 1.0 / 60.0, ..Self::new(0.0..=24.0, 0, "") }
    }

    /// A share that is shown in whole percent.
    pub fn percent(range: RangeInclusive<f64>) -> Self {
        Self { factor: 100.0, ..Self::new(range, 0, " %") }
    }

    /// The same on a logarithmic scale.
    #[must_use]
    pub fn logarithmic(self) -> Self {
        Self { is_logarithmic: true, ..self }
    }

    /// The same in steps of the shown number.
    #[must_use]
    pub fn step(self, step: f64) -> Self {
        Self { step, ..self }
    }

    /// The same with another change for a point of dragging in a field.
    #[must_use]
    pub fn speed(self, speed: f64) -> Self {
        Self { speed, ..self }
    }

    /// Shows a slider with a number field.
    pub fn slider<T: Numeric>(&self, ui: &mut Ui, value: &mut T) -> Response {
        let mut edited = value.to_f64() * self.factor;
        let is_dropped = has_dropped_text(ui);
        let get_or_set = |new: Option<f64>| self.get_or_set(&mut edited, new.filter(|_| !is_dropped));
        let slider = Slider::from_get_set(self.range.clone(), get_or_set)
            .clamping(SliderClamping::Edits)
            .update_while_editing(false)
            .logarithmic(self.is_logarithmic)
            .fixed_decimals(self.decimals)
            .suffix(self.unit);
        let slider = if self.step > 0.0 { slider.step_by(self.step) } else { slider };
        let response = ui.add(slider);
        self.store(value, edited);
        response
    }

    /// Shows a field that is dragged or typed into. `prefix` is shown before the number.
    pub fn field<T: Numeric>(&self, ui: &mut Ui, prefix: &str, value: &mut T) -> Response {
        let mut edited = value.to_f64() * self.factor;
        let is_dropped = has_dropped_text(ui);
        let get_or_set = |new: Option<f64>| self.get_or_set(&mut edited, new.filter(|_| !is_dropped));
        let field = DragValue::from_get_set(get_or_set)
            .range(self.range.clone())
            .clamp_existing_to_range(false)
            .update_while_editing(false)
            .speed(self.speed)
            .prefix(prefix)
            .suffix(self.unit);
        let field = match self.is_clock {
            true => field.custom_formatter(|hours, _| clock_text(hours)).custom_parser(clock_hours),
            false => field.fixed_decimals(self.decimals),
        };
        let response = ui.add(field);
        self.store(value, edited);
        response
    }

    /// Sets a number, unless it is shown as the old one is; returns it. A field that is left
    /// without a change sets its own text, within the range.
    fn get_or_set(&self, edited: &mut f64, new: Option<f64>) -> f64 {
        let kept = [*edited, edited.clamp(*self.range.start(), *self.range.end())].map(|n| self.shown(n));
        if let Some(new) = new.filter(|new| !kept.contains(&self.shown(*new))) {
            *edited = new;
        }
        *edited
    }

    /// Stores a number that has changed; others keep all their digits.
    fn store<T: Numeric>(&self, value: &mut T, edited: f64) {
        if edited != value.to_f64() * self.factor {
            *value = T::from_f64(edited / self.factor);
        }
    }

    /// The number in units of its last digit, as it is shown.
    fn shown(&self, number: f64) -> f64 {
        let steps = if self.is_clock { 60.0 } else { 10f64.powi(self.decimals as i32) };
        (number * steps).round()
    }
}

/// True in the update in which Escape leaves a field, and in the next one: egui takes the text of a
/// field up to one update after the focus is lost, and then no longer knows why it was.
fn has_dropped_text(ui: &Ui) -> bool {
    let (id, now) = (Id::unique("escape from a number"), ui.ctx().cumulative_pass_nr());
    if ui.input(|input| input.key_pressed(Key::Escape)) {
        ui.data_mut(|data| data.insert_temp(id, now));
    }
    ui.data(|data| data.get_temp::<u64>(id)).is_some_and(|escaped| now <= escaped + 1)
}
