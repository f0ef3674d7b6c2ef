//! Claims about the statistics, by subject.

mod acceptance;
mod universe;
