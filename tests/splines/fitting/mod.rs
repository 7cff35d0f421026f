//! Fits of splines against their theory, and against equations that are set up independently.

mod bases;
mod choices;
mod clamped;
mod covariance;
mod elevations;
mod energies;
mod failures;
mod figure;
mod fits;
mod interpolation;
mod likelihood;
mod membranes;
mod normal_equations;
mod quantiles;
mod random_knots;
mod refinement;
mod robustness;
mod smoothing;
mod spacing;
mod undetermined;
