//! Tests of the whole workspace live in `tests/` beside this file.
