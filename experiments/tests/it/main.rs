//! The experiments as a user runs them, at a small size.

mod pose_sets;
mod shrec11;
