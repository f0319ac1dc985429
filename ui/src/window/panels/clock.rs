//! Times of day as text.

/// Returns hours and minutes as people write them.
pub(super) fn clock_text(hours: f64) -> String {
    let minutes = (hours * 60.0).round() as u32;
    format!("{:02}:{:02}", minutes / 60, minutes % 60)
}

/// Returns the hours of a time like `18:30`, `18.30`, `18 30`, `1830` or `18`; `None` for other
/// texts.
pub(super) fn clock_hours(text: &str) -> Option<f64> {
    let text = text.trim();
    let is_digits = text.len() == 4 && text.bytes().all(|b| b.is_ascii_digit());
    let (hours, minutes) = match text.split_once([':', '.', ' ']) {
        Some(parts) => parts,
        None if is_digits => text.split_at(2),
        None => (text, "0"),
    };
    let [hours, minutes] = [hours, minutes].map(|part| part.parse::<u32>().ok());
    Some(f64::from(hours?) + f64::from(minutes.filter(|m| *m < 60)?) / 60.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_are_formatted_and_parsed_as_hours_and_minutes() {
        for (hours, text) in [(0.0, "00:00"), (9.5, "09:30"), (13.25, "13:15"), (24.0, "24:00")] {
            assert_eq!(clock_text(hours), text);
            assert_eq!(clock_hours(text), Some(hours));
        }
        for text in ["18:30", "18.30", "1830", " 18 30 "] {
            assert_eq!(clock_hours(text), Some(18.5), "{text}");
        }
        for text in ["noon", "", "12:75", "-3", "1e1"] {
            assert_eq!(clock_hours(text), None, "{text}");
        }
        assert_eq!(clock_hours("7"), Some(7.0));
    }
}
