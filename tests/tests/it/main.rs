//! Facts of the whole pipeline, on the shapes of the folder `fixtures` and on real ones.

mod equivalent_inputs;
mod invariance;
mod methods;
mod parts;
mod poses;
mod real_shapes;
mod turns;
