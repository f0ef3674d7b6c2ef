//! The C interface as C, C++ and Python see it.

mod header;
