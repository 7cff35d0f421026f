//! Independent canonical Delaunay triangulations, slow and simple. They share no code with the library.

pub mod clouds;
pub mod configurations;
pub mod constrained;
pub mod diagram4;
pub mod exact;
pub mod exact3;
pub mod exhaustive;
pub mod incremental;
pub mod laplace;
pub mod natural;
pub mod noding;
pub mod overlay;
pub mod peer;
pub mod segments;
pub mod sets;
pub mod sets4;
pub mod space;
pub mod tetrahedra;

/// A triangle as its vertex indices, counterclockwise, the least first.
pub fn normalised(triangle: [u32; 3]) -> [u32; 3] {
    let [a, b, c] = triangle;
    [[a, b, c], [b, c, a], [c, a, b]].into_iter().min().expect("three rotations")
}

/// Triangles as a sorted set.
pub fn as_set(triangles: impl IntoIterator<Item = [u32; 3]>) -> Vec<[u32; 3]> {
    let mut set: Vec<[u32; 3]> = triangles.into_iter().map(normalised).collect();
    set.sort_unstable();
    set
}
