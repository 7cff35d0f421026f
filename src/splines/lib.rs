//! Bivariate splines over Delaunay configurations (thesis, chapters 6 to 8): bases, and fits to data.

pub mod bases;
pub mod fitting;
