//! Lines in triangle meshes that stream, against the definition.

mod definition;
mod peer;
mod scene;
