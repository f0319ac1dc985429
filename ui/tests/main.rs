//! One binary for all tests of the program.

mod window;
