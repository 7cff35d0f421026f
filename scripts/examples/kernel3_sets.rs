//! Triangulates sets of points in 3D, one after another, for `scripts/check-cgal3`.
//!
//! On stdin, each set is its size as u32 and triples of f64; with `--weighted` quadruples, the last of which
//! is the weight. On stdout go the numbers of tetrahedra and of hull facets as u32, and four u32 per
//! tetrahedron, the indices of its points in the set. All numbers are little-endian.

use std::borrow::Cow;
use std::io::{self, Read, Write};

use spmesh_delaunay::delaunay3::{Kernel, Tetrahedralization};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let (mut input, mut output) = (io::stdin().lock(), io::BufWriter::new(io::stdout().lock()));
    // One kernel for all sets, to prove that no state of a set leaks into the next.
    let (mut kernel, mut mesh) = (Kernel::new(), Tetrahedralization::default());
    if std::env::args().nth(1).as_deref() == Some("--weighted") {
        while let Some(balls) = read_set::<4>(&mut input)? {
            let points = balls.iter().map(|&[x, y, z, _]| [x, y, z]).collect();
            let weights: Vec<f64> = balls.into_iter().map(|[.., weight]| weight).collect();
            kernel.triangulate_weighted(Cow::Owned(points), &weights, &mut mesh)?;
            write_set(&mesh, &mut output)?;
        }
    }
    while let Some(points) = read_set::<3>(&mut input)? {
        kernel.triangulate(Cow::Owned(points), &mut mesh)?;
        write_set(&mesh, &mut output)?;
    }
    Ok(())
}

fn read_set<const N: usize>(input: &mut impl Read) -> io::Result<Option<Vec<[f64; N]>>> {
    let mut size = [0; 4];
    match input.read_exact(&mut size) {
        Err(error) if error.kind() == io::ErrorKind::UnexpectedEof => return Ok(None),
        done => done?,
    }
    let mut bytes = vec![0; 8 * N * u32::from_le_bytes(size) as usize];
    input.read_exact(&mut bytes)?;
    let (numbers, _) = bytes.as_chunks::<8>();
    let (points, _) = numbers.as_chunks::<N>();
    Ok(Some(points.iter().map(|point| point.map(f64::from_le_bytes)).collect()))
}

fn write_set(mesh: &Tetrahedralization, output: &mut impl Write) -> io::Result<()> {
    let tetrahedra = mesh.tetrahedra();
    let sides = tetrahedra.iter().flat_map(|tetrahedron| (0..4).map(|side| tetrahedron.neighbour(side)));
    let hull = sides.filter(Option::is_none).count();
    output.write_all(&(tetrahedra.len() as u32).to_le_bytes())?;
    output.write_all(&(hull as u32).to_le_bytes())?;
    for tetrahedron in tetrahedra {
        for vertex in tetrahedron.vertices {
            output.write_all(&mesh.vertices()[vertex as usize].index.to_le_bytes())?;
        }
    }
    output.flush()
}
