//! The legend of a picture in false colour: a bar of its colours with numbers.

use super::false_color::{color, line_step};

/// Width and height of a letter, dots, with the gap after it.
const ADVANCE: usize = 6;
const LETTER: [usize; 2] = [5, 7];

/// Dots of the letters that legends need, row by row from the top.
const FONT: [(char, [&str; 7]); 27] = [
    ('0', [" ### ", "#   #", "#  ##", "# # #", "##  #", "#   #", " ### "]),
    ('1', ["  #  ", " ##  ", "  #  ", "  #  ", "  #  ", "  #  ", " ### "]),
    ('2', [" ### ", "#   #", "    #", "   # ", "  #  ", " #   ", "#####"]),
    ('3', ["#####", "   # ", "  #  ", "   # ", "    #", "#   #", " ### "]),
    ('4', ["   # ", "  ## ", " # # ", "#  # ", "#####", "   # ", "   # "]),
    ('5', ["#####", "#    ", "#### ", "    #", "    #", "#   #", " ### "]),
    ('6', ["  ## ", " #   ", "#    ", "#### ", "#   #", "#   #", " ### "]),
    ('7', ["#####", "    #", "   # ", "  #  ", " #   ", " #   ", " #   "]),
    ('8', [" ### ", "#   #", "#   #", " ### ", "#   #", "#   #", " ### "]),
    ('9', [" ### ", "#   #", "#   #", " ####", "    #", "   # ", " ##  "]),
    ('.', ["     ", "     ", "     ", "     ", "     ", " ##  ", " ##  "]),
    ('%', ["##   ", "##  #", "   # ", "  #  ", " #   ", "#  ##", "   ##"]),
    ('/', ["     ", "    #", "   # ", "  #  ", " #   ", "#    ", "     "]),
    ('a', ["     ", "     ", " ### ", "    #", " ####", "#   #", " ####"]),
    ('c', ["     ", "     ", " ### ", "#    ", "#    ", "#   #", " ### "]),
    ('d', ["    #", "    #", " ## #", "#  ##", "#   #", "#   #", " ####"]),
    ('e', ["     ", "     ", " ### ", "#   #", "#####", "#    ", " ### "]),
    ('h', ["#    ", "#    ", "# ## ", "##  #", "#   #", "#   #", "#   #"]),
    ('i', ["  #  ", "     ", " ##  ", "  #  ", "  #  ", "  #  ", " ### "]),
    ('l', [" ##  ", "  #  ", "  #  ", "  #  ", "  #  ", "  #  ", " ### "]),
    ('m', ["     ", "     ", "## # ", "# # #", "# # #", "#   #", "#   #"]),
    ('o', ["     ", "     ", " ### ", "#   #", "#   #", "#   #", " ### "]),
    ('r', ["     ", "     ", "# ## ", "##  #", "#    ", "#    ", "#    "]),
    ('t', [" #   ", " #   ", "###  ", " #   ", " #   ", " #  #", "  ## "]),
    ('u', ["     ", "     ", "#   #", "#   #", "#   #", "#  ##", " ## #"]),
    ('v', ["     ", "     ", "#   #", "#   #", "#   #", " # # ", "  #  "]),
    ('x', ["     ", "     ", "#   #", " # # ", "  #  ", " # # ", "#   #"]),
];

const BACKGROUND: [u8; 3] = [24, 24, 24];
const INK: [u8; 3] = [235, 235, 235];

/// Smallest height of a picture in pixels at which a dot of a letter is two pixels wide, and so on.
const HEIGHT_OF_DOT: usize = 400;

/// What a legend says.
#[derive(Clone, Copy, Debug)]
pub struct Legend<'a> {
    /// Value of the brightest colour.
    pub max: f32,
    /// Unit of the values, such as `lx`.
    pub unit: &'a str,
    /// True where the values are relative, which is written below the unit.
    pub is_relative: bool,
}

/// Returns a picture, row-major sRGB, with the legend to the right of it, and its size.
pub fn beside(
    picture: &[[u8; 3]],
    [width, height]: [u32; 2],
    legend: Legend<'_>,
) -> (Vec<[u8; 3]>, [u32; 2]) {
    let [width, height] = [width, height].map(|side| side as usize);
    let mut board = Board::new(height, legend);
    board.draw(legend);
    let row = |y: usize| {
        let of_board = &board.pixels[y * board.width..(y + 1) * board.width];
        picture[y * width..(y + 1) * width].iter().chain(of_board).copied()
    };
    let pixels = (0..height).flat_map(row).collect();
    (pixels, [(width + board.width) as u32, height as u32])
}

/// Returns a number for the legend: no more digits than it needs.
pub fn number(value: f32) -> String {
    let text = format!("{value:.4}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    text.to_owned()
}

/// The pixels of the legend.
struct Board {
    pixels: Vec<[u8; 3]>,
    width: usize,
    height: usize,
    /// Width of a dot of a letter, pixels.
    dot: usize,
}

impl Board {
    fn new(height: usize, legend: Legend<'_>) -> Self {
        let dot = 1 + height / HEIGHT_OF_DOT;
        let words = [number(legend.max), number(line_step(legend.max)), legend.unit.to_owned()];
        let relative = if legend.is_relative { "relative".len() } else { 0 };
        let letters = words.iter().map(|word| word.len() + 3).max().unwrap_or(0).max(relative + 1);
        let width = letters * ADVANCE * dot;
        Self { pixels: vec![BACKGROUND; width * height], width, height, dot }
    }

    fn draw(&mut self, legend: Legend<'_>) {
        let line = (LETTER[1] + 3) * self.dot;
        let lines = 1 + usize::from(legend.is_relative);
        self.write(legend.unit, [3 * self.dot, 3 * self.dot]);
        if legend.is_relative {
            self.write("relative", [3 * self.dot, 3 * self.dot + line]);
        }
        let (top, bottom) = (lines * line + 8 * self.dot, self.height.saturating_sub(8 * self.dot));
        if bottom <= top + line {
            return;
        }
        let bar = (2 * self.dot, 10 * self.dot);
        for y in top..bottom {
            let share = (bottom - 1 - y) as f32 / (bottom - 1 - top) as f32;
            self.pixels[y * self.width + bar.0..y * self.width + bar.0 + bar.1].fill(color(share));
        }
        self.write_numbers(legend.max, [top, bottom], 14 * self.dot);
    }

    /// Writes round numbers next to the bar, as many as there is room for.
    fn write_numbers(&mut self, max: f32, [top, bottom]: [usize; 2], x: usize) {
        let (step, half) = (line_step(max), LETTER[1] * self.dot / 2);
        let y_of = |value: f32| bottom - 1 - ((bottom - 1 - top) as f32 * value / max) as usize;
        let every =
            (1..).find(|n| (bottom - y_of(step * *n as f32)) > 12 * self.dot || *n as f32 * step >= max);
        let every = step * every.unwrap_or(1) as f32;
        let mut value = 0.0;
        while value <= max * (1.0 + f32::EPSILON) {
            self.write(&number(value), [x, y_of(value.min(max)).saturating_sub(half)]);
            value += every;
        }
    }

    /// Writes a text from its upper left corner. What has no room is left out.
    fn write(&mut self, text: &str, [x, y]: [usize; 2]) {
        for (i, letter) in text.chars().enumerate() {
            let Some((_, rows)) = FONT.iter().find(|(known, _)| *known == letter) else { continue };
            for (j, row) in rows.iter().enumerate() {
                let dots = row.bytes().enumerate().filter(|(_, dot)| *dot == b'#');
                for (k, _) in dots {
                    self.dot([x + (i * ADVANCE + k) * self.dot, y + j * self.dot]);
                }
            }
        }
    }

    fn dot(&mut self, [x, y]: [usize; 2]) {
        for y in y..(y + self.dot).min(self.height) {
            for x in x..(x + self.dot).min(self.width) {
                self.pixels[y * self.width + x] = INK;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_legend_stands_beside_the_picture_and_shows_the_ends_of_the_scale() {
        let picture = vec![[1, 2, 3]; 40 * 200];
        for (max, is_relative) in [(500.0, false), (0.05, true), (20_000.0, true)] {
            let (shown, [width, height]) =
                beside(&picture, [40, 200], Legend { max, unit: "cd/m2", is_relative });
            assert!(width > 40 && height == 200 && shown.len() == (width * height) as usize);
            let rows: Vec<&[[u8; 3]]> = shown.chunks(width as usize).collect();
            assert!(rows.iter().all(|row| row[..40] == [[1, 2, 3]; 40]), "the picture is as it was");
            for share in [0.0, 1.0] {
                assert!(rows.iter().any(|row| row[40..].contains(&color(share))), "{max}: {share}");
            }
            assert!(shown.contains(&INK));
        }
        // A picture that is too low for a bar keeps its pixels.
        let legend = Legend { max: 1.0, unit: "lx", is_relative: false };
        assert_eq!(beside(&[[9; 3]; 6], [3, 2], legend).0[..3], [[9; 3]; 3]);
    }

    #[test]
    fn numbers_are_short() {
        for (value, text) in [(0.0, "0"), (0.05, "0.05"), (500.0, "500"), (2.5, "2.5")] {
            assert_eq!(number(value), text);
        }
    }
}
