//! The experiments as a user runs them, at a small size.

mod shrec11;
