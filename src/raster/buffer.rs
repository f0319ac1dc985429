//! A flat, row-major picture of any plain type.

/// `width * height` values, row-major, top row first.
#[derive(Clone, Debug, PartialEq)]
pub struct Buffer2d<T> {
    width: u32,
    height: u32,
    values: Vec<T>,
}

impl<T: Clone> Buffer2d<T> {
    /// A buffer filled with `value`.
    pub fn filled(width: u32, height: u32, value: T) -> Self {
        Self { width, height, values: vec![value; width as usize * height as usize] }
    }

    /// Sets size and content, keeping the allocation where it is large enough.
    pub fn reset(&mut self, width: u32, height: u32, value: T) {
        self.width = width;
        self.height = height;
        self.values.clear();
        self.values.resize(width as usize * height as usize, value);
    }
}

impl<T> Buffer2d<T> {
    /// Takes values that are already there; `None` where their number is not `width * height`.
    pub fn from_vec(width: u32, height: u32, values: Vec<T>) -> Option<Self> {
        (values.len() == width as usize * height as usize).then_some(Self { width, height, values })
    }

    /// Pixels per row.
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Number of rows.
    pub fn height(&self) -> u32 {
        self.height
    }

    /// All values, row by row from the top.
    pub fn values(&self) -> &[T] {
        &self.values
    }

    /// All values, to be written.
    pub fn values_mut(&mut self) -> &mut [T] {
        &mut self.values
    }
}

impl<T> Default for Buffer2d<T> {
    fn default() -> Self {
        Self { width: 0, height: 0, values: Vec::new() }
    }
}
